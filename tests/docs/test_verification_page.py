"""The page on the reference problems, as ``screwpile verify --report`` wrote it, is complete."""

import re
from pathlib import Path

from workflows.verification.registry import problems

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "verification.md"


def test_the_page_holds_all_problems_and_all_are_within_tolerance():
    text = PAGE.read_text(encoding="utf-8")
    found = re.findall(r"^### ([\w-]+): (.*)$", text, flags=re.MULTILINE)
    expected = [(name, problem.title) for name, problem in problems().items()]
    assert found == expected, "write it again: screwpile verify --report docs/verification.md"
    assert "FAILED" not in text


def test_every_picture_of_the_page_is_used():
    text = PAGE.read_text(encoding="utf-8")
    pictures = (PAGE.parent / "images" / PAGE.stem).glob("*.png")
    assert {path.name for path in pictures} == set(re.findall(r"/([\w-]+\.png)\)", text))
