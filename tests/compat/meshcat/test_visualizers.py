"""MeshCat's tree, viser's server and geometries of coal, as programs that use visualizers see them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from support.two_pythons import variables

HERE = Path(__file__).parent


def run(script: str) -> None:
    done = subprocess.run(
        [sys.executable, str(HERE / script)],
        env=variables("pinocchio", ULNA_HEADLESS="1"), capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_the_tree_of_objects() -> None:
    pytest.importorskip("trimesh")
    run("tree_of_objects.py")


def test_the_server_of_viser() -> None:
    pytest.importorskip("viser")
    run("server_of_viser.py")


def test_geometries_of_coal() -> None:
    pytest.importorskip("coal")
    run("geometries_of_coal.py")
