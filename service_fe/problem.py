"""Finite-element model of soil, interface and rigid pile; solves one load step.

Small strain from the last accepted state: a step is a function of a state and of what is imposed,
and returns a new state.  The model satisfies ``handoff.equilibration.EquilibriumProblem``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from handoff.equilibration import EquilibrationError, ReleasedState
from handoff.facet_points import NormalsOf, ShareOf, whole_strength
from handoff.fe_mesh import FacetTag, FEMesh
from handoff.fe_state_file import FEState
from handoff.geostatic import geostatic_state
from handoff.tensor_arrays import six_vectors
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile, soils_of, undrained_shear_strength, unit_weights
from install_mpm.interface import with_strength_share
from install_mpm.pile import WHOLE_PILE
from service_fe.coupled_solver import make_solver
from service_fe.inclusion import Inclusion, interface_parameters, open_pattern
from service_fe.interface_forms import InterfaceForms, flat_normals
from service_fe.kinematics import soil_forms
from service_fe.load_step import LoadStep, Model
from service_fe.newton import StepNotConvergedError
from service_fe.options import ServiceNumerics
from service_fe.rigid_pile import PileControl, axial, held, rigid_motion
from service_fe.step import Step, Unknowns

RELEASED = 1e-9
"""Tolerance of the steps that release the out-of-balance force of a hand-over, if not smaller."""


def roller_supports(mesh: FEMesh) -> np.ndarray:
    """Return where the box holds the soil, (node, dim) bool: rollers at the sides, fixed bottom.

    The side of a box in space holds both horizontal displacements.
    """
    is_fixed = np.zeros(mesh.nodes.shape, dtype=bool)
    every_axis = list(range(mesh.nodes.shape[1]))
    for tag, axes in {
        FacetTag.SYMMETRY: [0],
        FacetTag.SIDE: every_axis[:-1],
        FacetTag.BOTTOM: every_axis,
    }.items():
        nodes = np.unique(mesh.facet_nodes[mesh.facet_tag == tag])
        is_fixed[np.ix_(nodes, axes)] = True
    return is_fixed


class ServiceProblem:
    """Soil, interface and rigid pile: half of a wall per metre run, a body of revolution, or all.

    Parameters
    ----------
    mesh
        Mesh of the soil; its pile facets carry the interface.
    ground
        Unit weight and soil law.
    interface
        Law of the interface; its strength follows that of the undisturbed ground.
    pile_weight
        Weight in N of the modelled half of the pile, or of a pile of revolution, on its axis.
    numerics
        Tolerance and limits of Newton's method.
    is_fixed
        Supports (node, dim) bool; the default is ``roller_supports``.
    kinematics
        In axisymmetry and in space all forces, areas and volumes are those of the whole body; in
        axisymmetry the pile may move along its axis only.
    normals
        Normals of the pile's exact surface; by default those of a flat-ended one.
    inclusion
        A deformable pile in the mesh, see ``deformable_pile``; what is called pile otherwise is
        then the cap on its head.
    strength_share
        Of the shear strength of the interface; by default that of facets that are the surface.

    Raises
    ------
    ValueError
        If the mesh cannot be used.
    """

    def __init__(
        self,
        mesh: FEMesh,
        ground: GroundProfile,
        interface: CoulombInterface,
        pile_weight: float = 0.0,
        numerics: ServiceNumerics | None = None,
        is_fixed: np.ndarray | None = None,
        kinematics: Kinematics = Kinematics.PLANE_STRAIN,
        normals: NormalsOf = flat_normals,
        inclusion: Inclusion | None = None,
        strength_share: ShareOf = whole_strength,
    ) -> None:
        self.mesh, self.ground, self.inclusion = mesh, ground, inclusion
        self.numerics = numerics or ServiceNumerics()
        mean_dilatation = self.numerics.mean_dilatation
        self._soil = soil_forms(mesh, kinematics, mean_dilatation=mean_dilatation)
        self.dim = mesh.nodes.shape[1]
        self.whole_body = WHOLE_PILE[kinematics]
        twin = None if inclusion is None else inclusion.twin
        self._interface = InterfaceForms(mesh, kinematics, normals, twin)
        if twin is not None:
            open_pattern(self._soil.matrix)
        self.interface_strength_share = strength_share(self._interface.facets)
        soils = soils_of(ground)
        strength = undrained_shear_strength(ground, self._interface.positions[:, -1])
        self.model = Model(
            soil=self._soil,
            interface=self._interface,
            solver=make_solver(self._soil, self.numerics),
            materials=dispatch.pack(soils if inclusion is None else (*soils, inclusion.law)),
            interface_parameters=with_strength_share(
                interface_parameters(interface, inclusion, strength, self._interface.parts),
                self.interface_strength_share,
            ),
            is_fixed=roller_supports(mesh) if is_fixed is None else is_fixed,
            pile_weight=-pile_weight * axial(self.dim),
            numerics=self.numerics,
        )

    @property
    def _unit_weights(self) -> np.ndarray:
        """Unit weights (n_materials,) in N/m^3."""
        of_ground = unit_weights(self.ground)
        return (
            of_ground
            if self.inclusion is None
            else np.append(of_ground, self.inclusion.unit_weight)
        )

    @property
    def integration_positions(self) -> np.ndarray:
        """Positions (n_q, dim) in m of the integration points, cell by cell."""
        return self._soil.integration_positions

    @property
    def integration_volumes(self) -> np.ndarray:
        """Integration weights (n_q,) in m^3, per metre run or of the whole body."""
        return self._soil.integration_volumes

    @property
    def own_points(self) -> np.ndarray:
        """Integration points (n,) of this rank of MPI, ascending; all of them without MPI."""
        return self._soil.partition.own_points

    def whole(self, values: np.ndarray) -> np.ndarray:
        """Return values (n_q, ...) of all integration points from those (n, ...) of each rank."""
        return self._soil.partition.whole(values)

    @property
    def interface_positions(self) -> np.ndarray:
        """Positions (n_i, dim) in m of the interface's integration points, facet by facet."""
        return self._interface.positions

    @property
    def interface_areas(self) -> np.ndarray:
        """Integration weights (n_i,) in m^2, per metre run or of the whole body."""
        return self._interface.areas

    @property
    def interface_normals(self) -> np.ndarray:
        """Exact unit normals (n_i, dim) from soil to pile."""
        return self._interface.normals

    @property
    def interface_facet_normals(self) -> np.ndarray:
        """Unit normals (n_i, dim) of the facets on which the interface points lie."""
        return self._interface.facet_normals

    @property
    def interface_parts(self) -> np.ndarray:
        """Part of the pile (n_i,) int64 of each interface point."""
        return self._interface.parts

    def wished_in_place_state(self) -> FEState:
        """Return the undisturbed state: geostatic stress and interface traction in balance."""
        return geostatic_state(
            self.ground,
            self.integration_positions,
            self.interface_positions,
            self.interface_normals,
            self.interface_facet_normals,
        )

    def pile_load(self, state: FEState) -> np.ndarray:
        """Return the load (n_motions,) in N and N m that holds the pile against soil and weight."""
        _, pile_force = self._interface.forces(state.interface_traction)
        return pile_force - self.model.pile_weight

    def gravity(self, state: FEState) -> np.ndarray:
        """Return the nodal forces (node, dim) in N of the weight of the soils of ``state``."""
        own = self._soil.partition.own(state)
        return self._soil.weight(self._unit_weights[own.material])

    def internal_force(self, state: FEState) -> np.ndarray:
        """Return the nodal forces (node, dim) in N of stress and interface of ``state``."""
        soil_force, _ = self._interface.forces(state.interface_traction)
        own = self._soil.partition.own(state)
        return self._soil.internal_force(six_vectors(own.cauchy_stress)) + soil_force

    def out_of_balance(self, state: FEState) -> float:
        """Return |f_ext - f_int(state)| at the free nodes over the weight of the soil, pile held.

        Raises
        ------
        ValueError
            If the soil has no weight.
        """
        weight = self._unit_weights[state.material] @ self.integration_volumes
        if weight <= 0.0:
            raise ValueError(
                "the out-of-balance force is measured by the weight of the soil, which is zero;"
                " give ground.unit_weight"
            )
        residual = self.gravity(state) - self.internal_force(state)
        return float(np.linalg.norm(residual[~self.model.is_fixed]) / weight)

    def release(
        self, state: FEState, share: float, on_pile: np.ndarray | None = None
    ) -> ReleasedState:
        """Return the state when ``share`` (0 to 1] of the out-of-balance force has gone.

        The pile is held, or loaded so that what the soil does to it, (n_motions,) in N and N m,
        goes by the same share to ``on_pile``.

        Raises
        ------
        EquilibrationError
            If Newton's method does not converge.
        """
        gravity = self.gravity(state)
        external = gravity - (1.0 - share) * (gravity - self.internal_force(state))
        exact = replace(self.numerics, tolerance=min(self.numerics.tolerance, RELEASED))
        model = self.model._replace(numerics=exact)
        still = np.zeros_like(self.mesh.nodes)
        control = held(self.dim) if on_pile is None else self._carrying(state, share, on_pile)
        try:
            step = LoadStep(model, state, control, still, external).solve(None)
        except StepNotConvergedError as error:
            raise EquilibrationError(
                f"releasing {share:.0%} of the out-of-balance force failed: {error};"
                " take more equilibration steps"
            ) from error
        displacement, motion = step.increment
        of_pile = rigid_motion(self.interface_positions) @ motion
        return ReleasedState(step.state, displacement, of_pile, len(step.residuals) - 1)

    def _carrying(self, state: FEState, share: float, on_pile: np.ndarray) -> PileControl:
        """Return the loads that take what the soil does to the pile by ``share`` to ``on_pile``."""
        now = self.pile_load(state)
        wanted = -on_pile - self.model.pile_weight
        every = np.ones(len(on_pile), dtype=bool)
        return PileControl(every, np.zeros(len(on_pile)), now + share * (wanted - now))

    def solve(
        self,
        state: FEState,
        control: PileControl,
        *,
        support_motion: np.ndarray | None = None,
        external_force: np.ndarray | None = None,
        guess: Unknowns | None = None,
        damping: float = 0.0,
    ) -> Step:
        """Return the load step that leads from ``state`` to what is imposed.

        Parameters
        ----------
        state
            Accepted state; read, never written.
        control
            Motion or load of the pile.
        support_motion
            Increments (node, dim) in m at the supports, used where fixed; default zero.
        external_force
            Nodal forces (node, dim) in N at the end of the step; default gravity.
        guess
            First guess of the increments, such as those of the step before; its prescribed part is
            replaced.
        damping
            Viscous over elastic stress; see ``settling``.

        Raises
        ------
        StepNotConvergedError
            If the tolerance is not reached; ``state`` is still the last accepted one.
        """
        motion = np.zeros_like(self.mesh.nodes) if support_motion is None else support_motion
        external = self.gravity(state) if external_force is None else external_force
        return LoadStep(self.model, state, control, motion, external, damping).solve(guess)
