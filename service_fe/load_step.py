"""One load step: out-of-balance force of soil and pile, its linearisation, the accepted result.

Unknowns are the increments of soil displacement u and pile motion q since the accepted state; the
unknown part q_l of the pile's motion is solved for together with u (``coupled_solver``).  What is
imposed on the pile may be told in other components s, q = F s (``rigid_pile``); then K_sp F stands
for K_sp, and F^T r_p for r_p.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState
from handoff.tensor_arrays import tensors_of
from install_mpm.constitutive.dispatch import Materials
from service_fe.axisymmetric_forms import AxisymmetricForms
from service_fe.coupled_solver import CoupledSolver, CoupledSystem
from service_fe.interface_forms import InterfaceForms, InterfaceResponse
from service_fe.linear_solver import FactorisationError
from service_fe.material_map import SoilResponse, soil_response
from service_fe.newton import StepNotConvergedError, linear_tolerance, solve_newton
from service_fe.options import ServiceNumerics
from service_fe.rigid_pile import PileControl, frame_of
from service_fe.soil_forms import SoilForms
from service_fe.step import Step, Unknowns
from service_fe.viscosity import viscous_stress, viscous_tangent, viscous_work


class Model(NamedTuple):
    """The discrete model; nothing in it depends on the state of the ground."""

    soil: SoilForms | AxisymmetricForms
    interface: InterfaceForms
    solver: CoupledSolver
    materials: Materials
    interface_parameters: np.ndarray
    """Packed parameters (n_i, 7)."""
    is_fixed: np.ndarray
    """Supports (node, dim) bool."""
    pile_weight: np.ndarray
    """Weight (n_motions,) of the modelled part of the pile, in N and N m."""
    numerics: ServiceNumerics


class Trial(NamedTuple):
    """The model evaluated at trial unknowns; satisfies ``newton.Trial``."""

    unknowns: Unknowns
    soil: SoilResponse
    interface: InterfaceResponse
    soil_residual: np.ndarray
    """Internal less external force (node, dim) in N."""
    pile_force: np.ndarray
    """Internal force less weight (n_motions,): the load that the pile needs."""
    out_of_balance: np.ndarray
    relative_residual: float


class LoadStep:
    """What is imposed in one step on a model in an accepted state.

    ``support_motion`` and ``external_force`` are (node, dim) in m and N; see
    ``ServiceProblem.solve``.  With ``damping`` the soil has a viscous stress beside its own.
    """

    def __init__(
        self,
        model: Model,
        state: FEState,
        control: PileControl,
        support_motion: np.ndarray,
        external_force: np.ndarray,
        damping: float = 0.0,
    ) -> None:
        self.model, self.state, self.control = model, state, control
        self._frame = frame_of(control)
        self._own_state = own = model.soil.partition.own(state)
        self._viscosity = damping * viscous_tangent(model.materials, own) if damping else None
        self.support_motion = np.where(model.is_fixed, support_motion, 0.0)
        self.external_force = external_force
        self._fixed_dofs = np.flatnonzero(model.is_fixed)
        lever = np.abs(model.interface.positions).max(initial=0.0) or 1.0
        self._pile_scale = np.full(len(control.motion), 1.0 / lever)
        self._pile_scale[: support_motion.shape[1]] = 1.0
        self._start_reference = 0.0
        unmoved = self.evaluate(self._first_unknowns(None))
        self._start_reference = self._reference(unmoved.soil_residual, unmoved.pile_force)
        self._start_load = unmoved.pile_force

    def solve(self, guess: Unknowns | None) -> Step:
        """Return the accepted step; see ``ServiceProblem.solve`` for guess and errors."""
        start = self.evaluate(self._first_unknowns(guess))
        try:
            solution = solve_newton(
                start,
                self.search_direction,
                self._evaluate_along,
                self._has_jump(start),
                self.model.numerics.tolerance,
                self.model.numerics.max_iterations,
                self.model.soil.partition.agreed,
            )
        except FactorisationError as error:
            raise StepNotConvergedError(str(error), (start.relative_residual,)) from error
        return self._accepted(solution.trial, solution.residuals)

    def _first_unknowns(self, guess: Unknowns | None) -> Unknowns:
        if guess is None:
            return Unknowns(np.zeros_like(self.support_motion), np.zeros(len(self.control.motion)))
        own = np.where(self.control.is_loaded, self._in_frame(guess.motion), self.control.motion)
        return Unknowns(
            np.where(self.model.is_fixed, self.support_motion, guess.displacement),
            self._frame @ own,
        )

    def _in_frame(self, motion: np.ndarray) -> np.ndarray:
        """Return the components s (n_motions,) of a motion q."""
        return np.linalg.solve(self._frame, motion)

    def _evaluate_along(self, trial: Trial, direction: np.ndarray, length: float) -> Trial:
        displacement, motion = trial.unknowns
        step = length * direction
        of_soil, own = np.split(step, [displacement.size])
        return self.evaluate(
            Unknowns(displacement + of_soil.reshape(displacement.shape), motion + self._frame @ own)
        )

    def evaluate(self, unknowns: Unknowns) -> Trial:
        """Return the response, the out-of-balance force and its relative size."""
        model, state = self.model, self.state
        strain = model.soil.strain(unknowns.displacement)
        soil = soil_response(model.materials, self._own_state, strain)
        stress = soil.stress
        if self._viscosity is not None:
            stress = stress + viscous_stress(self._viscosity, strain)
            soil = soil._replace(tangent=soil.tangent + self._viscosity)
        interface = model.interface.response(
            model.interface_parameters,
            state.interface_traction,
            model.interface.relative_displacement(unknowns.displacement, unknowns.motion),
        )
        interface_force, internal_pile_force = model.interface.forces(interface.traction)
        soil_residual = model.soil.internal_force(stress) + interface_force - self.external_force
        pile_force = internal_pile_force - model.pile_weight
        free_soil = np.where(model.is_fixed, 0.0, soil_residual)
        own_force = pile_force @ self._frame
        loaded_pile = np.where(self.control.is_loaded, own_force - self.control.load, 0.0)
        reference = self._reference(soil_residual, pile_force)
        is_valid = bool(model.soil.partition.sum_of(np.array(soil.n_failed)) == 0)
        relative = self._relative(free_soil, loaded_pile, reference) if is_valid else float("nan")
        return Trial(
            unknowns,
            soil,
            interface,
            soil_residual,
            pile_force,
            np.concatenate([free_soil.ravel(), loaded_pile]),
            model.soil.partition.agreed(relative),
        )

    def _viscous_share(self, trial: Trial) -> float:
        """Return the work of the viscous stress over that of the larger of the pile's two loads.

        By virtual work it is the share of the load that viscosity takes.
        """
        if self._viscosity is None:
            return 0.0
        displacement, motion = trial.unknowns
        of_pile = max(abs(load @ motion) for load in (self._start_load, trial.pile_force))
        viscous = viscous_work(self.model.soil, self._viscosity, displacement)
        return viscous / of_pile if of_pile else 0.0

    def _reference(self, soil_residual: np.ndarray, pile_force: np.ndarray) -> float:
        """Return external force plus support reaction plus load or reaction of the pile, in N.

        Or what that was at the step's start, if more: a step that takes all load away ends at zero.
        """
        pile = np.where(self.control.is_loaded, self.control.load, pile_force @ self._frame)
        reference = (
            np.linalg.norm(self.external_force)
            + np.linalg.norm(soil_residual[self.model.is_fixed])
            + np.linalg.norm(self._pile_scale * pile)
        )
        return max(float(reference), self._start_reference)

    def _relative(self, free_soil: np.ndarray, loaded_pile: np.ndarray, reference: float) -> float:
        """Return the out-of-balance force over the reference."""
        residual = np.linalg.norm(free_soil) + np.linalg.norm(self._pile_scale * loaded_pile)
        if residual == 0.0:
            return 0.0
        return float(residual / reference) if reference > 0.0 else 1.0

    def _jumps(self, trial: Trial) -> tuple[np.ndarray, np.ndarray]:
        """Return what the prescribed displacements (n_dofs,) and motions s still lack."""
        displacement, motion = trial.unknowns
        soil = np.where(self.model.is_fixed, self.support_motion - displacement, 0.0)
        lacking = self.control.motion - self._in_frame(motion)
        pile = np.where(self.control.is_loaded, 0.0, lacking)
        return soil.ravel(), pile

    def _has_jump(self, trial: Trial) -> bool:
        has_one = any(bool(jump.any()) for jump in self._jumps(trial))
        return self.model.soil.partition.agreed(has_one)

    def search_direction(self, trial: Trial) -> np.ndarray:
        """Return the Newton correction (n_dofs + n_motions,) of soil displacement and motion s.

        It is as exact as ``linear_tolerance`` asks.
        """
        soil_jump, motion = self._jumps(trial)
        system = self._system(trial, soil_jump, motion)
        size = np.hypot(np.linalg.norm(system.soil_force), np.linalg.norm(system.pile_force))
        reference = self._reference(trial.soil_residual, trial.pile_force)
        soil, motion[self.control.is_loaded] = self.model.solver.solve(
            system, linear_tolerance(float(size), reference, self.model.numerics.tolerance)
        )
        return np.concatenate([soil + soil_jump, motion])

    def _system(self, trial: Trial, soil_jump: np.ndarray, pile_jump: np.ndarray) -> CoupledSystem:
        """Return the linear system of an iteration, with K_ss left in the solver's matrix."""
        matrix, fixed, loaded = self.model.solver.matrix, self._fixed_dofs, self.control.is_loaded
        self.model.soil.stiffness(trial.soil.tangent)  # fills the solver's matrix
        interface = self.model.interface.stiffness(trial.interface.tangent)
        matrix.add_blocks(interface.dofs, interface.soil)
        motions = self._frame[:, loaded]
        soil_pile, pile_soil = interface.soil_pile @ motions, motions.T @ interface.pile_soil
        moved = self._frame @ pile_jump

        soil_force = -trial.soil_residual.ravel() - interface.soil_pile @ moved
        if soil_jump.any():
            soil_force -= matrix.multiply(soil_jump)
        lacking = self.control.load[loaded] - motions.T @ (
            trial.pile_force + interface.pile @ moved
        )
        pile_force = lacking - pile_soil @ soil_jump
        soil_force[fixed], soil_pile[fixed], pile_soil[:, fixed] = 0.0, 0.0, 0.0
        matrix.fix(fixed, diagonal=matrix.mean_diagonal())
        scale = self._pile_scale[loaded]
        return CoupledSystem(
            soil_pile=soil_pile,
            pile_soil=scale[:, None] * pile_soil,
            pile=scale[:, None] * (motions.T @ interface.pile @ motions),
            soil_force=soil_force,
            pile_force=scale * pile_force,
            motions=motions,
        )

    def _accepted(self, trial: Trial, residuals: tuple[float, ...]) -> Step:
        whole = self.model.soil.partition.whole
        state = FEState(
            cauchy_stress=whole(tensors_of(trial.soil.stress)),
            elastic_strain=whole(tensors_of(trial.soil.elastic_strain)),
            state_variables=whole(trial.soil.state_variables),
            material=self.state.material,
            interface_traction=trial.interface.traction,
            pile_displacement=self.state.pile_displacement
            + trial.unknowns.motion[: len(self.state.pile_displacement)],
        )
        reaction = np.where(self.model.is_fixed, trial.soil_residual, 0.0)
        viscous = self._viscous_share(trial)
        return Step(state, trial.unknowns, trial.pile_force, reaction, residuals, viscous)
