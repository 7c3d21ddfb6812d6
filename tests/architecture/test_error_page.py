"""The pages of error messages have a heading, and a row, for every error and warning of the library."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from ulna import errors

DOCS = Path(__file__).parents[2] / "docs"
BASES = {"UlnaError", "UlnaWarning"}
CLASSES = {
    name
    for name, value in vars(errors).items()
    if inspect.isclass(value) and issubclass(value, (errors.UlnaError, errors.UlnaWarning))
}


def test_every_error_has_a_heading_in_order() -> None:
    page = (DOCS / "reference" / "errors.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", page, re.MULTILINE)
    names = [name for heading in headings for name in heading.split(", ")]
    assert CLASSES - BASES - set(names) == set()
    firsts = [heading.split(", ")[0] for heading in headings if heading.split(", ")[0] in CLASSES]
    assert firsts == sorted(firsts)


def test_every_error_has_a_row_from_a_to_z() -> None:
    page = (DOCS / "howto" / "errors.md").read_text(encoding="utf-8")
    names = re.findall(r"^\| \[(\w+)\]", page, re.MULTILINE)
    assert names == sorted(CLASSES - BASES)
