"""Small meshes, random tensors and soils that the tests of the installation stage share."""

from collections.abc import Callable

import numba
import numpy as np
import pytest

from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from install_mpm.equilibrium import Discretisation, Prescribed
from install_mpm.geostatic import geostatic_gradient, undisturbed_state
from install_mpm.ground import Ground
from install_mpm.interface import no_interface
from install_mpm.linear_solvers import superlu
from install_mpm.material_points import MaterialPoints
from install_mpm.options import BackgroundMeshOptions, Box, Numerics
from install_mpm.pile import Pile, PileMotion
from install_mpm.seeding import seed_points
from install_mpm.step import StepResult, step

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


class Column:
    """A box of soil on rollers, without pile: x in (0, width), z in (-depth, 0)."""

    cell = reference_cell(CellType.TRI6)

    def __init__(self, mesh: BackgroundMesh, ground: Ground, tolerance: float = 1e-9) -> None:
        elements, self.interface = no_interface(2)
        pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 2)
        self.mesh, self.ground = mesh, ground
        self.model = Discretisation(
            self.cell,
            elements,
            dispatch.pack([ground.soil]),
            pattern,
            superlu(pattern),
            Numerics(tolerance=tolerance),
        )
        x, z = mesh.reference_nodes.T
        self.width, self.depth = x.max(), -z.min()
        self.supports = np.zeros(mesh.nodes.shape, dtype=bool)
        self.supports[:, 0] = (x < 1e-9) | (x > self.width - 1e-9)
        self.supports[:, 1] = z < 1e-9 - self.depth
        self.gradient = geostatic_gradient(ground, 1)
        self.motion = PileMotion(np.zeros(2))

    def points(self) -> MaterialPoints:
        """Twelve points in each cell."""
        return seed_points(self.mesh, self.cell, self.ground, 2)

    def scattered_points(self, rng: np.random.Generator) -> MaterialPoints:
        """The same, shaken within their cells; they get their geostatic state."""
        points = self.points()
        shift = rng.uniform(-0.03, 0.03, points.reference_coordinates.shape)
        coordinates = points.reference_coordinates + shift
        corners = self.mesh.nodes[self.mesh.cell_nodes[points.cell, :3]]
        shares = np.column_stack([1.0 - coordinates.sum(axis=1), coordinates])
        position = np.einsum("pv,pvi->pi", shares, corners)
        state = undisturbed_state(self.ground, position[:, 1], 1)
        return points._replace(
            position=position,
            reference_coordinates=coordinates,
            kirchhoff_stress=state.stress,
            elastic_log_strain=state.elastic_strain,
            state_variables=state.state_variables,
        )

    def step(
        self,
        points: MaterialPoints,
        mesh: BackgroundMesh,
        prescribed: Prescribed | None = None,
        move_mesh: Callable[[BackgroundMesh], BackgroundMesh] = lambda mesh: mesh,
        start: np.ndarray | None = None,
    ) -> StepResult:
        """One step under gravity and prescribed displacements."""
        at_rest = np.zeros_like(mesh.nodes)
        return step(
            points, mesh, self.interface, self.motion,
            prescribed or Prescribed(self.supports, at_rest), at_rest if start is None else start,
            lambda mesh, _: move_mesh(mesh), self.model, self.gradient,
        )  # fmt: skip

    def squeeze(self, mesh: BackgroundMesh, share: float):
        """Prescribed motion of the top by ``share`` of the height, and the mesh that follows it."""
        is_prescribed = self.supports.copy()
        on_top = np.abs(mesh.nodes[:, 1] - mesh.nodes[:, 1].max()) < 1e-9
        is_prescribed[on_top, 1] = True
        settlement = share * (mesh.nodes[:, 1] + self.depth)
        displacement = np.zeros_like(mesh.nodes)
        displacement[:, 1] = np.where(on_top, -settlement, 0.0)

        def follow(mesh: BackgroundMesh) -> BackgroundMesh:
            return mesh._replace(nodes=mesh.nodes - np.outer(settlement, [0.0, 1.0]))

        return Prescribed(is_prescribed, displacement), follow


@pytest.fixture(scope="session")
def make_column(make_grid) -> Callable[..., Column]:
    """Function that returns a column 1.5 m wide and 3 m high of a given ground."""

    def make(ground: Ground, **options: float) -> Column:
        return Column(make_grid(3, 6, width=1.5, depth=3.0, distortion=0.2), ground, **options)

    return make


TANGENT_ERROR = 1e-6
SMALLEST_DIFFERENCE = 1e-4
"""Smallest step of a difference over the first."""


@pytest.fixture
def tangent_errors(record_property) -> Callable[..., np.ndarray]:
    """Function that returns the relative error (n,) of the tangents at all states.

    By central differences.  A difference across a kink of the law is no derivative: where the error
    is too large, the step is made smaller, until the kink lies beyond it.  An error of the tangent
    itself stays at every step.  How many states needed that is recorded.
    """

    def errors_at(
        stress_at: Callable[[np.ndarray, np.ndarray], np.ndarray],
        trial: np.ndarray,
        tangent: np.ndarray,
        scale: np.ndarray | float,
        first_step: float,
    ) -> np.ndarray:
        """``stress_at`` returns the stress (m, 6) of trial strains (m, 6) of some rows (m,)."""
        errors, rows, step = np.full(len(trial), np.inf), np.arange(len(trial)), first_step
        scales = np.broadcast_to(scale, len(trial))
        while len(rows) and step >= SMALLEST_DIFFERENCE * first_step:
            worst = np.zeros(len(rows))
            for component, direction in enumerate(np.eye(6)):
                ends = [stress_at(trial[rows] + sign * step * direction, rows) for sign in (1, -1)]
                derivative = (ends[0] - ends[1]) / (2.0 * step)
                difference = np.abs(derivative - tangent[rows, :, component]).max(axis=1)
                worst = np.maximum(worst, difference)
            errors[rows] = np.minimum(errors[rows], worst / scales[rows])
            rows = np.flatnonzero(errors > TANGENT_ERROR)
            if step == first_step:
                record_property("states beside a kink", len(rows))
            step *= 0.1
        return errors

    return errors_at
