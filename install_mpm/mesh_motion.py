"""The mesh follows the pile: laws that move nodes, decoupled from the material points."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, straightened


def translate(
    mesh: BackgroundMesh,
    advance: float,
    moving_level: float,
    fixed_levels: tuple[float, float],
    rigid_zone: float = 0.0,
) -> BackgroundMesh:
    """Return the mesh with the nodes at ``moving_level`` moved *down* by ``advance`` (both in m).

    Between the moving level (of the reference mesh) and the two fixed levels, bottom and top, the
    vertical coordinate is stretched or compressed linearly: paper, eqs (1) and (2), with L_b the
    moving level, L_m the top, u = -``advance`` and heights from the bottom.  Nodes within
    ``rigid_zone`` above and below the moving level move as one, so that the cells around the pile
    tip keep their shape; zero gives the equations as printed.
    """
    bottom, top = fixed_levels
    levels = [bottom, moving_level - rigid_zone, moving_level + rigid_zone, top]
    moved = [bottom, moving_level - rigid_zone - advance, moving_level + rigid_zone - advance, top]
    nodes = mesh.reference_nodes.copy()
    nodes[:, -1] = np.interp(nodes[:, -1], levels, moved)
    return straightened(mesh._replace(nodes=nodes))
