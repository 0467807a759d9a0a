"""The report: complete, self-contained, faithful to the files, and clear when one is missing."""

import json
import re
from html.parser import HTMLParser

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from install_mpm.conventions import Kinematics
from install_mpm.record import StateFileError
from workflows import directory as names
from workflows.errors import DirectoryError
from workflows.report import write_report
from workflows.report_data import read_results
from workflows.report_fields import (
    deviatoric_stress,
    initial_position,
    nearest_index,
    pressure_change,
    sub_regions,
    window_of,
)
from workflows.report_html import Cell, figure, table
from workflows.report_sections import installation_html
from workflows.report_service import continuity, plastic_shear
from workflows.report_style import INK, panels, styled, svg_of
from workflows.report_tables import certificate_table
from workflows.report_units import plain, shown, significant

NEEDED = (
    names.INSTALLED,
    names.HANDED_OFF,
    names.CERTIFICATE,
    names.SERVICE,
    names.WISHED_SERVICE,
    names.SUMMARY,
)


class Page(HTMLParser):
    """Ids, addresses, tags left open, and text of a page."""

    VOID = ("meta", "link", "br", "img", "use", "path", "image")

    def __init__(self, html):
        super().__init__()
        self.ids, self.addresses, self.open, self.text = [], [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            if name in ("src", "href", "xlink:href"):
                self.addresses.append(value)
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
def results(quick_results):
    return read_results(quick_results)


@pytest.fixture(scope="module")
def html(quick_results):
    return (quick_results / names.REPORT).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(html):
    return Page(html)


def test_the_page_is_well_formed_and_asks_nothing_of_the_network(page):
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    for address in page.addresses:
        assert address.startswith(("#", "data:image/png;base64,")), address[:80]
    local = {address[1:] for address in page.addresses if address.startswith("#")}
    assert local <= set(page.ids)


def test_all_parts_are_there(page):
    wanted = {
        "results", "case", "installation", "convergence", "handoff", "service", "method",
        "provenance", "force", "points", "stress", "newton", "irregular", "handed_off", "tractions",
        "curves", "continuity",
    }  # fmt: skip
    assert wanted <= set(page.ids)
    assert len([name for name in page.ids if re.fullmatch(r"mechanism_\d", name)]) == 2


def test_figures_come_from_the_summary(page, results):
    text = " ".join(page.text)
    figures = results.summary["results"]
    assert shown(figures["installation"]["crowd_force_N"], "N") in text
    compression = figures["service"]["compression"]
    assert shown(compression["installed"]["capacity_N"], "N") in text
    assert shown(compression["wished_in_place"]["capacity_N"], "N") in text
    assert significant(compression["ratio"]["capacity"], 3) in text
    assert results.summary["case_sha256"] in text
    for name, version in results.summary["versions"].items():
        assert name in text
        assert version in text


def test_the_page_follows_the_ground_of_the_reader(html):
    assert "prefers-color-scheme: dark" in html
    assert "currentColor" in html
    assert INK not in html.split("</style>")[1]


def test_a_failed_check_is_red_and_announced(results_copy):
    path = results_copy / names.CERTIFICATE
    certificate = json.loads(path.read_text())
    certificate["synthetic_error"] |= {"value": 0.3, "is_met": False}
    path.write_text(json.dumps(certificate))
    html = write_report(results_copy).read_text(encoding="utf-8")
    assert html.count('class="fail">FAIL') == 1
    assert 'class="warning"><strong class="fail">Not certified.</strong>' in html
    assert "Checks of the certificate that failed: 1 (<code>synthetic_error</code>)." in html


def test_passed_checks_are_not_announced(html):
    assert 'class="warning"' not in html
    assert 'class="fail"' not in html


@pytest.mark.parametrize("name", NEEDED)
def test_a_missing_file_is_one_clear_sentence(results_copy, name):
    (results_copy / name).unlink()
    old = (results_copy / names.REPORT).read_bytes()
    with pytest.raises((DirectoryError, StateFileError), match=r"no such file; .*run") as caught:
        write_report(results_copy)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)
    assert (results_copy / names.REPORT).read_bytes() == old


@pytest.mark.parametrize("content", ["{", "[1, 2]", ""])
def test_a_damaged_summary_is_named(results_copy, content):
    (results_copy / names.SUMMARY).write_text(content)
    with pytest.raises(DirectoryError, match=r"summary\.json.*screwpile compare"):
        write_report(results_copy)


def test_a_missing_directory_is_named(tmp_path):
    with pytest.raises(DirectoryError, match="no such directory"):
        write_report(tmp_path / "nothing")


def test_writing_again_gives_the_same_page_and_leaves_matplotlib_alone(results_copy, html):
    before = dict(mpl.rcParams)
    assert write_report(results_copy).read_text(encoding="utf-8") == html
    assert dict(mpl.rcParams) == before


# --- pieces ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (250442.7, "N", "250.4 kN/m"),
        (-0.02494, "m", "−0.02494 m"),
        (1.0254e7, "N/m", "10.25 kN/m per mm"),
        (2.4e-11, "", "2.4 × 10⁻¹¹"),
        (0.0, "N", "0 kN/m"),
        (None, "N", "–"),
    ],
)
def test_numbers_are_shown_with_units_of_the_field(value, unit, text):
    assert shown(value, unit) == text


