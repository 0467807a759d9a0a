"""Volumes of the material points of sand and other drained soil whose plastic volume is a state.

The points of a cell see one pressure.  Where it evens out between them, the points that lose
elastic compression expand, and the others are compressed by as much.  Openings of sand, what it has
parted by without tension, are one for all points of a cell that is open as a whole.  Open soil
carries no pressure until it has closed: mixed with soil under pressure, at the integration points
or by smoothing, its opening would take that pressure away at rest.  So where some point of the cell
is not open the openings of the others close, and their volume goes with them.

Without either, sand that stays in the corner behind a trailing edge grows with every point under
pressure that passes by: to half more than its volume in a turn and a half.
"""

from __future__ import annotations

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.material_points import MaterialPoints


def exchange_volume(
    points: MaterialPoints, updated: MaterialPoints, materials: dispatch.Materials
) -> None:
    """Give each point the volume that the smoothing has taken from its elastic compression.

    ``points`` are those before the step, ``updated``, which is changed, those after it with the
    volume that follows from the motion of their cell.  The sum over the points of one soil in a
    cell stays what it is.  The specific volume then follows the volume of the point.
    """
    for row, column in enumerate(dispatch.log_volume_columns(materials)):
        here = np.flatnonzero(points.material == row)
        if column < 0 or not len(here):
            continue
        before, after = (
            of.state_variables[here, column]
            + np.trace(of.elastic_log_strain[here], axis1=1, axis2=2)
            - np.log(of.volume_ratio[here])
            for of in (points, updated)
        )
        _, cell = np.unique(points.cell[here], return_inverse=True)
        factor, volume = np.exp(after - before), updated.volume[here]
        scale = np.bincount(cell, volume) / np.bincount(cell, volume * factor)
        updated.volume[here] *= factor * scale[cell]
        updated.volume_ratio[here] *= factor * scale[cell]
        updated.state_variables[here, column] += np.log(scale[cell])


def share_openings(
    points: MaterialPoints, materials: dispatch.Materials
) -> tuple[MaterialPoints, float]:
    """Return the points with one opening of each soil of a cell, and the volume in m3 that closed.

    The volume of a point changes as its opening does, and so do its volume ratio and the plastic
    part of its specific volume.  Sharing conserves the volume; closing takes what was open.
    Undrained soil keeps its volume, which is that of its pore water.
    """
    volume, variables = points.volume.copy(), points.state_variables.copy()
    log_volumes = dispatch.log_volume_columns(materials)
    closed = 0.0
    for row, column in enumerate(dispatch.state_columns(materials, "opening")):
        here = np.flatnonzero(points.material == row)
        if column < 0 or not variables[here, column].any():
            continue
        shared, is_mixed = _shared(points.cell[here], variables[here, column], volume[here])
        change = shared - variables[here, column]
        variables[here, column] = shared
        if log_volumes[row] < 0:
            continue
        variables[here, log_volumes[row]] += change
        closed -= volume[here[is_mixed]] @ np.expm1(change[is_mixed])
        volume[here] *= np.exp(change)
    ratio = points.volume_ratio * volume / points.volume
    return points._replace(volume=volume, volume_ratio=ratio, state_variables=variables), closed


def _shared(
    cell: np.ndarray, opening: np.ndarray, volume: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the opening (n,) that each point has from now on, and whether others keep it shut."""
    _, cell = np.unique(cell, return_inverse=True)
    is_mixed = np.bincount(cell, opening == 0.0) > 0.0
    without = np.bincount(cell, volume * np.exp(-opening)) / np.bincount(cell, volume)
    shared = np.where(is_mixed, 0.0, -np.log(without))
    return shared[cell], is_mixed[cell]
