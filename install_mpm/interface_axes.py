"""Local axes of points on the surface of a pile, and how they turn about its axis."""

from __future__ import annotations

import numpy as np

from install_mpm.conventions import rotation_matrix

FACES_ROUND = 0.7
"""Cosine of normal and circumferential direction above which a surface faces round the axis."""


def frames(normals: np.ndarray, rotation: float) -> np.ndarray:
    """Return the local axes (n, 2, 2) of interface points in two dimensions.

    Rows tangent and normal, turned by ``rotation``.
    """
    normal = normals @ rotation_matrix(rotation, 2).T
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    return np.stack([tangent, normal], axis=1)


def frames_around_axis(normals: np.ndarray, positions: np.ndarray, rotation: float) -> np.ndarray:
    """Return the local axes (n, 3, 3) of interface points on a pile whose axis is the z axis.

    Rows two tangents and the normal, turned by ``rotation`` about the axis.  The first tangent is
    the part of the circumferential direction that lies in the surface, or of the radial direction
    where the surface faces round the axis, so the axes turn with the pile.
    """
    radius = np.linalg.norm(positions[:, :2], axis=1)
    away = np.zeros_like(normals)
    away[:, :2] = positions[:, :2] / np.where(radius > 0.0, radius, 1.0)[:, None]
    away[radius == 0.0] = (1.0, 0.0, 0.0)
    around = np.column_stack([-away[:, 1], away[:, 0], away[:, 2]])
    faces_round = np.abs((around * normals).sum(axis=1)) > FACES_ROUND
    first = np.where(faces_round[:, None], away, around)
    first = first - (first * normals).sum(axis=1)[:, None] * normals
    first /= np.linalg.norm(first, axis=1)[:, None]
    axes = np.stack([first, np.cross(normals, first), normals], axis=1)
    return axes @ rotation_matrix(rotation, 3).T


def axes_of(normals: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return the local axes (n, dim, dim) of ``normals`` (n, dim) at ``positions`` (n, dim)."""
    if normals.shape[1] == 2:
        return frames(normals, 0.0)
    return frames_around_axis(normals, positions, 0.0)


def polar_change(position: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Return the change (n,) in rad of the polar angle by a displacement (n, dim)."""
    moved = position + displacement
    cross = position[:, 0] * moved[:, 1] - position[:, 1] * moved[:, 0]
    change: np.ndarray = np.arctan2(cross, (position[:, :2] * moved[:, :2]).sum(axis=1))
    return change


def angle_gradient(position: np.ndarray) -> np.ndarray:
    """Return the derivative (n, dim) in rad/m of the polar angle by the ``position`` (n, dim)."""
    gradient = np.zeros_like(position)
    squared = np.maximum((position[:, :2] ** 2).sum(axis=1), 1e-300)
    gradient[:, 0], gradient[:, 1] = -position[:, 1] / squared, position[:, 0] / squared
    return gradient


def quarter_turned(vectors: np.ndarray) -> np.ndarray:
    """Return ``vectors`` (..., dim) turned by 90 degrees about the z axis, without their z part.

    It is their derivative by an angle of rotation.
    """
    turned = np.zeros_like(vectors)
    turned[..., 0], turned[..., 1] = -vectors[..., 1], vectors[..., 0]
    return turned


def turned_by(axes: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return local ``axes`` (n, dim, dim) turned by ``angle`` (n,) in rad, each by its own."""
    if not angle.any():
        return axes
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    turned = axes.copy()
    turned[:, :, 0] = cosine * axes[:, :, 0] - sine * axes[:, :, 1]
    turned[:, :, 1] = sine * axes[:, :, 0] + cosine * axes[:, :, 1]
    return turned