def test_options_are_shown_as_they_were_written():
    assert plain(0.05) == "0.05"
    assert plain(200e6, "Pa/m") == "200000 kPa/m"
    assert plain(np.pi / 6.0, "rad") == "30 °"
    assert plain("von_mises") == "von mises"


def test_text_from_files_cannot_become_markup():
    html = table(["<b>"], [["a & b", Cell("<i>x</i>", "number")]])
    assert "&lt;b&gt;" in html
    assert "a &amp; b" in html
    assert '<td class="number"><i>x</i></td>' in html
    with styled():
        picture, _ = panels(1, 1, 2.0, 2.0)
        assert "&lt;script&gt;" in figure("name", picture, "<script>")


def test_certificate_table_shows_value_limit_and_verdict():
    entry = {"value": 0.07, "unit": "", "meaning": "error", "limit": 0.05, "is_met": False}
    html = certificate_table({"some_error": entry}, Kinematics.PLANE_STRAIN, with_limit=True)
    for part in ("0.0700", "0.05", "FAIL", "some_error"):
        assert part in html
    other = certificate_table({"some_error": entry}, Kinematics.PLANE_STRAIN, with_limit=False)
    assert "some_error" not in other


def test_svg_ids_belong_to_their_figure():
    with styled():
        figure_, axes = panels(1, 1, 2.0, 2.0)
        axes[0, 0].plot([0.0, 1.0], clip_on=True)
        svg = svg_of(figure_, "one")
    assert isinstance(figure_, Figure)
    ids = re.findall(r'\bid="([^"]+)"', svg)
    assert ids
    assert all(name.startswith("one-") for name in ids)
    assert set(re.findall(r"url\(#([^)]+)\)", svg)) <= set(ids)
    assert "currentColor" in svg


def test_points_before_the_installation_lie_at_rest(results):
    start = initial_position(results.installed.material_points)
    assert start[:, 1].max() < 0.0
    assert start[:, 1].min() > -results.case.box.depth


def test_every_picture_element_of_the_soil_has_a_nearby_point(results):
    case, points = results.case, results.installed.material_points
    window = window_of(case)
    index = nearest_index(points, case, window)
    assert index.max() < len(points.mass)
    rows, columns = np.nonzero(index >= 0)
    pixel = window.right / index.shape[1]
    place = np.column_stack([(columns + 0.5) * pixel, window.bottom + (rows + 0.5) * pixel])
    distance = np.linalg.norm(place - points.position[index[rows, columns]], axis=1)
    assert (distance <= 1.5 * np.sqrt(points.volume[index[rows, columns]])).all()
    in_pile = (place[:, 0] < 0.3) & (place[:, 1] > -float(results.installed.pile.tip_depth) + 0.5)
    assert in_pile.mean() < 0.01
    assert 0.75 < (index >= 0).mean() < 0.95


def test_each_integration_point_lies_in_its_part_of_the_cell(results):
    mesh, places = results.handed_off.mesh, results.handed_off.integration.position
    parts = sub_regions(mesh, places)
    edges = np.roll(parts, -1, axis=1) - parts
    offset = places[:, None] - parts
    side = edges[:, :, 0] * offset[:, :, 1] - edges[:, :, 1] * offset[:, :, 0]
    assert (side >= -1e-12).all()
    area = 0.5 * np.abs(
        (parts[:, :, 0] * np.roll(parts, -1, axis=1)[:, :, 1]).sum(axis=1)
        - (parts[:, :, 1] * np.roll(parts, -1, axis=1)[:, :, 0]).sum(axis=1)
    )
    np.testing.assert_allclose(area, results.handed_off.integration.volume, rtol=1e-9)


def test_a_pile_that_was_not_moved_has_no_force_and_no_continuity(results):
    installed = results.installed
    at_rest = results._replace(
        installed=installed._replace(
            pile=installed.pile._replace(penetration=np.array(0.0)),
            history=type(installed.history)(*(field[:1] for field in installed.history)),
        )
    )
    with styled():
        html = installation_html(at_rest)
        assert continuity(at_rest.case, at_rest.installed, at_rest.service) is None
    assert 'id="points"' in html
    assert 'id="force"' not in html


def test_measures_of_stress(results):
    ground = results.case.ground
    stress = -ground.unit_weight * 2.0 * np.eye(3)[None] - 5e3 * np.eye(3)
    np.testing.assert_allclose(pressure_change(ground, stress, np.array([-2.0])), 5.0)
    shear = stress + np.array([[0.0, 7e3, 0.0], [7e3, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(deviatoric_stress(shear), 7e3)


def test_plastic_strain_counts_from_the_release(results):
    service = results.service
    strain = plastic_shear(results.case.ground, service, "compression")
    assert (strain >= -1e-12).all()
    assert strain.max() > 0.01
    released = service.programme("release").state.state_variables[:, 1]
    end = service.programme("compression").state.state_variables[:, 1]
    np.testing.assert_allclose(strain, end - released)
