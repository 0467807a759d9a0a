"""What the kinematics change in the finite-element model, each in one place."""

from __future__ import annotations

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.conventions import Kinematics
from service_fe.axisymmetric_forms import AxisymmetricForms
from service_fe.soil_forms import SoilForms

Forms = SoilForms | AxisymmetricForms


def soil_forms(mesh: FEMesh, kinematics: Kinematics, *, mean_dilatation: bool) -> Forms:
    """Return the discrete soil on a mesh; that of plane strain and of space differ in the mesh.

    ``mean_dilatation`` concerns tetrahedra alone: undrained soil puts four conditions on each, as
    many as it has displacements of its own, but only three on a triangle, which has four.
    """
    if kinematics == Kinematics.AXISYMMETRIC:
        return AxisymmetricForms(mesh)
    return SoilForms(mesh, mean_dilatation=mean_dilatation and kinematics == Kinematics.THREE_D)


def width(positions: np.ndarray, kinematics: Kinematics) -> np.ndarray:
    """Return the extent (n,) in m of the body normal to its plane: 1 m or 2 pi r; 1 in space."""
    if kinematics == Kinematics.AXISYMMETRIC:
        return 2.0 * np.pi * positions[:, 0]
    return np.ones(len(positions))
