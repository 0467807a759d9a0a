"""The mesh follows the pile: laws that move nodes, decoupled from the material points.

Every law returns the mesh with its nodes placed from the *reference* mesh by the whole motion so
far, so nothing drifts.  Neighbours and cells stay; only ``nodes`` change, and mid-side nodes lie in
the middle of their edges.  No law knows a material point: stress, volume and mass cannot change.
After a motion the points have to be found again (``location.relocate``); a step does that for the
mesh that its own law returns, so a mesh must not be moved between steps without it.

==========================  ====================================================================
``translate``               vertically, stretched between fixed levels: paper, eqs (1), (2)
``rotate``                  about the origin: paper, eqs (3), (4); whole, or tapered to a fixed rim
``translate_and_rotate``    with a rigid body in the plane, tapered to a fixed rim
``stretch``                 each axis by a factor
``expand``                  away from the origin or the axis, tapered to a fixed rim
``reset``                   back to the reference mesh, carried along by the pile
==========================  ====================================================================

A mesh whose cells have become too flat is made anew instead: ``remeshing``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, straightened
from install_mpm.pile import PileMotion, rigid_displacement


def translate(
    mesh: BackgroundMesh,
    advance: float,
    moving_level: float,
    fixed_levels: tuple[float, float],
    rigid_zone: float = 0.0,
) -> BackgroundMesh:
    """Return the mesh with the nodes at ``moving_level`` moved *down* by ``advance`` (both in m).

    Between the moving level (of the reference mesh) and the two fixed levels, bottom and top, the
    vertical coordinate is stretched or compressed linearly: paper, eqs (1) and (2), with L_b the
    moving level, L_m the top, u = -``advance`` and heights from the bottom.  Nodes within
    ``rigid_zone`` above and below the moving level move as one, so that the cells around the pile
    tip keep their shape; zero gives the equations as printed.
    """
    bottom, top = fixed_levels
    levels = [bottom, moving_level - rigid_zone, moving_level + rigid_zone, top]
    moved = [bottom, moving_level - rigid_zone - advance, moving_level + rigid_zone - advance, top]
    nodes = mesh.reference_nodes.copy()
    nodes[:, -1] = np.interp(nodes[:, -1], levels, moved)
    return straightened(mesh._replace(nodes=nodes))


def rotate_clockwise(nodes: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Return ``nodes`` (n, 2) turned about the origin by ``angle`` (rad), clockwise if positive.

    Paper, eqs (3) and (4), as printed: x1 = x0 cos + y0 sin, y1 = -x0 sin + y0 cos.  The angle may
    differ from node to node, (n,).
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = nodes[:, 0], nodes[:, 1]
    return np.column_stack([x * cosine + y * sine, -x * sine + y * cosine])


def rotate(
    mesh: BackgroundMesh,
    angle: float,
    *,
    inner_radius: float = np.inf,
    outer_radius: float = np.inf,
) -> BackgroundMesh:
    """Return the mesh with its reference nodes turned about the origin by ``angle`` (rad).

    Anticlockwise if positive, that is by eqs (3) and (4) of the paper with minus ``angle``.  The
    whole angle applies within ``inner_radius``; it tapers linearly to zero at ``outer_radius``.
    """
    nodes = mesh.reference_nodes
    share = _taper(np.linalg.norm(nodes, axis=1), inner_radius, outer_radius)
    return straightened(mesh._replace(nodes=rotate_clockwise(nodes, -angle * share)))


def translate_and_rotate(
    mesh: BackgroundMesh,
    motion: PileMotion,
    *,
    inner_radius: float = np.inf,
    outer_radius: float = np.inf,
) -> BackgroundMesh:
    """Return the mesh with its reference nodes moved by the rigid ``motion`` of the body.

    First the rotation about the origin, then the translation.  All of both applies within
    ``inner_radius`` of the origin; angle and translation taper linearly to zero at
    ``outer_radius``.
    """
    nodes = mesh.reference_nodes
    share = _taper(np.linalg.norm(nodes, axis=1), inner_radius, outer_radius)
    turned = rotate_clockwise(nodes, -motion.rotation * share)
    return straightened(mesh._replace(nodes=turned + share[:, None] * motion.translation))


def reset(mesh: BackgroundMesh, motion: PileMotion) -> BackgroundMesh:
    """Return the reference mesh at its place relative to the pile, which has made ``motion``.

    All nodes go with the pile, so cells have their first shape again; a mesh that is to stay in a
    fixed box needs ``translate`` or a new mesh instead.
    """
    nodes = mesh.reference_nodes
    return straightened(mesh._replace(nodes=nodes + rigid_displacement(motion, nodes)))


def stretch(mesh: BackgroundMesh, factors: tuple[float, float]) -> BackgroundMesh:
    """Return the mesh with its reference nodes scaled from the origin by ``factors`` per axis."""
    return straightened(mesh._replace(nodes=mesh.reference_nodes * np.array(factors)))


def expand(
    mesh: BackgroundMesh,
    growth: float,
    *,
    inner_radius: float,
    outer_radius: float,
    is_radius_horizontal: bool = False,
) -> BackgroundMesh:
    """Return the mesh with its reference nodes moved away from the origin by ``growth`` (m).

    The whole of it applies within ``inner_radius``; it tapers linearly to zero at ``outer_radius``.
    The radius is the distance from the origin, or the horizontal one from the vertical axis.
    """
    nodes = mesh.reference_nodes
    horizontal = np.column_stack([nodes[:, 0], np.zeros(len(nodes))])
    outward = horizontal if is_radius_horizontal else nodes
    radius = np.linalg.norm(outward, axis=1)
    share = _taper(radius, inner_radius, outer_radius)
    distance = growth * share / np.maximum(radius, inner_radius)
    return straightened(mesh._replace(nodes=nodes + distance[:, None] * outward))


class ScrewZones(NamedTuple):
    """Where the mesh moves with a screw pile, and where it stays."""

    inner_radius: float
    """Distance from the axis in m within which the mesh takes part in the whole motion."""
    outer_radius: float
    """Distance from the axis in m at which the motion has tapered to zero."""
    rigid_levels: tuple[float, float]
    """Levels in m, at zero pile motion, between which the mesh goes down with the pile as one."""
    fixed_levels: tuple[float, float]
    """Bottom and top in m, which stay at their level."""


def screw(
    mesh: BackgroundMesh, advance: float, angle: float, reset_angle: float, zones: ScrewZones
) -> BackgroundMesh:
    """Return the mesh of a pile that went down by ``advance`` (m) and turned by ``angle`` (rad).

    The pile takes the whole of both; they taper linearly to zero between inner and outer radius.
    Below and above the rigid levels the mesh is compressed and stretched as by eqs (1) and (2).
    ``reset_angle`` turns the reference mesh as a whole before: a pile is the same body at every
    angle, so the mesh can be wound back as often as wanted without making a new one.
    """
    reference = mesh.reference_nodes
    radius = np.linalg.norm(reference[:, :2], axis=1)
    share = _taper(radius, zones.inner_radius, zones.outer_radius)
    lower, upper = zones.rigid_levels
    bottom, top = zones.fixed_levels
    level = np.interp(
        reference[:, 2],
        [bottom, lower, upper, top],
        [bottom, lower - advance, upper - advance, top],
    )
    turn = reset_angle + share * (angle - reset_angle)
    nodes = np.empty_like(reference)
    nodes[:, :2] = rotate_clockwise(reference[:, :2], -turn)
    nodes[:, 2] = reference[:, 2] + share * (level - reference[:, 2])
    return straightened(mesh._replace(nodes=nodes))


def _taper(radius: np.ndarray, inner_radius: float, outer_radius: float) -> np.ndarray:
    """Return the share (n,) of a motion: one within the inner radius, zero from the outer one."""
    if not np.isfinite(outer_radius):
        return np.ones_like(radius)
    share: np.ndarray = np.clip((outer_radius - radius) / (outer_radius - inner_radius), 0.0, 1.0)
    return share
