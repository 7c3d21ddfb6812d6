"""Poses along lines, circles and splines."""

import numpy as np
import pytest

from ulna import trajectory
from ulna.errors import InputError, UnknownName
from ulna.spatial import SE3, so3_log

RNG = np.random.default_rng(2)
T0, T1 = SE3.from_rpy((0.1, 0.2, 0.3), (1, 2, 3)), SE3.from_rpy((1.0, -0.2, 0.5), (0, 2, 1))


def test_straight_lines_are_straight_and_turn_evenly() -> None:
    t = trajectory.pose_line(T0, T1, 2.0)
    T = t.sample(n=21).q
    along = (T[:, :3, 3] - T0.translation) @ (T1.translation - T0.translation)
    np.testing.assert_allclose(
        T[:, :3, 3] - T0.translation,
        along[:, None] * (T1.translation - T0.translation) / np.sum((T1.translation - T0.translation) ** 2),
        atol=1e-14,
    )
    turn = so3_log(T[:, :3, :3] @ T0.rotation.T)
    np.testing.assert_allclose(np.cross(turn, so3_log(T1.rotation @ T0.rotation.T)), 0.0, atol=1e-13)
    np.testing.assert_allclose(t.end, T1.matrix(), atol=1e-14)


def test_screws_have_a_constant_direction_in_the_moving_frame() -> None:
    t = trajectory.pose_line(T0, T1, 2.0, "screw")
    T, V = t.T(0.7), t.v(0.7)
    body = np.concatenate([T[:3, :3].T @ V[:3], T[:3, :3].T @ V[3:]])
    twist = (T0.inverse() @ T1).log().vector()
    np.testing.assert_allclose(body / np.linalg.norm(body), twist / np.linalg.norm(twist), atol=1e-13)
    np.testing.assert_allclose(t.end, T1.matrix(), atol=1e-13)


def test_limits_hold_for_origin_and_rotation() -> None:
    t = trajectory.pose_line(T0, T1, velocity=(0.5, 2.0), acceleration=(1.0, 4.0), jerk=(10.0, 40.0))
    V, A = t.sample(n=3000)[2:]
    assert np.linalg.norm(V[:, :3], axis=1).max() == pytest.approx(0.5)
    assert np.linalg.norm(A[:, :3], axis=1).max() <= 1.0 + 1e-9
    turning = trajectory.pose_line(
        T0, SE3.from_rotation(T1.rotation, T0.translation), velocity=(0.5, 2.0), acceleration=(1.0, 4.0)
    )
    assert np.linalg.norm(turning.sample(n=3000).v[:, 3:], axis=1).max() <= 2.0 + 1e-9


