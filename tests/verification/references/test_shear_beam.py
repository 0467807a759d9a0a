"""PA2: the geometrically exact beam against the elastica, linear beams and its own section.

Claimed: a slender beam is the elastica; a short one under a small load has the deflection of
Timoshenko's; a stretched section is Hencky's bar; stiffness falls as a section is bent.
"""

import numpy as np
import pytest

from workflows.verification.references.elastica import cantilever_tip
from workflows.verification.references.shear_beam import Section, cantilever_tips, strains


def test_a_slender_beam_is_the_elastica():
    section = Section(0.01, 12e6, 0.2)
    loads = np.array([0.02, 0.1])
    for load, (u, w) in zip(loads, cantilever_tips(section, 10.0, loads), strict=True):
        exact = cantilever_tip(
            load=load, length=10.0, depth=0.01, youngs_modulus=12e6, poissons_ratio=0.2
        )
        assert u == pytest.approx(exact.shortening, rel=1e-5)
        assert w == pytest.approx(exact.deflection, rel=1e-5)


def test_a_small_load_bends_and_shears_linearly():
    section, length, load = Section(1.0, 10e6, 0.3), 3.0, 1.0
    bending = load * length**3 / (3.0 * section.modulus / 12.0)
    shear = load * length / (5.0 / 6.0 * 10e6 / 2.6)
    _, w = cantilever_tips(section, length, np.array([load]))[0]
    assert w == pytest.approx(bending + shear, rel=1e-5)


def test_a_stretched_section_is_a_hencky_bar():
    stretch, curvature = strains(Section(0.5, 10e6, 0.3), np.array([0.3e6]), np.array([0.0]))
    modulus = 10e6 / (1.0 - 0.09)
    assert 0.5 * modulus * np.log(stretch[0]) / stretch[0] == pytest.approx(0.3e6, rel=1e-10)
    assert curvature[0] == pytest.approx(0.0, abs=1e-10)


def test_the_curvature_grows_faster_than_the_moment():
    stiffness = 10e6 / (1.0 - 0.09) / 12.0
    moment = np.array([1e-4, 0.1, 0.2]) * stiffness
    _, curvature = strains(Section(1.0, 10e6, 0.3), np.zeros(3), moment)
    assert curvature[0] == pytest.approx(1e-4, rel=1e-6)
    assert (np.diff(curvature * stiffness / moment) > 0.0).all()


def test_a_section_that_is_too_weak_is_refused():
    with pytest.raises(ValueError, match="cannot carry the load"):
        cantilever_tips(Section(0.5, 10e3, 0.3), 10.0, np.array([1e5]))
