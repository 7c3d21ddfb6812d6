"""The language of the compiler is what one reads in an afternoon: seven files of at most 1,600 lines, docstrings included."""

from __future__ import annotations

from pathlib import Path

import ulna

LANGUAGE = Path(ulna.__file__).parent / "compiler" / "language"
FILES = ("ops", "graph", "simplify", "scalar", "interpreter", "differentiation", "function")
OTHERS = {"__init__", "ports", "loop_derivatives", "kept_values", "cotangents", "custom_vjp", "vjp_rule"}
MOST = 1600


def test_the_language_is_small() -> None:
    lines = {name: len((LANGUAGE / f"{name}.py").read_text(encoding="utf-8").splitlines()) for name in FILES}
    assert sum(lines.values()) <= MOST, f"move what is not language to other packages: {lines}"


def test_no_file_of_the_language_is_left_out_of_the_count() -> None:
    assert {path.stem for path in LANGUAGE.glob("*.py")} == {*FILES, *OTHERS}
