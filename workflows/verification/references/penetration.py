"""PB7: deep penetration of a cone or flat-ended shaft into clay, published fits to computations.

These are fits to others' numerical results, quoted from the literature and not derived here: a
corridor, good to about 10 %.  Factors are (q - sigma_v0) / s_u.
"""

from __future__ import annotations

import numpy as np


def lu_factor(*, rigidity_index: float, adhesion: float, stress_anisotropy: float = 0.0) -> float:
    """Return 3.4 + 1.6 ln(I_r) - 1.9 Delta + 1.3 alpha.

    Source: Lu, Randolph, Hu & Bugarski (2004), Geotechnique 54, 257-267.

    Parameters
    ----------
    rigidity_index
        I_r = G / s_u.
    adhesion
        alpha, over s_u, 0 to 1.
    stress_anisotropy
        Delta = (sigma_v0 - sigma_h0) / (2 s_u).
    """
    return 3.4 + 1.6 * np.log(rigidity_index) - 1.9 * stress_anisotropy + 1.3 * adhesion


def teh_houlsby_factor(
    *,
    rigidity_index: float,
    face_adhesion: float,
    shaft_adhesion: float,
    stress_anisotropy: float = 0.0,
) -> float:
    """Return (1.67 + I_r / 1500) (1 + ln(I_r)) + 2.4 alpha_f - 0.2 alpha_s - 1.8 Delta.

    Parameters as in ``lu_factor``, with the adhesion of face and shaft.

    Source: Geotechnique 41 (1991), 17-34.
    """
    spherical = (1.67 + rigidity_index / 1500.0) * (1.0 + np.log(rigidity_index))
    return spherical + 2.4 * face_adhesion - 0.2 * shaft_adhesion - 1.8 * stress_anisotropy


def penetration_corridor(
    *, rigidity_index: float, adhesion: float, stress_anisotropy: float = 0.0
) -> tuple[float, float]:
    """Return the lower and the upper of both factors; ``adhesion`` is that of face and shaft."""
    lu = lu_factor(
        rigidity_index=rigidity_index, adhesion=adhesion, stress_anisotropy=stress_anisotropy
    )
    teh_houlsby = teh_houlsby_factor(
        rigidity_index=rigidity_index,
        face_adhesion=adhesion,
        shaft_adhesion=adhesion,
        stress_anisotropy=stress_anisotropy,
    )
    return min(lu, teh_houlsby), max(lu, teh_houlsby)
