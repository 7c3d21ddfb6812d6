"""The Python blocks of README and of the docs run, the links lead somewhere, and each source file says its job."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")])
SOURCES = sorted((ROOT / "src").rglob("*.py"))


def _name(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", DOCUMENTS, ids=_name)
def test_python_blocks_run(
    path: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # where blocks may write files
    blocks = re.findall(r"```python\n(.*?)```", path.read_text(), re.S)
    scope: dict[str, object] = {}
    for number, block in enumerate(blocks):
        exec(compile(block, f"{path.name} block {number + 1}", "exec"), scope)


@pytest.mark.parametrize("path", DOCUMENTS, ids=_name)
def test_links_lead_somewhere(path: Path) -> None:
    links = re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", path.read_text())
    missing = [link for link in links if "://" not in link and not (path.parent / link).exists()]
    assert not missing


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
