"""gmsh as a function from outline and edge length to cells: repeatable, quiet, no traces."""

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

LINEAR = {2: 2, 3: 4}
"""gmsh's number of the triangle and the tetrahedron with straight edges."""


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
        return _cells(gmsh, 2)


def fill_solid(
    places: np.ndarray, triangles: np.ndarray, size: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) in m and tetrahedra (m, 4) int64 in a closed surface, which is kept.

    ``triangles`` (k, 3) on ``places`` (l, 3) have their normals outward; ``size`` in m is the
    wanted edge length inside.  The places are the first vertices.

    Raises
    ------
    MeshError
        If gmsh cannot be loaded, or fails.
    """
    with _own_model() as gmsh:
        surface = gmsh.model.addDiscreteEntity(2)
        tags = np.arange(1, len(places) + 1)
        gmsh.model.mesh.addNodes(2, surface, tags, places.ravel())
        gmsh.model.mesh.addElementsByType(surface, 2, [], (triangles + 1).ravel())
        gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([surface])])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.setSizeCallback(lambda *_place: size)
        try:
            gmsh.model.mesh.generate(3)
        except Exception as error:  # gmsh raises bare exceptions
            raise MeshError(f"gmsh could not mesh the pile ({error})") from error
        finally:
            gmsh.model.mesh.removeSizeCallback()
        return _cells(gmsh, 3)


def _cells(gmsh: Any, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, dim) and simplices of the current model, from zero in gmsh's order."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    _, cell_tags = gmsh.model.mesh.getElementsByType(LINEAR[dim])
    cells = np.searchsorted(tags[order], cell_tags).reshape(-1, dim + 1).astype(np.int64)
    return coordinates.reshape(-1, 3)[order, :dim].copy(), cells


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