@pytest.mark.parametrize("orientation", ["fixed", "turning"])
def test_circles(orientation: str) -> None:
    centre, axis = np.array([0.5, 1.0, 0.0]), np.array([0.2, 0.1, 1.0])
    t = trajectory.circle(T0, centre, axis, 5.0, 3.0, orientation)  # type: ignore[arg-type]
    p = t.sample(n=50).q[:, :3, 3] - centre
    unit = axis / np.linalg.norm(axis)
    np.testing.assert_allclose(p @ unit, (p @ unit)[0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(p, axis=1), np.linalg.norm(p[0]), atol=1e-12)
    turned = so3_log(t.T(0.3)[:3, :3] @ T0.rotation.T)
    expected = (
        unit * 5.0 * trajectory.quintic(0.0, 1.0, 3.0)(0.3) if orientation == "turning" else np.zeros(3)
    )
    np.testing.assert_allclose(turned, expected, atol=1e-13)


@pytest.mark.parametrize("angle", [0.3, 2.0, 4.0, 6.0])
def test_arcs_go_through_their_points(angle: float) -> None:
    rotation = SE3.from_rpy((0.4, -0.3, 0.2), (1, 2, 3))
    points = [rotation @ np.array([np.cos(x), np.sin(x), 0.0]) for x in (0.0, 0.4 * angle, angle)]
    start = SE3.from_rotation(T0.rotation, points[0])
    t = trajectory.arc_through(start, points[1], points[2], 1.0)
    np.testing.assert_allclose(t.end[:3, 3], points[2], atol=1e-12)
    distance = np.linalg.norm(t.sample(n=4001).q[:, :3, 3] - points[1], axis=1).min()
    assert distance < 1e-3 * angle


@pytest.mark.parametrize("interpolation", ["decoupled", "screw"])
def test_splines_run_through_their_poses(interpolation: str) -> None:
    poses = [T0 @ SE3.exp(0.5 * k * np.array([0.3, 0.5, -0.2, 0.4, 0.6 - 0.3 * k, 0.5])) for k in range(5)]
    t = trajectory.pose_spline(poses, 4.0, interpolation)  # type: ignore[arg-type]
    found = t(t.knots)
    for pose in poses:
        assert np.abs(found - pose.matrix()).max(axis=(1, 2)).min() < 1e-11
    np.testing.assert_allclose(t.v([0.0, 4.0]), 0.0, atol=1e-12)
    drawn = trajectory.pose_spline(np.stack([p.matrix() for p in poses]), 4.0, interpolation, through=False)  # type: ignore[arg-type]
    np.testing.assert_allclose(drawn([0.0, 4.0]), [poses[0].matrix(), poses[-1].matrix()], atol=1e-14)
    rotation = t.sample(n=50).q[:, :3, :3]
    np.testing.assert_allclose(rotation @ rotation.swapaxes(1, 2), np.tile(np.eye(3), (50, 1, 1)), atol=1e-12)


def test_decoupled_translations_do_not_see_rotations() -> None:
    places = RNG.normal(size=(5, 3))
    one = trajectory.pose_spline([SE3.from_translation(p) for p in places], 2.0)
    two = trajectory.pose_spline([SE3.from_rpy((0.3 * k, 0.1, 0.2), p) for k, p in enumerate(places)], 2.0)
    np.testing.assert_allclose(one.sample(n=30).q[:, :3, 3], two.sample(n=30).q[:, :3, 3], atol=1e-10)


def test_poses_are_joined() -> None:
    t = trajectory.pose_line(T0, T1, 1.0) + trajectory.pose_line(T1, T0, 2.0, "screw")
    np.testing.assert_allclose(t.T([0.0, 1.0, 3.0]), [T0.matrix(), T1.matrix(), T0.matrix()], atol=1e-12)
    np.testing.assert_allclose(t.slowed(2.0).reversed()(2.0), t(2.0), atol=1e-12)
    with pytest.raises(InputError, match="'y' jumps|'x' jumps|'z' jumps"):
        trajectory.pose_line(T0, T1, 1.0) + trajectory.pose_line(T0, T1, 1.0)


def test_mistakes_are_named() -> None:
    with pytest.raises(InputError, match="same pose"):
        trajectory.pose_line(T0, T0, 1.0)
    with pytest.raises(UnknownName, match="'screw'"):
        trajectory.pose_line(T0, T1, 1.0, "screws")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="not a rotation"):
        trajectory.pose_line(np.diag([2.0, 1, 1, 1]), T1, 1.0)
    with pytest.raises(InputError, match="neither was given"):
        trajectory.pose_line(T0, T1)
    with pytest.raises(InputError, match="of the origin, and of the rotation"):
        trajectory.pose_line(T0, T1, velocity=1.0, acceleration=(1, 1))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="on a line"):
        trajectory.arc_through(T0, (1, 2, 4), (1, 2, 5), 1.0)
    with pytest.raises(InputError, match="on the circle's axis"):
        trajectory.circle(T0, (1, 2, 0), (0, 0, 1), duration=1.0)
    with pytest.raises(InputError, match="`axis` is zero"):
        trajectory.circle(T0, (0, 0, 0), (0, 0, 0), duration=1.0)
    with pytest.raises(InputError, match="`angle` is 0"):
        trajectory.circle(T0, (0, 0, 0), (0, 0, 1), 0.0, duration=1.0)
    with pytest.raises(InputError, match="at least two"):
        trajectory.pose_spline([T0], 1.0)
    with pytest.raises(InputError, match=r"from pose 0 to pose 1 it turns by 3"):
        trajectory.pose_spline([T0, T0 @ SE3.rx(3.0), T0 @ SE3.ry(3.0) @ SE3.rx(3.0), T0 @ SE3.rz(3.0)], 1.0)


def test_paths_stay_when_the_poses_they_were_made_of_change() -> None:
    a, b = T0.matrix(), T1.matrix()
    line, arc = trajectory.pose_line(a, b, 2.0), trajectory.circle(a, (0, 0, 0), (0, 0, 1), duration=2.0)
    before = line.T([0.5, 1.0]), arc.T([0.5, 1.0])
    a[:], b[:] = np.eye(4), np.eye(4)
    np.testing.assert_array_equal((line.T([0.5, 1.0]), arc.T([0.5, 1.0])), before)
