"""What a deformable pile adds to the finite-element model: a material, twins, and a cap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from handoff.fe_mesh import FacetTag
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic


class Inclusion(NamedTuple):
    """A deformable pile, meshed together with the soil; see ``deformable_pile``."""

    law: HenckyElastic
    """Its material is the last row of the table."""
    unit_weight: float
    """In N/m^3."""
    cap: CoulombInterface
    """Law of the layer between the head and the rigid cap."""
    n_cells: int
    """Of the pile; they are the last of the mesh."""
    twin: np.ndarray | None
    """Node of the pile (node,) at the place of a node of the soil; None if they are the same."""


def interface_parameters(
    law: CoulombInterface, inclusion: Inclusion | None, strength: np.ndarray, parts: np.ndarray
) -> np.ndarray:
    """Return the packed parameters (n_i, 7) of interface and cap beside soil of ``strength``."""
    packed = coulomb_interface.pack(law, strength)
    if inclusion is not None:
        on_head = parts == FacetTag.PILE_HEAD
        packed[on_head] = coulomb_interface.pack(inclusion.cap, 0.0 * strength[on_head])
    return packed


def open_pattern(matrix: PETSc.Mat) -> None:
    """Let ``matrix`` take entries between twins, which no cell has in common."""
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
