"""What a pile feels along its axis, in the report: signs, direction, rigid and deformable."""

from types import SimpleNamespace

import numpy as np
import pytest

from service_fe.options import Lateral, Release
from service_fe.results import AlongPile
from workflows.screw_along import along_pile, in_direction, lateral_programmes

DIRECTION = np.radians(30.0)


def result(model, *, is_rigid=False, is_bonded=False):
    """Three steps at four levels; the soil resists a deflection in the direction of the load."""
    heights = np.linspace(-3.0, 0.0, 4)
    along = np.array([np.cos(DIRECTION), np.sin(DIRECTION)])
    deflection = np.linspace(0.0, 0.03, 3)[:, None, None] * (heights + 3.0)[:, None] * along
    moment = np.full((3, 4, 2), np.nan) if is_rigid else -1e5 * deflection
    reaction = np.full((3, 4, 2), np.nan) if is_bonded else 50.0 - 1e6 * deflection
    entry = SimpleNamespace(
        programme=Lateral("push", 0.09, 0.03, direction=DIRECTION),
        along=AlongPile(heights, reaction, deflection, moment[..., 0], moment, moment),
    )
    rest = SimpleNamespace(programme=Release(), along=entry.along)
    entries = {"push": entry}
    return SimpleNamespace(model=model, programmes=(rest, entry), programme=entries.__getitem__)


def test_changes_are_told_along_the_load():
    entry = result("installed").programme("push")
    np.testing.assert_allclose(in_direction(entry, "deflection")[-1], [0.0, 0.03, 0.06, 0.09])
    np.testing.assert_allclose(
        in_direction(entry, "reaction")[-1], [0.0, -3e4, -6e4, -9e4], atol=1e-9
    )


@pytest.mark.parametrize("is_rigid", [True, False])
def test_picture_has_profiles_of_both_models_and_py_curves(is_rigid):
    service, wished = (result(name, is_rigid=is_rigid) for name in ("installed", "wished_in_place"))
    assert lateral_programmes(service) == ["push"]
    figure = along_pile(service, wished, "push")
    profiles = figure.axes[:-1]
    assert len(profiles) == (2 if is_rigid else 4)  # a rigid pile has no section forces
    assert all(len(axes.lines) == 2 for axes in profiles)
    for line in figure.axes[-1].lines:
        y, p = line.get_data()
        np.testing.assert_allclose(p, y * 1.0, atol=1e-9)  # 1 kN/m per mm
        assert y[-1] > 0.0
    assert len(figure.axes[-1].lines) >= 6


def test_picture_of_a_bonded_pile_has_no_p():
    service, wished = (result(name, is_bonded=True) for name in ("installed", "wished_in_place"))
    labels = [axes.get_xlabel() for axes in along_pile(service, wished, "push").axes]
    assert labels == ["deflection (mm)", "shear force (kN)", "bending moment (kN m)"]
