"""PA3: a block with free sides is stretched while the mesh follows (paper, Fig. 3, eqs (1)-(2)).

Hencky material under one free principal stress.  In plane stress the Kirchhoff stress is
tau = E ln(lambda).  In plane strain the free sides give e_x = -nu / (1 - nu) e_y, and
tau = E / (1 - nu^2) ln(lambda).  The Cauchy stress tau / J acts on the current cross-section,
which is J / lambda times the original one, so that the force is A_0 tau / lambda in both cases:
Poisson's ratio enters only through the modulus.  It is largest at lambda = e.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class StretchedBody:
    """Block after stretching, each of the shape of ``displacement``."""

    force: np.ndarray
    """At the top, tension positive, in N per metre run (plane stress: of a sheet 1 m thick)."""
    width: np.ndarray
    """Current width in m."""
    area: np.ndarray
    """Current area in the plane in m^2."""
    stress: np.ndarray
    """Cauchy stress in the direction of stretching in Pa, tension positive."""


def stretched_body(
    displacement: ArrayLike,
    *,
    height: float,
    width: float,
    youngs_modulus: float,
    poissons_ratio: float,
    is_plane_strain: bool = True,
) -> StretchedBody:
    """Return force and shape of a block whose top has moved by ``displacement``.

    Parameters
    ----------
    displacement
        Upward positive, any shape, in m; above minus ``height``.
    height, width
        Original, in m.
    youngs_modulus
        In Pa.
    """
    stretch = 1.0 + np.asarray(displacement, dtype=float) / height
    nu = poissons_ratio
    modulus = youngs_modulus / (1.0 - nu**2) if is_plane_strain else youngs_modulus
    sideways = stretch ** (-nu / (1.0 - nu) if is_plane_strain else -nu)
    thickness = np.ones_like(stretch) if is_plane_strain else sideways
    force = width * modulus * np.log(stretch) / stretch
    return StretchedBody(
        force,
        width * sideways,
        height * stretch * width * sideways,
        force / (width * sideways * thickness),
    )


def moved_heights(
    heights: ArrayLike, *, body_height: float, mesh_height: float, displacement: float
) -> np.ndarray:
    """Return the heights of mesh nodes that follow the top of the body, paper eqs (1)-(2).

    Nodes in the body stretch with it, nodes above it are compressed towards the top of the mesh.

    Parameters
    ----------
    heights
        Above the base, any shape, in m.
    body_height, mesh_height
        L_b before the motion, and L_m, in m.
    displacement
        Of the top of the body, u in m.
    """
    heights = np.asarray(heights, dtype=float)
    stretched = heights * (body_height + displacement) / body_height
    above = (mesh_height - body_height - displacement) / (mesh_height - body_height)
    return np.where(
        heights <= body_height, stretched, mesh_height - above * (mesh_height - heights)
    )
