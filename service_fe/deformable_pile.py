"""A deformable pile in the finite-element model: meshed inside, elastic, held by a rigid cap.

The pile is one more material of the soil's mesh.  Its nodes on the surface are twins of those of
the soil, joined by the interface elements of the rigid pile, or they are the same nodes
(``bonded``).  The section at the head is joined to a rigid cap by a stiff elastic layer without
thickness; the motion and the load of the cap are those that a programme imposes on a rigid pile.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from handoff.facet_points import FacetPoints, NormalsOf, ShareOf, whole_strength
from handoff.fe_mesh import FacetTag, FEMesh, pile_facets
from handoff.fe_state_file import FEState
from handoff.pile_mesh import PileMesh
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground, GroundProfile, soils_of
from service_fe.inclusion import Inclusion
from service_fe.options import DeformablePile, ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held

CAP_STIFFNESS = 100.0
"""Of the layer below the cap, times the size of the head over Young's modulus of the pile.

It gives way as a hundredth of a head's width of pile; a stiffer one would lift the round-off of the
forces above the tolerance of Newton's method.
"""

OnFacets = Callable[[FacetPoints], np.ndarray]

UNLIMITED = 1e30
"""Cohesion in Pa of the layer below the cap: it neither slips nor opens."""


class DeformableModel(NamedTuple):
    """A model of soil and deformable pile, and the pile alone with its cap."""

    problem: ServiceProblem
    alone: ServiceProblem
    node_of_pile: np.ndarray
    """Node of the model (n,) of each node of the pile's mesh."""

    def start(self, ground_state: FEState) -> FEState:
        """Return the state with the pile in equilibrium with the ground of ``ground_state``.

        This is the state of the model with a rigid pile.  The pile carries the stress that balances
        the tractions of the ground and its own weight, and no other: of all that its installation
        may have left in it nothing is known.

        Raises
        ------
        StepNotConvergedError
            If the elastic pile cannot be solved.
        """
        joined = self._with_pile(ground_state)
        force = self.problem.gravity(joined) - self.problem.internal_force(joined)
        unstressed = self.alone.wished_in_place_state()  # its material has no weight
        step = self.alone.solve(unstressed, held(self.problem.dim),
                                external_force=force[self.node_of_pile])  # fmt: skip
        n_soil, n_cap = len(ground_state.material), len(self.alone.interface_areas)
        for whole, part in (
            (joined.cauchy_stress, step.state.cauchy_stress),
            (joined.elastic_strain, step.state.elastic_strain),
        ):
            whole[n_soil:] = part
        joined.interface_traction[-n_cap:] = step.state.interface_traction
        return joined

    def _with_pile(self, ground_state: FEState) -> FEState:
        """Return the state with a pile and a cap that carry nothing."""
        inclusion = self.problem.inclusion
        assert inclusion is not None
        n_pile = len(self.problem.integration_volumes) - len(ground_state.material)
        n_interface = len(self.problem.interface_areas)
        kept = ground_state.interface_traction
        if inclusion.twin is None:
            kept = kept[:0]
        traction = np.zeros((n_interface, self.problem.dim))
        traction[: len(kept)] = kept
        zeros = np.zeros((n_pile, 3, 3))
        variables = ground_state.state_variables
        return ground_state._replace(
            cauchy_stress=np.concatenate([ground_state.cauchy_stress, zeros]),
            elastic_strain=np.concatenate([ground_state.elastic_strain, zeros]),
            state_variables=np.concatenate([variables, np.zeros((n_pile, variables.shape[1]))]),
            material=np.append(
                ground_state.material,
                np.full(n_pile, len(soils_of(self.problem.ground)), dtype=np.int64),
            ),
            interface_traction=traction,
        )


