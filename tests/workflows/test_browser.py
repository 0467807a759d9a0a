"""Reports in a real browser: no errors, no network; tabs, hover and the 3D view work."""

import io
import json
import shutil

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.utils import is_connectable
from selenium.webdriver.support.ui import WebDriverWait

from install_mpm.constitutive.parameters import VonMises
from install_mpm.ground import Ground
from workflows.directory import REPORT
from workflows.interactive import interactive, line, panels
from workflows.interactive_space import view
from workflows.report import filled_page
from workflows.report_sections import Section
from workflows.report_style import INK, styled
from workflows.screw_frames import PileSurface, PointCloud

pytestmark = pytest.mark.browser

WAIT = 120.0
"""Seconds; software rendering of the 3D view takes some on a loaded machine."""


class Service(webdriver.ChromeService):
    """The driver of the browser, by its address: a bare machine may not know "localhost"."""

    @property
    def service_url(self):
        return f"http://127.0.0.1:{self.port}"

    def is_connectable(self):
        return is_connectable(self.port, "127.0.0.1")


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    for argument in (
        "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,1000",
        "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
    ):  # fmt: skip
        options.add_argument(argument)
    options.binary_location = shutil.which("chromium")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def made_up_page(tmp_path_factory):
    """A page with two sections: a curve, and a tetrahedron as pile with soil behind it."""
    x = np.linspace(0.0, 1.0, 11)
    plot = panels(1, 1)
    plot.add_trace(line(x, 3.0 * x, "load", INK, "%{x:.2f} m, %{y:.3f} kN"))
    top, base = np.array([0.0, 0.0, 0.5]), np.array([[1, 0, -1], [-1, 1, -1], [-1, -1, -1.0]])
    corners = np.array([[top, base[i], base[(i + 1) % 3]] for i in range(3)])
    load = np.repeat([[10e3], [20e3], [30e3]], 3, axis=1)
    surface = PileSurface(corners, np.zeros(3, int), np.zeros((3, 3, 3)), load, load / 2.0)
    position = np.random.default_rng(0).uniform([-2, 0.1, -3], [2, 2, -0.2], (300, 3))
    cloud = PointCloud(
        position, np.zeros((300, 3)), 1e4 * (1.0 - position[:, 2]), np.full(300, 0.05)
    )
    ground = Ground(soil=VonMises(2e6, 0.49, 1e4), unit_weight=8e3, k0=1.0)
    with styled():
        parts = [
            Section(name, name.title(), interactive(f"{name}_figure", Figure((4, 3)), each, name))
            for name, each in (("curve", plot), ("space", view(surface, cloud, ground)))
        ]
    path = tmp_path_factory.mktemp("page") / REPORT
    path.write_text(filled_page("Title", "heading", "subtitle", parts), encoding="utf-8")
    return path


def opened(browser, path, fragment=""):
    """Open a page that does not carry over what the last one logged."""
    browser.get("about:blank")
    for kind in ("browser", "performance"):
        browser.get_log(kind)
    browser.get(f"{path.resolve().as_uri()}{fragment}")


def drawn(browser, name):
    """Return the figure after it is drawn."""
    figure = browser.find_element(By.ID, name)
    browser.execute_script("arguments[0].scrollIntoView()", figure)
    WebDriverWait(browser, WAIT).until(lambda _: "drawn" in figure.get_attribute("class"))
    WebDriverWait(browser, WAIT).until(
        lambda _: figure.find_elements(By.CSS_SELECTOR, ".plot .main-svg")
    )
    return figure


def shows(browser, names):
    """Return whether the sections with these names come to be the only ones that are seen."""
    sections = browser.find_elements(By.CSS_SELECTOR, "main > section")
    WebDriverWait(browser, WAIT).until(
        lambda _: [each.get_attribute("id") for each in sections if each.is_displayed()] == names
    )
    return True


def errors(browser):
    return [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]


def requests(browser):
    """Return the addresses that the browser asked for, without those inside the page."""
    messages = (json.loads(entry["message"])["message"] for entry in browser.get_log("performance"))
    found = {
        message["params"]["request"]["url"]
        for message in messages
        if message["method"] == "Network.requestWillBeSent"
    }
    return {address for address in found if not address.startswith(("data:", "blob:"))}


def test_tabs_show_one_section_or_everything(browser, made_up_page):
    opened(browser, made_up_page)
    assert shows(browser, ["curve"])
    browser.find_element(By.CSS_SELECTOR, 'nav a[href="#space"]').click()
    assert shows(browser, ["space"])
    chosen = browser.find_elements(By.CSS_SELECTOR, 'nav a[aria-selected="true"]')
    assert [tab.text for tab in chosen] == ["Space"]
    browser.find_element(By.CSS_SELECTOR, 'nav a[href="#everything"]').click()
    assert shows(browser, ["curve", "space"])
    opened(browser, made_up_page, "#space_figure")  # an address inside a section opens it
    assert shows(browser, ["space"])


def test_a_curve_tells_its_value_under_the_mouse(browser, made_up_page):
    opened(browser, made_up_page)
    figure = drawn(browser, "curve_figure")
    assert not figure.find_element(By.CSS_SELECTOR, ".still").is_displayed()
    area = figure.find_element(By.CSS_SELECTOR, ".nsewdrag")
    ActionChains(browser).move_to_element(area).perform()
    label = WebDriverWait(browser, WAIT).until(
        lambda _: figure.find_elements(By.CSS_SELECTOR, ".hoverlayer .hovertext")
    )
    assert "0.50 m, 1.500 kN" in label[0].text


def test_the_view_in_space_is_not_blank_and_buttons_change_it(browser, made_up_page):
    opened(browser, made_up_page, "#space")
    figure = drawn(browser, "space_figure")
    WebDriverWait(browser, WAIT).until(lambda _: colours_of(figure) > 200)
    before = figure.screenshot_as_png
    buttons = figure.find_elements(By.CSS_SELECTOR, ".updatemenu-button")
    assert [button.text for button in buttons] == ["contact pressure", "shear traction"]
    buttons[1].click()
    WebDriverWait(browser, WAIT).until(lambda _: figure.screenshot_as_png != before)
    assert errors(browser) == []


def colours_of(figure):
    """Return how many colours the middle of a figure has."""
    image = Image.open(io.BytesIO(figure.screenshot_as_png)).convert("RGB")
    width, height = image.size
    middle = image.crop((width // 4, height // 4, 3 * width // 4, 3 * height // 4))
    return len(np.unique(np.asarray(middle).reshape(-1, 3), axis=0))


@pytest.mark.dolfinx
def test_a_whole_report_opens_without_errors_and_without_network(browser, quick_results):
    path = quick_results / REPORT
    opened(browser, path, "#everything")
    for name in ("force", "curves"):
        drawn(browser, name)
    assert errors(browser) == []
    assert {address.partition("#")[0] for address in requests(browser)} == {path.resolve().as_uri()}
