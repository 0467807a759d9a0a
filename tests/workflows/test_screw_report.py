"""Report, views and pictures of a screw pile: complete, self-contained, not blank, and right."""

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import meshio
import numpy as np
import pytest
from PIL import Image

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.ground import Ground
from install_mpm.history import append
from install_mpm.installation import InstallationProgress
from install_mpm.options import Box, ScrewMeshOptions, ScrewNumerics
from install_mpm.screw_history import driven
from install_mpm.screw_pile import Helix, ScrewPile, part_names
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Phase, Pose, ScrewProgramme, phase_motion, rim_travel
from install_mpm.screw_setup import geostatic_state, move_mesh, set_up
from install_mpm.screw_surface import follow, pile_elements
from install_mpm.state_file import PileState, write_installed_state
from workflows import cli
from workflows.case import CaseError, case_text
from workflows.directory import INSTALLED, REPORT, TIMING
from workflows.screw_animation import MOST_BYTES
from workflows.screw_case import ScrewCase
from workflows.screw_export import (
    SERIES,
    export_screw_pile,
    frame_interval,
    frame_writer,
    read_points,
    read_surface,
    stored_frames,
)
from workflows.screw_frames import pile_surface, points_near_pile
from workflows.screw_pictures import plane_section
from workflows.screw_report import write_screw_report
from workflows.screw_report_curves import balance_error
from workflows.screw_slices import distance_from_pile
from workflows.screw_theory import Motion, closed_forms, part_torques
from workflows.screw_view import Frame, feature_edges, project, rasterise, view_from
from workflows.stages import report as report_stage

STRENGTH, ADHESION = 10e3, 0.5
HELIX = Helix(diameter=1.0, pitch=0.33, thickness=0.12, height=0.25)
STEPS = 5
JACKED = Path(__file__).parents[2] / "cases" / "jacked_pile_clay_quick.toml"


@pytest.fixture(scope="module")
def case():
    stiffness = 50 * 200 * STRENGTH
    return ScrewCase(
        "Screw pile <in> clay",
        Ground(soil=VonMises(200 * STRENGTH, 0.49, STRENGTH), unit_weight=8e3, k0=1.0),
        ScrewPile(0.5, 1.2, (HELIX,), 8e3),
        CoulombInterface(stiffness, stiffness / 10, adhesion_factor=ADHESION),
        Box(width=2.75, depth=3.0, headroom=0.5),
        ScrewMeshOptions(0.25, 0.42, 0.4, 1.2, 0.05, points_per_direction=1),
        ScrewProgramme((Phase("in", 0.2, 1.0),), 0.06),
        ScrewNumerics(tolerance=1e-6),
    )


@pytest.fixture(scope="module")
def mesh(case):
    return generate_screw_mesh(case.pile, case.box, case.background_mesh)


@pytest.fixture(scope="module")
def states(case, mesh):
    """States as an installation leaves them, with made-up forces: geostatic soil, moved pile."""
    problem = set_up(
        case.ground, case.pile, case.interface, case.box, case.installation, case.numerics, mesh
    )
    state = geostatic_state(problem, mesh, case.background_mesh, 'title = "x"')
    found = []
    for number in range(STEPS + 1):
        travel = 0.06 * min(number, STEPS - 1)
        whole = phase_motion(case.pile, case.installation.phases[0])
        share = travel / rim_travel(case.pile, whole)
        pose = Pose(share * whole.advance, share * whole.rotation)
        moved = move_mesh(problem, mesh, pose)
        interface = follow(
            state.interface, problem.model.elements, problem.normals, pose.rotation, moved,
            case.ground, case.interface, problem.strength_share,
        )  # fmt: skip
        slide = np.array([0.01, 0.0, -0.02]) * number / STEPS
        points = state.material_points._replace(
            displacement=np.exp(-((state.material_points.position[:, :1]) ** 2)) * slide
        )
        state = state._replace(
            background_mesh=moved,
            interface=interface,
            material_points=points,
            pile=PileState(
                np.array(pose.advance), np.array(pose.rotation),
                np.array(case.pile.embedment + pose.advance), np.zeros(3),
            ),
            history=append(state.history, row_of(case, number, travel, pose)),
        )  # fmt: skip
        found.append(state)
    return found


