"""PA10: rigid ellipse turned in a disc; published stiffness, circle, infinite medium."""

import pytest

from workflows.verification.references.annulus_torsion import small_strain_torque
from workflows.verification.references.ellipse_rotation import (
    ellipse_rotation,
    infinite_medium_stiffness,
)

ELLIPSE = {"semi_major": 2.0, "semi_minor": 1.0, "youngs_modulus": 10.0}


@pytest.mark.parametrize(
    ("nu", "in_disc", "in_infinite_medium"),
    [(0.0, 164.62845, 146.60766), (0.3, 131.33641, 115.46024)],
)
def test_published_digits(nu, in_disc, in_infinite_medium):
    result = ellipse_rotation(**ELLIPSE, outer_radius=5.0, poissons_ratio=nu)
    assert result.stiffness == pytest.approx(in_disc, abs=5e-6)
    assert result.residual < 1e-13
    unbounded = infinite_medium_stiffness(**ELLIPSE, poissons_ratio=nu)
    assert unbounded == pytest.approx(in_infinite_medium, abs=5e-6)


def test_circle_is_the_annulus():
    material = {"youngs_modulus": 10.0, "poissons_ratio": 0.3}
    result = ellipse_rotation(semi_major=1.0, semi_minor=1.0, outer_radius=4.0, **material)
    annulus = small_strain_torque(1.0, inner_radius=1.0, outer_radius=4.0, **material)
    assert result.stiffness == pytest.approx(annulus, rel=1e-12)


def test_ellipse_outside_the_disc_is_refused():
    with pytest.raises(ValueError, match="does not lie in the circle"):
        ellipse_rotation(**ELLIPSE, outer_radius=1.9, poissons_ratio=0.3)


def test_large_disc_is_the_infinite_medium():
    # 1/T tends to its limit with 1/R^2
    limit = 1.0 / infinite_medium_stiffness(**ELLIPSE, poissons_ratio=0.3)
    gaps = [
        limit - 1.0 / ellipse_rotation(**ELLIPSE, outer_radius=r, poissons_ratio=0.3).stiffness
        for r in (100.0, 200.0)
    ]
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=1e-3)
    assert gaps[1] < 1e-4 * limit
