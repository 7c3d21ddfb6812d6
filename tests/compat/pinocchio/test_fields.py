"""No field of a Data is ever silently what it was before: each is Pinocchio's, or the truth of now, or says what to call."""

from __future__ import annotations

from pathlib import Path

import pytest
from field_judge import FieldJudge

from support.two_pythons import both
from ulna.robots.example_robot_data import share_folder

ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", ""),
    "solo12": ("solo_description/robots/solo12.urdf", "FreeFlyer", ""),
    "panda": ("panda_description/urdf/panda.urdf", "", ""),
    "panda, fingers coupled": ("panda_description/urdf/panda.urdf", "", "mimic"),
}


@pytest.mark.parametrize(
    ("robot", "used"),
    [
        ("ur5", "everything"),
        pytest.param(
            "solo12", "everything", marks=pytest.mark.slow
        ),  # on a free flyer; another arm would show the same
        pytest.param("panda, fingers coupled", "nothing", marks=pytest.mark.slow),
        pytest.param("ur5", "each", marks=pytest.mark.slow),
    ],
)
def test_no_field_is_silently_what_it_was(robot: str, used: str, tmp_path: Path) -> None:
    file, root, mimic = ROBOTS[robot]
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    own, real = both(
        Path(__file__).parent / "asked_fields.py", tmp_path, str(share / "robots" / file), root, mimic, used
    )
    judge = FieldJudge(own["after"], real["after"], real["truths"], bool(mimic))
    faults = {asked: found for asked in own["after"] if (found := judge.faults(asked))}
    assert not faults
    left_out = {"fresh"} if used == "each" else set()
    assert own["after"].keys() == {x for x in real["after"] if x.split(" | ")[0] not in left_out}
    assert judge.compared > 2000
