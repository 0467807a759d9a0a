"""What winding the mesh of a screw pile back does to the state that the material points carry.

The points keep their stress, the facets on the pile and their tractions stay; but other points
share a cell, so that the stress which the next step starts from is another one.  It is compared
with that on the mesh as it would be without the winding, before anything moves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm import carriers
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.equilibrium import Prescribed, StepSystem
from install_mpm.geostatic import change_with_height
from install_mpm.injection import sub_region_of
from install_mpm.interface import InterfacePoints
from install_mpm.location import relocate
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_motion import screw
from install_mpm.pile import PileMotion
from install_mpm.screw_programme import Pose
from install_mpm.screw_setup import ScrewInstallation, wound_back
from install_mpm.step import switch_on

AT_REST = PileMotion(np.zeros(3))


class WindingChange(NamedTuple):
    """Changes by a winding; NaN in a step without one."""

    winding_stress_change: float = np.nan
    """Of the stress that the points' places in the mesh have, over that before: L2, by volume."""
    winding_force_change: float = np.nan
    """Of the vertical force that this stress has on the pile, in N."""
    winding_torque_change: float = np.nan
    """Of its torque, in N m, positive against driving the pile down."""
    winding_energy_change: float = np.nan
    """Of half of stress times elastic strain in all of the soil, in J."""


class _Carried(NamedTuple):
    """What a mesh makes of the state of the points."""

    stress: np.ndarray
    """Cauchy stress at the integration point of each material point, moved to its height as in
    undisturbed ground, (n_points, 3, 3) in Pa."""
    force: float
    torque: float
    energy: float


def winding_change(
    problem: ScrewInstallation,
    points: MaterialPoints,
    mesh: BackgroundMesh,
    interface: InterfacePoints,
    before: float,
    pose: Pose,
) -> WindingChange:
    """Return what the step from the rotation ``before`` (rad) to ``pose`` changed by winding.

    ``points``, ``mesh`` and ``interface`` are those at its end.
    """
    wound = wound_back(problem, before)
    if wound == wound_back(problem, pose.rotation):
        return WindingChange()
    unwound = screw(mesh, pose.advance, pose.rotation, wound, problem.zones)
    old = _carried(problem, relocate(points, unwound)[0], unwound, interface)
    new = _carried(problem, points, mesh, interface)
    squares = [
        points.volume @ (stress**2).sum(axis=(1, 2))
        for stress in (new.stress - old.stress, old.stress)
    ]
    return WindingChange(
        float(np.sqrt(squares[0] / squares[1])) if squares[1] > 0.0 else 0.0,
        new.force - old.force,
        problem.pile.sense * (new.torque - old.torque),
        new.energy - old.energy,
    )


def _carried(
    problem: ScrewInstallation,
    points: MaterialPoints,
    mesh: BackgroundMesh,
    interface: InterfacePoints,
) -> _Carried:
    """Return what a step on ``mesh`` would start from."""
    model = problem.model
    given = carriers.give_state(points, mesh, model, problem.gradient)
    system = StepSystem(
        mesh, given.quadrature, given.fill, switch_on(interface, given.fill, model), AT_REST,
        Prescribed(problem.supports, np.zeros_like(mesh.nodes)), model,
    )  # fmt: skip
    system.evaluate(np.zeros(mesh.nodes.size))
    on_pile = np.unique(model.elements.nodes)
    force = (system.external - system.internal)[on_pile]
    stress, strain = system.trial.cauchy_stress, given.quadrature.elastic_log_strain
    own = points.cell * len(model.cell.integration_coordinates) + sub_region_of(points, model.cell)
    height = np.einsum(
        "pa,pa->p", given.quadrature.shape_values[own], mesh.nodes[mesh.cell_nodes[points.cell], 2]
    )
    change = change_with_height(
        problem.gradient, points.material, height, points.position[:, 2], 2,
        points.state_variables.shape[1],
    )  # fmt: skip
    return _Carried(
        stress[own] + change.stress,
        float(force[:, 2].sum()),
        float(np.cross(mesh.nodes[on_pile], force)[:, 2].sum()),
        float(0.5 * given.quadrature.volume @ (stress * strain).sum(axis=(1, 2))),
    )
