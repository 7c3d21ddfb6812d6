"""The commands that install optional dependencies: they name what pyproject.toml requires, and every caller's package."""

from __future__ import annotations

import ast
import re
import shlex
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

from ulna.errors import MissingExtra
from ulna.extras import install_command, requirements

ROOT = Path(__file__).resolve().parents[2]
EXTRAS: dict[str, list[str]] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"][
    "optional-dependencies"
]


def named(requirement: str) -> str:
    match = re.match(r"[\w.-]+", requirement)
    assert match
    return match[0].lower().replace("_", "-")


def parts(requirement: str) -> tuple[str, frozenset[str]]:
    """A requirement, whatever the order of its conditions."""
    head = re.match(r"[\w.-]+(\[.*?\])?", requirement)
    assert head
    return head[0].lower(), frozenset(requirement[head.end() :].replace(" ", "").split(","))


@pytest.mark.parametrize("extra", [name for name in EXTRAS if name != "all"])
def test_the_command_names_what_the_extra_requires(extra: str) -> None:
    words = shlex.split(install_command(extra, "nothing"))
    assert words[:2] == ["pip", "install"]
    assert {parts(w) for w in words[2:]} == {parts(r) for r in EXTRAS[extra]}
    if extra not in ("docs", "torch", "jax", "cuda", "parquet"):  # builds the site, which users do not; large
        assert {parts(r) for r in requirements("all")} >= {parts(r) for r in EXTRAS[extra]}


def test_without_metadata_the_package_stands_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    assert install_command("no-such-extra", "viser") == "pip install viser"

    def none(_: str) -> list[str]:
        raise metadata.PackageNotFoundError("ulna")

    monkeypatch.setattr(metadata, "requires", none)
    assert install_command("viewer", "viser") == "pip install viser"
    monkeypatch.setattr(metadata, "requires", lambda _: None)
    assert requirements("viewer") == ()


def test_every_missing_package_is_in_the_extra_that_is_named() -> None:
    calls = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            name = getattr(getattr(node, "func", None), "id", "")
            if isinstance(node, ast.Call) and name in ("MissingExtra", "needed", "install_command"):
                words = [a.value if isinstance(a, ast.Constant) else None for a in node.args[:2]]
                calls.append((path.name, *(words[::-1] if name == "install_command" else words)))
    assert len(calls) > 25
    for file, package, extra in calls:
        if extra is not None:
            required = {named(r) for r in EXTRAS[str(extra)]}
            assert package is None or str(package).lower() in required, (file, package, extra)


def test_no_message_asks_for_ulna_itself() -> None:
    """`pip install ulna[...]` works only once Ulna is in a package index."""
    wrong = [
        p for p in (ROOT / "src").rglob("*.py") if re.search(r"pip install .?ulna\[|ulna\[", p.read_text())
    ]
    assert [p.name for p in wrong] in ([], ["extras.py"])


def test_the_message() -> None:
    error = MissingExtra("viser", "viewer", "The page in the browser")
    assert str(error).startswith(
        "The page in the browser needs the package 'viser'. Install it with: pip install 'viser"
    )
    assert (error.package, error.extra) == ("viser", "viewer")


COMPARED = {"roboticstoolbox", "spatialmath", "spatialgeometry", "swift", "pinocchio", "coal", "meshcat"}
"""Packages whose scripts `ulna run` runs without them, or that pages name beside ours."""

HEAVY = {"torch", "jax"}
"""Gigabytes: each has a separate extra."""


def imported_by_documents() -> dict[str, str]:
    """The packages that code in the documents and examples imports, each with one place."""
    out: dict[str, str] = {}
    blocks = [(p.name, p.read_text()) for p in (ROOT / "examples").glob("*.py")]
    for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]:
        blocks += [(page.name, b) for b in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)]
    for place, code in blocks:
        for name in re.findall(
            r"^\s*(?:from|import) ([a-zA-Z_]\w*)[\w.]*(?: import| as|$)", code, re.MULTILINE
        ):
            out.setdefault(name, place)
    return out


def test_all_installs_what_the_documents_import() -> None:
    """Pages imported SymPy, which `pip install '.[all]'` did not bring."""
    distributions = metadata.packages_distributions()
    extras = set(re.findall(r"[\w-]+", EXTRAS["all"][0].partition("[")[2]))
    brought = {named(r) for extra in extras for r in EXTRAS[extra]} | {"numpy", "llvmlite", "lxml", "ulna"}
    for name, place in imported_by_documents().items():
        if name in sys.stdlib_module_names | COMPARED | HEAVY or (ROOT / "examples" / f"{name}.py").exists():
            continue
        homes = {d.lower().replace("_", "-") for d in distributions.get(name, [name])}
        assert homes & brought, f"{place} imports {name}, which the extra `all` does not bring"
