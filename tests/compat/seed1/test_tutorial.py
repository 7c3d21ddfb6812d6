"""Every script of the seed tutorial runs to its end without a screen, in historic and in today's spelling."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ulna.robots.example_robot_data import share_folder

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
pytest.importorskip("trimesh", reason="trimesh, which reads meshes, is not installed")
if share_folder() is None:
    pytest.skip("example-robot-data is not installed", allow_module_level=True)

SCRIPTS = sorted((Path(__file__).parents[3] / "examples" / "seed-1").glob("*/[0-9]*.py"))


def run(script: Path, folder: Path, **variables: str) -> str:
    """What a script says, run as a user runs it."""
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-m", "ulna", "run", str(script)],
        env={**os.environ, "ULNA_HEADLESS": "1", **variables},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_the_script_runs_to_its_end(script: Path, tmp_path: Path) -> None:
    said = run(script, tmp_path)
    match script.stem[0]:
        case "1":
            assert "Columns 0 through 5" in said and "R =" in said
        case "2":
            assert "shoulder_lift_joint" in said and "p =" in said
        case "3":
            assert "wrist_1_link_0 world/pinocchio/visuals/wrist_1_link_0" in said
            assert "'world/sphere'" in said
        case "4":
            assert "reached [0.5 0.1 0.2]" in said and "p = 0.35  0.2  0.3" in said
        case "5":
            assert "gap 0.0" in said
    if script.stem[0] in "345":
        (picture,) = tmp_path.glob("*.png")
        assert picture.stat().st_size > 10_000


def test_there_are_five_scripts_in_both_spellings() -> None:
    assert [p.name for p in SCRIPTS if p.parent.name == "today"] == [
        p.name for p in SCRIPTS if p.parent.name == "historic"
    ]
    assert len(SCRIPTS) == 10
