"""The public names: all there, one home each, documented, and light to import."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import ulna
import ulna.algorithms

HEAVY = (
    "viser",
    "trimesh",
    "matplotlib",
    "scipy",
    "xacro",
    "ulna.viewer",
    "dask",
    "distributed",
    "zarr",
    "xarray",
    "sympy",
    "torch",
    "jax",
    "ulna.compiler.language",
    "ulna.compiler.runtime",
    "ulna.algorithms.dynamics.crba",
    "ulna.algorithms.kinematics",
    "ulna.recursions",
    "hashlib",
    "multiprocessing",
    "queue",
    "subprocess",
    "llvmlite",
    "urllib.request",
    "ssl",
)


@pytest.mark.parametrize("name", ulna.__all__)
def test_every_name_is_there_and_documented(name: str) -> None:
    value = getattr(ulna, name)
    assert name.startswith("__") or inspect.getdoc(value), f"ulna.{name} has no docstring"
    assert not inspect.ismodule(value) or name in ("errors", "numeric")


@pytest.mark.parametrize(
    "room",
    [
        "collision",
        "compat",
        "control",
        "diagnosis",
        "exporting",
        "faces",
        "identification",
        "ik",
        "scale",
        "sim",
        "trajectory",
        "viewer",
    ],
)
def test_rooms_open_when_asked_for(room: str) -> None:
    script = f"import ulna; print(ulna.{room}.__doc__.splitlines()[0])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stdout.strip(), done.stderr


def test_there_are_few_names() -> None:
    assert len(ulna.__all__) <= 30
    assert len(set(ulna.__all__)) == len(ulna.__all__)


def test_importing_ulna_imports_nothing_heavy() -> None:
    script = f"import sys, ulna; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_importing_ulna_imports_few_files() -> None:
    """On top of NumPy: each takes 0.1 ms and more. What only some programs need is imported when it is first used."""
    script = (
        "import sys, numpy; before = set(sys.modules); import ulna; print(*sorted(set(sys.modules) - before))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    imported = sorted(set(done.stdout.split()) - set(sys.builtin_module_names))  # those are no files
    assert len(imported) <= 142, imported


def test_files_of_algorithms() -> None:
    """What type checkers read and what is imported when first used are the same."""
    source = ast.parse(Path(ulna.algorithms.__file__).read_text(encoding="utf-8"))
    block = next(node for node in source.body if isinstance(node, ast.If))
    for node in block.body:
        assert isinstance(node, ast.ImportFrom)
        for alias in node.names:
            home = importlib.import_module(str(node.module))
            assert getattr(ulna.algorithms, alias.name) is getattr(home, alias.name)
    assert {alias.name for node in block.body for alias in node.names} == set(dir(ulna.algorithms))  # type: ignore[attr-defined]


@pytest.mark.parametrize("kind", [ulna.Robot, ulna.Model, ulna.ModelBuilder, ulna.SE3, ulna.SO3, ulna.Motion])
def test_every_public_method_is_documented(kind: type) -> None:
    silent = [
        name
        for name, member in inspect.getmembers(kind)
        if not name.startswith("_")
        and (callable(member) or isinstance(member, property))
        and not inspect.getdoc(member)
    ]
    assert not silent
