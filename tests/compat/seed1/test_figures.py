"""Ulna's package has the recorded figures of Pinocchio 4.1 to their digits, through RobotWrapper and its algorithms."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ulna.robots.example_robot_data import share_folder

HERE = Path(__file__).parent
SHARE = share_folder()


@pytest.mark.skipif(SHARE is None, reason="example-robot-data is not installed")
def test_the_recorded_figures_of_three_robots(tmp_path: Path) -> None:
    table, out = HERE / "figures.json", tmp_path / "found.json"
    words = [str(HERE / "figures_of.py"), str(table), str(out), str(SHARE)]
    done = subprocess.run(
        [sys.executable, "-m", "ulna", "run", *words],
        env={**os.environ, "ULNA_HEADLESS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    expected, found = (json.loads(p.read_text(encoding="utf-8")) for p in (table, out))
    assert set(expected) == {"ur5", "panda", "solo12"}
    for name, figures in expected.items():
        for key in ("sizes", "names", "parents", "visual_names", "collision_names"):
            assert found[name][key] == figures[key], f"{name}: {key}"
        for key in ("total_mass", "neutral"):
            _same(found[name][key], figures[key], f"{name}: {key}")
        for own, wanted in zip(found[name]["configs"], figures["configs"], strict=True):
            for key in sorted(set(wanted) - {"q", "v", "a", "tau"}):
                _same(own[key], wanted[key], f"{name}: {key}")


def _same(own: Any, wanted: Any, what: str) -> None:
    if isinstance(wanted, dict):
        assert set(own) == set(wanted), what
        for key in wanted:
            _same(own[key], wanted[key], f"{what}: {key}")
    elif isinstance(wanted, list) and wanted and isinstance(wanted[0], dict):
        for k, (a, b) in enumerate(zip(own, wanted, strict=True)):
            _same(a, b, f"{what}[{k}]")
    else:
        size = max(1.0, float(np.abs(wanted).max()))
        np.testing.assert_allclose(own, wanted, rtol=1e-10, atol=1e-11 * size, err_msg=what)
