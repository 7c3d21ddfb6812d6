"""Trajectories against the Robotics Toolbox, where both mean the same."""

import numpy as np
import pytest

from ulna import trajectory
from ulna.spatial import SE3

toolbox = pytest.importorskip(
    "roboticstoolbox", reason="the Robotics Toolbox, the judge here, is not installed"
)

RNG = np.random.default_rng(11)
TIME = np.linspace(0.0, 2.5, 51)


@pytest.mark.parametrize("moving", [False, True])
def test_quintics_are_jtraj_with_a_vector_of_times(moving: bool) -> None:
    q0, q1, v0, v1 = RNG.normal(size=(4, 7))
    speeds = (v0, v1) if moving else (None, None)
    theirs = toolbox.jtraj(q0, q1, TIME, *speeds)
    q, v, a = trajectory.quintic(q0, q1, 2.5, *speeds).state(TIME)
    np.testing.assert_allclose(q, theirs.q, atol=1e-10)
    np.testing.assert_allclose(v, theirs.qd, atol=1e-10)
    np.testing.assert_allclose(a, theirs.qdd, atol=1e-9)


def test_scalar_quintics_and_trapezoids() -> None:
    theirs = toolbox.quintic(0.3, -1.2, TIME, 0.4, -0.2)
    q, v, a = trajectory.quintic(0.3, -1.2, 2.5, 0.4, -0.2).state(TIME)
    for ours, other in ((q, theirs.q), (v, theirs.qd), (a, theirs.qdd)):
        np.testing.assert_allclose(ours[:, 0], np.ravel(other), atol=1e-10)
    for speed in (None, 0.7, 0.95):
        theirs = toolbox.trapezoidal(0.3, -1.2, TIME, V=speed)
        t = trajectory.trapezoidal(0.3, -1.2, velocity=speed, duration=2.5)
        q, v, _ = t.state(TIME)
        np.testing.assert_allclose(q[:, 0], np.ravel(theirs.q), atol=1e-10)
        np.testing.assert_allclose(v[:, 0], np.ravel(theirs.qd), atol=1e-10)


def test_mtraj_is_the_same_law_for_each_joint() -> None:
    q0, q1 = RNG.normal(size=(2, 4))
    theirs = toolbox.mtraj(toolbox.trapezoidal, q0, q1, TIME)
    np.testing.assert_allclose(trajectory.trapezoidal(q0, q1, duration=2.5)(TIME), theirs.q, atol=1e-10)
    theirs = toolbox.mtraj(toolbox.quintic, q0, q1, TIME)
    np.testing.assert_allclose(trajectory.quintic(q0, q1, 2.5)(TIME), theirs.q, atol=1e-10)


def test_quintic_blends_are_mstraj() -> None:
    points = RNG.normal(size=(5, 3))
    theirs = toolbox.mstraj(points, dt=0.01, tacc=0.4, tsegment=[1.0, 1.5, 0.8, 1.2])
    t = trajectory.blended(points, 0.4, segment_times=[1.0, 1.5, 0.8, 1.2], kind="quintic", ends="half")
    rows = t.sample(rate=100.0)
    count = min(len(rows.t), len(theirs.q) + 1)
    np.testing.assert_allclose(rows.q[1:count], theirs.q[: count - 1], atol=1e-9)
    np.testing.assert_allclose(rows.v[1:count], theirs.qd[: count - 1], atol=1e-8)
    assert t.duration == pytest.approx(4.5)


def test_decoupled_lines_under_a_trapezoid_are_ctraj() -> None:
    from spatialmath import SE3 as Pose

    a, b = SE3.exp(RNG.normal(size=6)), SE3.exp(RNG.normal(size=6))
    theirs = toolbox.ctraj(Pose(a.matrix(), check=False), Pose(b.matrix(), check=False), 50)
    even = trajectory.pose_line(a, b, 1.0).path
    ours = even.retimed(trajectory.trapezoidal(0.0, 1.0, duration=1.0))
    np.testing.assert_allclose(ours.sample(n=50).q, np.stack([T.A for T in theirs]), atol=1e-7)
