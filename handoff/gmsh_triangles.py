"""gmsh as a function from outline and edge length to triangles: repeatable, quiet, no traces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from install_mpm.soil_bands import Drawing

OPTIONS = {
    "General.NumThreads": 1.0,
    "General.Terminal": 0.0,
    "Mesh.Algorithm": 6.0,
    "Mesh.RandomSeed": 1.0,
    "Mesh.MeshSizeExtendFromBoundary": 0.0,
    "Mesh.MeshSizeFromPoints": 0.0,
    "Mesh.MeshSizeFromCurvature": 0.0,
    "Mesh.MeshSizeMin": 0.0,
    "Mesh.MeshSizeMax": 1e22,
    "Mesh.MeshSizeFactor": 1.0,
    "Mesh.ElementOrder": 1.0,
}
"""One thread and one seed: the same outline gives the same mesh; 6 is Frontal-Delaunay."""


class MeshError(RuntimeError):
    """A finite-element mesh cannot be made; the message says what to change."""


def triangulate(
    outline: np.ndarray, edge_length: Callable[[float, float], float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 2) in m and triangles (m, 3) that fill a polygon; ``fill_polygons``."""
    return fill_polygons([outline], edge_length)


def fill_polygons(
    outlines: Sequence[np.ndarray], edge_length: Callable[[float, float], float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 2) in m and counter-clockwise triangles (m, 3) int64 that fill polygons.

    ``outlines`` (corners, 2) in m are counter-clockwise and share the corners at which they touch;
    ``edge_length(x, z)`` is the wanted length in m.  The same arguments give bit-equal results.

    Raises
    ------
    MeshError
        If gmsh cannot be loaded, or fails.
    """
    with _own_model() as gmsh:
        drawing = Drawing(gmsh.model.geo)
        for outline in outlines:
            drawing.add_surface(outline)
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.setSizeCallback(lambda _dim, _tag, x, z, _y, _size: edge_length(x, z))
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:  # gmsh raises bare exceptions
            raise MeshError(f"gmsh could not mesh the ground ({error})") from error
        finally:
            gmsh.model.mesh.removeSizeCallback()
        return _triangles(gmsh)


def _triangles(gmsh: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles of the current model, numbered from zero in gmsh's order."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    _, triangle_tags = gmsh.model.mesh.getElementsByType(2)
    triangles = np.searchsorted(tags[order], triangle_tags).reshape(-1, 3).astype(np.int64)
    return coordinates.reshape(-1, 3)[order, :2].copy(), triangles


@contextmanager
def _own_model() -> Iterator[Any]:
    """Lend gmsh with an empty model; afterwards gmsh is as it was found, initialised or not."""
    try:
        import gmsh
    except (ImportError, OSError) as error:  # the wheel needs system libraries, such as libGLU
        raise MeshError(f"gmsh cannot be loaded ({error}); run script/bootstrap") from error

    was_running = bool(gmsh.isInitialized())
    if not was_running:
        gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    before = {name: gmsh.option.getNumber(name) for name in OPTIONS}
    current = gmsh.model.getCurrent()
    try:
        for name, value in OPTIONS.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add("screwpile")
        yield gmsh
    finally:
        if was_running:
            gmsh.model.remove()
            for name, value in before.items():
                gmsh.option.setNumber(name, value)
            gmsh.model.setCurrent(current)
        else:
            gmsh.finalize()
