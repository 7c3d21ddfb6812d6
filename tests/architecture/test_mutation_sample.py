"""The mutation sampling of `scripts/`: which mutants it makes, which tests it tries them with, and its verdicts."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("coverage")
SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"

SOURCE = '''"""Steps."""


def step(x, size=2):
    """Ten is the limit."""
    if x > 10:
        raise ValueError(f"{x} is above 10")
    return x + size
'''

TESTS = """import pytest
from tiny.steps import step


def test_step():
    assert step(1) == 3
"""


@pytest.fixture(scope="module")
def tools() -> Any:
    """The modules of the script."""
    sys.path.insert(0, str(SCRIPTS))
    try:
        from mutation import choice, coverage_map, mutants, sampling

        yield {"choice": choice, "map": coverage_map, "mutants": mutants, "sampling": sampling}
    finally:
        sys.path.remove(str(SCRIPTS))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A package with one function, and a test that does not look at its limit."""
    for name, text in {
        "src/tiny/__init__.py": "",
        "src/tiny/steps.py": SOURCE,
        "tests/unit/test_steps.py": TESTS,
        "tests/unit/test_others.py": "def test_others():\n    assert True\n",
        "pyproject.toml": "[tool.pytest.ini_options]\n",
    }.items():
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return tmp_path


def changes(tools: Any, source: str) -> set[str]:
    """The changes that the mutants of a source make; each leaves it valid Python with another syntax tree."""
    found = tools["mutants"].mutants(source.encode(), "src/file.py")
    for mutant in found:
        changed = mutant.applied(source.encode())
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(source)), mutant.name
    return {mutant.change for mutant in found}


def test_every_kind_of_mutant_is_made(tools: Any) -> None:
    assert changes(tools, SOURCE) == {
        "constant: 2 -> 3",
        "constant: 2 -> 1",
        "comparison: x > 10 -> (x >= 10)",
        "comparison: x > 10 -> (x <= 10)",
        "constant: 10 -> 11",
        "constant: 10 -> 9",
        'statement: raise ValueError(f"{x} is above 10") -> pass',
        "return: x + size -> None",
        "arithmetic: x + size -> (x - size)",
    }
    assert {
        "and/or: a and (not b) -> (a or not b)",
        "negation: not b -> (b)",
        "swapped: f(a, b) -> (f(b, a))",
        "text: 'é' -> 'é_'",
        "statement: f(a, b) -> pass",
        "swapped: a @ b -> (b @ a)",
        "condition: a -> (not (a))",
        "statement: a.x = b -> pass",
    } <= changes(tools, "def g(a, b):\n f(a, b)\n a.x = b\n if a: return a and (not b)\n return 'é', a @ b\n")


def test_letters_that_are_looked_up_lose_one(tools: Any) -> None:
    """A letter more would change nothing."""
    found = changes(tools, "def f(a):\n    return a.kind in 'iuf' or a in ('b', 'c')\n")
    assert "text: 'iuf' -> 'iu'" in found and "text: 'iuf' -> 'iuf_'" not in found
    assert "text: 'b' -> 'b_'" in found


def test_lines_of_the_map_are_found_again_after_the_sources_changed(tools: Any, tmp_path: Path) -> None:
    before, after = tmp_path / "before.py", tmp_path / "after.py"
    before.write_text("a\nb\nc\nd\n")
    after.write_text("new\na\nb\nchanged\nd\n")
    assert tools["map"]._places(before, after) == {1: 2, 2: 3, 4: 5}
    assert tools["map"]._places(tmp_path / "nothing.py", after) == {}


def test_types_prose_and_what_has_no_effect_are_left_alone(tools: Any) -> None:
    source = '''"""Doc."""
from typing import TYPE_CHECKING, Literal
__all__ = ["f"]
if TYPE_CHECKING:
    SIZE = 3
def f(x: Literal["a", "b"] = ..., *y: "int") -> Literal[3]:
    """Doc."""
    warnings.warn("text", stacklevel=2)
    assert x == 3
    max(x, y)
'''
    assert changes(tools, source) == {
        'statement: warnings.warn("text", stacklevel=2) -> pass',
        "statement: max(x, y) -> pass",
    }


def test_a_longer_sample_begins_with_the_shorter(tools: Any, project: Path) -> None:
    files = list(tools["sampling"].all_files(project / "src"))
    sample = tools["sampling"].sample
    assert sample(project, files, 4, 7)[:2] == sample(project, files, 2, 7)
    moved = sample(project, files, 4, 7)
    (project / "src/tiny/steps.py").write_text(SOURCE.replace("def step", "LIMIT = 3\n\n\ndef step"))
    assert [m.key for m in sample(project, files, 5, 7) if "LIMIT" not in m.place] == [m.key for m in moved]
    assert len({mutant.line for mutant in sample(project, files, 9, 7)}) == 5  # lines that have mutants


def test_without_a_map_the_tests_that_name_the_module_are_tried(tools: Any, project: Path) -> None:
    mutant = tools["mutants"].mutants(SOURCE.encode(), "src/tiny/steps.py")[0]
    nothing = tools["map"].CoverageMap(project, project / "out")
    assert tools["choice"].stages(mutant, nothing, project, 10.0) == [
        ["tests/unit/test_steps.py::test_step"],
        ["tests/unit/test_steps.py"],
    ]


def run(project: Path, *words: str) -> tuple[int, str]:
    """The status and output of the script on a project."""
    done = subprocess.run(
        [sys.executable, str(SCRIPTS / "mutation_sample.py"), "--root", str(project), *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_with_a_map_gaps_survive_and_all_else_is_caught(project: Path) -> None:
    """The refusal is not tested. The sources stay as they are; a second run finds all verdicts in the file."""
    run(project, "--map", "tests/unit")
    status, output = run(project, "--count", "4", "--seed", "3")
    results = json.loads((project / "out" / "mutation" / "results.json").read_text())
    lines = {key.split(" | ")[1].split()[0]: verdict for key, verdict in results.items()}
    assert {word: verdict["status"] for word, verdict in lines.items()} == {
        "def": "caught",
        "if": lines["if"]["status"],  # `x >= 10` survives, `x <= 10` does not
        "raise": "survived",
        "return": "caught",
    }
    assert lines["return"]["test"] == "tests/unit/test_steps.py::test_step"
    assert (project / "src/tiny/steps.py").read_text() == SOURCE
    assert status == 1
    assert run(project, "--count", "4", "--seed", "3")[1].splitlines() == output.splitlines()[-2:]
    assert "-        raise ValueError" in run(project, "--count", "4", "--seed", "3", "--show", "5")[1]


@pytest.mark.slow
def test_a_map_grows_folder_by_folder(tools: Any, project: Path) -> None:
    (project / "tests/laws").mkdir()
    (project / "tests/laws/test_more.py").write_text(TESTS.replace("step(1) == 3", "step(2, 3) == 5"))
    for folder in ("tests/unit", "tests/laws"):
        run(project, "--map", folder)
    covered = tools["map"].CoverageMap(project, project / "out" / "mutation")
    assert covered.of_lines("src/tiny/steps.py", 8, 8) == {
        "tests/unit/test_steps.py::test_step",
        "tests/laws/test_more.py::test_step",
    }
