"""What people who come from other libraries try first: each is answered with the call that does it."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, UlnaError

R = ulna.load("panda", visuals="simple")
Q = R.configurations["qr"]
T = ulna.SE3.from_matrix(R.fk(Q))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: ulna.load(R), "is of type Robot, loaded already"),
        (lambda: ulna.load(R.model), r"ulna.Robot\(model\) makes a Robot of a Model"),
        (
            lambda: ulna.load("panda", floating=True),
            r"load\(\) has no argument `floating`. Did you mean `root`",
        ),
        (lambda: ulna.load("panda", base=np.eye(4)), "Did you mean `root`"),
        (lambda: ulna.load("panda", mesh_dir="."), "Did you mean `package_dirs`"),
        (lambda: ulna.load(filename="panda"), "Did you mean `name_or_path`"),
        (lambda: ulna.load_model("panda", packagedirs="."), "Did you mean `package_dirs`"),
        (lambda: ulna.load("panda", root="floating"), 'A floating base is root="free_flyer"'),
        (lambda: ulna.Robot("panda"), r"of type str; expected a Model. ulna.load\(name_or_path\)"),  # type: ignore[arg-type]
        (lambda: ulna.Robot(R), "a Robot needs no other"),  # type: ignore[arg-type]
        (lambda: ulna.compile("fk", R), r'robot.kernel\("fk"\)'),  # type: ignore[arg-type]
        (lambda: R.jacobian(Q, "local"), "'local' is a reference: write reference=\"local\""),
        (lambda: R.jacobian(Q, "world"), "'world' is a reference"),
        (lambda: R.configurations.qr, r'has no attribute \'qr\'. Write \["qr"\]'),  # type: ignore[attr-defined]
        (lambda: R.kernel("ik"), "robot.ik is a method that searches"),
        (lambda: R.kernel("collides"), "robot.collides is a method that searches"),
        (lambda: T * T, r"SE3 has no `\*`; compose and apply with `@`"),
        (lambda: T * [1.0, 2.0, 3.0], "compose and apply with `@`"),
        (lambda: T * np.eye(4), "compose and apply with `@`"),
        (lambda: np.eye(4) * T, "compose and apply with `@`"),
        (lambda: T.so3() * T.so3(), r"SO3 has no `\*`"),
        (lambda: R.model.joint_index(0), "Joints go by name: joint_names.0. is 'panda_joint1'"),  # type: ignore[arg-type]
        (lambda: R.total_mass("panda_link3"), "'panda_link3' is a link; joint 'panda_joint3' moves it"),
        (lambda: R.total_mass("panda_link0"), "'panda_link0' is a link; no joint moves it"),
        (lambda: R.total_mass("panda_hand_tcp"), "'panda_hand_tcp' is a .*; joint 'panda_joint7' moves it"),
        (lambda: R.total_mass("panda_joint8"), "That joint is fixed"),
        (lambda: R.ik(T, joints=[0, 1, 2]), "Joints go by name"),  # type: ignore[list-item]
    ],
)
def test_first_attempts_are_answered(call: Callable[[], Any], said: str) -> None:
    with pytest.raises(UlnaError, match=said):
        call()


def test_entries_of_a_pose_are_those_of_its_matrix() -> None:
    for index in ((0, 3), (slice(3), 3), 0):
        with pytest.raises(
            IndexError, match=r"An index picks from a batch, of shape \(\) here.*T.matrix\(\)"
        ):
            T[index]
    batch = ulna.SE3.stack([T, T])
    assert batch[1].is_close(T)
    with pytest.raises(IndexError, match=r"batch, of shape \(2,\) here"):
        batch[2]


def test_what_is_right_stays_as_it_was() -> None:
    configurations = R.configurations
    assert dict(pickle.loads(pickle.dumps(configurations))).keys() == dict(configurations).keys()
    assert copy.deepcopy(configurations) == configurations and copy.copy(configurations) == configurations
    assert not hasattr(configurations, "shape") and not hasattr(configurations, "qr")
    with pytest.raises(TypeError):
        T * 2.0  # type: ignore[operator]
    with pytest.raises(TypeError):
        T * ulna.Motion.zero()  # type: ignore[operator]
    assert R.jacobian(Q, "panda_hand", "local").shape == (6, 7)
    assert ulna.load("panda", root="free_flyer", visuals="simple").nv == 13


def test_a_solution_of_inverse_kinematics_is_a_goal() -> None:
    """`robot.plan(q, robot.ik(T))` raised ValueError: setting an array element with a sequence."""
    robot = ulna.load("panda", visuals="simple")
    q = robot.configurations["qr"]
    solution = robot.ik(ulna.SE3.pointing_down((0.4, 0.2, 0.3)))
    plan = robot.plan(q, solution)
    assert plan
    np.testing.assert_allclose(plan.points[-1], solution.q)
    with pytest.raises(InputError, match="no configuration"):
        robot.plan(q, robot.ik(ulna.SE3(4.0, 0.2, 0.3)))
    with pytest.raises(InputError, match="expected a World"):
        robot.plan(q, q, [1])


def test_a_robot_that_was_not_loaded_is_no_mesh() -> None:
    viewer = ulna.Viewer(page=False)
    for path in ("panda", "arm.urdf"):
        with pytest.raises(InputError, match=rf"viewer\.add\(ulna\.load\('{path}'\)\)"):
            viewer.add(path)
    with pytest.raises(InputError, match=r"table\.stl"):
        viewer.add("table.stl")


def test_a_missing_mesh_is_reported_once(tmp_path: Path) -> None:
    from ulna.diagnosis import diagnose

    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="arm"><link name="base"><visual><geometry><mesh filename="package://arm/base.stl"/></geometry>'
        '</visual></link><link name="tip"/><joint name="j" type="continuous"><parent link="base"/><child link="tip"/>'
        '<axis xyz="0 0 1"/></joint></robot>'
    )
    assert sum("base.stl" in f.message for f in diagnose(file)) == 1
