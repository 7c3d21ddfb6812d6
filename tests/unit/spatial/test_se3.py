"""Poses and rotations by hand: small cases one can check on paper."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.spatial import SE3, SO3, Force, Inertia, Motion

close = np.testing.assert_allclose
QUARTER = np.pi / 2


def test_quarter_turns() -> None:
    close(SO3.rx(QUARTER) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    close(SO3.ry(QUARTER) @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    close(SO3.rz(QUARTER) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    close(SE3.rz(QUARTER) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    close(SE3.trans(1, 2, 3) @ SE3.rx(QUARTER) @ np.array([0, 1, 0]), [1, 2, 4], atol=1e-15)


def test_rpy_is_that_of_urdf() -> None:
    rpy = np.array([0.1, 0.2, 0.3])
    expected = SO3.rz(0.3) @ SO3.ry(0.2) @ SO3.rx(0.1)
    assert SO3.from_rpy(rpy).is_close(expected, 1e-15)
    assert SO3.from_euler(rpy[::-1], "zyx").is_close(expected, 1e-15)
    close(expected.rpy(), rpy, rtol=1e-14)
    close(expected.euler("zyx"), rpy[::-1], rtol=1e-14)
    close(SE3.from_rpy(rpy, [1, 2, 3]).rpy(), rpy, rtol=1e-14)


def test_rpy_at_gimbal_lock_gives_all_to_roll() -> None:
    close(SO3.from_rpy([0.3, QUARTER, 0.1]).rpy(), [0.2, QUARTER, 0.0], atol=1e-15)
    close(SO3.from_rpy([0.3, -QUARTER, 0.1]).rpy(), [0.4, -QUARTER, 0.0], atol=1e-15)


def test_quaternions_have_w_last_and_positive() -> None:
    half = np.sqrt(0.5)
    close(SO3.rx(QUARTER).quat_xyzw(), [half, 0, 0, half])
    close(SE3.rz(-QUARTER).quat_xyzw(), [0, 0, -half, half])
    close(SO3.from_quat_xyzw([0, -3, 0, -3]).matrix, SO3.ry(QUARTER).matrix, atol=1e-15)
    close(SE3.from_quat_xyzw([0, 0, 0, 2], [1, 2, 3]).matrix(), SE3.trans(1, 2, 3).matrix())


def test_angle_and_axis() -> None:
    close(SO3.from_angle_axis(QUARTER, [0, 0, 7]).matrix, SO3.rz(QUARTER).matrix, atol=1e-15)
    angle, axis = SO3.rz(-QUARTER).angle_axis()
    close(angle, QUARTER)
    close(axis, [0, 0, -1])
    angle, axis = SO3.identity().angle_axis()
    assert angle == 0.0
    close(axis, [1, 0, 0])
    batch = SO3.from_angle_axis(np.array([0.1, 0.2]), [[1, 0, 0], [0, 2, 0]])
    close(batch.log(), [[0.1, 0, 0], [0, 0.2, 0]], atol=1e-16)


def test_screw_of_a_quarter_turn() -> None:
    pose = SE3.exp(Motion([0, 0, 2.0], [0, 0, QUARTER]))
    close(pose.matrix(), (SE3.trans(0, 0, 2) @ SE3.rz(QUARTER)).matrix(), atol=1e-15)
    around = SE3.exp([0, -QUARTER, 0, 0, 0, QUARTER])  # about the vertical line through x = 1
    close(around @ [1, 0, 0], [1, 0, 0], atol=1e-15)
    close(around @ [0, 0, 0], [1, -1, 0], atol=1e-15)


def test_twist_seen_from_a_shifted_frame() -> None:
    spin = Motion(
        [0, 0, 0], [0, 0, 1.0]
    )  # a body that spins about the z axis of b, which stands at x = 2 in a
    seen = SE3.trans(2, 0, 0).act(spin)
    close(seen.linear, [0, -2, 0])
    close(seen.angular, [0, 0, 1])
    push = SE3.trans(2, 0, 0).act(Force([0, 1, 0], [0, 0, 0]))
    close(push.angular, [0, 0, 2])


def test_adjoints_of_a_rotation_of_whole_numbers_keep_the_fractions_of_its_translation() -> None:
    turn, p = np.diag([1, -1, -1]), np.array([0.1, 0.2, 0.3])
    whole, floats = SE3(turn, p), SE3(turn.astype(float), p)
    for matrix in (SE3.adjoint, SE3.dual_adjoint):
        np.testing.assert_array_equal(matrix(whole), matrix(floats))
    assert np.abs(whole.adjoint()[:3, 3:]).max() == 0.3


def test_distance_and_interpolation() -> None:
    a, b = SE3.identity(), SE3.trans(3, 4, 0) @ SE3.rz(1.0)
    close(a.distance(b), (5.0, 1.0))
    close(a.interpolate(b, 0.5, straight=True).matrix(), (SE3.trans(1.5, 2, 0) @ SE3.rz(0.5)).matrix())
    assert a.interpolate(b, 0.5).distance(b)[0] > 2.5  # the screw runs along an arc
    path = a.interpolate(b, np.linspace(0, 1, 5))
    assert path.batch_shape == (5,)
    close(path[-1].matrix(), b.matrix(), atol=1e-15)
    close(a.interpolate(b, np.linspace(0, 1, 5), straight=True).translation[:, 0], np.linspace(0, 3, 5))


def test_mixed_batches_broadcast() -> None:
    poses = SE3.rz(np.linspace(0, 1, 4))
    assert poses.matrix().shape == (4, 4, 4)
    assert (SE3.trans(1, 0, 0) @ poses).batch_shape == (4,)
    assert poses.act(Motion([1, 0, 0], [0, 0, 1])).batch_shape == (4,)
    assert poses.act(Inertia.from_sphere(1.0, 1.0)).batch_shape == (4,)
    assert (SE3.identity() @ np.zeros((7, 3))).shape == (7, 3)
    assert (SE3.random(np.random.default_rng(0), (5, 1)) @ poses).batch_shape == (5, 4)
    assert SE3.trans(np.zeros(6), 0, 0).batch_shape == (6,)
    assert poses.adjoint().shape == (4, 6, 6)


def test_random_rotations_are_even() -> None:
    poses = SE3.random(np.random.default_rng(0), (4000,), reach=2.0)
    close(poses.rotation.mean(axis=0), np.zeros((3, 3)), atol=0.04)
    close(np.cos(poses.so3().distance(SO3.identity())).mean(), -0.5, atol=0.05)  # E[trace R] = 0
    assert np.abs(poses.translation).max() == pytest.approx(2.0, abs=0.01)


def test_rotations_poses_and_inertias_have_matrices_by_one_name() -> None:
    """`R.matrix` is an attribute and `T.matrix()` a method; `as_matrix()` is the form for all."""
    T = SE3(0.1, 0.2, 0.3) @ SE3.rz(np.linspace(0.0, 1.0, 4))
    R, inertia = T.so3(), Inertia.from_box(2.0, (0.1, 0.2, 0.3))
    assert R.as_matrix().shape == (4, 3, 3) and T.as_matrix().shape == (4, 4, 4)
    np.testing.assert_array_equal(R.as_matrix(), R.matrix)
    np.testing.assert_array_equal(T.as_matrix(), T.matrix())
    np.testing.assert_array_equal(T.as_matrix()[:, :3, :3], R.as_matrix())
    np.testing.assert_array_equal(inertia.as_matrix(), inertia.matrix())
