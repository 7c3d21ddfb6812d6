"""Every damaged document is read and computed with, or refused with an error of Ulna: no hang, crash or other exception.

`python -m fuzz.run` (in tests/) runs one reader for longer, or with another seed.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from fuzz.readers import MESHES, NAMES

COUNTS = {"urdf": 150, "xacro": 80, "mjcf": 200, "srdf": 150, "dh": 100, "ets": 100}


def run(name: str, count: int, folder: Path) -> None:
    command = [sys.executable, "-m", "fuzz.run", name, f"--count={count}", f"--keep={folder}"]
    try:
        done = subprocess.run(
            command, cwd=Path(__file__).parents[1], capture_output=True, text=True, timeout=600, check=False
        )
    except subprocess.TimeoutExpired as late:
        pytest.fail(f"it never ended: {(late.stderr or b'')[-200:]!r}, in {folder}")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    assert (
        "'read'" in done.stdout and "'refused'" in done.stdout
    )  # the documents are neither all sound nor all hopeless


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_many_damaged_documents(name: str, tmp_path: Path) -> None:
    if name == "xacro":
        pytest.importorskip("xacro")
    if name == "mjcf":
        pytest.importorskip("mujoco")
    if name in MESHES:
        pytest.importorskip("trimesh")
    if name == "dae":
        pytest.importorskip("collada")
    run(name, COUNTS.get(name, 300), tmp_path)
