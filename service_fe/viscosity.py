"""Viscosity of the soil: a stress in proportion to the strain of a step, and what it takes.

It is part of the balance of a step and not of the state after it.  ``settling`` lets it decay until
nothing is left; ``ServiceNumerics.viscosity`` keeps it in every step.
"""

from __future__ import annotations

import numpy as np

from handoff.fe_state_file import FEState
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.dispatch import Materials
from install_mpm.constitutive.models import Model
from service_fe.axisymmetric_forms import AxisymmetricForms
from service_fe.material_map import soil_response
from service_fe.soil_forms import SoilForms


def viscous_tangent(materials: Materials, state: FEState) -> np.ndarray:
    """Return the elastic tangent (n_q, 6, 6) in Pa of soil that can fail: its viscosity's measure.

    It is that of half the elastic strain of ``state``, well inside the yield surface.  Openings
    count as closed: soil that has opened has no stiffness of its own, and needs viscosity most.
    A purely elastic material, such as a pile's, has none.
    """
    variables = state.state_variables.copy()
    columns = dispatch.state_columns(materials, "opening")[state.material]
    opens = np.flatnonzero(columns >= 0)
    variables[opens, columns[opens]] = 0.0
    half = state._replace(elastic_strain=0.5 * state.elastic_strain, state_variables=variables)
    tangent = soil_response(materials, half, np.zeros((len(state.material), 6))).tangent
    tangent[materials.model[state.material] == Model.HENCKY_ELASTIC] = 0.0
    return tangent


def viscous_stress(viscosity: np.ndarray, strain: np.ndarray) -> np.ndarray:
    """Return the stress (n_q, 6) in Pa of ``strain`` (n_q, 6) with ``viscosity`` (n_q, 6, 6)."""
    stress: np.ndarray = np.einsum("qij,qj->qi", viscosity, strain)
    return stress


def viscous_work(
    soil: SoilForms | AxisymmetricForms, viscosity: np.ndarray, displacement: np.ndarray
) -> float:
    """Return the work in J of the viscous stress on the way ``displacement`` (node, dim) in m."""
    strain = soil.strain(displacement)
    density = np.einsum("qi,qi->q", viscous_stress(viscosity, strain), strain)
    own = soil.integration_volumes[soil.partition.own_points] @ density
    return float(soil.partition.sum_of(np.array(own)))
