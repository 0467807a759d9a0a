"""PA11 and PA12: two elastic blocks joined by one interface element, sheared (paper, Fig. 9).

Two unit squares, the lower one held at its base, the upper one pulled sideways at its top.  While
the interface sticks, the blocks and the interface are springs in series; once it slips, the force
is c L + N tan(phi).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from workflows.verification.small_strain_blocks import load, make_blocks

NODES = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
CELLS = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
INTERFACE = np.array([[3, 2, 4, 5]])
BASE, TOP = [0, 1], [6, 7]


@dataclass(frozen=True)
class InterfaceShearResult:
    """Horizontal force per metre run after each step, and what it should be."""

    displacement: np.ndarray
    """Displacement of the top, (n_steps,) in m."""
    force: np.ndarray
    """Computed horizontal force, (n_steps,) in N."""
    exact: np.ndarray
    """Closed form, (n_steps,) in N."""
    slip: float
    """Relative displacement of the two sides at the end in m."""
    residuals: tuple[np.ndarray, ...]
    """Relative residuals of the Newton iterations of each step."""


def interface_shear(
    *,
    youngs_modulus: float = 10e3,
    shear_stiffness: float = 1e7,
    normal_stiffness: float = 1e7,
    cohesion: float = 0.1,
    friction_angle: float = np.deg2rad(24.0),
    precompression: float = 0.0,
    displacement: float = 0.5,
    steps: int = 10,
    is_held_vertically: bool = True,
) -> InterfaceShearResult:
    """Return the shear force of the blocks.

    The defaults are those of the paper's Fig. 9 (Poisson's ratio is zero).

    Parameters
    ----------
    youngs_modulus, cohesion, precompression
        In Pa.
    shear_stiffness, normal_stiffness
        Of the interface, in Pa/m.
    friction_angle
        In rad; there is no dilation.
    displacement
        Of the top at the end, in m.
    is_held_vertically
        Hold the vertical displacement of all nodes (PA11 a), or of the top only (PA11 b).
    """
    law = CoulombInterface(
        normal_stiffness, shear_stiffness, cohesion=cohesion, friction_angle=friction_angle
    )
    blocks = make_blocks(
        NODES,
        CELLS,
        INTERFACE,
        HenckyElastic(youngs_modulus, 0.0),
        coulomb_interface.pack(law, np.zeros(1))[0],
        vertical_stress=-precompression,
    )
    is_prescribed = np.zeros(NODES.shape, dtype=bool)
    is_prescribed[BASE + TOP] = True
    is_prescribed[:, 1] |= is_held_vertically
    motion = np.zeros_like(NODES)
    motion[TOP, 0] = displacement / steps
    forces, residuals, slip = [], [], 0.0
    for _ in range(steps):
        blocks, equilibrium = load(blocks, is_prescribed, motion)
        forces.append(equilibrium.reaction[TOP, 0].sum())
        residuals.append(equilibrium.newton.residuals)
        slip += equilibrium.displacement[4, 0] - equilibrium.displacement[3, 0]
    top = displacement * np.arange(1, steps + 1) / steps
    shear_modulus = youngs_modulus / 2.0
    stiffness = 1.0 / (2.0 / shear_modulus + 1.0 / shear_stiffness)
    strength = cohesion + precompression * np.tan(friction_angle)
    return InterfaceShearResult(
        top, np.array(forces), np.minimum(stiffness * top, strength), slip, tuple(residuals)
    )
