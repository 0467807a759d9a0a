"""The soil beside and below a pile as level bands, which meshes of layered ground follow."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from install_mpm.options import Box
from install_mpm.pile import Pile

Corner = tuple[float, float]


def soil_bands(
    pile: Pile, tip_depth: float, box: Box, boundaries: Sequence[float]
) -> list[np.ndarray]:
    """Return outlines (corners, 2) in m, anticlockwise, of the soil between depths ``boundaries``.

    Bands share their corners, so that they can be joined edge to edge; without a boundary within
    the box there is one.
    """
    inside = [depth for depth in boundaries if 0.0 < depth < box.depth]
    levels = [0.0, *inside, box.depth]
    return [
        _band(pile.half_width, tip_depth, box.width, top, bottom)
        for top, bottom in pairwise(levels)
    ]


def _band(half_width: float, tip: float, width: float, top: float, bottom: float) -> np.ndarray:
    """Return the outline of the band between two depths, from its lower corner at the left."""
    left = [(half_width if bottom <= tip else 0.0, -bottom)]
    right = [(width, -bottom), (width, -top)]
    beside = [(half_width, -top)] if top <= tip else [(0.0, -top)]
    below = [(half_width, -tip), (0.0, -tip)] if top <= tip < bottom else []
    corners = left + right + (below if top == tip else beside + below)
    return np.array(corners)


class Drawing:
    """Surfaces drawn in gmsh's ``geo`` kernel that share the points and lines they have in common.

    ``lines`` holds the line between two corners, keyed by them in the order it was drawn in.
    """

    def __init__(self, geo: Any) -> None:
        self._geo = geo
        self._points: dict[Corner, int] = {}
        self.lines: dict[tuple[Corner, Corner], int] = {}

    def add_surface(self, outline: np.ndarray) -> None:
        """Draw the surface with the corners ``outline`` (n, 2) in m."""
        corners = [(float(x), float(z)) for x, z in outline]
        for corner in corners:
            if corner not in self._points:
                self._points[corner] = self._geo.addPoint(*corner, 0.0)
        lines = [self._line(*ends) for ends in pairwise([*corners, corners[0]])]
        self._geo.addPlaneSurface([self._geo.addCurveLoop(lines)])

    def _line(self, start: Corner, end: Corner) -> int:
        """Return the line from ``start`` to ``end``; negative if it was drawn the other way."""
        if (end, start) in self.lines:
            return -self.lines[end, start]
        if (start, end) not in self.lines:
            self.lines[start, end] = self._geo.addLine(self._points[start], self._points[end])
        return self.lines[start, end]
