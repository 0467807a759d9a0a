"""The pages of the documentation agree with the code, with the bibliography and with each other."""

import re
from pathlib import Path

import pytest

from install_mpm.conventions import CONVENTIONS
from workflows.state_file_page import state_file_page

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")])


def test_the_page_on_state_files_is_up_to_date():
    text = (ROOT / "docs" / "state_file.md").read_text(encoding="utf-8")
    assert text == state_file_page(), (
        "write it again: python -m workflows.state_file_page > docs/state_file.md"
    )


def test_the_page_on_conventions_lists_all_of_them():
    lines = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8").splitlines()
    assert [line[2:] for line in lines if line.startswith("- ")] == list(CONVENTIONS)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (page.parent / target).exists(), target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_named_on_a_page_exist(page):
    """Modules and scripts in code style; a bare name may belong to any package."""
    names = {path.name for path in ROOT.glob("[a-z]*/**/*.py")}
    for name in re.findall(r"`([\w./]+\.py)`", page.read_text(encoding="utf-8")):
        if page.name != "architecture.md":  # names files that are still to come
            assert (ROOT / name).exists() or name in names or list(ROOT.glob(f"*/{name}")), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_citations_are_in_the_bibliography(page):
    bibliography = (ROOT / "docs" / "references.bib").read_text(encoding="utf-8")
    keys = set(re.findall(r"^@\w+\{(\w+),", bibliography, flags=re.MULTILINE))
    cited = re.findall(r"\[([a-z]+\d{4})\]", page.read_text(encoding="utf-8"))
    assert set(cited) <= keys


def test_every_entry_of_the_bibliography_is_cited():
    bibliography = (ROOT / "docs" / "references.bib").read_text(encoding="utf-8")
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for key in re.findall(r"^@\w+\{(\w+),", bibliography, flags=re.MULTILINE):
        assert f"[{key}]" in text
