"""Mohr-Coulomb and Drucker-Prager: edges and apex, dilation that fades, openings that close."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import dispatch, frictional, mohr_coulomb
from install_mpm.constitutive.element_driver import Loading, drive, element
from install_mpm.constitutive.parameters import DruckerPrager, MohrCoulomb

PHI, PSI = np.radians(35.0), np.radians(12.0)
VARIANTS = {
    "no dilation": {},
    "dilation": {"dilation_angle": PSI},
    "associated": {"dilation_angle": PHI},
    "no cohesion": {"dilation_angle": PSI, "cohesion": 0.0},
    "fading": {"dilation_angle": PSI, "critical_void_ratio": 0.9},
    "loose": {"dilation_angle": PSI, "critical_void_ratio": 0.5},
}
LAWS = {"mohr_coulomb": MohrCoulomb, "drucker_prager": DruckerPrager}
CONES = ("compression", "extension", "plane_strain", "inner")
every_law = pytest.mark.parametrize("law", LAWS)
every_variant = pytest.mark.parametrize("variant", VARIANTS)
N_STATES = 10_000
STRAIN = 0.05
"""Size of the trial strains; the soil yields at about a tenth of it."""
ZERO = np.zeros((3, 3))


def make(law, variant="dilation", **changes):
    options = {"youngs_modulus": 4e6, "poissons_ratio": 0.3, "cohesion": 10e3,
               "friction_angle": PHI}  # fmt: skip
    return LAWS[law](**{**options, **VARIANTS[variant], **changes})


def evaluate(soil, trial, state=None):
    trial = np.ascontiguousarray(trial)
    n = len(trial)
    if state is None:
        state = dispatch.initial_state(soil, np.zeros(n), np.zeros((n, 3, 3)))
    shapes = {"stress": (6,), "elastic_strain": (6,), "state": (3,), "tangent": (6, 6)}
    arrays = {name: np.empty((n, *shape)) for name, shape in shapes.items()}
    status = np.full(n, -1)
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(n, dtype=np.int64), trial, state, *arrays.values(), status
    )
    assert (status == 0).all()
    return SimpleNamespace(**arrays)


def yield_values(soil, stress, state):
    value = np.empty(len(stress))
    material = np.zeros(len(stress), dtype=np.int64)
    dispatch.yield_function_all(dispatch.pack([soil]), material, stress, state, value)
    return value


def six_vectors(principal, rng):
    """Mandel six-vectors with these principal values (n, 3) and random axes."""
    axes = np.linalg.qr(rng.normal(size=(len(principal), 3, 3)))[0]
    tensors = np.einsum("nia,na,nja->nij", axes, principal, axes)
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    return tensors[:, rows, columns] * [1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3]


@pytest.fixture
def trial_strains(rng):
    """Trial strains (n, 6) that return to everywhere: some have two or three equal values."""
    lode = rng.uniform(0.0, np.pi / 3.0, N_STATES)
    lode[::5], lode[1::5] = 0.0, np.pi / 3.0
    size = STRAIN * rng.uniform(0.01, 1.0, N_STATES)
    size[2::50] = 0.0
    mean = STRAIN * rng.uniform(-1.0, 0.5, N_STATES)
    angles = lode[:, None] + 2.0 * np.pi / 3.0 * np.array([0.0, -1.0, 1.0])
    return six_vectors(mean[:, None] + size[:, None] * np.cos(angles), rng)


def where_returned(soil, result, trial):
    """Number of equal principal stresses, 0 where the point is elastic."""
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    tensors = np.empty((len(trial), 3, 3))
    scaled = result.stress / [1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3]
    tensors[:, rows, columns] = tensors[:, columns, rows] = scaled
    values = np.linalg.eigvalsh(tensors)
    equal = 1 + (np.diff(values, axis=1) < 1e-7 * np.abs(values).max()).sum(axis=1)
    return np.where(np.abs(trial - result.elastic_strain).max(axis=1) < 1e-12, 0, equal)


@every_law
@every_variant
def test_consistent_tangent_is_the_derivative_of_the_stress(
    law, variant, trial_strains, tangent_errors
):
    soil = make(law, variant)
    result = evaluate(soil, trial_strains)
    errors = tangent_errors(
        lambda trial, rows: evaluate(soil, trial).stress,
        trial_strains, result.tangent, soil.youngs_modulus, 1e-6 * STRAIN,
    )  # fmt: skip
    assert errors.max() < 1e-6
    if law == "mohr_coulomb":
        regions = np.bincount(where_returned(soil, result, trial_strains), minlength=4)
        assert (regions > 200).all()  # elastic, planes, edges, apex


@every_law
def test_tangent_at_the_apex_regularises_and_no_more(law, trial_strains):
    """There it is a trillionth of the elastic one: soil beside it may have a millionth."""
    soil = make(law)
    result = evaluate(soil, trial_strains)
    sizes = np.linalg.norm(result.tangent, axis=(1, 2))
    is_apex = where_returned(soil, result, trial_strains) == 3
    assert is_apex.sum() > 200
    ratios = sizes[is_apex] / sizes.max()
    assert ratios.min() > 0.0
    assert ratios.max() < 1e-11


@every_law
@every_variant
def test_stress_ends_on_the_yield_surface(law, variant, trial_strains):
    soil = make(law, variant)
    result = evaluate(soil, trial_strains)
    value = yield_values(soil, result.stress, result.state)
    scale = np.abs(result.stress).max()
    assert value.max() <= 1e-11 * scale
    is_plastic = where_returned(soil, result, trial_strains) > 0
    assert np.abs(value[is_plastic]).max() <= 1e-11 * scale


@every_law
def test_associated_return_is_the_closest_point(law, trial_strains):
    """No admissible stress is nearer to the trial stress in the norm of elastic energy."""
    soil = make(law, "associated")
    result = evaluate(soil, trial_strains)
    plastic = trial_strains - result.elastic_strain
    for shift in (1, 7, 1234):
        other = np.roll(result.stress, shift, axis=0)
        work = (plastic * (result.stress - other)).sum(axis=1)
        assert work.min() > -1e-9 * STRAIN * np.abs(result.stress).max()


@every_law
@every_variant
def test_closed_cycles_dissipate(law, variant, rng):
    soil = make(law, variant)
    n, parts = 500, 20
    corners = [six_vectors(STRAIN * rng.uniform(-1.0, 0.3, (n, 3)), rng) for _ in range(4)]
    start = np.zeros((n, 6))
    strain, state, stress = start, None, evaluate(soil, start).stress
    work, round_off = np.zeros(n), 1e-12 * soil.youngs_modulus * STRAIN**2
    for begin, end in zip([start, *corners], [*corners, start], strict=True):
        for _ in range(parts):
            trial = strain + (end - begin) / parts
            result = evaluate(soil, trial, state)
            plastic_work = (result.stress * (trial - result.elastic_strain)).sum(axis=1)
            if soil.critical_void_ratio is None:  # else the work of an opening comes back
                assert plastic_work.min() >= -round_off
            work += (0.5 * (stress + result.stress) * (end - begin) / parts).sum(axis=1)
            strain, state, stress = result.elastic_strain, result.state, result.stress
    assert work.min() >= -round_off * parts
    assert work.max() > 1e3 * round_off


@every_law
def test_plastic_flow_has_the_dilation_angle(law):
    """Triaxial compression: volume grows by N_psi - 1 of the axial shortening, N of the angle."""
    soil = make(law, cohesion=0.0)
    path = sheared(soil, 0.2)
    volume = [np.trace(state.gradient) - 3.0 for state in path[-2:]]
    axial = [state.gradient[1, 1] for state in path[-2:]]
    flow = (1.0 + np.sin(PSI)) / (1.0 - np.sin(PSI)) - 1.0
    assert np.diff(volume)[0] / -np.diff(axial)[0] == pytest.approx(flow, rel=1e-8)


def sheared(soil, shortening, steps=30):
    """Drained triaxial compression at 100 kPa."""
    lateral, start = np.diag([True, False, True]), -100e3 * np.eye(3)
    loading = Loading(lateral, np.diag([0.0, -shortening, 0.0]), start, steps)
    return drive(soil, element(soil, start), [loading])


def void_ratio(state):
    """Total void ratio of an element: the state and the elastic strain make the volume."""
    volume = state.state_variables[frictional.LOG_VOLUME] + np.trace(state.elastic_strain)
    return np.expm1(volume)


@every_law
def test_void_ratio_is_that_of_the_volume(law):
    soil = make(law, "fading")
    for state in sheared(soil, 0.3)[::10]:
        volume = (1.0 + soil.initial_void_ratio) * np.exp(np.trace(state.gradient) - 3.0)
        assert 1.0 + void_ratio(state) == pytest.approx(volume, rel=1e-8)


@every_law
def test_dilation_ends_at_the_critical_void_ratio(law):
    """e_c - e decays exponentially with shear: without an end the soil would pass e_c by far."""
    soil = make(law, "fading")
    ratios = np.array([void_ratio(state) for state in sheared(soil, 3.0, steps=100)])
    assert np.all(np.diff(ratios[5:]) > -1e-12)
    assert 0.89 < ratios[-1] < 0.9
    endless = void_ratio(sheared(replace(soil, critical_void_ratio=None), 3.0)[-1])
    assert endless > 2.0
    loose = make(law, "loose")
    assert void_ratio(sheared(loose, 1.0)[-1]) < loose.initial_void_ratio


@every_law
def test_opening_closes_before_pressure_builds_up(law):
    """Pulled and pressed in turn, soil with a critical void ratio does not grow."""
    soil = make(law, "fading")
    apex = soil.cohesion / np.tan(soil.friction_angle)
    driven, start = np.zeros((3, 3), dtype=bool), element(soil, ZERO)
    stretches = (0.3, 0.05, 0.3, 0.0, -0.01)
    path = drive(soil, start, [Loading(driven, s * np.eye(3), ZERO, 4) for s in stretches])
    ends = path[4::4]
    for stretch, state in zip(stretches[:3], ends[:3], strict=True):
        np.testing.assert_allclose(np.diag(state.stress), apex, rtol=1e-9)
        opening = state.state_variables[frictional.OPENING]
        assert opening == pytest.approx(3.0 * stretch - np.trace(state.elastic_strain), rel=1e-9)
    bulk = soil.youngs_modulus / (3.0 * (1.0 - 2.0 * soil.poissons_ratio))
    assert ends[4].stress[0, 0] == pytest.approx(-0.03 * bulk, rel=1e-9)
    assert ends[4].state_variables[frictional.OPENING] == 0.0
    hard = drive(make(law), start, [Loading(driven, s * np.eye(3), ZERO, 4) for s in stretches])
    assert hard[20].stress[0, 0] < -0.8 * bulk  # without, pressing meets the soil at once


def principal_strengths(soil, kind, pressure):
    """Deviator at failure in Pa of triaxial compression or extension at a mean pressure."""
    sine, cosine = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
    sign = -1.0 if kind == "compression" else 1.0
    return 6.0 * (soil.cohesion * cosine + pressure * sine) / (3.0 + sign * sine)


@pytest.mark.parametrize("kind", ["compression", "extension"])
def test_triaxial_cones_match_the_pyramid(kind):
    soil, pressure = make("drucker_prager", cone=kind), 80e3
    q = principal_strengths(soil, kind, pressure)
    axial = -1.0 if kind == "compression" else 1.0
    principal = -pressure + q * axial * np.array([[-1.0, 2.0, -1.0]]) / 3.0
    stress = np.hstack([principal, np.zeros((1, 3))])
    for law in (soil, make("mohr_coulomb")):
        assert abs(yield_values(law, stress, np.zeros((1, 3)))[0]) < 1e-10 * q


@pytest.mark.parametrize("variant", ["no dilation", "dilation", "associated"])
def test_plane_strain_cone_matches_the_pyramid_at_collapse(variant):
    """A biaxial test ends at the strength of Mohr-Coulomb, and dilates by sin(psi)."""
    soil = make("drucker_prager", variant, cone="plane_strain")
    start = -100e3 * np.eye(3)
    loading = Loading(np.diag([True, False, False]), np.diag([0.0, -3.0, 0.0]), start, 60)
    path = drive(soil, element(soil, start), [loading])
    major, minor = -path[-1].stress[1, 1], -path[-1].stress[0, 0]
    sine, cosine = np.sin(PHI), np.cos(PHI)
    assert major - minor == pytest.approx(
        (major + minor) * sine + 2.0 * soil.cohesion * cosine, rel=1e-6
    )
    change = path[-1].gradient - path[-2].gradient
    dilation = (change[0, 0] + change[1, 1]) / (change[0, 0] - change[1, 1])
    assert dilation == pytest.approx(np.sin(soil.dilation_angle), abs=1e-6)


def test_inner_cone_is_inside_the_pyramid_and_touches_it(trial_strains):
    pyramid, cone = make("mohr_coulomb"), make("drucker_prager", cone="inner")
    result = evaluate(cone, trial_strains)
    value = yield_values(pyramid, result.stress, result.state)
    assert value.max() < 1e-9 * np.abs(result.stress).max()
    is_sheared = np.abs(trial_strains).max(axis=1) > 0.02
    assert value[is_sheared].max() > -2e-2 * pyramid.cohesion


def test_mohr_coulomb_is_elastic_inside_the_pyramid_and_outside_the_cone(trial_strains):
    """The test that needs no principal axes must not cut anything off."""
    pyramid = make("mohr_coulomb")
    stiff = evaluate(make("mohr_coulomb", cohesion=1e9), trial_strains)
    is_elastic = yield_values(pyramid, stiff.stress, stiff.state) <= 0.0
    result = evaluate(pyramid, trial_strains)
    np.testing.assert_allclose(result.stress[is_elastic], stiff.stress[is_elastic], rtol=1e-12)
    in_cone = yield_values(make("drucker_prager", cone="inner"), stiff.stress, stiff.state) <= 0.0
    assert (is_elastic & ~in_cone).sum() > 50
    assert not (in_cone & ~is_elastic).any()


def test_flow_that_would_make_energy_is_refused():
    with pytest.raises(ValueError, match=r"dilation_angle 0\.7 rad is larger"):
        make("mohr_coulomb", dilation_angle=0.7)


@every_law
def test_strain_that_is_not_finite_is_told(law):
    soil, shapes = make(law), ((1, 6), (1, 6), (1, 3), (1, 6, 6))
    arrays, status = [np.empty(shape) for shape in shapes], np.zeros(1, dtype=np.int64)
    material, trial = np.zeros(1, dtype=np.int64), np.full((1, 6), np.nan)
    state = dispatch.initial_state(soil, np.zeros(1), np.zeros((1, 3, 3)))
    dispatch.update_all(dispatch.pack([soil]), material, trial, state, *arrays, status)
    assert status[0] == mohr_coulomb.NOT_FINITE