def row_of(case, number, travel, pose):
    """One row of a history: the torque grows to that of full adhesion; the last is a release."""
    n_parts = len(part_names(case.pile))
    is_released = number == STEPS
    share = 0.0 if is_released else min(number / 2.0, 1.0)
    tangential = np.zeros(n_parts)
    tangential[[0, 2, 3, 4, 5]] = 160.0, 1900.0, 1100.0, 1120.0, 900.0
    normal = np.zeros(n_parts)
    normal[[3, 6]] = -300.0, 1000.0
    work = 300.0 * share
    return {
        "travel": travel, "penetration": pose.advance, "rotation": pose.rotation,
        "release_share": float(is_released), "phase": int(is_released), "phase_share": 1.0,
        "crowd_force": 9e3 * share,
        "torque": share * (tangential + normal).sum(),
        "lateral_force": [1e3 * share, 0.0], "overturning_moment": [0.0, 2e3 * share],
        "part_torque": share * (tangential + normal), "part_normal_torque": share * normal,
        "part_force": np.zeros(n_parts),
        "far_force_mismatch": 1e-8, "far_moment_mismatch": 1e-7,
        "rig_work": work, "interface_work": 0.6 * work, "soil_work": 0.5 * work,
        "weight_work": 0.1 * work * (1.0 + 1e-3),
        "iterations": 4, "residual": 1e-7, "convergence_order": 1.9 if number else np.nan,
        "cuts": 0, "empty_cells": 0, "partly_filled_cells": number,
        "empty_integration_points": 0, "injected_points": 3, "merged_points": 3,
        "projected_points": 0, "smallest_cell_quality": 0.05,
        "smallest_volume_ratio": 0.99, "largest_volume_ratio": 1.01,
        "advancement_ratio": 0.875 if number else np.nan,
        "edge_torque": np.nan, "edge_force": np.nan,
        "mass_error": 1e-16, "volume_error": 2e-15, "closed_volume": 1e-4 * number,
        "pressure_scatter": 3e3 + number,
        "winding_stress_change": 0.02 if number == 2 else np.nan,
        "winding_force_change": -250.0 if number == 2 else np.nan,
        "winding_torque_change": 40.0 if number == 2 else np.nan,
        "winding_energy_change": -1.5 if number == 2 else np.nan,
        "residual_history": [1e-1, 1e-3, 1e-7],
    }  # fmt: skip


@pytest.fixture(scope="module")
def directory(tmp_path_factory, states):
    """A results directory with the frames of all steps."""
    path = tmp_path_factory.mktemp("screw")
    write = frame_writer(path, every=1)
    for state in states:
        write(state, progress_of(state))
    return path


def progress_of(state, target=1e9):
    travel = state.history.travel
    return InstallationProgress(len(travel) - 1, travel[-1], target, 0.0, 0.0, 1, 0)


# --- the page -------------------------------------------------------------------------------------


