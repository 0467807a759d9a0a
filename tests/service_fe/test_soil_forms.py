import numpy as np
import pytest

from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.mandel import to_mandel
from service_fe.soil_forms import SoilForms

pytestmark = pytest.mark.dolfinx

GRADIENT = np.array([[0.3, -0.7], [0.2, 0.5]])


@pytest.fixture(scope="module")
def soil(box_mesh):
    return SoilForms(box_mesh)


def small_strain(gradient):
    strain = np.zeros((3, 3))
    strain[:2, :2] = 0.5 * (gradient + gradient.T)
    vector = np.empty(6)
    to_mandel(strain, vector)
    return vector


def test_ufl_mandel_vector_is_the_one_of_the_constitutive_laws(soil, box_mesh):
    strain = soil.strain(box_mesh.nodes @ GRADIENT.T)
    np.testing.assert_allclose(
        strain, np.tile(small_strain(GRADIENT), (len(strain), 1)), atol=1e-14
    )


def test_integration_points_are_in_the_order_of_the_mesh(soil, box_mesh):
    """The strain of u = (x^2, x z) at the points that are said to be the integration points."""
    x, z = box_mesh.nodes.T
    strain = soil.strain(np.column_stack([x**2, x * z]))
    x, z = soil.integration_positions.T
    np.testing.assert_allclose(strain[:, 0], 2.0 * x, atol=1e-13)
    np.testing.assert_allclose(strain[:, 1], x, atol=1e-13)
    np.testing.assert_allclose(strain[:, 3], np.sqrt(2.0) * 0.5 * z, atol=1e-13)
    cell = np.arange(len(x)) // 3
    centre = box_mesh.nodes[box_mesh.cell_nodes[:, :3]].mean(axis=1)
    own = np.linalg.norm(soil.integration_positions - centre[cell], axis=1)
    assert own.max() < 0.6


def test_order_of_the_mesh_does_not_matter(soil, box_mesh):
    rng = np.random.default_rng(1)
    cells, nodes = rng.permutation(len(box_mesh.cell_nodes)), rng.permutation(len(box_mesh.nodes))
    place = np.argsort(nodes)
    shuffled = FEMesh(
        box_mesh.nodes[nodes], place[box_mesh.cell_nodes[cells]], box_mesh.facet_nodes[:0],
        box_mesh.facet_tag[:0],
    )  # fmt: skip
    other = SoilForms(shuffled)
    stress = rng.normal(size=(len(cells), 3, 6))
    np.testing.assert_allclose(
        other.internal_force(stress[cells].reshape(-1, 6)),
        soil.internal_force(stress.reshape(-1, 6))[nodes],
        atol=1e-12,
    )


def test_integration_volumes_fill_the_box(soil):
    assert soil.integration_volumes.sum() == pytest.approx(2.0 * 1.5, rel=1e-14)


def test_weight_points_down_and_is_complete(soil):
    weight = soil.weight(np.full(len(soil.integration_volumes), 18e3))
    np.testing.assert_allclose(weight.sum(axis=0), [0.0, -18e3 * 3.0], atol=1e-8)


def test_internal_force_is_dual_to_strain(soil, box_mesh):
    rng = np.random.default_rng(2)
    displacement = rng.normal(size=box_mesh.nodes.shape)
    stress = rng.normal(size=(len(soil.integration_volumes), 6))
    work = soil.integration_volumes @ (stress * soil.strain(displacement)).sum(axis=1)
    assert (soil.internal_force(stress) * displacement).sum() == pytest.approx(work, rel=1e-12)


def test_curved_edge_is_refused(box_mesh):
    nodes = box_mesh.nodes.copy()
    nodes[box_mesh.cell_nodes[0, 3]] += 0.01
    with pytest.raises(ValueError, match="middle of a straight edge"):
        SoilForms(box_mesh._replace(nodes=nodes))


def test_loose_node_is_refused(box_mesh):
    with pytest.raises(ValueError, match="belong to no cell"):
        SoilForms(box_mesh._replace(nodes=np.vstack([box_mesh.nodes, [[9.0, 9.0]]])))
