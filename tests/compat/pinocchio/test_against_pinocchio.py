"""Ulna's package answers what Pinocchio answers: the same lines are run on both, each in its own interpreter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.two_pythons import both
from ulna.robots.example_robot_data import share_folder

ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", ""),
    "panda": ("panda_description/urdf/panda.urdf", "", ""),
    "panda, fingers coupled": ("panda_description/urdf/panda.urdf", "", "mimic"),
    "kinova": ("kinova_description/robots/kinova.urdf", "", ""),
    "ur5 in the plane": ("ur_description/urdf/ur5_robot.urdf", "Planar", ""),
    "solo12": ("solo_description/robots/solo12.urdf", "FreeFlyer", ""),
}
SLOW = ("panda", "ur5 in the plane")
SECOND = "double_pendulum_description/urdf/double_pendulum.urdf"


def _compare(tmp_path: Path, *words: str, script: str = "asked.py") -> None:
    own, wanted = both(Path(__file__).parent / script, tmp_path, *words)
    assert list(own) == list(wanted)
    wrong = [line for line in wanted if not _same(own[line], wanted[line])]
    assert not wrong


def _same(own: object, wanted: object) -> bool:
    if isinstance(wanted, str) or (isinstance(wanted, list) and wanted and isinstance(wanted[0], str)):
        return own == wanted
    if isinstance(wanted, list) and wanted and isinstance(wanted[0], list):
        assert isinstance(own, list)
        return len(own) == len(wanted) and all(_same(a, b) for a, b in zip(own, wanted, strict=True))
    a, b = np.asarray(own, dtype=float), np.asarray(wanted, dtype=float)
    return a.shape == b.shape and bool(
        np.abs(a - b).max(initial=0.0) <= 1e-9 * max(1.0, np.abs(b).max(initial=0.0))
    )


def test_displacements_motions_forces_inertias(tmp_path: Path) -> None:
    _compare(tmp_path, "spatial")


@pytest.mark.parametrize("robot", [pytest.param(r, marks=[pytest.mark.slow] * (r in SLOW)) for r in ROBOTS])
def test_models_and_algorithms(robot: str, tmp_path: Path) -> None:
    file, root, mimic = ROBOTS[robot]
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    _compare(tmp_path, "robot", *(str(share / "robots" / file), root, mimic, str(share / "robots" / SECOND)))


@pytest.mark.parametrize("robot", ["ur5", pytest.param("solo12", marks=pytest.mark.slow)])
def test_what_algorithms_leave_in_a_data(robot: str, tmp_path: Path) -> None:
    file, root, _ = ROBOTS[robot]
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    _compare(tmp_path, str(share / "robots" / file), root, script="asked_left.py")


def test_rarer_names_and_members(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    arm, humanoid = (share / "robots" / name for name in ("ur_description", "simple_humanoid_description"))
    words = [arm / "urdf" / "ur5_robot.urdf", arm / "srdf" / "ur5.srdf", share.parent]
    words += [humanoid / "urdf" / "simple_humanoid.urdf", humanoid / "srdf" / "simple_humanoid.srdf"]
    _compare(tmp_path, *(str(word) for word in words), script="asked_names.py")


def test_geometries_of_files_and_of_models_put_together(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    arm, humanoid = (share / "robots" / name for name in ("ur_description", "simple_humanoid_description"))
    words = [arm / "urdf" / "ur5_robot.urdf", arm / "srdf" / "ur5.srdf", share.parent]
    words += [humanoid / "urdf" / "simple_humanoid.urdf"]
    _compare(tmp_path, *(str(word) for word in words), script="asked_geometry.py")


def test_arguments_by_name(tmp_path: Path) -> None:
    _compare(tmp_path, script="asked_by_name.py")


def test_members_answer_and_refuse_as_in_pinocchio(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    arm = share / "robots" / "ur_description"
    words = [arm / "urdf" / "ur5_robot.urdf", arm / "srdf" / "ur5.srdf", share.parent]
    _compare(tmp_path, *(str(word) for word in words), script="asked_members.py")
