"""What a pile feels along its shaft: soil reaction per length, deflection, and section forces.

Everything is told at levels along the axis by hat functions w_k(z) that add up to one,

    p_k = int w_k t dA / int w_k dz ,   V_k = int w_k sigma_xz dV / int w_k dz ,
    N_k = int w_k sigma_zz dV / int w_k dz ,   M_k = int w_k x sigma_zz dV / int w_k dz ,

so that the reactions add up to the force on the pile whatever the cells.  The section forces are
those of a deformable pile, means over the length of a hat.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_mesh import FacetTag, pile_facets
from handoff.fe_state_file import FEState
from handoff.interface_transfer import forces_on_pile
from install_mpm.ground import soils_of
from service_fe.problem import ServiceProblem
from service_fe.results import AlongPile
from service_fe.rigid_pile import rigid_motion


class Levels(NamedTuple):
    """Levels along a pile."""

    height: np.ndarray
    """z (n_level,) in m, equally spaced, ascending."""

    @property
    def lengths(self) -> np.ndarray:
        """Integrals (n_level,) in m of the hats: the spacing, half of it at the ends."""
        spacing = np.full(len(self.height), self.height[1] - self.height[0])
        spacing[[0, -1]] *= 0.5
        return spacing

    def hats(self, height: np.ndarray) -> np.ndarray:
        """Return w (n_level, n) at ``height`` (n,) in m; beyond the ends they are constant."""
        spacing = self.height[1] - self.height[0]
        inside = np.clip(height, self.height[0], self.height[-1])
        return np.maximum(0.0, 1.0 - np.abs(inside - self.height[:, None]) / spacing)


def levels_of(problem: ServiceProblem) -> Levels | None:
    """Return levels not closer than the cells of the pile are high, or the facets on a rigid one.

    None if there is no pile, or none in space.
    """
    mesh = problem.mesh
    if problem.dim == 2:
        return None
    corners = mesh.nodes[mesh.facet_nodes[pile_facets(mesh), : problem.dim], -1]
    if problem.inclusion is not None:
        corners = mesh.nodes[mesh.cell_nodes[_pile_cells(problem), : problem.dim + 1], -1]
    if len(corners) == 0:
        return None
    tip, head = corners.min(), corners.max()
    spacing = np.ptp(corners, axis=1).max()
    count = max(2, int((head - tip) / spacing) + 1)
    return Levels(np.linspace(tip, head, count))


def _pile_cells(problem: ServiceProblem) -> np.ndarray:
    """Return the cells (n,) of a deformable pile, which come last."""
    assert problem.inclusion is not None
    return np.arange(len(problem.mesh.cell_nodes) - problem.inclusion.n_cells,
                     len(problem.mesh.cell_nodes))  # fmt: skip


def soil_reaction(problem: ServiceProblem, state: FEState, levels: Levels) -> np.ndarray:
    """Return the horizontal force in N/m of the soil on the modelled part, (n_level, horizontal).

    NaN if the soil sticks to the pile and there is no interface that could tell it.
    """
    on_surface = problem.interface_parts != FacetTag.PILE_HEAD
    if not on_surface.any():
        return np.full((len(levels.height), problem.dim - 1), np.nan)
    places = problem.interface_positions[on_surface]
    force = forces_on_pile(
        state.interface_traction[on_surface], problem.interface_normals[on_surface],
        problem.interface_areas[on_surface], places,
    )  # fmt: skip
    total = levels.hats(places[:, -1]) @ force[:, :-1]
    return np.asarray(total / levels.lengths[:, None])


def deflection(
    problem: ServiceProblem, displacement: np.ndarray, motion: np.ndarray, levels: Levels
) -> np.ndarray:
    """Return the horizontal displacement of the pile in m, (n_level, horizontal).

    Of nodal displacements (node, dim), which a deformable pile has, and the motion (n_motions,).
    """
    if problem.inclusion is None:
        axis = np.zeros((len(levels.height), problem.dim))
        axis[:, -1] = levels.height
        return np.asarray((rigid_motion(axis) @ motion)[:, :-1])
    nodes = np.unique(problem.mesh.cell_nodes[_pile_cells(problem)])
    hats = levels.hats(problem.mesh.nodes[nodes, -1])
    mean: np.ndarray = hats @ displacement[nodes, :-1] / hats.sum(axis=1)[:, None]
    return mean


def section_forces(
    problem: ServiceProblem, state: FEState, levels: Levels
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return N (n_level,), V and M (n_level, horizontal) of the modelled part; NaN if rigid."""
    across = problem.dim - 1
    if problem.inclusion is None:
        unknown = np.full((len(levels.height), across), np.nan)
        return unknown[:, 0], unknown, unknown
    is_pile = state.material == len(soils_of(problem.ground))
    places = problem.integration_positions[is_pile]
    stress = state.cauchy_stress[is_pile]
    vertical = problem.dim - 1
    weight = levels.hats(places[:, -1]) * problem.integration_volumes[is_pile]
    weight /= levels.lengths[:, None]
    axial = stress[:, vertical, vertical]
    return (
        weight @ axial,
        weight @ stress[:, :across, vertical],
        weight @ (places[:, :across] * axial[:, None]),
    )


class Recorder:
    """Collects what a pile in space feels along its axis in the steps of a programme."""

    def __init__(self, problem: ServiceProblem) -> None:
        self._problem, self._levels = problem, levels_of(problem)
        self._rows: list[tuple[np.ndarray, ...]] = []

    def add(self, state: FEState, displacement: np.ndarray, motion: np.ndarray) -> None:
        """Add a step: its state, and displacement (node, dim) and motion since the start."""
        if self._levels is None:
            return
        problem, levels = self._problem, self._levels
        self._rows.append(
            (
                soil_reaction(problem, state, levels),
                deflection(problem, displacement, motion, levels),
                *section_forces(problem, state, levels),
            )
        )

    def result(self) -> AlongPile | None:
        """Return all steps; None if there is no pile in space."""
        if self._levels is None:
            return None
        columns = zip(*self._rows, strict=True)
        return AlongPile(self._levels.height, *(np.array(column) for column in columns))
