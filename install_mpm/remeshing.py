"""The background mesh is made anew at the present place of the pile; the state goes with it.

Material points keep their state and are located in the new mesh.  Interface tractions are carried
to the new facets by their integral along each part of the pile, so the force on a part is kept.
What has changed shows after the next equilibrium: the change of stress and force is recorded.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from install_mpm.background_mesh import BackgroundMesh, cell_quality
from install_mpm.interface import InterfacePoints
from install_mpm.location import relocate
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.pile import PilePart
from install_mpm.state_file import InstalledState

ALONG = {PilePart.BASE: 0, PilePart.SHAFT: 1}
"""Axis along which each part of the pile runs."""


def is_worn(mesh: BackgroundMesh, smallest_quality: float) -> bool:
    """Return whether a cell is worse than ``smallest_quality``."""
    return bool(cell_quality(mesh).min() < smallest_quality)


def on_new_mesh(
    state: InstalledState, mesh: BackgroundMesh, interface: InterfacePoints
) -> InstalledState:
    """Return the state on ``mesh``, whose fresh ``interface`` takes the tractions of the old."""
    points, _ = relocate(state.material_points, mesh)
    return state._replace(
        material_points=points,
        background_mesh=mesh,
        interface=carried_tractions(state.interface, interface),
        control=state.control._replace(displacement_per_step=np.zeros_like(mesh.nodes)),
    )


def carried_tractions(old: InterfacePoints, new: InterfacePoints) -> InterfacePoints:
    """Return ``new`` with the tractions of ``old``; the force on each part is the same.

    The force up to a place along the part is interpolated linearly in the area up to there; a new
    point takes the mean over the area that it stands for.
    """
    traction = np.zeros_like(new.traction)
    for part, axis in ALONG.items():
        source, target = np.flatnonzero(old.part == part), np.flatnonzero(new.part == part)
        source = source[np.argsort(old.position[source, axis], kind="stable")]
        target = target[np.argsort(new.position[target, axis], kind="stable")]
        force = old.traction[source] * (old.area * old.covered)[source, None]
        reached = np.append(0.0, np.cumsum(old.area[source]))
        wanted = np.append(0.0, np.cumsum(new.area[target])) * (
            reached[-1] / new.area[target].sum()
        )
        for component in range(traction.shape[1]):
            integral = np.append(0.0, np.cumsum(force[:, component]))
            traction[target, component] = np.diff(np.interp(wanted, reached, integral))
        traction[target] /= new.area[target, None]
    return new._replace(traction=traction)


def with_changes(before: InstalledState, after: InstalledState) -> InstalledState:
    """Return the state ``after``, the last row of its history told what has changed."""
    history = after.history
    stress, force = history.remesh_stress_change.copy(), history.remesh_force_change.copy()
    stress[-1] = stress_change(before.material_points, after.material_points)
    force[-1] = history.crowd_force[-1] - before.history.crowd_force[-1]
    return after._replace(
        history=history._replace(remesh_stress_change=stress, remesh_force_change=force)
    )


def stress_change(before: MaterialPoints, after: MaterialPoints) -> float:
    """Return the change of Cauchy stress over the stress before, both as L2 norms by volume.

    Points may have been split or merged: each is compared with the nearest one before.
    """
    _, nearest = cKDTree(before.position).query(after.position)
    old, new = cauchy_stress(before)[nearest], cauchy_stress(after)
    norms = [after.volume @ (field**2).sum(axis=(1, 2)) for field in (new - old, old)]
    return float(np.sqrt(norms[0] / norms[1])) if norms[1] > 0.0 else 0.0