def deformable_model(
    soil: FEMesh,
    pile: PileMesh,
    properties: DeformablePile,
    ground: GroundProfile,
    interface: CoulombInterface,
    pile_weight: float,
    *,
    kinematics: Kinematics,
    normals: NormalsOf,
    strength_share: ShareOf = whole_strength,
    is_fixed: np.ndarray | None = None,
    numerics: ServiceNumerics | None = None,
) -> DeformableModel:
    """Return the model of a deformable pile; see ``ServiceProblem`` for what has no word here.

    Parameters
    ----------
    soil, pile
        Meshes that conform to each other.
    properties
        Elasticity of the pile, and whether it sticks to the soil.
    pile_weight
        In N; it is spread over the volume of the pile's mesh.
    is_fixed
        Supports (node, dim) bool of the soil.
    """
    law = HenckyElastic(properties.youngs_modulus, properties.poissons_ratio)
    mesh, twin, node_of_pile = _joined(soil, pile, is_bonded=properties.contact == "bonded")
    head = pile.mesh.nodes[
        np.unique(pile.mesh.facet_nodes[pile.mesh.facet_tag == FacetTag.PILE_HEAD])
    ]
    spring = CAP_STIFFNESS * law.youngs_modulus / np.ptp(head[:, 0])
    cap = CoulombInterface(spring, spring, cohesion=UNLIMITED)
    alone = ServiceProblem(
        pile.mesh, Ground(0.0, 1.0, law), cap, kinematics=kinematics, normals=_upward,
        numerics=numerics,
    )  # fmt: skip
    unit_weight = pile_weight / alone.integration_volumes.sum()
    fixed = None
    if is_fixed is not None:
        fixed = np.zeros(mesh.nodes.shape, dtype=bool)
        fixed[: len(soil.nodes)] = is_fixed
        fixed[node_of_pile] |= alone.model.is_fixed
    inclusion = Inclusion(law, float(unit_weight), cap, len(pile.mesh.cell_nodes), twin)
    problem = ServiceProblem(
        mesh, ground, interface, 0.0, numerics, fixed, kinematics,
        _with_head(normals, _upward), inclusion, _with_head(strength_share, whole_strength),
    )  # fmt: skip
    return DeformableModel(problem, alone, node_of_pile)


def _joined(
    soil: FEMesh, pile: PileMesh, *, is_bonded: bool
) -> tuple[FEMesh, np.ndarray | None, np.ndarray]:
    """Return the mesh of both, the twins in it (node,), and its nodes of the pile's mesh.

    Cells of the soil come first, and so do its facets on the pile, unless they are ``bonded``.
    """
    n_soil, inside = len(soil.nodes), pile.mesh
    node_of_pile = n_soil + np.arange(len(inside.nodes))
    here = np.flatnonzero(pile.twin >= 0)
    nodes, kept = np.vstack([soil.nodes, inside.nodes]), np.ones(len(soil.facet_tag), dtype=bool)
    twin = None
    if is_bonded:
        is_shared = np.zeros(len(inside.nodes), dtype=bool)
        is_shared[pile.twin[here]] = True
        node_of_pile = n_soil + np.cumsum(~is_shared) - 1
        node_of_pile[pile.twin[here]] = here
        nodes = np.vstack([soil.nodes, inside.nodes[~is_shared]])
        kept[pile_facets(soil)] = False
    else:
        twin = np.full(len(nodes), -1)
        twin[here] = n_soil + pile.twin[here]
    is_outer = np.isin(inside.facet_tag, [FacetTag.PILE_HEAD, FacetTag.SYMMETRY])
    mesh = FEMesh(
        nodes,
        np.vstack([soil.cell_nodes, node_of_pile[inside.cell_nodes]]),
        np.vstack([soil.facet_nodes[kept], node_of_pile[inside.facet_nodes[is_outer]]]),
        np.append(soil.facet_tag[kept], inside.facet_tag[is_outer]),
    )
    return mesh, twin, node_of_pile


def _upward(facets: FacetPoints) -> np.ndarray:
    normals = np.zeros_like(facets.positions)
    normals[:, -1] = 1.0
    return normals


def _with_head(of_surface: OnFacets, of_head: OnFacets) -> OnFacets:
    """Return what is found at points on facets of the pile's surface, and on those of its head."""

    def of_all(facets: FacetPoints) -> np.ndarray:
        found, is_surface = of_head(facets), facets.facet_parts != FacetTag.PILE_HEAD
        found[np.repeat(is_surface, len(facets.weights))] = of_surface(facets.selected(is_surface))
        return found

    return of_all
