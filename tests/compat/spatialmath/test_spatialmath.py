"""spatialmath under `ulna run` is the package itself, imported without what it seldom needs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ulna.compat.packages import FOLDERS

pytest.importorskip("spatialmath")
TYPICAL = Path(__file__).with_name("typical.py")


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *command],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
        env={
            **os.environ,
            "MPLBACKEND": "Agg",
            "PYTHONWARNINGS": "ignore::SyntaxWarning",
        },  # its escapes, since 3.12
    )


def test_typical_scripts_print_the_same() -> None:
    plain, worn = run(str(TYPICAL)), run("-m", "ulna", "run", str(TYPICAL))
    assert plain.returncode == worn.returncode == 0, worn.stderr
    assert worn.stdout == plain.stdout and len(plain.stdout) > 10_000
    assert worn.stderr.strip() == "", "importing spatialmath brought what it seldom needs"


def test_notebooks_that_have_it_keep_it() -> None:
    code = """
import spatialmath, ulna.faces
before = spatialmath.SE3
ulna.compat.use("roboticstoolbox")
import roboticstoolbox as rtb
from spatialmath import SE3
panda = rtb.models.Panda()
assert SE3 is before and type(panda.fkine(panda.qr)) is SE3
"""
    done = run("-c", code)
    assert done.returncode == 0, done.stderr


def test_where_it_is_not_installed_it_says_so() -> None:
    code = f"import ulna.faces, sys; sys.path[:] = [{str(FOLDERS['roboticstoolbox'])!r}]; import spatialmath"
    done = run("-c", code)
    assert "ModuleNotFoundError: spatialmath is not installed; it comes with: pip install " in done.stderr
