"""Which closed form is seen in which arm."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from support.random_arms import CLOSED, GENERAL, model_of, redundant
from ulna.errors import InputError, UnknownName
from ulna.ik.analytic import Arm, arm_geometries, arm_of
from ulna.ik.analytic.chain import movable, usual
from ulna.model import Composite, Model, ModelBuilder, Revolute
from ulna.spatial import SE3


def _arm(model: Model) -> Arm:
    end = model.frame(model.tool)
    return arm_of(model, end, movable(model, end)[-7:], model.neutral)


@pytest.mark.parametrize("name", CLOSED)
def test_special_axes_are_seen_wherever_they_stand(name: str) -> None:
    rng = np.random.default_rng(1)
    best = arm_geometries(_arm(model_of(CLOSED[name](rng), rng)))[0]
    assert best.triple in name
    easy = any(word in name for word in ("meets", "2 parallel 3", "1 parallel 2"))
    assert (best.pair != "general") == easy


@pytest.mark.parametrize("name", [n for n in GENERAL if n != "quarter turns"])
def test_no_closed_form_is_seen_where_there_is_none(name: str) -> None:
    rng = np.random.default_rng(2)
    assert arm_geometries(_arm(model_of(GENERAL[name](rng), rng))) == []


def test_the_pose_is_the_product_of_exponentials() -> None:
    robot = ulna.load("panda")
    arm = _arm(robot.model)
    q = robot.random_configuration(seed=3)
    T = arm.base(q)
    for axis in arm.axes:
        T = T @ axis.move(axis.scale * q[axis.index] + axis.offset)
    assert np.allclose((T @ arm.end).matrix(), robot.fk(q), atol=1e-14)


def test_methods_of_known_arms() -> None:
    ur5, panda = ulna.load("ur5"), ulna.load("panda")
    assert (
        arm_geometries(_arm(ur5.model))[0]
        .describe(_arm(ur5.model).names)
        .startswith("three parallel axes: shoulder_lift")
    )
    best = arm_geometries(_arm(panda.model))[0]
    assert (best.free, best.triple, best.pair) == (6, "spherical", "intersecting")
    assert {geometry.free for geometry in arm_geometries(_arm(panda.model), 3)} == {3}


def test_a_slide_among_seven_joints_is_the_one_to_hold() -> None:
    arm = _arm(redundant("PRRRRRR", np.random.default_rng(0)))
    assert {geometry.free for geometry in arm_geometries(arm)} == {0}
    assert arm_geometries(_arm(redundant("PPRRRRR", np.random.default_rng(0)))) == []


def test_axes_that_are_nearly_special_are_used_and_say_how_far_they_are_off() -> None:
    rng = np.random.default_rng(4)
    lines = CLOSED["spherical wrist, 2 parallel 3"](rng)
    lines[4] = (lines[4][0], lines[4][1] + 3e-6)
    best = arm_geometries(_arm(model_of(lines, rng)))[0]
    assert 1e-8 < best.deviation < 1e-5
    lines[4] = (lines[4][0], lines[4][1] + 1e-3)
    assert arm_geometries(_arm(model_of(lines, rng))) == []


def test_joints_that_do_not_move_the_frame_are_refused_by_name() -> None:
    robot = ulna.load("ur5")
    end = robot.model.frame(robot.tool)
    with pytest.raises(UnknownName, match="elbow_joint"):
        arm_of(robot.model, end, ["elbow_join"], robot.neutral)
    with pytest.raises(InputError, match="No joint moves"):
        arm_of(robot.model, end, [], robot.neutral)


def test_the_finger_of_a_gripper_is_not_among_the_usual_joints() -> None:
    model = redundant("RRRRRRRP", np.random.default_rng(0))
    assert usual(model, model.frame("tip")) == tuple(f"joint{i}" for i in range(1, 8))
    model = redundant("PRRRRRR", np.random.default_rng(0))
    assert usual(model, model.frame("tip")) == tuple(f"joint{i}" for i in range(1, 8))


def test_usual_joints_are_counted_by_coordinates() -> None:
    """Two joints that mimic others come on top of six."""
    b = ModelBuilder("m").add_link("base")
    for k in range(8):
        b.add_link(f"link{k}")
        mimic = {2: ("1", 0.5, 0.0), 4: ("3", 1.0, 0.0)}.get(k)
        parent = f"link{k - 1}" if k else "base"
        b.add_joint(
            str(k), Revolute((k % 2, 1.0, 0.3 * k)), parent, f"link{k}", SE3.trans(0.1, 0.0, 0.2), mimic=mimic
        )
    robot = ulna.Robot(b.set_tool("link7").build())
    assert usual(robot.model, robot.model.frame("link7")) == tuple("01234567")
    q = np.array([0.3, -0.4, 0.5, 0.2, -0.6, 0.1])
    assert np.abs(robot.ik_all(robot.fk(q)).q - q).max(axis=1).min() < 1e-6
    two = Composite((Revolute(), Revolute((1.0, 0.0, 0.0))))
    b = ModelBuilder("c").add_link("base")
    for k in range(7):
        b.add_link(f"link{k}")
        parent = f"link{k - 1}" if k else "base"
        b.add_joint(str(k), Revolute() if k else two, parent, f"link{k}", SE3.trans(0.1, 0.0, 0.2))
    model = b.build()
    assert usual(model, model.frame("link6")) == tuple("123456")


def test_mimic_joints_follow_in_the_chain() -> None:
    b = ModelBuilder("m")
    for name in ("a", "b", "c"):
        b.add_link(name)
    b.add_joint("first", Revolute((0, 0, 1)), "a", "b", SE3.trans(0, 0, 1), lower=-1, upper=1)
    b.add_joint("second", Revolute((0, 1, 0)), "b", "c", SE3.trans(1, 0, 0), mimic=("first", 2.0, 0.1))
    model = b.build()
    arm = arm_of(model, model.frame("c"), ["first"], model.neutral)
    assert arm.names == ("first", "second") and not arm.is_independent
    assert (arm.axes[1].scale, arm.axes[1].offset) == (2.0, 0.1)
