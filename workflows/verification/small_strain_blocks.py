"""Quadrilateral blocks and interface elements in small strain, as input of the interface problems.

They go through the same kernels, assembly and Newton iteration as the installation stage; the four
integration points of a quadrilateral keep their own state, and nothing moves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import GRAVITY
from install_mpm.discretisation import Discretisation
from install_mpm.equilibrium import Prescribed, StepEquilibrium, find_equilibrium
from install_mpm.geostatic import elastic_strain_of
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.linear_solvers import mumps
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion

AT_REST = PileMotion(np.zeros(2))


class Blocks(NamedTuple):
    """Elastic blocks with an interface, and their state between steps."""

    mesh: BackgroundMesh
    model: Discretisation
    fill: CellFill
    points: IntegrationPoints
    interface: InterfacePoints


def make_blocks(
    nodes: np.ndarray,
    cell_nodes: np.ndarray,
    interface_nodes: np.ndarray,
    soil: HenckyElastic,
    interface_parameters: np.ndarray,
    *,
    unit_weight: float = 0.0,
    vertical_stress: float = 0.0,
    numerics: Numerics | None = None,
) -> Blocks:
    """Return unit-thickness blocks with one horizontal interface element.

    Parameters
    ----------
    nodes : (n_nodes, 2)
        Coordinates in m.
    cell_nodes : (n_cells, 4)
        Quadrilaterals, anticlockwise.
    interface_nodes : (1, 2) or (1, 4)
        Lower side, then upper side of the interface; two nodes where the other side is rigid.
    soil
        Elastic law of the blocks.
    interface_parameters : (7,)
        Packed parameters of ``coulomb_interface``.
    unit_weight, vertical_stress
        Weight in N/m^3 and uniform initial stress in Pa (tension positive), also on the interface.
    """
    cell = reference_cell(CellType.QUAD4)
    mesh = BackgroundMesh(nodes, nodes, cell_nodes, np.full((len(cell_nodes), 4), -1))
    pattern = sparsity_pattern([cell_nodes, interface_nodes], len(nodes), 2)
    elements = InterfaceElements(interface_nodes, np.zeros(1, dtype=np.int64), *facet_rule(2, 2))
    model = Discretisation(
        cell,
        elements,
        dispatch.pack([soil]),
        pattern,
        mumps(pattern),
        numerics or Numerics(tolerance=1e-12, volumetric_term=0.0, soft_stiffness=0.0),
        has_mean_dilatation=False,
        is_finite_strain=False,
    )
    points, fill = _filled_cells(mesh, model, soil, unit_weight, vertical_stress)
    interface = _interface(nodes[interface_nodes[0, :2]], interface_parameters, vertical_stress)
    return Blocks(mesh, model, fill, points, interface)


def _filled_cells(
    mesh: BackgroundMesh,
    model: Discretisation,
    soil: HenckyElastic,
    unit_weight: float,
    vertical_stress: float,
) -> tuple[IntegrationPoints, CellFill]:
    """Return the integration points of full cells under a uniform vertical stress."""
    geometry = cell_geometry(mesh, model.cell, model.kinematics)
    n_cells, n_per_cell = geometry.integration_height.shape
    n_points = n_cells * n_per_cell
    stress = np.zeros((n_points, 3, 3))
    stress[:, 1, 1] = vertical_stress
    no_state = np.zeros((n_points, 0))
    points = IntegrationPoints(
        cell_start=np.arange(n_cells + 1) * n_per_cell,
        reference_coordinates=np.tile(model.cell.integration_coordinates, (n_cells, 1)),
        shape_values=geometry.shape_values.reshape(n_points, 4),
        shape_gradients=geometry.shape_gradients.reshape(n_points, 4, 2),
        hoop_gradients=geometry.hoop_gradients.reshape(n_points, 4),
        volume=geometry.integration_volume.ravel(),
        density=np.full(n_points, unit_weight / GRAVITY),
        volume_ratio=np.ones(n_points),
        elastic_log_strain=elastic_strain_of(soil, stress, no_state),
        state_variables=no_state,
        material=np.zeros(n_points, dtype=np.int64),
    )
    everywhere = np.ones(n_cells, dtype=bool)
    no_points = np.zeros(0, dtype=np.int64)
    fill = CellFill(
        no_points,
        np.zeros(n_cells + 1, dtype=np.int64),
        np.ones(n_cells),
        np.ones(len(mesh.nodes)),
        everywhere,
        everywhere,
        geometry.volume,
    )
    return points, fill


def _interface(ends: np.ndarray, parameters: np.ndarray, vertical_stress: float) -> InterfacePoints:
    """Return the two Gauss points of a horizontal element between ``ends`` (2, 2).

    The pile side above.
    """
    shape_values, weights = facet_rule(2, 2)
    return InterfacePoints(
        position=shape_values @ ends,
        normal=np.tile([0.0, 1.0], (2, 1)),
        area=weights * np.linalg.norm(ends[1] - ends[0]),
        traction=np.tile([0.0, vertical_stress], (2, 1)),
        parameters=np.tile(parameters, (2, 1)),
        part=np.zeros(2, dtype=np.int64),
        covered=np.ones(2),
    )


def load(
    blocks: Blocks, is_prescribed: np.ndarray, displacement: np.ndarray
) -> tuple[Blocks, StepEquilibrium]:
    """Return the blocks after a step with prescribed nodal displacements (n_nodes, 2) in m.

    And its equilibrium.

    Raises
    ------
    RuntimeError
        If the step does not converge.
    """
    equilibrium = find_equilibrium(
        blocks.mesh,
        blocks.points,
        blocks.fill,
        blocks.interface,
        AT_REST,
        Prescribed(is_prescribed, displacement),
        np.zeros_like(displacement),
        blocks.model,
    )
    if not equilibrium.newton.is_converged:
        raise RuntimeError(f"blocks: residuals {equilibrium.newton.residuals} do not converge")
    points = blocks.points._replace(
        elastic_log_strain=equilibrium.trial.elastic_log_strain.copy(),
    )
    interface = blocks.interface._replace(traction=equilibrium.traction.copy())
    return blocks._replace(points=points, interface=interface), equilibrium
