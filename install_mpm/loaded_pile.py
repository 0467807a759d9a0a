"""Motions of the rigid pile whose load is given: their size is found in the step.

The pile has no nodes, so each of them is one more unknown of the step, beside the displacement of
the soil, and its equation is that the load of the rig, the weight and the interface tractions are
in equilibrium.  What a small motion of the pile does to the interface is what the opposite motion
of the soil does, seen by an observer who moves with the pile.  So all derivatives follow from force
f and stiffness K of the interface elements.  With the velocity v of a motion at the nodes of the
soil and its rate of rotation w,

    df/ds = w f' - K c ,     r = -v . f - load ,     dr/du = w f' - K^T v ,

f' being f turned by a right angle about the z axis.  The velocity c is v where a surface is swept,
and that of the middle between soil and pile elsewhere: there the axes of the slip turn by half of
the rotation of the pile, not with the soil.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.interface import InterfaceElements
from install_mpm.interface_axes import quarter_turned
from install_mpm.kernels.scatter import scatter_force
from install_mpm.pile import PileMotion, rigid_displacement


class LoadedMotions(NamedTuple):
    """Rigid motions whose load is given; their sizes s (m,) in m are unknowns of the step."""

    translation: np.ndarray
    """Per unit of s, (m, dim); parallel to the axis of rotation."""
    rotation: np.ndarray
    """Per unit of s, (m,) in rad/m."""
    load: np.ndarray
    """On the pile beside the interface tractions at the end of the step, where s = 0, (m,) in N."""
    load_change: np.ndarray
    """Of the load with s, (m, m) in N/m: the pile weighs more the deeper it is."""
    start: np.ndarray
    """First trial of s, (m,) in m."""


class Border(NamedTuple):
    """Equations of the loaded motions and what they share with those of the soil."""

    residual: np.ndarray
    """Out-of-balance load, (m,) in N."""
    columns: np.ndarray
    """Change of the nodal forces with s, (n_dofs, m) in N/m."""
    rows: np.ndarray
    """Change of the residual with the nodal displacements, (m, n_dofs) in N/m."""
    corner: np.ndarray
    """Change of the residual with s, (m, m) in N/m."""


def with_found(motion: PileMotion, loaded: LoadedMotions, sizes: np.ndarray) -> PileMotion:
    """Return the given ``motion`` together with the loaded ones of these ``sizes`` (m,) in m."""
    return PileMotion(
        motion.translation + sizes @ loaded.translation,
        float(motion.rotation + sizes @ loaded.rotation),
    )


def turning_places(
    elements: InterfaceElements, start: np.ndarray, soil: np.ndarray, motion: PileMotion
) -> np.ndarray:
    """Return the places (n_elements, n_nodes, dim) in m by which the axes of the slip turn.

    Those of the ``soil`` at the end of the step where an element is swept, as a whole; elsewhere
    the middle between it and the pile, which has made ``motion`` from ``start``.
    """
    flat = start.reshape(-1, start.shape[-1])
    pile = start + rigid_displacement(motion, flat).reshape(start.shape)
    middle: np.ndarray = (soil + pile) / 2.0
    if elements.is_swept is None:
        return middle
    is_swept = elements.is_swept.reshape(len(start), -1)[:, 0]
    return np.where(is_swept[:, None, None], soil, middle)


def border(
    loaded: LoadedMotions,
    sizes: np.ndarray,
    soil: np.ndarray,
    slip_axes: np.ndarray,
    forces: np.ndarray,
    stiffness: np.ndarray,
    dofs: np.ndarray,
    is_free: np.ndarray,
) -> Border:
    """Return the border of a trial.

    Of the nodes of the interface elements are the places of the ``soil`` at the end of the step,
    those by which the ``slip_axes`` turn, and the ``forces``, each (n_elements, n_nodes, dim); of
    the elements the ``stiffness`` (n_elements, n_nodes, dim, n_nodes, dim) and the ``dofs``
    (n_elements, n_nodes * dim), of which ``is_free`` (n_dofs,) is to be found.
    """
    n_motions, n_dofs = len(sizes), len(is_free)
    columns, rows = np.zeros((n_motions, n_dofs)), np.zeros((n_motions, n_dofs))
    velocity = np.array([_velocity(loaded, k, soil) for k in range(n_motions)])
    turned = quarter_turned(forces)
    change = np.array([
        rate * turned - np.einsum("eaibj,ebj->eai", stiffness, _velocity(loaded, k, slip_axes))
        for k, rate in enumerate(loaded.rotation)
    ])  # fmt: skip
    for k, rate in enumerate(loaded.rotation):
        by_soil = rate * turned - np.einsum("eaibj,eai->ebj", stiffness, velocity[k])
        scatter_force(change[k].reshape(dofs.shape), dofs, columns[k])
        scatter_force(by_soil.reshape(dofs.shape), dofs, rows[k])
    return Border(
        -np.einsum("keai,eai->k", velocity, forces) - loaded.load - loaded.load_change @ sizes,
        np.where(is_free, columns, 0.0).T,
        np.where(is_free, rows, 0.0),
        -np.einsum("keai,meai->km", velocity, change) - loaded.load_change,
    )


def _velocity(loaded: LoadedMotions, number: int, places: np.ndarray) -> np.ndarray:
    """Return the velocity of a motion at ``places`` (..., dim), per unit of its size."""
    velocity: np.ndarray = loaded.translation[number] + loaded.rotation[number] * quarter_turned(
        places
    )
    return velocity
