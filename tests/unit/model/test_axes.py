"""Unit axes and poses are cleaned to exact zeros and ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.errors import InputError
from ulna.model import ConstantVelocity, Ellipsoid, Helical, Planar, Revolute, Universal
from ulna.model.joints.axes import rotate_about, rotation_about, snap, snap_pose, unit_axis
from ulna.spatial import SE3, so3_exp


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ((0, 0, 2), (0.0, 0.0, 1.0)),
        ((-3, 0, 0), (-1.0, 0.0, 0.0)),
        ((1e-17, 1.0, 0.0), (0.0, 1.0, 0.0)),
        ((1.0, -6e-16, 0.0), (1.0, 0.0, 0.0)),
        ((3e-320, 0.0, 0.0), (1.0, 0.0, 0.0)),
        ((0.0, 1e300, 0.0), (0.0, 1.0, 0.0)),
        ((3, 4, 0), (0.6, 0.8, 0.0)),
    ],
)
def test_axes_are_scaled_and_snapped(given: tuple[float, ...], expected: tuple[float, ...]) -> None:
    axis = unit_axis(given)
    assert axis == pytest.approx(expected, abs=1e-16)
    assert [math.copysign(1.0, c) for c in axis if c == 0.0] == [1.0] * axis.count(0.0)
    assert [c for c, e in zip(axis, expected, strict=True) if e in (0.0, 1.0, -1.0) and c != e] == []


def test_a_unit_axis_keeps_its_bits() -> None:
    axis = tuple(np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8]))
    assert unit_axis(axis) == axis
    assert unit_axis(unit_axis((1, 2, 3))) == unit_axis((1, 2, 3))


@pytest.mark.parametrize("axis", [(0, 0, 0), (0, 1), (math.nan, 0, 1), (math.inf, 0, 0), "xyz", None, 5])
def test_an_invalid_axis_is_refused(axis: object) -> None:
    with pytest.raises(InputError, match="`axis`"):
        Revolute(axis)  # type: ignore[arg-type]


def test_other_impossible_kinds_are_refused() -> None:
    with pytest.raises(InputError, match="parallel"):
        Universal((0, 0, 1), (0, 0, -2))
    with pytest.raises(InputError, match="`pitch`"):
        Helical((0, 0, 1), math.nan)
    for wrong in (None, "x", "1.0", True, 1j, np.ones(2)):
        for make, name in (
            (lambda x: Helical((0, 0, 1), x), "pitch"),
            (ConstantVelocity, "distance"),
            (lambda x: Ellipsoid(1.0, x), "radius_y"),
        ):
            with pytest.raises(InputError, match=f"`{name}` is .*; expected a finite number"):
                make(wrong)


def test_snapping_goes_no_further_than_rounding_noise() -> None:
    assert snap(6.1e-17) == 0.0
    assert snap(1.0 - 2e-16) == 1.0
    assert snap(-1.0 + 2e-16) == -1.0
    assert snap(1e-14) == 1e-14
    assert snap(0.9999999) == 0.9999999
    assert snap(3.7) == 3.7
    assert math.copysign(1.0, snap(-0.0)) == 1.0


def test_a_quarter_turn_is_exact_and_read_only() -> None:
    pose = snap_pose(SE3.from_rpy((math.pi / 2, 0.0, math.pi / 2), (1e-17, -0.0, 0.3)))
    assert set(np.abs(pose.rotation).ravel()) == {0.0, 1.0}
    assert pose.translation.tolist() == [0.0, 0.0, 0.3]
    with pytest.raises(ValueError, match="read-only"):
        pose.rotation[0, 0] = 2.0


def test_rotations_about_an_axis_are_those_of_the_exponential() -> None:
    rng = np.random.default_rng(0)
    for axis in [(1, 0, 0), (0, -1, 0), (0, 3, 4), *rng.standard_normal((5, 3))]:
        unit = unit_axis(axis)
        angle, v = rng.uniform(-4.0, 4.0, 6), unit_axis(rng.standard_normal(3))
        expected = so3_exp(angle[:, None] * np.array(unit))
        np.testing.assert_allclose(rotation_about(unit, angle), expected, atol=1e-15)
        np.testing.assert_allclose(rotate_about(unit, angle, v), expected @ np.array(v), atol=2e-15)


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, -1), (0.3, -0.5, 0.8)])
def test_the_axes_of_a_plane_are_right_handed(normal: tuple[float, float, float]) -> None:
    kind = Planar(normal)
    frame = np.stack([*kind.axes, kind.normal], axis=1)
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-15)
    assert np.linalg.det(frame) == pytest.approx(1.0)


def test_the_axes_of_the_coordinate_planes_run_in_a_circle() -> None:
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    assert Planar(z).axes == (x, y)
    assert Planar(x).axes == (y, z)
    assert Planar(y).axes == (z, x)
