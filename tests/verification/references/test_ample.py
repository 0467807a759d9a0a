"""Figures of AMPLE: consistent with the exact column, with the elastica and with each other."""

import numpy as np
import pytest

from workflows.verification.references import ample
from workflows.verification.references.column import column
from workflows.verification.references.elastica import cantilever_tip


def exact(original_height):
    data = ample.COLUMN
    return column(
        original_height,
        length=data.height,
        youngs_modulus=data.youngs_modulus,
        poissons_ratio=data.poissons_ratio,
        density=data.density,
        gravity=data.gravity,
    )


@pytest.mark.parametrize(("cells", "error"), [(16, 0.31e-2), (32, 0.097e-2), (64, 0.042e-2)])
def test_column_displacement_has_the_published_error(cells, error):
    height = ample.COLUMN.height
    top_point = exact(height - height / cells / 4.0)
    excess = ample.COLUMN_GIMP[cells].top_displacement / top_point.displacement - 1.0
    assert excess == pytest.approx(error, abs=6e-5)


def test_column_converges_and_carries_its_weight():
    errors = [ample.COLUMN_GIMP[n].stress_error for n in (16, 32, 64)]
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(rates, [1.80, 1.27], atol=5.1e-3)
    data = ample.COLUMN
    weight = data.density * data.gravity * data.height * data.height / 16.0
    assert weight == pytest.approx(ample.COLUMN_BASE_REACTION)
    assert ample.COLUMN_STANDARD_MPM.stress_error / errors[0] == pytest.approx(24.0, abs=0.5)
    top_point = data.height - data.height / 64.0 + ample.COLUMN_GIMP[16].top_displacement
    assert top_point == pytest.approx(ample.COLUMN_TOP_POINT, abs=1e-7)


@pytest.mark.parametrize(
    "history", [ample.BEAM_9_POINTS, ample.BEAM_9_POINTS_GHOST, ample.BEAM_36_POINTS]
)
def test_beam_is_near_the_elastica(history):
    data = ample.BEAM
    for step, (u, v) in history.items():
        tip = cantilever_tip(
            load=data.load * step / data.steps,
            length=data.length,
            depth=data.depth,
            youngs_modulus=data.youngs_modulus,
            poissons_ratio=data.poissons_ratio,
        )
        assert -v == pytest.approx(tip.deflection, rel=0.04)
        assert -u == pytest.approx(tip.shortening, rel=0.08)


def test_collapse_strengths():
    assert ample.COLLAPSE.uniaxial_strength == pytest.approx(24.495e3, abs=0.5)
    assert ample.COLLAPSE.undrained_shear_strength == pytest.approx(14.142e3, abs=0.5)
    x, y = np.array(list(ample.COLLAPSE_EXTENT.values())).T
    assert np.all(np.diff(x) > 0.0)
    assert np.all(np.diff(y) < 0.0)
