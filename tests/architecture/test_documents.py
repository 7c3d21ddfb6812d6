"""The Python blocks of README and of the docs run, the links lead somewhere, and each source file says its job."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from docs_site import execution, pages  # noqa: E402

DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
SOURCES = sorted((ROOT / "src").rglob("*.py"))


def _name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def _is_heavy(path: Path) -> bool:
    """Whether a page draws films or many pictures."""
    return path.parent.name == "gallery" or ".film(" in "".join(
        b.code for b in pages.blocks(path.read_text())
    )


def _marks(path: Path) -> list[pytest.MarkDecorator]:
    slow = [pytest.mark.slow] if _is_heavy(path) else []
    return [*slow, pytest.mark.page] if path in pages.pages() else slow


RUNS = [pytest.param(p, id=_name(p), marks=_marks(p)) for p in DOCUMENTS]


@pytest.mark.parametrize("path", RUNS)
def test_python_blocks_run_and_make_the_pictures(path: Path, tmp_path: Path) -> None:
    outputs = execution.run(path, tmp_path)
    assert not pages.missing_pictures(path, [name for output in outputs for name in output.files])


@pytest.mark.parametrize("path", DOCUMENTS, ids=_name)
def test_links_lead_somewhere(path: Path) -> None:
    assert not pages.broken_links(path)


@pytest.mark.parametrize("path", SOURCES, ids=_name)
def test_a_file_opens_with_its_job(path: Path) -> None:
    doc = ast.get_docstring(ast.parse(path.read_text()))
    assert doc, f"{path.name} has no opening sentence"
    first = doc.split("\n\n")[0]
    assert first.rstrip().endswith((".", ":", "?")), f"{path.name} opens with no sentence: {first!r}"


def test_nothing_names_this_workplace() -> None:
    forbidden = re.compile(r"(?<![A-Za-z0-9_.])/(?:tmp|work|root|home)/")
    found = [
        f"{_name(p)}: {line.strip()}"
        for p in [*SOURCES, *DOCUMENTS, *(ROOT / "tests").rglob("*.py"), *(ROOT / "benchmarks").rglob("*.py")]
        for line in p.read_text().splitlines()
        if forbidden.search(line) and p != Path(__file__)
    ]
    assert not found


def test_the_page_of_the_compiler_lists_its_files() -> None:
    folder = ROOT / "src/ulna/compiler"
    listed = set(re.findall(r"`(?:\w+/)*(\w+\.py)`", (ROOT / "docs/compiler.md").read_text()))
    files = {path.name for path in folder.rglob("*.py")} - {"__init__.py"}
    assert files <= listed, f"docs/compiler.md does not list {sorted(files - listed)}"
    known = {path.name for path in (ROOT / "src/ulna").rglob("*.py")}
    known |= {
        path.name for part in ("tests", "benchmarks", "scripts") for path in (ROOT / part).rglob("*.py")
    }
    assert listed <= known, f"docs/compiler.md lists {sorted(listed - known)}, which are not there"


def test_the_map_of_the_packages_names_every_layer() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    tower = settings["tool"]["importlinter"]["contracts"][0]["layers"]
    layers = {name for layer in tower for name in re.findall(r"\w+", layer)}
    page = (ROOT / "docs/architecture.md").read_text().split("## How data flows")[0]
    assert layers <= set(re.findall(r"`(\w+)`", page))
