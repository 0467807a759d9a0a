"""Equilibrium of one step on the background mesh: residual and tangent for a trial displacement."""

from __future__ import annotations

from functools import partial
from itertools import chain, repeat
from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, size_at_nodes
from install_mpm.constitutive.dispatch import Model
from install_mpm.discretisation import Discretisation
from install_mpm.far_field import far_field_mismatch
from install_mpm.integration_points import CellFill, IntegrationPoints, Trial, empty_trial
from install_mpm.interface import (
    Contact,
    InterfacePoints,
    add_turning_of_traction,
    soil_displacement,
    step_axes,
)
from install_mpm.kernels.carry import body_force
from install_mpm.kernels.equilibrium import evaluate_cells
from install_mpm.kernels.interface_force import evaluate_interface
from install_mpm.kernels.scatter import constrain, scatter_force, scatter_stiffness
from install_mpm.linear_solvers import BorderedTangent, LinearSolve, solve_bordered
from install_mpm.loaded_pile import LoadedMotions, border, turning_places, with_found
from install_mpm.newton import NO_LIMIT, Evaluation, NewtonResult, solve_newton
from install_mpm.pile import PileMotion, rigid_displacement
from install_mpm.soft_terms import PRESSURE_DEPENDENT, cell_options, softly_held
from install_mpm.timing import measured


class Prescribed(NamedTuple):
    """Prescribed nodal displacements of a step, supports and whatever else is driven, and loads."""

    is_prescribed: np.ndarray
    """(n_nodes, dim) bool."""
    displacement: np.ndarray
    """(n_nodes, dim) in m."""
    force: np.ndarray | None = None
    """Dead nodal load at the end of the step beside the weight, (n_nodes, dim) in N; None: none."""


class StepEquilibrium(NamedTuple):
    """Solution of a step; of use only if ``newton.is_converged``."""

    newton: NewtonResult
    displacement: np.ndarray
    """Nodal displacement increment, (n_nodes, dim) in m."""
    trial: Trial
    """State at the integration points at the end of the step."""
    traction: np.ndarray
    """Interface traction at the end of the step, local axes, (n_interface_points, dim) in Pa."""
    reaction: np.ndarray
    """Support force at prescribed dofs, zero elsewhere, (n_nodes, dim) in N."""
    internal_force: np.ndarray
    """Of the stresses at the end of the step, (n_nodes, dim) in N."""
    external_force: np.ndarray
    """Weight and nodal loads, (n_nodes, dim) in N."""
    contact: Contact
    """What pile and soil do to each other at the end of the step."""
    motion: PileMotion
    """Of the pile in the step, with what was found of it."""


def find_equilibrium(
    mesh: BackgroundMesh,
    points: IntegrationPoints,
    fill: CellFill,
    interface: InterfacePoints,
    motion: PileMotion,
    prescribed: Prescribed,
    start: np.ndarray,
    model: Discretisation,
    loaded: LoadedMotions | None = None,
) -> StepEquilibrium:
    """Return the equilibrium of soil and interface at the end of the step (paper, 2.1, phase ii).

    ``start`` (n_nodes, dim) is the first trial displacement in m.  The pile makes the given
    ``motion`` and those that are ``loaded``, as far as their loads take it.
    """
    system = StepSystem(mesh, points, fill, interface, motion, prescribed, model, loaded)
    first = np.where(prescribed.is_prescribed, prescribed.displacement, start)
    first = np.where(system.is_free | prescribed.is_prescribed, first, 0.0).ravel()
    if loaded is not None:
        first = np.append(first, loaded.start)
    if prescribed.displacement.any() and not start.any():
        first = _elastic_solution(system, first)
    newton = _newton_from(system, first, gives_up=model.numerics.second_start)
    if not newton.is_converged and model.numerics.second_start:
        at_rest = np.where(prescribed.is_prescribed, prescribed.displacement, 0.0).ravel()
        at_rest = np.append(at_rest, np.zeros(first.size - start.size))
        again, wasted = _newton_from(system, at_rest), newton.residuals
        both = np.concatenate([wasted[np.isfinite(wasted)], again.residuals])
        newton = again._replace(residuals=both)
    reaction = np.where(prescribed.is_prescribed, system.out_of_balance, 0.0)
    return StepEquilibrium(
        newton,
        newton.solution[: start.size].reshape(start.shape),
        system.trial,
        system.traction,
        reaction,
        system.internal,
        system.external,
        system.contact(),
        system.motion,
    )


