"""The whole hand-over, on a finite-element problem that knows its solution."""

import json

import numpy as np
import pytest

from handoff.equilibration import EquilibrationError, ReleasedState
from handoff.geostatic import geostatic_state
from handoff.hand_over import hand_over
from handoff.quality import Certificate, Figure, failed_checks
from handoff.synthetic import airy_stress

pytestmark = pytest.mark.gmsh


class KnownSolution:
    """Ground whose only balanced state is the geostatic one; a release goes straight towards it."""

    def __init__(self, mesh, site, build):
        self.mesh, self.ground = mesh, site.ground
        self.integration_positions, self.integration_volumes = build.integration_points(mesh)
        self.own_points = np.arange(len(self.integration_volumes))
        surface = build.pile_surface(mesh)
        self.interface_positions, self.interface_areas = surface.positions, surface.areas
        self.interface_normals, self.interface_parts = surface.normals, surface.parts
        self.interface_facet_normals = surface.normals
        self.interface_strength_share = np.ones(len(surface.areas))

    def whole(self, values):
        return values

    def geostatic(self):
        return geostatic_state(
            self.ground,
            self.integration_positions,
            self.interface_positions,
            self.interface_normals,
        )

    def out_of_balance(self, state):
        target = self.geostatic()
        change = [np.abs(a - b).max() for a, b in zip(state, target, strict=True)]
        return max(change[0], change[4]) / np.abs(target.cauchy_stress).max()

    def release(self, state, share, on_pile=None):
        assert on_pile is None, "the rig still holds a wall"
        target = self.geostatic()
        new = state._replace(
            cauchy_stress=(1.0 - share) * state.cauchy_stress + share * target.cauchy_stress,
            interface_traction=(1.0 - share) * state.interface_traction
            + share * target.interface_traction,
        )
        return ReleasedState(new, np.full((len(self.mesh.nodes), 2), 1e-4), np.zeros((1, 2)), 2)


@pytest.fixture
def run(site, build):
    """Return the function that hands over an installed state, and the phases that were observed."""
    phases: list[str] = []

    def run(installed, options=None):
        return hand_over(
            installed,
            site.ground,
            site.placed,
            site.box,
            site.interface,
            options or site.options,
            lambda mesh: KnownSolution(mesh, site, build),
            phases.append,
        )

    run.phases = phases
    return run


def stressed(undisturbed, site, factor):
    """Return the installed state with a steep balanced field on top of the geostatic stress."""
    points = undisturbed.material_points
    extra = factor * airy_stress(site.ground, site.pile, 2.0, points.position)
    return undisturbed._replace(
        material_points=points._replace(kirchhoff_stress=points.kirchhoff_stress + extra)
    )


def test_pile_that_was_not_moved_gives_the_geostatic_state_unmoved(run, undisturbed, site, build):
    handed_off, certificate = run(undisturbed)
    problem = KnownSolution(handed_off.mesh, site, build)
    for name, expected in problem.geostatic()._asdict().items():
        scale = max(np.abs(expected).max(), 1e-30)
        assert np.abs(getattr(handed_off.state, name) - expected).max() <= 1e-9 * scale, name
    assert certificate.figures["equilibration_displacement"].value == 0.0
    assert certificate.figures["yield_correction_share"].value == 0.0
    assert failed_checks(certificate) == []
    assert handed_off.pile.head_load == pytest.approx(0.0, abs=1e-6)
    assert handed_off.case_text == undisturbed.case_text


def test_phases_are_told_in_order(run, undisturbed):
    run(undisturbed)
    assert run.phases == ["mesh", "transfer", "admissibility", "equilibration", "certificate"]


def test_certificate_is_plain_data_in_the_state(run, undisturbed):
    handed_off, certificate = run(undisturbed)
    plain = json.loads(handed_off.certificate)
    assert set(plain) == set(certificate.figures)
    assert plain["synthetic_error"]["limit"] == 0.05
    assert plain["synthetic_error"]["is_met"] is True
    assert plain["volume_fe"]["value"] == pytest.approx(19.0)


def test_what_the_equilibration_takes_away_is_told(run, undisturbed, site):
    _, certificate = run(stressed(undisturbed, site, 0.7))
    value = {name: figure.value for name, figure in certificate.figures.items()}
    assert value["out_of_balance_before"] > 0.05
    assert value["out_of_balance_after"] <= 1e-8
    assert value["out_of_balance_geostatic"] == 0.0
    assert 0.02 < value["equilibration_stress_change"] < 0.5
    assert value["equilibration_displacement"] == pytest.approx(5 * 1e-4 * np.sqrt(2.0))
    assert 0.0 < value["yield_correction_share"] < 0.2
    assert 0.0 < value["yield_correction_mean"] <= value["yield_correction_max"] < 1.0
    assert value["nearest_difference"] > 0.005


def test_stress_that_is_balanced_but_wrong_fails_the_reaction_check(run, undisturbed):
    points = undisturbed.interface
    pushed = points._replace(traction=points.traction * [1.0, 2.0])
    pile = undisturbed.pile._replace(reaction=2.0 * undisturbed.pile.reaction)
    _, certificate = run(undisturbed._replace(interface=pushed, pile=pile))
    assert [sentence.split()[0] for sentence in failed_checks(certificate)] == [
        "pile_reaction_change"
    ]
    assert certificate.figures["pile_reaction_change"].value == pytest.approx(0.5)


def test_hole_in_the_cloud_is_bridged_by_the_geostatic_state_and_flagged(run, undisturbed):
    points = undisturbed.material_points
    kept = np.linalg.norm(points.position - (2.0, -1.0), axis=1) > 0.4
    holed = type(points)(*(field[kept] for field in points))
    wrong = holed._replace(kirchhoff_stress=2.0 * holed.kirchhoff_stress)
    options_before = run(undisturbed._replace(material_points=holed))[1].figures
    assert options_before["fallback_targets"].value > 5
    assert not options_before["fallback_share"].is_met
    assert options_before["nearest_distance_max"].value > 3.0
    assert run(undisturbed._replace(material_points=wrong))[1].figures[
        "out_of_balance_before"
    ].value == pytest.approx(1.0, rel=0.2)


def test_figure_without_limit_never_fails_and_no_number_does():
    certificate = Certificate(
        {
            "free": Figure(1e9, "N", "for information"),
            "kept": Figure(0.1, "", "small", 0.2),
            "lost": Figure(float("nan"), "m", "no number", 0.2),
        }
    )
    assert failed_checks(certificate) == ["lost is nan m, more than 0.2: no number"]


def test_failed_equilibration_is_told(run, undisturbed, site, monkeypatch):
    def fail(*_):
        raise EquilibrationError("Newton's method did not converge")

    monkeypatch.setattr(KnownSolution, "release", fail)
    with pytest.raises(EquilibrationError, match="cannot be equilibrated"):
        run(stressed(undisturbed, site, 0.7))
