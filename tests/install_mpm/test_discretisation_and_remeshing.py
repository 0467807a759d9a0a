"""The choices of the case: schemes and cells with one driver, and a mesh that is made anew."""

import numpy as np
import pytest

from install_mpm.background_mesh import cell_quality
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from install_mpm.installation import NotConvergedError, install
from install_mpm.interface import InterfacePoints, reaction
from install_mpm.options import (
    BackgroundMeshOptions,
    DiscretisationOptions,
    InstallationProgramme,
    Numerics,
)
from install_mpm.pile import surface_normals
from install_mpm.remeshing import carried_tractions

pytestmark = pytest.mark.gmsh

LAW = CoulombInterface(200e6, 20e6, adhesion_factor=0.5)
FIRM_CLAY = Ground(18e3, 1.0, VonMises(4e6, 0.3, 20e3))


@pytest.fixture(scope="module")
def run(pile, box):
    """Function that installs the pile; returns the final state and all states."""

    def install_pile(penetration, *, resume_from=None, kinematics=Kinematics.PLANE_STRAIN,
                     step=0.04, smallest_quality=0.0, **choices):  # fmt: skip
        states = []
        state = install(
            FIRM_CLAY, pile, LAW, box, BackgroundMeshOptions(0.25, 1.0, 0.0, 2, smallest_quality),
            InstallationProgramme(penetration, step), Numerics(), 'title = "short"\n',
            kinematics=kinematics, discretisation=DiscretisationOptions(**choices),
            resume_from=resume_from, observe=lambda state, progress: states.append(state),
        )  # fmt: skip
        return state, states

    return install_pile


@pytest.fixture(scope="module")
def default_force(run):
    return run(0.12)[0].history.crowd_force[-1]


@pytest.mark.parametrize(
    "choices",
    [
        {"cells": "tri3"},
        {"scheme": "quadrature"},
        {"scheme": "quadrature", "cells": "tri3"},
        {"scheme": "quadrature", "cells": "tri3", "cell_weighted": True},
    ],
    ids=["carriers tri3", "quadrature tri6", "quadrature tri3", "quadrature tri3 weighted"],
)
def test_every_scheme_installs_the_pile_with_about_the_same_force(run, default_force, choices):
    """Coarse meshes and other cells: within a third; the start is in equilibrium to round-off."""
    history = run(0.12, **choices)[0].history
    assert history.residual_history[0, 0] < 1e-10
    assert history.crowd_force[-1] == pytest.approx(default_force, rel=0.35)


def test_mesh_made_anew_keeps_the_force_and_says_what_changed(run):
    """The cells below the tip flatten by eqs (1)-(2); a new mesh at the pile's place is better."""
    old, stages = run(0.4, step=0.08)
    qualities = [cell_quality(state.background_mesh).min() for state in (stages[0], old)]
    assert qualities[1] < 0.95 * qualities[0]
    wanted = float(np.mean(qualities))
    new, states = run(0.4, step=0.08, smallest_quality=wanted)
    history = new.history
    rows = np.flatnonzero(np.isfinite(history.remesh_stress_change))
    assert len(rows) >= 1
    assert (np.diff(history.penetration)[rows - 1] == 0.0).all()
    assert (history.remesh_stress_change[rows] < 0.1).all()
    before = history.crowd_force[rows - 1]
    assert (np.abs(history.remesh_force_change[rows]) < 0.15 * np.abs(before)).all()
    assert history.smallest_cell_quality[rows[0]] > wanted
    assert history.crowd_force[-1] == pytest.approx(old.history.crowd_force[-1], rel=0.1)
    mass = [state.material_points.mass.sum() for state in states]
    np.testing.assert_allclose(mass, mass[0], rtol=1e-12)
    resumed, _ = run(0.4, step=0.08, smallest_quality=wanted, resume_from=states[rows[0]])
    for name in new.material_points._fields:
        a, b = getattr(new.material_points, name), getattr(resumed.material_points, name)
        np.testing.assert_array_equal(a, b, err_msg=name)


def interface_in_pieces(rng, n_points, **fields):
    """Base and shaft of one and four metres, each in ``n_points`` pieces of random length."""
    pieces = rng.dirichlet(np.full(n_points, 5.0), size=2) * [[1.0], [4.0]]
    place = np.cumsum(pieces, axis=1) - pieces / 2.0
    still = np.zeros(n_points)
    shuffled = rng.permutation(2 * n_points)
    part = np.repeat([0, 1], n_points)
    points = InterfacePoints(
        position=np.vstack([np.column_stack([place[0], still]),
                            np.column_stack([still, place[1]])]),
        normal=surface_normals(part),
        area=pieces.ravel(),
        traction=rng.normal(size=(2 * n_points, 2)),
        parameters=np.zeros((2 * n_points, 5)),
        part=part,
        covered=np.ones(2 * n_points),
    )  # fmt: skip
    return InterfacePoints(*(field[shuffled] for field in points))._replace(**fields)


def test_carried_tractions_keep_the_force_on_each_part():
    rng = np.random.default_rng(3)
    old, new = interface_in_pieces(rng, 30), interface_in_pieces(rng, 41)
    carried = carried_tractions(old, new)
    for part in (0, 1):
        before = reaction(old, old.part == part)
        np.testing.assert_allclose(reaction(carried, new.part == part), before, rtol=1e-11)


def test_uniform_tractions_are_carried_unchanged_and_uncovered_points_give_nothing():
    rng = np.random.default_rng(4)
    new = interface_in_pieces(rng, 25)
    old = interface_in_pieces(rng, 30, traction=np.full((60, 2), -7.0))
    np.testing.assert_allclose(carried_tractions(old, new).traction, -7.0, rtol=1e-12)
    bare = old._replace(covered=np.zeros(60))
    assert not carried_tractions(bare, new).traction.any()


def test_mesh_that_cannot_be_better_is_refused(run):
    with pytest.raises(NotConvergedError, match="smallest_quality"):
        run(0.08, smallest_quality=0.49 + 0.5)
