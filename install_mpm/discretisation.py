"""What stays the same in every step of a run: cells, scheme, materials, solver and numerics."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np

from install_mpm.assembly import SparsityPattern
from install_mpm.cells import ReferenceCell
from install_mpm.constitutive.dispatch import Materials
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.ground import GroundProfile
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.interface import InterfaceElements
from install_mpm.linear_solvers import Solve
from install_mpm.material_points import MaterialPoints
from install_mpm.options import Numerics


class Scheme(Enum):
    """How material points and the equations of a step are related."""

    CARRIERS = "carriers"
    """Material points carry the state to fixed integration points of the cells (the default)."""
    QUADRATURE = "quadrature"
    """Material points are the integration points (the paper's scheme)."""


class Discretisation(NamedTuple):
    """The choices and tools of a run."""

    cell: ReferenceCell
    elements: InterfaceElements
    materials: Materials
    pattern: SparsityPattern
    solve: Solve
    numerics: Numerics
    kinematics: Kinematics = Kinematics.PLANE_STRAIN
    has_mean_dilatation: bool = True
    is_finite_strain: bool = True
    scheme: Scheme = Scheme.CARRIERS
    is_cell_weighted: bool = False
    """With ``Scheme.QUADRATURE``: scale the volumes of the points of interior cells to the cell."""
    has_weight_of_points: bool = False
    """With ``Scheme.CARRIERS``: a cell weighs what its material points weigh, so that the supports
    carry the weight of the body to round-off.

    By default an interior cell weighs its volume times the density, so that undisturbed ground
    stays in equilibrium however the points lie in the cells.
    """
    compares_resultants: bool = False
    """In space: a step has converged only if force and moment on the pile are those of supports and
    loads, to the tolerance."""
    gravity: float = GRAVITY
    """Gravitational acceleration in m/s^2, or in the units of everything else."""


class GeostaticGradient(NamedTuple):
    """Geostatic state per metre of height: it moves a state from one place to one nearby."""

    strain: np.ndarray
    """Elastic strain, (n_materials, 3, 3) in 1/m."""
    stress: np.ndarray
    """Cauchy stress, (n_materials, 3, 3) in Pa/m."""
    curved: tuple[int, ...] = ()
    """Rows of the soil table whose strain is not linear in the depth: it follows ``ground``."""
    ground: GroundProfile | None = None
    """The undisturbed ground; needed for ``curved`` rows only."""


class StepStart(NamedTuple):
    """What phase (i) of a step makes of the material points."""

    points: MaterialPoints
    """The material points, with injected ones."""
    fill: CellFill
    quadrature: IntegrationPoints
    n_empty: int
    """Integration points of filled cells without a material point."""
    n_injected: int = 0
    n_merged: int = 0
    closed_volume: float = 0.0
    """Volume in m3 (or m2, m3 per radian) of openings of sand that closed."""
