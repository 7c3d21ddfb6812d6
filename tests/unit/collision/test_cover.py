"""Points that stand for a solid: none of the solid is farther from them than is said, and those inside lie inside."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ulna.collision.cover import sample
from ulna.collision.solids import Solid
from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Plane, Shape, Sphere
from ulna.spatial import SE3

PLACE = SE3.from_rpy(np.array([0.3, -0.5, 0.8]), np.array([1.0, 2.0, 3.0]))
NOTHING = np.zeros((0, 3))


def _rho(p: np.ndarray) -> np.ndarray:
    return np.hypot(p[:, 0], p[:, 1])


SHAPES: list[tuple[Shape, np.ndarray, Callable[[np.ndarray], np.ndarray]]] = [
    (
        Box((0.2, 0.3, 0.1)),
        np.array([0.1, 0.15, 0.05]),
        lambda p: (np.abs(p) <= [0.1, 0.15, 0.05]).all(axis=1),
    ),
    (Sphere(0.1), np.full(3, 0.1), lambda p: (p**2).sum(axis=1) <= 0.01),
    (Cylinder(0.1, 0.3), np.array([0.1, 0.1, 0.15]), lambda p: (_rho(p) <= 0.1) & (np.abs(p[:, 2]) <= 0.15)),
    (
        Capsule(0.1, 0.2),
        np.array([0.1, 0.1, 0.2]),
        lambda p: _rho(p) ** 2 + np.maximum(np.abs(p[:, 2]) - 0.1, 0.0) ** 2 <= 0.01,
    ),
    (
        Ellipsoid((0.1, 0.2, 0.15)),
        np.array([0.1, 0.2, 0.15]),
        lambda p: ((p / [0.1, 0.2, 0.15]) ** 2).sum(axis=1) <= 1,
    ),
    (
        Cone(0.1, 0.3),
        np.array([0.1, 0.1, 0.15]),
        lambda p: (np.abs(p[:, 2]) <= 0.15) & (_rho(p) <= 0.1 * (0.15 - p[:, 2]) / 0.3),
    ),
]


def solid_of(shape: Shape) -> Solid:
    return Solid("owner", shape, -1, SE3.identity(), NOTHING, np.zeros((0, 3), dtype=int))


@pytest.mark.parametrize("step", [0.02, 0.03])
@pytest.mark.parametrize(("shape", "half", "is_inside"), SHAPES, ids=[type(s).__name__ for s, *_ in SHAPES])
def test_no_point_of_the_solid_is_farther_away_than_said(
    shape: Shape, half: np.ndarray, is_inside: Callable[[np.ndarray], np.ndarray], step: float
) -> None:
    near, inside, delta = sample(solid_of(shape), PLACE, step)
    assert delta == pytest.approx(step * np.sqrt(3) / 2)
    back = PLACE.inverse()
    near, inside = np.asarray(back @ near), np.asarray(back @ inside)
    points = np.random.default_rng(1).uniform(-half, half, (4000, 3))
    points = points[is_inside(points)]
    gap = np.sqrt(((points[:, None] - near[None]) ** 2).sum(axis=2)).min(axis=1)
    assert gap.max() <= delta + 1e-12
    assert gap.max() > 0.3 * delta  # and not far less, which would take more points than needed
    assert is_inside(inside * (1.0 - 1e-9)).all()
    assert len(inside) > 20
    assert (np.abs(near) - half).max() <= 2.0 * delta  # none stands far outside


def test_a_grid_that_would_have_too_many_points_is_wider() -> None:
    shape = Box((2.0, 3.0, 1.0))
    near, _, delta = sample(solid_of(shape), SE3.identity(), 0.01)
    h = (2.02 * 3.02 * 1.02 / 60_000) ** (1 / 3)
    assert delta == pytest.approx(h * np.sqrt(3) / 2)
    assert 20_000 < len(near) < 90_000


def test_the_grid_is_about_the_middle_and_reaches_beyond_every_side() -> None:
    near, inside, delta = sample(solid_of(Box((0.2, 0.2, 0.2))), SE3.identity(), 0.1)
    assert delta == pytest.approx(0.05 * np.sqrt(3))
    np.testing.assert_allclose(np.unique(np.round(near, 12)), [-0.1, 0.0, 0.1])
    np.testing.assert_array_equal(near, inside)


def test_a_plane_has_no_bounds() -> None:
    with pytest.raises(InputError, match="boundless; no spheres cover it"):
        sample(solid_of(Plane()), SE3.identity(), 0.1)
