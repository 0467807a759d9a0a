"""Results of AMPLE 1.1, an independent implicit MPM code, for its own three demonstrations.

These are figures of another code, with its discretisation error, not exact solutions: they say what
a second implementation of the same equations gets from the same inputs.  AMPLE (Coombs & Augarde
2020, Advances in Engineering Software 139, 102748; GPLv3) was run unmodified under GNU Octave 7.3,
source of July 2026 (4cbd757), the ghost-stabilised variant from its branch AMPLE-GS (7d05a03).

All in plane strain, quadrilateral cells, the load growing linearly over the steps, gravity
downward, GIMP unless stated, Newton tolerance 1e-9 (1e-6 in the branch).  SI units; x to the right,
y upward.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ColumnInput:
    """Elastic column of one cell's width between rollers, also on the base; Hencky (PA1)."""

    height: float = 50.0
    youngs_modulus: float = 1e4
    poissons_ratio: float = 0.0
    density: float = 80.0
    gravity: float = 10.0
    points_per_cell: tuple[int, int] = (2, 2)
    steps: int = 40


@dataclass(frozen=True)
class ColumnResult:
    """State of the column at full load."""

    stress_error: float
    """Sum of |s_yy - exact| V_0 over rho g L times the sum of V_0."""
    top_displacement: float
    """Vertical, of the highest points, in m."""
    iterations: int | None = None
    """Newton iterations of all steps, where recorded."""


COLUMN = ColumnInput()
COLUMN_GIMP = {
    16: ColumnResult(3.658906e-3, -25.99712714, 166),
    32: ColumnResult(1.048706e-3, -25.95967155, 166),
    64: ColumnResult(4.357237e-4, -25.94970765, 166),
}
"""By the number of cells over the height."""
COLUMN_STANDARD_MPM = ColumnResult(8.669649e-2, -27.95322042, 195)
"""16 cells, points as integration points, so with cell-crossing error."""
COLUMN_STANDARD_MPM_GHOST = ColumnResult(8.697724e-2, -27.60084844, 176)
"""16 cells, ghost penalty E."""
COLUMN_GIMP_GHOST = ColumnResult(3.318460e-3, -25.88681275, 143)
"""16 cells, ghost penalty E."""
COLUMN_TOP_POINT = 23.22162286
"""Height of the highest points with 16 cells, in m."""
COLUMN_LOWEST_STRESS = -38314.31
"""Smallest vertical stress of a point with 16 cells, in Pa."""
COLUMN_BASE_REACTION = 125000.0
"""Sum over the base with 16 cells (50 / 16 m wide), in N."""


@dataclass(frozen=True)
class BeamInput:
    """Elastic cantilever; Hencky (PA2).

    The body lies in 0 <= x <= 10, 9 <= y <= 10.  x is fixed on the line x = 0, y at the node
    (0, 9.5).  Half of the load acts on each of the two points of the last column next to the
    middle line.
    """

    length: float = 10.0
    depth: float = 1.0
    youngs_modulus: float = 12e6
    poissons_ratio: float = 0.2
    load: float = 100e3
    cell_size: float = 0.25
    steps: int = 50


BEAM = BeamInput()
BEAM_9_POINTS = {
    1: (-0.023033, -0.622706),
    6: (-0.704633, -3.376108),
    12: (-1.939010, -5.397546),
    17: (-2.841008, -6.349145),
    23: (-3.686948, -7.043206),
    28: (-4.232382, -7.416981),
    34: (-4.749128, -7.736720),
    39: (-5.105508, -7.942119),
    45: (-5.446487, -8.128766),
    50: (-5.68868415, -8.25688661),
}
"""Mean displacement (x, y) of the loaded points in m by step, 3 x 3 points per cell.

11 solves were singular to working precision, and step 15 did not converge.
"""
BEAM_9_POINTS_GHOST = {
    1: (-0.022687, -0.618050),
    6: (-0.701069, -3.368236),
    12: (-1.902996, -5.359630),
    17: (-2.762430, -6.295295),
    23: (-3.568288, -6.986252),
    28: (-4.094413, -7.369394),
    34: (-4.598934, -7.699459),
    39: (-4.939790, -7.906439),
    45: (-5.283278, -8.104301),
    50: (-5.52353634, -8.23878625),
}
"""The same with ghost penalty E; all steps converged."""
BEAM_36_POINTS = {
    1: (-0.02292972, -0.62200724),
    2: (-0.09132078, -1.23837698),
    4: (-0.34358174, -2.38485398),
    6: (-0.69957935, -3.36843962),
    8: (-1.10347143, -4.18150254),
    10: (-1.51218454, -4.83735407),
    12: (-1.90578930, -5.36815426),
}
"""The same with the 6 x 6 points of the demonstration, no ghost penalty; stopped at step 12."""


@dataclass(frozen=True)
class CollapseInput:
    """Elasto-plastic block that collapses under its weight; half of it, x = 0 is the middle.

    Hencky and von Mises without hardening: the norm of the deviatoric Kirchhoff stress is at most
    ``deviator_norm``.  Rollers on x = 0 and on the base; the grid is 16 m x 8 m.
    """

    width: float = 8.0
    height: float = 8.0
    youngs_modulus: float = 1e6
    poissons_ratio: float = 0.3
    deviator_norm: float = 20e3
    density: float = 1000.0
    gravity: float = 10.0
    cell_size: float = 1.0
    points_per_cell: tuple[int, int] = (6, 6)
    steps: int = 40

    @property
    def undrained_shear_strength(self) -> float:
        """Return the strength in pure shear, the norm over sqrt(2), in Pa."""
        return self.deviator_norm / 2.0**0.5

    @property
    def uniaxial_strength(self) -> float:
        """Return the yield stress in uniaxial stress, the norm times sqrt(3/2), in Pa."""
        return self.deviator_norm * 1.5**0.5


COLLAPSE = CollapseInput()
COLLAPSE_EXTENT = {
    10: (7.964562, 7.856401),
    18: (8.028367, 7.810201),
    23: (8.688459, 7.789146),
    27: (9.780364, 7.652410),
    31: (11.010408, 7.305303),
    36: (12.621500, 6.664230),
    40: (13.70056779, 6.17284283),
}
"""Largest x and largest y of the points in m by step."""
COLLAPSE_VOLUME_RATIO = (0.937893, 1.027476)
"""Smallest and largest det F of the points at full load."""
COLLAPSE_MEAN_STRESS = -12301.2
"""Volume mean of a third of the trace of the Cauchy stress at full load, in Pa."""
COLLAPSE_ITERATIONS = 225
"""Newton iterations of all steps: 4 in each of the first 15, 5 to 7 later."""