def _newton_from(system: StepSystem, first: np.ndarray, *, gives_up: bool = False) -> NewtonResult:
    """Return what Newton's method makes of the trial ``first`` (n_unknowns,) in m."""
    numerics, largest = system.model.numerics, NO_LIMIT
    if numerics.largest_correction is not None:
        of_nodes = numerics.largest_correction * size_at_nodes(system.mesh)
        largest = np.full(len(first), NO_LIMIT)
        largest[: system.external.size] = np.repeat(of_nodes, system.mesh.nodes.shape[1])
    return solve_newton(
        system.evaluate, system.solver(), first, numerics.tolerance, numerics.max_iterations,
        largest, gives_up=gives_up, patience=numerics.patience,
    )  # fmt: skip


def _elastic_solution(system: StepSystem, first: np.ndarray) -> np.ndarray:
    """Return the trial (n_unknowns,) of elastic soil: one linear solve from ``first``.

    Driven nodes beside nodes at rest would put all of the motion into one row of cells, far beyond
    yield; the elastic solution spreads it.  Soil whose elasticity is not linear goes without.
    """
    soils = system.materials
    if np.isin(soils.model, PRESSURE_DEPENDENT).any():
        return first
    system.materials = soils._replace(model=np.full_like(soils.model, Model.HENCKY_ELASTIC))
    state = system.evaluate(first)
    system.materials = soils
    if not state.is_admissible:  # a cell is crushed: the step is too long
        return first
    return first + system.solver()(state.tangent, -state.residual)


