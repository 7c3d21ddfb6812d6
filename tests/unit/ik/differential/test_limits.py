"""Limits, one by one: what they allow, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.errors import InputError, ShapeError, UnknownName
from ulna.ik import (
    AccelerationLimit,
    Interval,
    Limit,
    LinearTask,
    PlaneLimit,
    PositionLimit,
    PostureTask,
    Strip,
    VelocityLimit,
)
from ulna.ik.differential.limits import _limited, _speed_to_stop
from ulna.model import (
    Composite,
    Continuous,
    Model,
    ModelBuilder,
    Planar,
    Prismatic,
    Revolute,
    Universal,
)
from ulna.spatial import SE3


def chain(*joints: tuple, mimic: bool = False) -> Model:
    b = ModelBuilder("chain").add_link("link0")
    for k, (kind, options) in enumerate(joints):
        b.add_link(f"link{k + 1}")
        b.add_joint(f"joint{k}", kind, f"link{k}", f"link{k + 1}", SE3.trans(0.0, 0.0, 0.5), **options)
    if mimic:
        b.add_link("follower").add_joint(
            "follow", Revolute(), "link0", "follower", mimic=("joint0", -2.0, 0.1)
        )
    return b.build()


@pytest.fixture
def model() -> Model:
    return chain(
        (Revolute((0, 1, 0)), {"lower": -1.0, "upper": 2.0, "velocity": 3.0}),
        (Continuous(), {"velocity": 1.0}),
        (Prismatic((1, 0, 0)), {"lower": 0.0}),
        (Universal(), {"lower": (-1.0, -2.0), "upper": (1.0, 2.0)}),
        (Composite((Revolute(), Prismatic())), {"upper": (0.5, 0.6)}),
        mimic=True,
    )


Q = np.array([1.5, 20.0, 0.2, 0.5, -0.5, 0.1, 0.2])
inf = np.inf


def check(bound: Interval | Strip, lower: list, upper: list) -> None:
    assert isinstance(bound, Interval)
    np.testing.assert_allclose(bound.lower, lower, atol=1e-12)
    np.testing.assert_allclose(bound.upper, upper, atol=1e-12)


def test_position(model: Model) -> None:
    bound = PositionLimit(gain=0.5, margin=0.1).bounds(model, Q, 0.1)
    lower = np.array([-2.4, -inf, -0.1, -1.4, -1.4, -inf, -inf]) * 5.0
    upper = np.array([0.4, inf, inf, 0.4, 2.4, 0.3, 0.3]) * 5.0
    check(bound, list(lower), list(upper))


def test_position_refuses() -> None:
    with pytest.raises(InputError, match="`gain` is 0"):
        PositionLimit(gain=0.0)
    with pytest.raises(InputError, match="`margin` is -1"):
        PositionLimit(margin=-1.0)
    narrow = chain((Revolute(), {"lower": -0.1, "upper": 0.1}))
    with pytest.raises(InputError, match="leaves joint 'joint0' no range"):
        PositionLimit(margin=0.2).bounds(narrow, np.zeros(1), 0.1)
    planar = chain((Planar(), {"lower": (-1.0, -1.0, -3.0), "upper": (1.0, 1.0, 3.0)}))
    with pytest.raises(InputError, match="'joint0' is planar"):
        PositionLimit().bounds(planar, np.zeros(3), 0.1)


def test_velocity(model: Model) -> None:
    check(VelocityLimit().bounds(model, Q, 0.1), [-3, -1, *[-inf] * 5], [3, 1, *[inf] * 5])
    check(VelocityLimit().bounds(chain((Revolute(), {"velocity": 0.0})), np.zeros(1), 0.1), [-inf], [inf])
    check(VelocityLimit(0.5).bounds(model, Q, 0.1), [-0.5] * 7, [0.5] * 7)
    some = VelocityLimit({"joint1": 0.2, "joint3": (0.3, 0.4)}).bounds(model, Q, 0.1)
    check(some, [-inf, -0.2, -inf, -0.3, -0.4, -inf, -inf], [inf, 0.2, inf, 0.3, 0.4, inf, inf])
    with pytest.raises(UnknownName, match="joint1"):
        VelocityLimit({"join1": 0.2}).bounds(model, Q, 0.1)
    with pytest.raises(ShapeError, match="VelocityLimit"):
        VelocityLimit([1.0, 2.0]).bounds(model, Q, 0.1)
    with pytest.raises(InputError, match="not above 0"):
        VelocityLimit(0.0).bounds(model, Q, 0.1)


def test_acceleration(model: Model) -> None:
    v = np.array([1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    free = AccelerationLimit({"joint0": 2.0, "joint1": 3.0}, braking=False).bounds(model, Q, 0.1, v)
    check(free, [0.8, -1.3, *[-inf] * 5], [1.2, -0.7, *[inf] * 5])
    assert AccelerationLimit(1.0).inputs(model) == {"v": (7,)}
    assert AccelerationLimit(1.0, name="before").inputs(model) == {"before": (7,)}
    near = Q.copy()
    near[0] = 2.0 - 0.05
    braked = AccelerationLimit({"joint0": 2.0}).bounds(model, near, 0.1, 0.3 * v)
    np.testing.assert_allclose(
        braked.upper[0], 0.35
    )  # (0.05 / 0.1 + 0.1 * 2) / 2: goes 0.035 and 0.015, and stands
    too_fast = AccelerationLimit({"joint0": 2.0}).bounds(model, near, 0.1, 2.0 * v)
    np.testing.assert_allclose((too_fast.lower[0], too_fast.upper[0]), 1.8)  # brakes as hard as it may


@pytest.mark.parametrize("way", [0.0, 1e-9, 0.003, 0.0199, 0.02, 0.0201, 0.5, 7.3])
def test_a_joint_that_brakes_stands_before_its_limit(way: float) -> None:
    a, dt, left, v = 2.0, 0.1, way, 0.0
    for _ in range(400):
        bound = float(_speed_to_stop(left, a, dt))
        assert bound >= v - a * dt - 1e-9  # it never asks for a harder deceleration
        v = bound
        left -= v * dt
        assert left >= -1e-12
    assert left < 1e-9


def test_plane(model: Model) -> None:
    limit = PlaneLimit("link2", (0.0, 0.0, 1.0), 0.4, gain=0.5)
    bound = limit.bounds(model, Q, 0.1, limit.defaults(model)["link2_plane"])
    assert isinstance(bound, Strip)
    height = 0.5 + 0.5 * np.cos(1.5)
    np.testing.assert_allclose(bound.A, [[-0.5 * np.sin(1.5), 0, 0, 0, 0, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(bound.lower, [(0.4 - height) * 5.0])
    assert bound.upper[0] == inf
    with pytest.raises(InputError, match="length 1"):
        PlaneLimit("link2", (0.0, 0.0, 2.0))
    with pytest.raises(InputError, match="`gain` is 2"):
        PlaneLimit("link2", gain=2.0)


def test_limits_that_users_define_take_part(model: Model) -> None:
    from ulna.ik import DifferentialIK

    class OneWay(Limit):
        """Joints only go up."""

        def bounds(self, model, q, dt, *inputs):
            return Interval(np.zeros(model.nv), np.full(model.nv, inf))

    ik = DifferentialIK(model, [PostureTask(1.0)], [OneWay()])
    v = ik.velocity(Q, 0.1, Q + np.array([1, -1, 1, -1, 1, -1, 1]) * 0.1)
    np.testing.assert_allclose(v, [1, 0, 1, 0, 1, 0, 1], atol=1e-6)


def test_continuous_joints_take_the_short_way(model: Model) -> None:
    from ulna.ik import DifferentialIK

    ik = DifferentialIK(model, [PostureTask(1.0)], [])
    target = Q.copy()
    target[1] = 0.1 + 20.0 - 6.0 * np.pi
    assert abs(ik.velocity(Q, 1.0, target)[1] - 0.1) < 1e-6


def test_linear_task_refuses_another_size(model: Model) -> None:
    with pytest.raises(ShapeError, match=r"\(k, 7\)"):
        LinearTask(np.ones((1, 3))).costs(model)


def test_joints_without_limits_of_position_need_none() -> None:
    """Planar joints, whose positions are no vectors, are refused only where they have such limits."""
    model = chain(
        (Planar(), {"velocity": (1.0, 1.0, 1.0)}),
        (Revolute(), {"velocity": 3.0}),
        (Revolute(), {"lower": -1.0, "upper": 1.0}),
        (
            Revolute(),
            {"lower": -0.4, "upper": 0.4, "mimic": ("joint2", 2.0, 0.0)},
        ),  # those of a follower do not count
    )
    assert list(_limited(model, 0.1, "limit")) == [(model.nq - 1, model.nv - 1, -0.9, 0.9)]
