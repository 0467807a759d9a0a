"""What the kinematics change in the finite-element model, each in one place."""

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
    Kinematics.THREE_D: SoilForms,
}
"""The discrete soil on a mesh; that of plane strain and of space differ in the mesh alone."""


def width(positions: np.ndarray, kinematics: Kinematics) -> np.ndarray:
    """Return the extent (n,) in m of the body normal to its plane: 1 m or 2 pi r; 1 in space."""
    if kinematics == Kinematics.AXISYMMETRIC:
        return 2.0 * np.pi * positions[:, 0]
    return np.ones(len(positions))