class StepSystem:
    """Work arrays of a step, filled by every evaluation."""

    def __init__(
        self,
        mesh: BackgroundMesh,
        points: IntegrationPoints,
        fill: CellFill,
        interface: InterfacePoints,
        motion: PileMotion,
        prescribed: Prescribed,
        model: Discretisation,
        loaded: LoadedMotions | None = None,
    ) -> None:
        n_nodes, dim = mesh.nodes.shape
        n_cells, n_cell_nodes = mesh.cell_nodes.shape
        n_elements, n_element_nodes = model.elements.nodes.shape
        self.mesh, self.points, self.model = mesh, points, model
        self.materials = model.materials
        self.interface, self.is_prescribed = interface, prescribed.is_prescribed
        self.options = cell_options(fill, points, model)
        self.given, self.loaded = motion, loaded
        is_turning = bool(motion.rotation or (loaded is not None and loaded.rotation.any()))
        self.is_swept = model.elements.is_swept if is_turning else None
        self.trial = empty_trial(points)
        self.traction = np.zeros_like(interface.traction)
        self.cell_force = np.zeros((n_cells, n_cell_nodes, dim))
        self.cell_stiffness = np.zeros((n_cells, n_cell_nodes, dim, n_cell_nodes, dim))
        self.element_force = np.zeros((n_elements, n_element_nodes, dim))
        self.element_stiffness = np.zeros((n_elements, n_element_nodes, dim, n_element_nodes, dim))
        self.external = np.zeros((n_nodes, dim))
        self.internal = np.zeros((n_nodes, dim))
        self.out_of_balance = np.zeros((n_nodes, dim))
        body_force(mesh.cell_nodes, points, model.gravity, self.external)
        if prescribed.force is not None:
            self.external += prescribed.force
        self.takes_part = fill.is_active | softly_held(mesh, points, fill, self.options)
        is_held = np.zeros(n_nodes, dtype=bool)
        is_held[mesh.cell_nodes[self.takes_part]] = True
        self.is_free = is_held[:, None] & ~prescribed.is_prescribed

    def solver(self) -> LinearSolve:
        """Return the solver of a Newton iteration, whose first call factorises in any case."""
        inner = chain([0.0], repeat(self.model.numerics.inner_tolerance))

        def solve(tangent: np.ndarray, right_hand_side: np.ndarray) -> np.ndarray:
            return self.model.solve(
                tangent, right_hand_side, self.is_prescribed.ravel(), next(inner)
            )

        return solve if self.loaded is None else partial(solve_bordered, solve)

    def evaluate(self, unknowns: np.ndarray) -> Evaluation:
        """Return residual and tangent at a trial.

        The ``unknowns`` are the displacement (n_dofs,) in m, then the sizes of loaded motions.
        """
        nodal = unknowns[: self.external.size].reshape(self.external.shape)
        sizes = unknowns[self.external.size :]
        self._move_pile(sizes)
        with measured("kernels"):
            self._evaluate_blocks(nodal)
        is_admissible = not self.trial.status.any()
        pattern = self.model.pattern
        internal, interface = np.zeros(nodal.size), np.zeros(nodal.size)
        values = np.zeros(len(pattern.indices))
        families = zip(
            (self.cell_force, self.element_force),
            (self.cell_stiffness, self.element_stiffness),
            (internal, interface),
            pattern.dofs,
            pattern.slots,
            strict=True,
        )
        with measured("assembly"):
            for force, stiffness, total, dofs, slots in families:
                scatter_force(force.reshape(dofs.shape), dofs, total)
                scatter_stiffness(stiffness.reshape(slots.shape), slots, values)
            constrain(pattern.indptr, pattern.indices, self.is_free.ravel(), values)
        self.internal = internal.reshape(nodal.shape)
        out_of_balance = internal + interface - self.external.ravel()
        self.out_of_balance = out_of_balance.reshape(nodal.shape)
        supports = out_of_balance[self.is_prescribed.ravel()]
        reference = sum(map(np.linalg.norm, (self.external, supports, interface)))
        residual = np.where(self.is_free.ravel(), out_of_balance, 0.0)
        mismatch = self._mismatch(nodal) if self.model.compares_resultants else 0.0
        evaluation = Evaluation(residual, values, float(reference) or 1.0, is_admissible, mismatch)
        return evaluation if self.loaded is None else self._bordered(evaluation, nodal, sizes)

    def _mismatch(self, nodal: np.ndarray) -> float:
        """Return the larger relative mismatch of force and moment at the last evaluation."""
        reaction = np.where(self.is_prescribed, self.out_of_balance, 0.0)
        end = self.mesh.nodes + nodal
        return max(far_field_mismatch(self.contact(), end, reaction + self.external))

    def _move_pile(self, sizes: np.ndarray) -> None:
        """Move the pile as given, and by ``sizes`` (m,) in m of its loaded motions."""
        self.motion = self.given
        if self.loaded is not None:
            self.motion = with_found(self.given, self.loaded, sizes)
        self.pile_displacement = rigid_displacement(self.motion, self.interface.position)

    def _bordered(self, evaluation: Evaluation, nodal: np.ndarray, sizes: np.ndarray) -> Evaluation:
        """Return the evaluation with the equations of the loaded motions after those of soil."""
        assert self.loaded is not None
        elements, dofs = self.model.elements, self.model.pattern.dofs[1]
        start = self.mesh.nodes[elements.nodes]
        soil = start + nodal[elements.nodes]
        with measured("assembly"):
            edge = border(
                self.loaded, sizes, soil, turning_places(elements, start, soil, self.motion),
                self.element_force, self.element_stiffness, dofs, self.is_free.ravel(),
            )  # fmt: skip
        return evaluation._replace(
            residual=np.append(evaluation.residual, edge.residual),
            tangent=BorderedTangent(evaluation.tangent, edge.columns, edge.rows, edge.corner),
        )

    def contact(self) -> Contact:
        """Return the forces between pile and soil at the last evaluation."""
        area = (self.interface.area * self.interface.covered)[:, None]
        return Contact(
            self.interface.position + self.soil_displacement,
            -area * np.einsum("pij,pi->pj", self.axes.traction, self.traction),
            -area * self.traction[:, -1:] * self.axes.traction[:, -1],
        )

    def _evaluate_blocks(self, nodal: np.ndarray) -> None:
        """Fill force and stiffness of all cells and interface elements."""
        evaluate_cells(
            self.mesh.cell_nodes, self.takes_part, self.points, nodal, self.materials,
            self.options, self.cell_force, self.cell_stiffness, self.trial,
        )  # fmt: skip
        self.soil_displacement = soil_displacement(self.model.elements, nodal)
        self.axes = step_axes(
            self.interface, self.is_swept, self.motion.rotation,
            self.pile_displacement, self.soil_displacement,
        )  # fmt: skip
        evaluate_interface(
            self.model.elements.nodes, self.model.elements.shape_values,
            self.interface.area * self.interface.covered, self.interface.parameters,
            self.interface.traction, self.axes, self.pile_displacement,
            nodal, self.element_force, self.element_stiffness, self.traction,
        )  # fmt: skip
        if self.is_swept is not None:
            contact = self.contact()
            add_turning_of_traction(
                self.element_stiffness, self.model.elements, contact.force, contact.position
            )