class Page(HTMLParser):
    """Ids, addresses, tags left open, and text of a page."""

    VOID = ("meta", "link", "br", "img", "use", "path", "image")

    def __init__(self, html):
        super().__init__()
        self.ids, self.addresses, self.open, self.text = [], [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.ids += [value for name, value in attributes if name == "id"]
        self.addresses += [v for name, v in attributes if name in ("src", "href", "xlink:href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in self.VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


@pytest.fixture(scope="module")
def page(directory, case, states):
    (directory / TIMING).write_text('{"kernels": 12.0, "assembly": 3.0}')
    installed = states[-1]._replace(case_text=case_text(case))
    write_installed_state(directory / INSTALLED, installed, "test")
    (remark,) = report_stage.run(case, directory)
    assert remark == f"open {directory / REPORT}"
    return Page((directory / REPORT).read_text(encoding="utf-8"))


def pictures_of(page, kind):
    prefix = f"data:image/{kind};base64,"
    found = [address for address in page.addresses if address.startswith(prefix)]
    return [Image.open(io.BytesIO(base64.b64decode(text[len(prefix) :]))) for text in found]


def test_the_page_is_well_formed_and_asks_nothing_of_the_network(page):
    assert page.open == []
    assert {name for name in page.ids if page.ids.count(name) > 1} == set()
    for address in page.addresses:
        assert address.startswith(("#", "data:image/png;base64,", "data:image/gif;base64,"))
    local = {address[1:] for address in page.addresses if address.startswith("#")}
    assert local <= set(page.ids)


def test_all_parts_are_there(page):
    wanted = {
        "results", "case", "installation", "ground", "checks", "method", "torque", "parts", "work",
        "side", "vertical", "horizontal", "tractions", "animation", "newton", "irregular", "far",
    }  # fmt: skip
    assert wanted <= set(page.ids)
    text = " ".join(page.text)
    assert "Screw pile <in> clay" in text
    assert "kernels" in text
    assert "3.0 s" in text


def test_figures_are_those_of_the_step_in_which_the_rig_stops(page, states):
    text = " ".join(page.text)
    torque = states[-2].history.torque[-1]
    assert states[-1].history.torque[-1] == 0.0
    assert f"{torque / 1e3:.3f} kN m" in text
    assert "9.000 kN" in text


def test_points_and_windings_are_told(page):
    text = " ".join(" ".join(page.text).split())
    assert "scatter of the pressure in a cell within a diameter of the pile, worst step" in text
    assert "3.0 kPa, 0.30 su" in text
    assert "largest change by winding the mesh back, 1 times" in text
    assert "0.25 kN" in text
    assert "advancement ratio of the last step that turned 0.875" in text
    assert "mass changed by merging and splitting, worst step" in text


def test_no_picture_is_blank(page):
    pictures = pictures_of(page, "png")
    assert len(pictures) >= 8
    for picture in pictures:
        if min(picture.size) > 20:  # smaller ones are of colour bars
            assert np.asarray(picture.convert("RGBA")).reshape(-1, 4).std(axis=0).max() > 5.0


def test_the_animation_moves(page):
    (animation,) = pictures_of(page, "gif")
    assert animation.n_frames == STEPS + 1
    seen = []
    for number in range(animation.n_frames):
        animation.seek(number)
        seen.append(np.asarray(animation.convert("RGB"), dtype=float))
    assert np.abs(seen[1] - seen[0]).mean() > 0.1
    largest = max(len(address) for address in page.addresses)
    assert largest * 3 / 4 < MOST_BYTES


def test_without_frames_there_is_no_animation(tmp_path, case, states):
    html = write_screw_report(tmp_path, case, states[-2]).read_text(encoding="utf-8")
    assert 'id="animation"' not in html
    assert "has let go" not in " ".join(Page(html).text[:400])


# --- figures --------------------------------------------------------------------------------------


def test_closed_forms_of_the_parts(case):
    names, tau = part_names(case.pile), ADHESION * STRENGTH
    motion = Motion(turn=0.1, advance=0.1 * HELIX.pitch / (2.0 * np.pi))
    forms = closed_forms(case.pile, 1.5, motion, np.full(len(names), tau))
    form = {names[part]: torque for part, torque in forms.items()}
    a, r, t = 0.25, 0.5, 0.12
    assert form["tip"] == pytest.approx(2.0 * np.pi / 3.0 * tau * a**3)
    assert form["lower face"] == form["upper face"]
    assert form["lower face"] == pytest.approx(2.0 * np.pi / 3.0 * tau * (r**3 - a**3))
    slope = HELIX.pitch / (2.0 * np.pi)
    cosine = r / np.hypot(r, slope)
    assert form["rim"] == pytest.approx(2.0 * np.pi * r**2 * t * tau * cosine)
    cosine = a / np.hypot(a, slope)
    assert form["shaft"] == pytest.approx(2.0 * np.pi * a**2 * (1.5 - t) * tau * cosine)
    assert form["cone"] == 0.0
    backward = closed_forms(case.pile, 1.5, Motion(-0.1, -0.01), np.full(len(names), tau))
    assert backward[0] == -forms[0]
    assert closed_forms(case.pile, 1.5, Motion(0.0, 0.1), np.full(len(names), tau)) == {}


def test_a_cone_that_only_turns_has_the_torque_of_a_rough_cone():
    pile = ScrewPile(0.5, 1.2, (), 8e3, tip_length=0.5)
    forms = closed_forms(pile, 1.2, Motion(0.1, 0.0), np.full(3, 5e3))
    slant = np.hypot(0.5, 0.25)
    assert forms[1] == pytest.approx(2.0 * np.pi / 3.0 * 5e3 * 0.25**2 * slant, rel=1e-4)


def test_part_torques_compare_the_driven_pile(case, states):
    parts = {part.name: part for part in part_torques(case.pile, states[-1], None)}
    assert set(parts) == set(part_names(case.pile)) - {"cone"}
    assert parts["lower face"].tangential == 1100.0
    assert parts["lower face"].normal == -300.0
    exact = 2.0 * np.pi / 3.0 * ADHESION * STRENGTH * (0.5**3 - 0.25**3)
    assert parts["lower face"].closed_form == pytest.approx(exact)
    assert parts["lower face"].deviation == pytest.approx(1100.0 / exact - 1.0)
    assert parts["leading edge"].closed_form is None
    assert parts["leading edge"].deviation is None


def test_error_of_the_power_balance(states):
    error = balance_error(driven(states[-1].history))
    np.testing.assert_allclose(error[1:], 1e-4, rtol=1e-6)


# --- geometry -------------------------------------------------------------------------------------


def test_the_surface_of_the_interface_is_that_of_the_mesh(case, mesh, states):
    elements, part, _ = pile_elements(mesh, case.pile)
    surface = pile_surface(states[0].interface)
    np.testing.assert_allclose(surface.corners, mesh.nodes[elements.nodes[:, :3]], atol=1e-12)
    np.testing.assert_array_equal(surface.part, part)
    tip = surface.part == 0
    np.testing.assert_allclose(surface.pressure[tip], 1.2 * 8e3, rtol=1e-3)
    np.testing.assert_allclose(surface.traction[tip][:, :, 2], 1.2 * 8e3, rtol=1e-3)


def test_distance_from_the_pile_is_zero_on_its_surface(case, states):
    surface, pose = pile_surface(states[-1].interface), pose_of(states[-1])
    places = surface.corners[surface.corners[:, :, 2].max(axis=1) < 0.0]
    on_surface = distance_from_pile(case.pile, pose, places)
    assert np.abs(on_surface).max() < 1e-4
    z = -1.0 - pose.advance
    inside_and_out = np.array([[0.0, 0.1, z], [0.4, 0.0, 0.0], [0.0, 0.6, z], [0.0, 0.0, -1.3]])
    assert (distance_from_pile(case.pile, pose, inside_and_out) < 0.0).tolist() == [
        True, False, False, False,
    ]  # fmt: skip
    polar = pose.rotation + 1.0  # in the plate, a radian from the leading edge
    level = case.pile.leading_level(HELIX) + HELIX.pitch / (2.0 * np.pi) - pose.advance
    in_plate = np.array([0.4 * np.cos(polar), 0.4 * np.sin(polar), level])
    assert distance_from_pile(case.pile, pose, in_plate) == pytest.approx(-0.06)


def test_distance_from_rounded_edges(case):
    helix = replace(HELIX, edges="rounded")
    pile = replace(case.pile, helices=(helix,))
    sign = np.array([1.0, -pile.sense, 1.0])  # a right-handed plate winds towards +y
    ahead = np.array([[0.4, y, pile.leading_level(helix)] for y in (0.02, 0.1)]) * sign
    ahead[:, 2] -= helix.pitch * np.array([0.02, 0.1]) / (2.0 * np.pi * 0.4)
    found = distance_from_pile(pile, Pose(0.0, 0.0), ahead)
    np.testing.assert_allclose(found, [-0.04, 0.04], atol=1e-12)


def pose_of(state):
    return Pose(float(state.pile.penetration), float(state.pile.rotation))


def test_a_plane_cuts_the_mesh_into_polygons_that_cover_it(case, mesh):
    polygons, cells = plane_section(mesh.nodes, mesh.cell_nodes[:, :4])
    assert len(polygons) == len(cells)
    area = sum(area_of(polygon) for polygon in polygons)
    box, pile = case.box, case.pile
    whole = 2.0 * box.width * (box.depth + box.headroom)
    shaft = pile.shaft_diameter * (pile.embedment + box.headroom)
    plate = 2.0 * (HELIX.radius - pile.shaft_radius) * HELIX.thickness
    assert area == pytest.approx(whole - shaft - plate, rel=0.02)


def area_of(polygon):
    x, z = polygon.T
    return 0.5 * abs((x * np.roll(z, -1) - z * np.roll(x, -1)).sum())


def test_the_nearer_triangle_hides_the_other():
    near = np.array([[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 0.0, 1.0]])
    far = near * [-1.0, 2.0, 2.0]
    view = view_from(0.0, 0.0)  # against the x axis
    triangles = np.stack([far, near])
    raster = rasterise(triangles, view, Frame(-2.0, 2.0, -2.0, 2.0), 80)
    assert raster.triangle[40, 40] == 1
    assert raster.triangle[2, 40] == 0
    assert raster.triangle[78, 2] == -1
    rows, columns = np.nonzero(raster.triangle >= 0)
    corners = triangles[raster.triangle[rows, columns]]
    place = (raster.shares[rows, columns][:, :, None] * corners).sum(axis=1)
    seen = project(place, view)
    np.testing.assert_allclose(seen[:, 0], -2.0 + (columns + 0.5) * 0.05, atol=1e-9)
    np.testing.assert_allclose(seen[:, 1], -2.0 + (rows + 0.5) * 0.05, atol=1e-9)
    np.testing.assert_allclose(seen[:, 2], raster.depth[rows, columns], atol=1e-9)
    edges = feature_edges(raster, np.array([0, 1]))
    assert edges.any()
    assert not edges[40, 40]


@pytest.mark.parametrize("seen", [0, 1])
def test_of_both_sides_of_a_surface_the_one_towards_the_viewer_is_drawn(seen):
    """Corners of facets go round clockwise from outside the pile."""
    view = view_from(0.3, 0.5)
    clockwise = np.array([-view.right, view.up, view.right])
    sides = np.stack([clockwise, clockwise[::-1]])[[seen, 1 - seen]]
    raster = rasterise(sides, view, Frame(-1.0, 1.0, -1.0, 1.0), 40)
    assert set(np.unique(raster.triangle)) == {-1, seen}


def test_check_draws_the_mesh(case, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text(case))
    cli.check(path, plot=tmp_path / "pictures" / "mesh.png")
    picture = Image.open(tmp_path / "pictures" / "mesh.png")
    assert picture.format == "PNG"
    pixels = np.asarray(picture.convert("RGB"), dtype=float)
    assert (pixels.std(axis=(0, 1)) > 20.0).all()
    for third in np.array_split(pixels, 3, axis=1):
        assert third.std() > 10.0


def test_check_draws_screw_piles_only(tmp_path):
    with pytest.raises(CaseError, match="screw pile only"):
        cli.check(JACKED, plot=tmp_path / "mesh.png")
    assert not list(tmp_path.iterdir())


# --- frames ---------------------------------------------------------------------------------------


def test_frames_are_read_back(directory, states):
    assert stored_frames(directory) == list(range(STEPS + 1))
    surface, stored = pile_surface(states[2].interface), read_surface(directory, 2)
    np.testing.assert_allclose(stored.corners, surface.corners, atol=1e-6)
    np.testing.assert_allclose(stored.pressure, surface.pressure, rtol=1e-5, atol=1e-2)
    np.testing.assert_array_equal(stored.part, surface.part)
    cloud, points = points_near_pile(states[2]), read_points(directory, 2)
    np.testing.assert_allclose(points.position, cloud.position, atol=1e-6)
    np.testing.assert_allclose(points.mean_pressure, cloud.mean_pressure, rtol=1e-5, atol=1e-2)


def test_a_run_leaves_some_tens_of_frames(case):
    long = replace(case, installation=ScrewProgramme((Phase("in", 3.0, 1.0),), 0.01))
    n_steps = 3.0 * np.hypot(np.pi, HELIX.pitch) / 0.01
    assert 30 < n_steps / frame_interval(long) < 60
    assert frame_interval(case) == 1


def test_lists_of_frames_have_the_load_step_as_time(directory):
    for series in SERIES:
        text = (directory / "paraview" / f"{series}.pvd").read_text()
        times = [int(time) for time in re.findall(r'timestep="([^"]+)"', text)]
        assert times == list(range(STEPS + 1))
        for name in re.findall(r'file="([^"]+)"', text):
            assert (directory / "paraview" / name).exists()


def test_a_resumed_run_replaces_the_frames_after_its_start(tmp_path, states):
    write = frame_writer(tmp_path, every=2)
    for state in states:
        write(state, progress_of(state))
    assert stored_frames(tmp_path) == [0, 2, 4]
    write = frame_writer(tmp_path, every=1)
    write(states[1], progress_of(states[1]))
    assert stored_frames(tmp_path) == [0, 1]
    assert (tmp_path / "paraview" / "pile_surface.pvd").read_text().count("DataSet") == 2
    assert not list(tmp_path.rglob("*.partial"))


def test_the_last_step_is_stored_whatever_the_interval(tmp_path, states):
    write = frame_writer(tmp_path, every=100)
    for state in states[:4]:
        write(state, progress_of(state, target=float(states[3].history.travel[-1])))
    assert stored_frames(tmp_path) == [0, 3]


def test_the_state_at_the_end_is_exported_in_full(tmp_path, states, case):
    files = export_screw_pile(tmp_path, states[-1], case.ground)
    surface, points, cells = (meshio.read(path) for path in files)
    assert len(points.points) == len(states[-1].material_points.mass)
    assert points.point_data["cauchy_stress"].shape == (len(points.points), 6)
    np.testing.assert_allclose(points.points, states[-1].material_points.position)
    assert surface.cells[0].type == "triangle"
    assert cells.cells[0].type == "tetra"
    fill = cells.cell_data["fill"][0]
    assert 0.99 < np.median(fill[fill > 0.0]) < 1.01
    assert fill.min() == 0.0
