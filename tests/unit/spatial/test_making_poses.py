"""Poses from what people have: matrices, three numbers, a point and a direction; and what is said where that fails."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, ShapeError
from ulna.spatial import SE3, SO3

RNG = np.random.default_rng(3)
T = SE3.random(RNG).matrix()
R = SO3.random(RNG).matrix


def test_a_pose_of_three_numbers_a_matrix_or_nothing() -> None:
    assert SE3(1.0, 2.0, 3.0) == SE3.trans(1.0, 2.0, 3.0)
    assert SE3(np.array([1.0, 2.0]), 0.0, 0.0).batch_shape == (2,)
    assert SE3(T) == SE3.from_matrix(T)
    assert SE3(T.tolist()) == SE3.from_matrix(T)
    assert SE3(SE3(T)) == SE3(T)
    assert SE3() == SE3.identity()
    assert SE3(SO3(R)) == SE3.from_rotation(R)
    assert SE3(SO3(R), [1, 2, 3]) == SE3.from_rotation(R, [1, 2, 3])
    assert SE3(R, np.ones(3)) == SE3(rotation=R, translation=np.ones(3))
    assert SE3(np.stack([T, T])).batch_shape == (2,)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SE3([1, 2, 3]), r"SE3\(x, y, z\)"),
        (lambda: SE3(R), r"SE3\.from_rotation\(R, p\)"),
        (lambda: SE3([0, 0, 0, 1], [1, 2, 3]), r"SE3\.from_quat_xyzw"),
        (lambda: SE3(np.zeros(3), np.zeros(3)), r"SE3\.from_rpy"),
        (lambda: SE3(R, np.zeros(4)), r"`translation` has shape \(4,\)"),
        (lambda: SE3(R, np.zeros(3), 1.0), r"SE3\(rotation, translation\) or"),
        (lambda: SE3(2.0 * T), "last row"),
        (lambda: R @ SE3(), r"shape \(3, 3\); expected \(\.\.\., 4, 4\)"),
        (lambda: T @ SO3(R), r"shape \(4, 4\); expected \(\.\.\., 3, 3\)"),
    ],
)
def test_what_is_no_pose_says_what_makes_one(make: Callable[[], Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


def test_matrices_and_poses_are_composed() -> None:
    pose = SE3.random(RNG)
    for product in (T @ pose, SE3(T) @ pose.matrix()):
        assert isinstance(product, SE3)
        np.testing.assert_allclose(product.matrix(), T @ pose.matrix(), atol=1e-15)
    batch = np.stack([T, np.eye(4), T]) @ pose
    assert batch.batch_shape == (3,)
    np.testing.assert_allclose((R @ SO3(R)).matrix, R @ R, atol=1e-15)
    robot = ulna.load("ur5")
    raised = robot.fk(robot.neutral) @ SE3(0.0, 0.0, 0.1)
    np.testing.assert_allclose(raised.translation, (robot.fk(robot.neutral) @ [0, 0, 0.1, 1])[:3])


def is_rotation(matrix: np.ndarray) -> bool:
    return bool(
        np.allclose(np.swapaxes(matrix, -1, -2) @ matrix, np.eye(3))
        and np.allclose(np.linalg.det(matrix), 1.0)
    )


def test_pointing_down() -> None:
    pose = SE3.pointing_down((0.4, 0.2, 0.3), yaw=0.5)
    assert is_rotation(pose.rotation)
    np.testing.assert_array_equal(pose.translation, [0.4, 0.2, 0.3])
    np.testing.assert_allclose(pose.rotation[:, 2], [0, 0, -1])
    np.testing.assert_allclose(pose.rotation[:, 0], [np.cos(0.5), np.sin(0.5), 0])
    assert SE3.pointing_down((1, 2, 3)).is_close(SE3.pointing((1, 2, 3), (0, 0, -2)))
    batch = SE3.pointing_down(RNG.normal(size=(4, 3)), np.arange(4.0))
    assert batch.batch_shape == (4,)


def test_pointing_along_a_direction() -> None:
    direction, x = RNG.normal(size=(2, 50, 3))
    for pose in (SE3.pointing((1, 2, 3), direction), SE3.pointing((1, 2, 3), direction, x)):
        assert is_rotation(pose.rotation)
        unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
        np.testing.assert_allclose(pose.rotation[..., 2], unit)
    across = np.cross(unit, x)
    np.testing.assert_allclose((pose.rotation[..., 0] * across).sum(-1), 0.0, atol=1e-12)
    assert ((pose.rotation[..., 0] * x).sum(-1) > 0.0).all()
    np.testing.assert_allclose(SE3.pointing((0, 0, 0), (2, 0, 0)).rotation[:, 0], [0, 0, 1])
    for wrong in ({"direction": (0, 0, 0)}, {"direction": (0, 0, 1), "x": (0, 0, 2)}):
        with pytest.raises(InputError, match="direction"):
            SE3.pointing((0, 0, 0), **wrong)
    with pytest.raises(ShapeError, match="position"):
        SE3.pointing((0, 0), (0, 0, 1))


@pytest.mark.parametrize(
    "direction", [(1, 1e-8, 0), (1, -2e-9, 1e-9), (1e200, 1e200, 0), (1e-160, 0, 1e-160), (0, 5e-324, 0)]
)
def test_directions_near_the_x_axis_huge_and_tiny_ones_make_rotations(direction: tuple[float, ...]) -> None:
    exponent = np.frexp(direction)[1][np.array(direction) != 0.0].max()
    unit = np.ldexp(direction, -exponent)  # a common factor of two changes no digit
    unit /= np.linalg.norm(unit)
    for rotation in (
        SE3.pointing((0, 0, 0), direction).rotation,
        SE3.looking_at((0, 0, 0), direction, up=(0, 0, 1)).rotation,
    ):
        np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-15)
        np.testing.assert_allclose(rotation[:, 2], unit, atol=1e-15)
    turn = SO3.from_angle_axis(0.5, direction).matrix
    np.testing.assert_allclose(turn, SO3.from_angle_axis(0.5, unit).matrix, atol=1e-15)
    np.testing.assert_allclose(
        SO3.from_quat_xyzw([*direction, max(direction)]).matrix,
        SO3.from_quat_xyzw([*unit, max(unit)]).matrix,
        atol=1e-15,
    )


def test_looking_at() -> None:
    positions = RNG.normal(size=(20, 3))
    target = np.array([0.1, 0.2, 0.3])
    camera = SE3.looking_at(positions, target)
    assert is_rotation(camera.rotation)
    seen = camera.inverse() @ target
    np.testing.assert_allclose(seen[:, :2], 0.0, atol=1e-12)
    assert (seen[:, 2] > 0.0).all()
    above = camera.inverse() @ (target + [0, 0, 0.01])
    np.testing.assert_allclose(above[:, 0], 0.0, atol=1e-12)
    assert (above[:, 1] < 0.0).all()  # up in the world is up in the picture: y points down
    with pytest.raises(InputError, match="zero"):
        SE3.looking_at(target, target)
    with pytest.raises(InputError, match=r"up=\(1, 0, 0\)"):
        SE3.looking_at((0, 0, 1), (0, 0, 0))


def test_an_arm_reaches_down_to_a_point() -> None:
    robot = ulna.load("panda")
    solution = robot.ik(SE3.pointing_down((0.4, 0.2, 0.3)))
    assert solution.success
    np.testing.assert_allclose(robot.fk(solution.q)[:3, 2:], [[0, 0.4], [0, 0.2], [-1, 0.3]], atol=1e-5)


def test_poses_stay_when_the_arrays_they_were_made_of_change() -> None:
    T, p, turn = np.eye(4), np.zeros(3), [0.0, 0.0, 0.0, 1.0]
    made = [
        SE3(T),
        SE3.from_matrix(T),
        SE3.project(T),
        SE3.from_translation(p),
        SE3.from_rpy((0.0, 0.0, 0.0), p),
    ]
    made += [SE3.from_quat_xyzw(turn, p), SE3.from_rotation(T[:3, :3], p), SE3.pointing(p, (0.0, 0.0, 1.0))]
    rotation = SO3.from_matrix(T[:3, :3])
    T[:3], p[:] = 7.0, 7.0
    assert all(pose == SE3.identity() for pose in made) and rotation == SO3.identity()
    assert len({*made, SE3.identity()}) == 1
