"""The Toolbox's console runs as a module, and each of its options has its effect."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from ulna.compat.packages import environment

pytest.importorskip("spatialmath")


def _console(*arguments: str, typed: str = "") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "roboticstoolbox.bin.rtbtool", *arguments]
    env = environment(["roboticstoolbox"]) | {"MPLBACKEND": "agg"}
    return subprocess.run(
        command, input=typed, env=env, capture_output=True, text=True, timeout=600, check=False
    )


def test_a_script_then_what_is_typed(tmp_path: Path) -> None:
    script = tmp_path / "lab.py"
    script.write_text("arm = models.DH.Puma560()\n")
    typed = "print(arm.n, arm.fkine(arm.qz).t[0] > 0, rtb.Robot([Link(ET.Rz())]).default_backend)\n"
    done = _console("--swift", "--prompt", "lab: ", str(script), typed=typed)
    assert (
        "6 True swift" in done.stdout and "lab: " in done.stdout and "Robotics Toolbox on Ulna" in done.stderr
    )


def test_help_and_unknown_options() -> None:
    shown, refused = _console("--help"), _console("--ansi")
    assert shown.returncode == 0 and "--no-banner" in shown.stdout
    assert refused.returncode == 2 and "--ansi" in refused.stderr
