"""RobotWrapper, geometries, SRDF and collisions answer as real Pinocchio's do; visualizers draw what they say."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.two_pythons import variables
from ulna.compat.packages import FOLDERS
from ulna.robots.example_robot_data import share_folder

HERE = Path(__file__).parent
SHARE = share_folder()
pytestmark = pytest.mark.skipif(SHARE is None, reason="example-robot-data is not installed")


def run(script: Path, *words: str, faced: bool = True) -> None:
    done = subprocess.run(
        [sys.executable, str(script), *words],
        env=variables("pinocchio" if faced else None, ULNA_HEADLESS="1"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_the_wrapper_and_its_geometries_answer_as_real_ones(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    answers = []
    for faced in (True, False):
        out = tmp_path / f"{faced}.json"
        run(HERE / "wrapper_asked.py", str(out), str(SHARE), faced=faced)
        said = json.loads(out.read_text(encoding="utf-8"))
        assert (str(FOLDERS["pinocchio"]) in said["file"]) == faced
        answers.append(said["found"])
    own, wanted = answers
    wrong = [f"{r}: {k}" for r in wanted for k in wanted[r] if not _same(own[r][k], wanted[r][k])]
    assert not wrong


def _same(own: Any, wanted: Any) -> bool:
    if isinstance(wanted, dict):
        return list(own) == list(wanted) and all(_same(own[k], wanted[k]) for k in wanted)
    if isinstance(wanted, list):
        return len(own) == len(wanted) and all(_same(a, b) for a, b in zip(own, wanted, strict=True))
    if isinstance(wanted, float):
        return bool(np.isclose(own, wanted, rtol=1e-9, atol=1e-9))
    return own == wanted


@pytest.mark.parametrize("script", sorted(HERE.glob("drawn_*.py")), ids=lambda p: p.stem)
def test_what_is_drawn(script: Path, tmp_path: Path) -> None:
    pytest.importorskip("viser")
    pytest.importorskip("trimesh")
    run(script, str(SHARE), str(tmp_path))
