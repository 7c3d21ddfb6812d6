"""Each joint moves through its range, one after the other; sliders read and write single numbers."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.viewer.robot.joint_sweep import joint_sweep
from ulna.viewer.robot.slider_coordinates import slider_coordinates

URDF = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="r_slide" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-0.1" upper="0.05" effort="1" velocity="1"/></joint>
<joint name="r_turn" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint>
<joint name="r_bend" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 1 0"/>
<limit lower="-4" upper="1" effort="1" velocity="1"/></joint></robot>"""


def robot(text: str = URDF) -> ulna.Robot:
    return ulna.load(text)


def test_every_joint_goes_four_fifths_of_the_way_to_its_limits_and_back() -> None:
    start = np.array([0.0, 0.5, -0.5])
    sweep = joint_sweep(robot(), start)
    assert len(sweep) == 3 * 40 + 1
    np.testing.assert_allclose(np.diff(sweep.t), 1 / 25)
    assert sweep.t[0] == 0.0 and sweep.duration == pytest.approx(3 * 1.6)
    np.testing.assert_array_equal(sweep.q[-1], start)
    for joint in range(3):
        part = sweep.q[40 * joint : 40 * joint + 40]
        others = [k for k in range(3) if k != joint]
        np.testing.assert_array_equal(part[:, others], np.tile(start[others], (40, 1)))
        np.testing.assert_allclose(part[[0, 20]], [start, start], atol=1e-12)
        reach_up = (0.05, np.pi / 2, 1.5)[joint]
        reach_down = (0.1, np.pi / 2, np.pi / 2)[joint]
        assert part[10, joint] == pytest.approx(start[joint] + 0.8 * reach_up)
        assert part[30, joint] == pytest.approx(start[joint] - 0.8 * reach_down)


def test_beyond_a_limit_it_stays_where_it_is_on_that_side() -> None:
    q = np.array([0.2, 0.0, 0.0])  # the first is above its limit
    assert joint_sweep(robot(), q).q[:20, 0].max() <= 0.2


def test_many_joints_share_fourteen_seconds_and_none_rest_for_one() -> None:
    links = "".join(f'<link name="l{k}"/>' for k in range(41))
    joints = "".join(
        f'<joint name="j{k}" type="continuous"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(40)
    )
    many = robot(f'<robot name="m">{links}{joints}</robot>')
    assert joint_sweep(many, np.zeros(40)).duration == pytest.approx(40 * 9 / 25)
    none = robot('<robot name="n"><link name="a"/></robot>')
    rest = joint_sweep(none, np.zeros(0))
    np.testing.assert_array_equal(rest.t, [0.0, 1.0])


def test_sliders_have_labels_limits_and_steps() -> None:
    slide, turn, bend = slider_coordinates(robot())
    assert [c.label for c in (slide, turn, bend)] == ["slide [m]", "turn [rad]", "bend [rad]"]
    assert (slide.low, slide.high, slide.step) == (-0.1, 0.05, pytest.approx(0.15 / 500))
    assert (turn.low, turn.high, turn.step) == (-np.pi, np.pi, 0.001)
    assert slide.hint.endswith("-0.1 to 0.05 m")
    assert turn.hint.endswith("no limits")
    assert bend.hint.endswith("-229° to 57°")
    q = np.array([0.01, 0.02, 0.03])
    assert [c.read(q) for c in (slide, turn, bend)] == [0.01, 0.02, 0.03]
    np.testing.assert_array_equal(slide.write(q, 9.0), (0.05, 0.02, 0.03))
    np.testing.assert_array_equal(turn.write(q, 9.0), (0.01, 9.0, 0.03))
    np.testing.assert_array_equal(q, (0.01, 0.02, 0.03))


def test_a_joint_without_range_still_has_a_slider() -> None:
    stuck = slider_coordinates(robot(URDF.replace('"0.05"', '"-0.1"')))[0]
    assert (stuck.low, stuck.high, stuck.step) == (-0.1, pytest.approx(-0.1 + 1e-6), 1e-6)
    assert stuck.high > stuck.low


def test_rotations_have_angles() -> None:
    free = ulna.load(URDF.replace('type="continuous"', 'type="floating"'))
    labels = [c.label for c in slider_coordinates(free)]
    assert len(labels) == 1 + 6 + 1
    roll, pitch, yaw = (c for c in slider_coordinates(free) if c.hint.endswith("of its rotation"))
    assert [c.label for c in (roll, pitch, yaw)] == ["turn roll [rad]", "turn pitch [rad]", "turn yaw [rad]"]
    assert [c.high for c in (roll, pitch, yaw)] == [np.pi, np.pi / 2, np.pi]
    q = free.model.neutral.copy()
    for coordinate, value in ((roll, 0.3), (pitch, -0.4), (yaw, 1.2)):
        q = coordinate.write(q, value)
    assert [c.read(q) for c in (roll, pitch, yaw)] == pytest.approx([0.3, -0.4, 1.2])
    c, s = np.cos, np.sin
    x = np.asarray(free.fk(q, "c"))[:3, 0]
    np.testing.assert_allclose(x, (c(1.2) * c(-0.4), s(1.2) * c(-0.4), -s(-0.4)), atol=1e-12)
