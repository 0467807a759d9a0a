"""Material points: the moving carriers of stress and state."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.conventions import Kinematics, dimension
from install_mpm.record import Field


class MaterialPoints(NamedTuple):
    """State of all material points; in two dimensions per metre run."""

    position: Annotated[np.ndarray, Field(("point", "dim"), "m", "current position")]
    displacement: Annotated[
        np.ndarray, Field(("point", "dim"), "m", "displacement since the start of installation")
    ]
    mass: Annotated[np.ndarray, Field(("point",), "kg", "mass, constant but for injection")]
    volume: Annotated[np.ndarray, Field(("point",), "m^3", "current volume")]
    volume_ratio: Annotated[
        np.ndarray, Field(("point",), "", "J = det F, current over initial volume")
    ]
    elastic_log_strain: Annotated[
        np.ndarray, Field(("point", 3, 3), "", "elastic logarithmic (Hencky) strain")
    ]
    kirchhoff_stress: Annotated[
        np.ndarray, Field(("point", 3, 3), "Pa", "Kirchhoff stress, volume_ratio times Cauchy")
    ]
    state_variables: Annotated[
        np.ndarray, Field(("point", "state"), "SI", "state variables of the soil law")
    ]
    material: Annotated[np.ndarray, Field(("point",), "", "row of the soil table", "int64")]
    cell: Annotated[
        np.ndarray, Field(("point",), "", "background cell that holds the point", "int64")
    ]
    reference_coordinates: Annotated[
        np.ndarray, Field(("point", "dim"), "", "position in the reference cell")
    ]


def cauchy_stress(points: MaterialPoints) -> np.ndarray:
    """Return the Cauchy stress (n_points, 3, 3) in Pa."""
    stress: np.ndarray = points.kirchhoff_stress / points.volume_ratio[:, None, None]
    return stress


def plane_area(points: MaterialPoints, kinematics: Kinematics) -> np.ndarray:
    """Return the area (n_points,) in m^2 of the points in the plane of a two-dimensional model."""
    if kinematics != Kinematics.AXISYMMETRIC:
        return points.volume
    area: np.ndarray = points.volume / (2.0 * np.pi * points.position[:, 0])
    return area


def point_sizes(points: MaterialPoints, kinematics: Kinematics) -> np.ndarray:
    """Return the size (n_points,) in m: square root of the area, or cube root of the volume."""
    sizes: np.ndarray = plane_area(points, kinematics) ** (1.0 / dimension(kinematics))
    return sizes


def at_start(points: MaterialPoints) -> MaterialPoints:
    """Return the points with the positions and volumes that they had before the installation."""
    return points._replace(
        position=points.position - points.displacement,
        displacement=np.zeros_like(points.displacement),
        volume=points.volume / points.volume_ratio,
        volume_ratio=np.ones_like(points.volume_ratio),
    )
