"""The page of error messages has a heading for every error and warning of the library."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from ulna import errors

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "errors.md"
BASES = {"UlnaError", "UlnaWarning"}


def test_every_error_has_a_heading_in_order() -> None:
    headings = re.findall(r"^## (.*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    names = [name for heading in headings for name in heading.split(", ")]
    classes = {
        name
        for name, value in vars(errors).items()
        if inspect.isclass(value) and issubclass(value, (errors.UlnaError, errors.UlnaWarning))
    }
    assert classes - BASES - set(names) == set()
    firsts = [heading.split(", ")[0] for heading in headings if heading.split(", ")[0] in classes]
    assert firsts == sorted(firsts)
