"""The finite-element mesh of the installed pile: straight-edged 6-node triangles.

The ground is meshed with a level surface, conforming to the pile at its installed depth; the surface
is then warped to the profile that the installation left.  Two models with the same depth and a level
surface get the identical mesh.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.record import Field


class FacetTag(IntEnum):
    """Parts of the boundary of the soil; the first two are the pile's and equal ``PilePart``."""

    PILE_BASE = 0
    PILE_SHAFT = 1
    SYMMETRY = 2
    SIDE = 3
    BOTTOM = 4
    SURFACE = 5


class FEMesh(NamedTuple):
    """Six-node triangles with straight edges and their boundary facets; x >= 0, z up."""

    nodes: Annotated[np.ndarray, Field(("node", 2), "m", "node coordinates (x, z)")]
    cell_nodes: Annotated[
        np.ndarray,
        Field(
            ("cell", 6),
            "",
            "vertices counter-clockwise, then mid-sides of edges 01, 12, 20",
            "int64",
        ),
    ]
    facet_nodes: Annotated[
        np.ndarray,
        Field(
            ("facet", 3), "", "boundary edges: ends, soil on the left hand, then mid-side", "int64"
        ),
    ]
    facet_tag: Annotated[
        np.ndarray, Field(("facet",), "", "FacetTag of each boundary edge", "int64")
    ]
