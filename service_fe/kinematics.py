"""What plane strain and axisymmetry change in the finite-element model, each in one place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.conventions import Kinematics
from service_fe.axisymmetric_forms import AxisymmetricForms
from service_fe.soil_forms import SoilForms

Forms = SoilForms | AxisymmetricForms

FORMS: dict[Kinematics, Callable[[FEMesh], Forms]] = {
    Kinematics.PLANE_STRAIN: SoilForms,
    Kinematics.AXISYMMETRIC: AxisymmetricForms,
}


def soil_forms(mesh: FEMesh, kinematics: Kinematics) -> Forms:
    """Return the discrete soil.

    Raises
    ------
    ValueError
        If there are no forms for ``kinematics``.
    """
    if kinematics not in FORMS:
        known = " or ".join(kind.name for kind in FORMS)
        raise ValueError(f"the service stage is two-dimensional; use {known}")
    return FORMS[kinematics](mesh)


def width(positions: np.ndarray, kinematics: Kinematics) -> np.ndarray:
    """Return the extent (n,) in m of the body normal to its plane: 1 m or 2 pi r."""
    if kinematics == Kinematics.AXISYMMETRIC:
        return 2.0 * np.pi * positions[:, 0]
    return np.ones(len(positions))
