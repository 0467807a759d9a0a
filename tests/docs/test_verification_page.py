"""The page on the reference problems is as ``screwpile verify --report`` wrote it."""

import re
from pathlib import Path

from workflows.verification.registry import problems

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "verification.md"


def test_the_page_holds_problems_of_the_registry_in_its_order():
    text = PAGE.read_text(encoding="utf-8")
    found = re.findall(r"^### ([\w-]+): (.*)$", text, flags=re.MULTILINE)
    known = [(name, problem.title) for name, problem in problems().items()]
    assert found
    assert found == [entry for entry in known if entry in found]


def test_every_picture_of_the_page_is_used():
    text = PAGE.read_text(encoding="utf-8")
    pictures = (PAGE.parent / "images" / PAGE.stem).glob("*.png")
    assert {path.name for path in pictures} == set(re.findall(r"/([\w-]+\.png)\)", text))
