"""PA3: the mesh follows a stretched block by the paper's eqs (1) and (2).

Claimed: nodes, area and force are exact, in tension and compression, with free sides that move.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.stretched_body import stretched_body


@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3}, {"u": 0.4, "L_m": 2.0, "width": 0.5}])
def test_stretched_body(parameters):
    outcome = stretched_body(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) > 1.8
