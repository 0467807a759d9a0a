"""PA15: a heavy block is pulled along a rough rigid plane.

It starts to slip at H = c L + N tan(phi), at the displacement H / (k_s L), and then needs no
further force; with dilation it climbs at the angle psi.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from workflows.verification.small_strain_blocks import load, make_blocks

NODES = np.array([[0, 0], [1, 0], [1, -1], [0, -1]], dtype=float)
CELLS = np.array([[3, 2, 1, 0]])
PLANE = np.array([[0, 1]])
"""The plane lies above a hanging block, as the pile lies above the soil.

Weight acts upward there.
"""


@dataclass(frozen=True)
class SlidingBlockResult:
    """Pull and climb of the block, and what they should be."""

    displacement: np.ndarray
    """Horizontal displacement, (n_steps,) in m."""
    force: np.ndarray
    """Pull, (n_steps,) in N."""
    exact: np.ndarray
    """Closed form of the pull, (n_steps,) in N."""
    climb: np.ndarray
    """Distance from the plane since slip began, (n_steps,) in m."""
    exact_climb: np.ndarray
    """Slip times tan(psi), (n_steps,) in m."""
    normal_force: np.ndarray
    """Force between block and plane, compression positive, (n_steps,) in N."""


def sliding_block(
    *,
    weight: float = 20e3,
    cohesion: float = 2e3,
    friction_angle: float = np.deg2rad(24.0),
    dilation_angle: float = 0.0,
    shear_stiffness: float = 1e7,
    normal_stiffness: float = 1e8,
    displacement: float = 2.4e-3,
    steps: int = 8,
) -> SlidingBlockResult:
    """Return pull and climb of a block of unit length under ``displacement`` in equal steps.

    Parameters
    ----------
    weight
        Normal force N in N.
    cohesion
        In Pa.
    friction_angle, dilation_angle
        In rad.
    shear_stiffness, normal_stiffness
        Of the interface, in Pa/m.
    displacement
        Final horizontal displacement in m.
    """
    law = CoulombInterface(
        normal_stiffness,
        shear_stiffness,
        cohesion=cohesion,
        friction_angle=friction_angle,
        dilation_angle=dilation_angle,
    )
    blocks = make_blocks(
        NODES,
        CELLS,
        PLANE,
        HenckyElastic(1e7, 0.0),
        coulomb_interface.pack(law, np.zeros(1))[0],
        unit_weight=-weight,
    )
    is_prescribed = np.zeros(NODES.shape, dtype=bool)
    is_prescribed[:, 0] = True
    blocks, _ = load(blocks, is_prescribed, np.zeros_like(NODES))  # the weight alone
    motion = np.zeros_like(NODES)
    motion[:, 0] = displacement / steps
    forces, climbs, normals = [], [0.0], []
    for _ in range(steps):
        blocks, equilibrium = load(blocks, is_prescribed, motion)
        forces.append(equilibrium.reaction[:, 0].sum())
        climbs.append(climbs[-1] - equilibrium.displacement[:2, 1].mean())
        normals.append(-(blocks.interface.traction[:, 1] * blocks.interface.area).sum())
    pulled = displacement * np.arange(1, steps + 1) / steps
    strength = cohesion + weight * np.tan(friction_angle)
    slip = np.maximum(pulled - strength / shear_stiffness, 0.0)
    return SlidingBlockResult(
        pulled,
        np.array(forces),
        np.minimum(shear_stiffness * pulled, strength),
        np.array(climbs[1:]),
        slip * np.tan(dilation_angle),
        np.array(normals),
    )
