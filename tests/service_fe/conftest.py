"""Small structured meshes and problems that the tests of the service stage share."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem


def structured_mesh(x, z, tag_of):
    """Six-node triangles on the grid ``x`` by ``z``; ``tag_of(middle)`` names boundary edges."""
    n_x, n_z = len(x), len(z)
    nodes = np.array([(a, b) for b in z for a in x], dtype=float)
    triangles = []
    for j in range(n_z - 1):
        for i in range(n_x - 1):
            a, b, c, d = j * n_x + i, j * n_x + i + 1, (j + 1) * n_x + i + 1, (j + 1) * n_x + i
            triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return quadratic(nodes, np.array(triangles), tag_of)


def quadratic(vertices, triangles, tag_of):
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    unique, inverse, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    nodes = np.concatenate([vertices, vertices[unique].mean(axis=1)])
    middle = len(vertices) + inverse.reshape(3, -1).T
    cells = np.column_stack([triangles, middle])
    facets, tags = [], []
    for edge in np.flatnonzero(counts == 1):
        tag = tag_of(nodes[len(vertices) + edge])
        facets.append((*unique[edge], len(vertices) + edge))
        tags.append(tag)
    return FEMesh(
        np.ascontiguousarray(nodes),
        cells.astype(np.int64),
        np.array(facets, dtype=np.int64),
        np.array(tags, dtype=np.int64),
    )


def box_tags(width, depth):
    def tag_of(middle):
        x, z = middle
        if x < 1e-9:
            return FacetTag.SYMMETRY
        if x > width - 1e-9:
            return FacetTag.SIDE
        return FacetTag.BOTTOM if z < -depth + 1e-9 else FacetTag.SURFACE

    return tag_of


@pytest.fixture(scope="session")
def make_structured_mesh():
    return structured_mesh


@pytest.fixture(scope="session")
def box_mesh():
    """Ground of 2 m by 1.5 m, slightly graded."""
    x = np.array([0.0, 0.3, 0.7, 1.2, 2.0])
    z = np.array([-1.5, -0.9, -0.4, 0.0])
    return structured_mesh(x, z, box_tags(2.0, 1.5))


HALF_WIDTH, TIP = 0.5, 1.0


@pytest.fixture(scope="session")
def pile_mesh():
    """Half of a pile (0.5 m, tip at 1 m) in ground of 3 m by 3 m."""
    x = np.array([0.0, 0.25, 0.5, 0.8, 1.4, 3.0])
    z = np.array([-3.0, -1.9, -1.3, -1.0, -0.7, -0.35, 0.0])
    full = structured_mesh(x, z, lambda middle: 0)
    vertices = full.nodes[: len(x) * len(z)]
    triangles = full.cell_nodes[:, :3]
    middle = vertices[triangles].mean(axis=1)
    kept = triangles[~((middle[:, 0] < HALF_WIDTH) & (middle[:, 1] > -TIP))]
    used, triangles = np.unique(kept, return_inverse=True)
    outer = box_tags(3.0, 3.0)

    def tag_of(middle):
        if middle[0] < HALF_WIDTH + 1e-9 and middle[1] > -TIP - 1e-9:
            is_base = abs(middle[1] + TIP) < 1e-9
            return FacetTag.PILE_BASE if is_base else FacetTag.PILE_SHAFT
        return outer(middle)

    return quadratic(vertices[used], triangles.reshape(-1, 3), tag_of)


CLAY = VonMises(youngs_modulus=4e6, poissons_ratio=0.49, undrained_shear_strength=20e3)
CLAY_GROUND = Ground(unit_weight=18e3, k0=0.8, soil=CLAY)
ADHESIVE = CoulombInterface(normal_stiffness=2e8, shear_stiffness=2e7, adhesion_factor=0.5)
PILE_WEIGHT = 18e3 * HALF_WIDTH * TIP


@pytest.fixture(scope="session")
def make_pile_problem(pile_mesh):
    """Pile wished in place in clay, with numerics of one's own."""

    def make(numerics=None):
        return ServiceProblem(pile_mesh, CLAY_GROUND, ADHESIVE, PILE_WEIGHT, numerics)

    return make


@pytest.fixture(scope="session")
def pile_problem(make_pile_problem):
    """The same with default numerics; keeps no state, so all tests may share it."""
    return make_pile_problem()


@pytest.fixture(scope="session")
def undisturbed(pile_problem):
    return pile_problem.wished_in_place_state()
