"""Proportional servoing: errors in the frame's own axes, and when the goal counts as reached."""

import numpy as np
import pytest

from ulna.control import p_servo
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.spatial import SE3


def pose(
    rpy: tuple[float, float, float] = (0, 0, 0), place: tuple[float, float, float] = (0, 0, 0)
) -> np.ndarray:
    return np.asarray(SE3.from_rpy(rpy, place).matrix())


def test_the_first_step_of_the_recorded_servoing() -> None:
    # 0.2, 0.2, 0.35 along the tool's own axes: exactly the error, whatever way the tool looks
    T = pose((np.pi - 0.1, 0.2, 0.3), (0.484, 0.0, 0.413))
    v, arrived = p_servo(T, T @ pose(place=(0.2, 0.2, 0.35)), 1.0, 0.01)
    np.testing.assert_allclose(v, [0.2, 0.2, 0.35, 0, 0, 0], atol=1e-15)
    assert not arrived


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_turn_about_one_axis_is_that_angle(axis: int) -> None:
    angles = [0.0, 0.0, 0.0]
    angles[axis] = 0.4
    turn = pose((angles[0], angles[1], angles[2]))
    T = pose((0.3, -0.2, 0.9), (1, 2, 3))
    expected = np.zeros(6)
    expected[3 + axis] = 0.8
    own, _ = p_servo(T, T @ turn, 2.0)
    np.testing.assert_allclose(own, expected, atol=1e-12)
    there = T.copy()
    there[:3, :3] = turn[:3, :3] @ T[:3, :3]
    world, _ = p_servo(T, there, 2.0, method="angle-axis")
    np.testing.assert_allclose(world, expected, atol=1e-12)


def test_angles_are_in_the_frames_axes_and_rotation_vectors_in_the_worlds() -> None:
    T = pose((0, 0, np.pi / 2))
    goal = T @ pose(place=(1, 0, 0))
    np.testing.assert_allclose(p_servo(T, goal)[0], (1, 0, 0, 0, 0, 0), atol=1e-12)
    np.testing.assert_allclose(p_servo(T, goal, method="angle-axis")[0], (0, 1, 0, 0, 0, 0), atol=1e-12)


def test_the_methods_differ_for_turns_about_several_axes() -> None:
    goal = pose((0.3, -0.5, 0.7))
    by_angles, _ = p_servo(np.eye(4), goal, method="rpy")
    by_vector, _ = p_servo(np.eye(4), goal, method="angle-axis")
    np.testing.assert_allclose(by_angles[3:], (0.3, -0.5, 0.7), atol=1e-12)
    assert np.linalg.norm(by_vector[3:]) == pytest.approx(np.arccos((np.trace(goal) - 2) / 2))


def test_the_error_adds_up_over_metres_and_radians() -> None:
    goal = pose((0.0, 0.0, 0.04), (0.03, -0.02, 0.0))
    assert p_servo(np.eye(4), goal, threshold=0.0901)[1]
    assert not p_servo(np.eye(4), goal, threshold=0.0899)[1]


def test_arriving_does_not_depend_on_the_gain() -> None:
    goal = pose(place=(0.05, 0, 0))
    assert p_servo(np.eye(4), goal, gain=1000.0, threshold=0.06)[1]


def test_each_axis_may_have_its_gain() -> None:
    v, _ = p_servo(np.eye(4), pose((0, 0, 0.1), (1, 1, 1)), gain=(1, 2, 3, 4, 5, 6))
    np.testing.assert_allclose(v, (1, 2, 3, 0, 0, 0.6), atol=1e-12)


def test_a_half_turn_has_a_finite_answer() -> None:
    for method in ("rpy", "angle-axis"):
        v, _ = p_servo(np.eye(4), pose((np.pi, 0, 0)), method=method)
        assert np.abs(v[3:]).sum() == pytest.approx(np.pi)


def test_a_batch_is_its_poses() -> None:
    T = np.stack([pose((0.1, 0.2, 0.3)), pose(place=(1, 2, 3))])
    for method in ("rpy", "angle-axis"):
        v, arrived = p_servo(T, np.eye(4), 2.0, threshold=1.0, method=method)
        assert v.shape == (2, 6) and arrived.tolist() == [True, False]
        np.testing.assert_allclose(v[0], p_servo(T[0], np.eye(4), 2.0, method=method)[0], atol=1e-14)


def test_poses_are_matrices_or_se3() -> None:
    T, T_goal = SE3(0.1, 0.2, 0.3) @ SE3.rx(0.3), SE3.pointing_down((0.4, 0.0, 0.2))
    expected = p_servo(T.matrix(), T_goal.matrix())[0]
    for a, b in ((T, T_goal), (T, T_goal.matrix()), (T.matrix(), T_goal)):
        np.testing.assert_array_equal(p_servo(a, b)[0], expected)


def test_mistakes_are_named() -> None:
    with pytest.raises(ShapeError, match="4, 4"):
        p_servo(np.eye(3), np.eye(4))
    with pytest.raises(NonFiniteError, match="T_goal"):
        p_servo(np.eye(4), np.full((4, 4), np.nan))
    with pytest.raises(ShapeError, match="gain"):
        p_servo(np.eye(4), np.eye(4), gain=(1, 2, 3))
    with pytest.raises(InputError, match="gain"):
        p_servo(np.eye(4), np.eye(4), gain=np.inf)
    with pytest.raises(UnknownName, match="'angle-axis'"):
        p_servo(np.eye(4), np.eye(4), method="angle_axis")  # type: ignore[arg-type]


@pytest.mark.parametrize("method", ["rpy", "angle-axis"])
def test_an_invalid_pose_is_never_reached(method: str) -> None:
    shifted = np.eye(4)
    shifted[3, :3] = 0.01  # a transposed pose
    for bad in (np.zeros((4, 4)), 2.0 * np.eye(4), shifted):
        with pytest.raises(InputError, match="no pose"):
            p_servo(bad, bad, method=method)
        with pytest.raises(InputError, match="no pose"):
            p_servo(np.stack([np.eye(4), bad]), np.eye(4), method=method)
    assert p_servo(np.eye(4).round(4), np.eye(4), method=method)[1]
    assert p_servo(np.zeros((0, 4, 4)), np.eye(4), method=method)[0].shape == (0, 6)


@pytest.mark.parametrize("threshold", [-0.1, -1, float("nan"), -np.inf])
def test_a_threshold_below_zero_is_refused(threshold: float) -> None:
    with pytest.raises(InputError, match="`threshold`.*zero or more"):
        p_servo(np.eye(4), np.eye(4), threshold=threshold)
    assert not p_servo(np.eye(4), np.eye(4), threshold=0.0)[1]
