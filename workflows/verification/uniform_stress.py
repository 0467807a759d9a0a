"""A body under a uniform stress that it carries from the start."""

from __future__ import annotations

import numpy as np

from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.geostatic import elastic_strain_of
from workflows.verification.body import Body


def with_stress(body: Body, soil: SoilParameters, stress: np.ndarray) -> Body:
    """Return the body of ``soil`` under the uniform ``stress`` (3, 3) in Pa."""
    stresses = np.repeat(np.asarray(stress, dtype=np.float64)[None], len(body.points.mass), axis=0)
    points = body.points._replace(
        kirchhoff_stress=stresses,
        elastic_log_strain=elastic_strain_of(soil, stresses, body.points.state_variables),
    )
    return body._replace(points=points)
