"""Drucker-Prager beside OpenSees, extra `opensees`: other soils than those of the problem.

OpenSees is not imported here: its libraries and those of PETSc do not bear each other.
"""

import numpy as np
import pytest

from workflows.verification.opensees_triaxial import PROBLEM, opensees_triaxial


@pytest.mark.skipif(not PROBLEM.is_available, reason="the extra 'opensees' is not installed")
@pytest.mark.parametrize(
    "inputs", [{}, {"c": 0.0}, {"E": 15e6, "nu": 0.2, "c": 1e3, "phi": np.radians(35.0)}]
)
def test_every_step_is_that_of_opensees(inputs):
    outcome = opensees_triaxial(**inputs)
    assert len(outcome.checks) == 9
    assert [check for check in outcome.checks if not check.is_met] == []
