"""The background mesh: straight-edged cells that follow the pile, decoupled from the material points."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.record import Field


class BackgroundMesh(NamedTuple):
    """Nodes now and in the reference position, and cells with their neighbours."""

    nodes: Annotated[np.ndarray, Field(("node", "dim"), "m", "current node coordinates")]
    reference_nodes: Annotated[
        np.ndarray, Field(("node", "dim"), "m", "node coordinates at zero pile motion")
    ]
    cell_nodes: Annotated[
        np.ndarray, Field(("cell", "cell_node"), "", "nodes of each cell, vertices first", "int64")
    ]
    cell_neighbours: Annotated[
        np.ndarray,
        Field(("cell", "facet"), "", "cell across the facet opposite each vertex, -1 outside", "int64"),
    ]
