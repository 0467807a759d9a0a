"""Small meshes, random tensors and soils that the tests of the installation stage share."""

from collections.abc import Callable

import numba
import numpy as np
import pytest

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from install_mpm.ground import Ground
from install_mpm.options import BackgroundMeshOptions, Box
from install_mpm.pile import Pile

Builder = Callable[..., BackgroundMesh]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240229)


@pytest.fixture
def threads():
    """Function that sets the number of threads; the old number comes back after the test."""
    before = numba.get_num_threads()
    yield lambda n: numba.set_num_threads(min(n, numba.config.NUMBA_NUM_THREADS))
    numba.set_num_threads(before)


def tensor_rotation(axis_angle: np.ndarray) -> np.ndarray:
    """Rotation by |axis_angle| about its direction (Rodrigues)."""
    angle = np.linalg.norm(axis_angle)
    x, y, z = axis_angle / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


@pytest.fixture
def make_rotation(rng):
    """Function that returns a random rotation, in space or about tensor axis 2."""

    def make(dim: int = 3) -> np.ndarray:
        if dim == 2:
            return tensor_rotation(np.array([0.0, 0.0, rng.uniform(1.0, 3.0)]))
        return tensor_rotation(rng.normal(size=3))

    return make


def grid_of_triangles(
    columns: int,
    rows: int,
    *,
    width: float = 1.0,
    depth: float = 1.0,
    n_nodes: int = 6,
    distortion: float = 0.0,
) -> BackgroundMesh:
    """Rectangle below z = 0, cut into triangles; ``distortion`` moves inner vertices at random."""
    x, z = np.meshgrid(np.linspace(0.0, width, columns + 1), np.linspace(-depth, 0.0, rows + 1))
    vertices = np.column_stack([x.ravel(), z.ravel()])
    is_inner = (np.abs(x / width - 0.5) < 0.499) & (np.abs(z / depth + 0.5) < 0.499)
    shift = np.random.default_rng(5).uniform(-1.0, 1.0, vertices.shape)
    vertices += distortion * shift * is_inner.ravel()[:, None] * [width / columns, depth / rows]
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    right, above, across = first + 1, first + columns + 1, first + columns + 2
    corners = np.stack([first, right, across, first, across, above], axis=1).reshape(-1, 3)
    if n_nodes == 3:
        return make_background_mesh(vertices, corners)
    ends = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, edge_of = np.unique(ends, axis=0, return_inverse=True)
    nodes = np.concatenate([vertices, vertices[edges].mean(axis=1)])
    middles = len(vertices) + edge_of.reshape(-1, 3)
    return make_background_mesh(nodes, np.concatenate([corners, middles], axis=1))


@pytest.fixture(scope="session")
def make_grid() -> Builder:
    return grid_of_triangles


@pytest.fixture(scope="session")
def clay() -> VonMises:
    return VonMises(4e6, 0.49, 20e3)


@pytest.fixture(scope="session")
def clay_ground(clay) -> Ground:
    return Ground(unit_weight=18e3, k0=0.8, soil=clay)


@pytest.fixture(scope="session")
def elastic_ground() -> Ground:
    return Ground(unit_weight=18e3, k0=0.6, soil=HenckyElastic(5e6, 0.3))


@pytest.fixture(scope="session")
def pile() -> Pile:
    """Pile of the soil's unit weight: it starts without head load."""
    return Pile(half_width=0.5, embedment=2.0, unit_weight=18e3)


@pytest.fixture(scope="session")
def box() -> Box:
    return Box(width=4.0, depth=5.0, headroom=0.6)


@pytest.fixture(scope="session")
def mesh_options() -> BackgroundMeshOptions:
    return BackgroundMeshOptions(size_at_pile=0.25, size_far=1.0)


def mandel_tensors(vectors: np.ndarray) -> np.ndarray:
    """Symmetric tensors (n, 3, 3) of Mandel six-vectors (n, 6), written out by hand."""
    xx, yy, zz, xy, xz, yz = np.asarray(vectors).T
    xy, xz, yz = (shear / np.sqrt(2.0) for shear in (xy, xz, yz))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)


@pytest.fixture(scope="session")
def tensors_of() -> Callable[[np.ndarray], np.ndarray]:
    return mandel_tensors


def mandel_vectors(tensors: np.ndarray) -> np.ndarray:
    """Mandel six-vectors (n, 6) of symmetric tensors (n, 3, 3), written out by hand."""
    t, root = np.asarray(tensors), np.sqrt(2.0)
    components = [t[:, 0, 0], t[:, 1, 1], t[:, 2, 2]]
    components += [root * t[:, 0, 1], root * t[:, 0, 2], root * t[:, 1, 2]]
    return np.stack(components, axis=1)


@pytest.fixture(scope="session")
def vectors_of() -> Callable[[np.ndarray], np.ndarray]:
    return mandel_vectors
