"""What the from_ constructors refuse, and what they say."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.spatial import SE3, SO3, Force, Inertia, Motion, euler_to_matrix

SKEWED = np.eye(3) + 1e-3 * np.ones((3, 3))


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: SO3.from_matrix(np.eye(4)), r"`matrix` has shape \(4, 4\); expected \(..., 3, 3\)"),
        (lambda: SE3.from_matrix(np.eye(3)), r"`matrix` has shape \(3, 3\); expected \(..., 4, 4\)"),
        (lambda: SE3.from_quat_xyzw([0, 0, 1]), "The order is x, y, z, w"),
        (lambda: SE3.from_rpy([0, 0]), "`rpy`"),
        (lambda: SE3.from_translation([0, 0]), "`translation`"),
        (lambda: Motion.from_vector(np.zeros(5)), r"`vector` has shape \(5,\); expected \(..., 6\)"),
        (lambda: SE3.exp(np.zeros(5)), "Linear part first"),
        (lambda: SE3.identity() @ np.zeros(4), r"\(\.\.\., 3\), or a pose"),
        (lambda: SO3.identity() @ np.zeros(4), "SO3.from_matrix"),
        (lambda: Inertia.from_com(1.0, np.zeros(3), np.zeros((2, 2))), "Six numbers"),
        (lambda: Inertia.from_parameters(np.zeros(6)), "parameters"),
    ],
)
def test_wrong_shapes(call: Any, text: str) -> None:
    with pytest.raises(ShapeError, match=text):
        call()


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: SO3.from_matrix(SKEWED), r"differs from the identity by 0.002.*SO3.project\(matrix\)"),
        (lambda: SO3.from_matrix(np.diag([1.0, 1.0, -1.0])), "determinant is -1"),
        (lambda: SO3.from_matrix(np.stack([np.eye(3), SKEWED])), r"at index \(1,\)"),
        (lambda: SE3.from_matrix(np.diag([2.0, 1.0, 1.0, 1.0])), r"by 3; .*SE3.project\(matrix\)"),
        (lambda: SE3.from_matrix(np.eye(4) + np.eye(4, k=-3)), "last row .* by 1.*transposed"),
        (lambda: SE3.from_rotation(SKEWED), r"SO3.project\(rotation\)"),
        (lambda: SO3.from_quat_xyzw([0, 0, 0, 0]), "`quat` is zero"),
        (lambda: SO3.from_angle_axis(1.0, [0, 0, 0]), "`axis` is zero"),
        (lambda: euler_to_matrix(np.zeros(3), "xxz"), "'xxz'; expected three of the letters"),
        (lambda: euler_to_matrix(np.zeros(3), "abc"), "'abc'"),
        (lambda: SE3.identity().act(np.zeros(6)), "ndarray; expected a Motion, Force or Inertia"),
        (lambda: SE3.identity().act_inverse(3), "int; expected a Motion"),
        (lambda: Inertia.from_com(-1.0, np.zeros(3), np.eye(3)), "-1 kg; expected zero or more"),
        (lambda: Inertia.from_com(1.0, np.zeros(3), np.eye(3, k=1)), "not symmetric: .* by 1 kg"),
    ],
)
def test_wrong_numbers(call: Any, text: str) -> None:
    with pytest.raises(InputError, match=text):
        call()


def test_nan_and_text_are_refused() -> None:
    with pytest.raises(NonFiniteError, match=r"`translation\[1\]` is nan"):
        SE3.from_translation([0.0, np.nan, 0.0])
    with pytest.raises(NonFiniteError, match=r"`matrix\[2, 2\]` is inf"):
        SO3.from_matrix(np.diag([1.0, 1.0, np.inf]))
    with pytest.raises(DtypeError, match="real numbers"):
        SO3.from_matrix(np.eye(3) * 1j)
    with pytest.raises(DtypeError, match="dtype <U1"):
        Force.from_vector(["a"] * 6)  # type: ignore[arg-type]

    with pytest.raises(DtypeError, match="holds None"):
        SE3.from_translation([0.0, None, 1.0])  # type: ignore[list-item]
    with pytest.raises(InputError, match=r"different lengths; expected \(..., 4, 4\)"):
        SE3.from_matrix([[1, 0], [0]])


def test_rounding_passes() -> None:
    r = SO3.rz(0.3).matrix + 1e-8
    np.testing.assert_array_equal(SO3.from_matrix(r).matrix, r)
    assert SE3.from_translation(np.array([1, 2.0, 3], dtype=object)).translation.dtype == float
    np.testing.assert_array_equal(SE3.from_matrix(SKEWED_POSE, check=False).rotation, SKEWED)


def test_symbols_pass() -> None:
    sympy = pytest.importorskip("sympy")
    symbols = np.array(sympy.symbols("m:16"), dtype=object).reshape(4, 4)
    assert (SE3.from_matrix(symbols).rotation == symbols[:3, :3]).all()
    assert SE3.from_translation([sympy.Symbol("x"), 0.0, 0.0]).translation[0] == sympy.Symbol("x")


SKEWED_POSE = np.block([[SKEWED, np.ones((3, 1))], [np.zeros((1, 3)), np.ones((1, 1))]])


def test_project_gives_the_nearest_rotation() -> None:
    pose = SE3.project(SKEWED_POSE)
    assert SO3.from_matrix(pose.rotation) == pose.so3()
    np.testing.assert_array_equal(pose.translation, np.ones(3))
    np.testing.assert_allclose(
        pose.rotation, np.eye(3), atol=1e-15
    )  # the nearest to a symmetric positive one
    mirrored = SO3.project(np.diag([1.0, 1.0, -0.1]))
    np.testing.assert_allclose(mirrored.matrix, np.eye(3), atol=1e-15)
    assert SO3.project(np.stack([SKEWED, SKEWED])).batch_shape == (2,)
