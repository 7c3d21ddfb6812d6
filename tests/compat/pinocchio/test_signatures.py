"""Every overload of Pinocchio can be called here with the same positions, names and defaults."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from support.two_pythons import both, variables
from ulna.robots.example_robot_data import share_folder

HERE = Path(__file__).parent
FROM_AN_INDEX = "made by `createData`, which knows the joint; an empty one is of no use"
REASONS = {
    "JointDataComposite.__init__": FROM_AN_INDEX,
    "Model.existFrame": "None stands for all types",
    "Model.getFrameId": "None stands for all types",
    "computeConstraintDynamicsDerivatives": "None stands for the same settings, not made anew for each call",
    "computeImpulseDynamicsDerivatives": "None stands for the same settings, not made anew for each call",
}
"""Why a signature differs."""


def _run(script: str, real: bool, *words: str) -> None:
    command = [sys.executable, str(HERE / script), *words]
    chosen = variables(None if real else "pinocchio")
    done = subprocess.run(command, env=chosen, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr


def test_every_overload_is_taken(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    theirs, found = tmp_path / "overloads.json", tmp_path / "found.json"
    _run("overloads.py", True, str(theirs))
    _run("signatures.py", False, str(theirs), str(found))
    answers: dict[str, Any] = json.loads(found.read_text(encoding="utf-8"))
    assert answers["count"] > 1000
    assert not [each for each in answers["differences"] if each[0] not in REASONS]
    assert {path for path, *_ in answers["differences"]} == set(REASONS)  # none is listed for nothing


def test_arguments_by_position_are_those_of_pinocchio(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    robots = share / "robots"
    words = [
        robots / "ur_description/urdf/ur5_robot.urdf",
        robots / "panda_description/urdf/panda.urdf",
        share.parent,
    ]
    own, wanted = both(HERE / "asked_positions.py", tmp_path, *map(str, words))
    assert own == wanted
