"""Injection of material points where an integration point has none, by splitting.

Conserves mass and volume.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cell_fill import CellGeometry
from install_mpm.cells import ReferenceCell
from install_mpm.discretisation import GeostaticGradient
from install_mpm.geostatic import change_with_height
from install_mpm.integration_points import CellFill
from install_mpm.material_points import MaterialPoints

LEAST_SHARE = 1e-3
"""Volume of a point over that of its sub-region below which it is not split.

Where soil flows through a sub-region without a point of it staying there, what is split off leaves
in each step, and its donor would be halved without end.  The sub-region takes the mean of its cell.
"""


def inject(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    geometry: CellGeometry,
    fill: CellFill,
    gradient: GeostaticGradient,
) -> MaterialPoints:
    """Return the points with one more at every empty integration point of an interior cell.

    The new point is split off the largest point of the cell, or of a neighbour where the cell is
    empty, unless that is too small: mass and volume are conserved exactly, and the state is moved
    with the geostatic gradient.
    """
    if not fill.is_interior.any():
        return points
    occupied = np.zeros(geometry.integration_height.shape, dtype=bool)
    nearest = sub_region_of(points, cell)
    occupied[points.cell, nearest] = True
    split: list[tuple[int, int, int]] = []
    volume = points.volume.copy()
    for c, q in np.argwhere(~occupied & fill.is_interior[:, None]):
        donors = _points_near(c, fill, mesh)
        if len(donors) == 0:
            continue
        donor = donors[np.argmax(volume[donors])]
        if volume[donor] < LEAST_SHARE * geometry.integration_volume[c, q]:
            continue
        volume[donor] /= 2.0
        split.append((donor, c, q))
    return _split(points, np.array(split, dtype=np.int64).reshape(-1, 3), mesh, cell, gradient)


def sub_region_of(points: MaterialPoints, cell: ReferenceCell) -> np.ndarray:
    """Return the integration point (n_points,) whose sub-region holds each material point."""
    coordinates = np.ascontiguousarray(points.reference_coordinates.T)
    nearest, least = np.zeros(len(points.cell), dtype=np.int64), np.full(len(points.cell), np.inf)
    for q, place in enumerate(cell.integration_coordinates):
        distance, total = np.zeros_like(least), np.zeros_like(least)
        for own, centre in zip(coordinates, place, strict=True):
            difference = own - centre
            distance += difference**2
            total += difference
        distance += total**2  # the dependent barycentric coordinate
        is_nearer = distance < least
        nearest[is_nearer] = q
        np.minimum(least, distance, out=least)
    return nearest


def _points_near(c: int, fill: CellFill, mesh: BackgroundMesh) -> np.ndarray:
    """Return the points of cell ``c``, or of its neighbours if it is empty."""
    own = fill.point_order[fill.cell_start[c] : fill.cell_start[c + 1]]
    if len(own):
        return own
    neighbours = mesh.cell_neighbours[c]
    return np.concatenate(
        [
            fill.point_order[fill.cell_start[n] : fill.cell_start[n + 1]]
            for n in neighbours
            if n >= 0
        ]
    )


def _split(
    points: MaterialPoints,
    split: np.ndarray,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    gradient: GeostaticGradient,
) -> MaterialPoints:
    """Return the points with one more per row (donor, cell, integration point) of ``split``."""
    if len(split) == 0:
        return points
    donor, c, q = split.T
    halvings = _earlier_of_same(donor) + 1
    n_split = np.bincount(donor, minlength=len(points.mass))
    volume, mass = points.volume * 0.5**n_split, points.mass * 0.5**n_split
    new = MaterialPoints(*(field[donor] for field in points))
    reference = cell.integration_coordinates[q]
    place = _position(mesh, cell, c, reference)
    change = change_with_height(
        gradient, new.material, new.position[:, -1], place[:, -1], cell.dim - 1,
        points.state_variables.shape[1],
    )  # fmt: skip
    new = new._replace(
        position=place,
        reference_coordinates=reference,
        cell=c,
        volume=new.volume * 0.5**halvings,
        mass=new.mass * 0.5**halvings,
        elastic_log_strain=new.elastic_log_strain + change.strain,
        kirchhoff_stress=new.kirchhoff_stress + change.stress,
        state_variables=new.state_variables + change.state_variables,
    )
    kept = points._replace(volume=volume, mass=mass)
    return MaterialPoints(*(np.concatenate(pair) for pair in zip(kept, new, strict=True)))


def _earlier_of_same(numbers: np.ndarray) -> np.ndarray:
    """Return how many earlier entries of ``numbers`` (n,) equal each one, (n,)."""
    order = np.argsort(numbers, kind="stable")
    ordered = numbers[order]
    earlier = np.empty(len(numbers), dtype=np.int64)
    earlier[order] = np.arange(len(numbers)) - np.searchsorted(ordered, ordered)
    return earlier


def _position(
    mesh: BackgroundMesh, cell: ReferenceCell, cells: np.ndarray, xi: np.ndarray
) -> np.ndarray:
    """Return the places (n, dim) of reference coordinates ``xi`` (n, dim) in ``cells`` (n,)."""
    vertices = mesh.nodes[mesh.cell_nodes[cells, : cell.n_vertices]]
    edges = vertices[:, 1:] - vertices[:, :1]
    place: np.ndarray = vertices[:, 0] + np.einsum("nv,nvi->ni", xi, edges)
    return place


def merge(
    points: MaterialPoints, cell: ReferenceCell, fill: CellFill, most_per_cell: int
) -> MaterialPoints:
    """Return the points with the nearest pairs of crowded cells merged until none holds too many.

    Only points of the same soil and sub-region are merged.  Mass, volume, initial volume and the
    volume integrals of displacement, strain, stress and state variables are conserved; the new
    point lies at the centre of volume.
    """
    crowded = np.flatnonzero(np.diff(fill.cell_start) > most_per_cell)
    if len(crowded) == 0:
        return points
    merged = MaterialPoints(*(np.array(field) for field in points))
    is_left = np.ones(len(points.mass), dtype=bool)
    region = sub_region_of(points, cell)
    held = [fill.point_order[fill.cell_start[c] : fill.cell_start[c + 1]] for c in crowded]
    while held:
        pairs = [_nearest_pairs(merged, own, region, len(own) - most_per_cell) for own in held]
        kept, gone = np.concatenate(pairs).T
        _merge_pairs(merged, kept, gone)
        is_left[gone] = False
        held = [own[is_left[own]] for own, found in zip(held, pairs, strict=True) if len(found)]
        held = [own for own in held if len(own) > most_per_cell]
    return MaterialPoints(*(field[is_left] for field in merged))


def _nearest_pairs(
    points: MaterialPoints, own: np.ndarray, region: np.ndarray, most: int
) -> np.ndarray:
    """Return at most ``most`` pairs (n, 2) of ``own``, the nearest first, no point in two of them.

    Both points of a pair are of the same soil and sub-region.
    """
    first, second = _all_pairs(len(own))
    material, own_region, position = points.material[own], region[own], points.position[own]
    is_same = (own_region[first] == own_region[second]) & (material[first] == material[second])
    first, second = first[is_same], second[is_same]
    difference = position[first] - position[second]
    order = np.argsort((difference**2).sum(axis=1), kind="stable")
    first, second = own[first[order]], own[second[order]]
    taken: set[int] = set()
    pairs: list[tuple[int, int]] = []
    for pair in zip(first.tolist(), second.tolist(), strict=True):
        if len(pairs) == most:
            break
        if taken.isdisjoint(pair):
            taken.update(pair)
            pairs.append(pair)
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


@lru_cache(maxsize=64)
def _all_pairs(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return first and second number of all pairs of ``n`` things; most cells hold equally many."""
    return np.triu_indices(n, 1)


def _merge_pairs(points: MaterialPoints, kept: np.ndarray, gone: np.ndarray) -> None:
    """Put the points ``gone`` (n,) into ``kept`` (n,), in place; no point is in two pairs."""
    pair = np.stack([kept, gone])
    volume = points.volume[pair]
    share = volume / volume.sum(axis=0)
    initial_volume = volume / points.volume_ratio[pair]
    cauchy = points.kirchhoff_stress[pair] / points.volume_ratio[pair][:, :, None, None]
    ratio = volume.sum(axis=0) / initial_volume.sum(axis=0)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.asarray(np.einsum("pn,pn...->n...", share, values))

    for name in (
        "position", "displacement", "elastic_log_strain", "state_variables",
        "reference_coordinates",
    ):  # fmt: skip
        field = getattr(points, name)
        field[kept] = mean(field[pair])
    points.kirchhoff_stress[kept] = ratio[:, None, None] * mean(cauchy)
    points.volume_ratio[kept] = ratio
    points.volume[kept] = volume.sum(axis=0)
    points.mass[kept] = points.mass[pair].sum(axis=0)
