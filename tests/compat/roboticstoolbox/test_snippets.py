"""Short pieces of code have the same outcome in both packages: values, types, printed text, warnings, exceptions."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("roboticstoolbox")

FOLDER = Path(__file__).parent / "snippets"
THEMES = sorted({file.stem for file in FOLDER.glob("*.py")} - {"run_snippets", "compare"})
TOGETHER = {"imports": ["imports"], "the others": [theme for theme in THEMES if theme != "imports"]}
"""Which themes share their two processes: to import the toolbox takes seconds. What one imports is there in those after it."""


def _module(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(f"snippets_{name}", FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("themes", TOGETHER)
def test_outcomes_are_those_of_the_toolbox(themes: str) -> None:
    compare, snippets = _module("compare"), {}
    for theme in TOGETHER[themes]:
        of_theme = _module(theme).SNIPPETS
        assert len(of_theme) > 5
        snippets |= {f"{theme}, {name}": code for name, code in of_theme.items()}
    ulna, toolbox = compare.run_both(snippets)
    different = {name: compare.difference(ulna[name], toolbox[name]) for name in snippets}
    wrong = [f"{name}: {snippets[name]}\n{text}" for name, text in different.items() if text]
    assert not wrong, f"{len(wrong)} of {len(snippets)} differ:\n" + "\n\n".join(wrong[:10])
