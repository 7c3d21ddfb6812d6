"""Inertias by hand: solids, Steiner's theorem, and what counts as physical."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.errors import InputError
from ulna.spatial import SE3, Inertia, Motion

close = np.testing.assert_allclose

SOLIDS = {
    "sphere": (Inertia.from_sphere(3.0, 0.5), lambda x, y, z: x**2 + y**2 + z**2 <= 0.25),
    "ellipsoid": (
        Inertia.from_ellipsoid(3.0, [0.9, 0.5, 0.7]),
        lambda x, y, z: (x / 0.9) ** 2 + (y / 0.5) ** 2 + (z / 0.7) ** 2 <= 1,
    ),
    "box": (
        Inertia.from_box(3.0, [0.8, 1.0, 1.8]),
        lambda x, y, z: (abs(x) <= 0.4) & (abs(y) <= 0.5) & (abs(z) <= 0.9),
    ),
    "cylinder": (
        Inertia.from_cylinder(3.0, 0.5, 1.6),
        lambda x, y, z: (x**2 + y**2 <= 0.25) & (abs(z) <= 0.8),
    ),
    "capsule": (
        Inertia.from_capsule(3.0, 0.4, 1.0),
        lambda x, y, z: x**2 + y**2 + np.maximum(abs(z) - 0.5, 0) ** 2 <= 0.16,
    ),
    "cone": (
        Inertia.from_cone(3.0, 0.8, 1.6),
        lambda x, y, z: (np.hypot(x, y) <= 0.8 * (0.5 - z / 1.6)) & (abs(z) <= 0.8),
    ),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_agree_with_counting_cells(name: str) -> None:
    body, inside = SOLIDS[name]
    axis = (np.arange(120) + 0.5) / 120 * 2 - 1
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    points = np.stack([x, y, z], axis=-1)[inside(x, y, z)]
    close(body.com, points.mean(axis=0), atol=4e-3)
    arm = points - points.mean(axis=0)
    second = 3.0 * np.einsum("ni,nj->ij", arm, arm) / len(arm)
    close(body.inertia, np.trace(second) * np.eye(3) - second, atol=0.01)
    assert body.is_physical()
    assert body.mass == 3.0


def test_two_points_on_a_rod() -> None:
    rod = Inertia.from_point(1.0, [0, 0, 1]) + Inertia.from_point(3.0, [0, 0, -1])
    assert rod.mass == 4.0
    close(rod.com, [0, 0, -0.5])
    close(rod.inertia, np.diag([3.0, 3.0, 0.0]))
    close(rod.about_origin(), np.diag([4.0, 4.0, 0.0]))
    assert rod.is_physical()
    close(rod.kinetic_energy(Motion([0, 0, 0], [1, 0, 0])), 2.0)


def test_what_is_made_of_arrays_stays_when_they_change() -> None:
    com, moments, six = np.zeros(3), np.eye(3), np.zeros(6)
    body, twist = Inertia.from_com(1.0, com, moments), Motion.from_vector(six)
    about_origin = Inertia.from_origin(1.0, com, moments)
    com[:], moments[:], six[:] = 7.0, 7.0, 7.0
    assert body == about_origin == Inertia(1.0, np.zeros(3), np.eye(3))
    assert twist == Motion.zero()


def test_nothing_and_nothing_is_nothing() -> None:
    both = Inertia.zero() + Inertia.zero()
    assert both == Inertia.zero()
    batch = Inertia(np.array([0.0, 2.0]), np.zeros(3), np.zeros((3, 3))) + Inertia.zero()
    close(batch.com, np.zeros((2, 3)))


def test_from_origin_and_from_six_numbers() -> None:
    body = Inertia.from_com(2.0, [0.1, 0.2, 0.3], [1.0, 0.01, 0.02, 2.0, 0.03, 2.5])
    close(body.inertia, [[1.0, 0.01, 0.02], [0.01, 2.0, 0.03], [0.02, 0.03, 2.5]])
    assert Inertia.from_origin(2.0, body.com, body.about_origin()).is_close(body, 1e-15)
    assert Inertia([1.0, 2.0], [0, 0, 0], np.eye(3)) == Inertia.from_com([1.0, 2.0], np.zeros(3), np.eye(3))
    assert Inertia.from_com([1.0, 2.0], np.zeros(3), np.eye(3)).batch_shape == (2,)


def test_a_ball_is_a_ball_from_everywhere() -> None:
    ball = Inertia.from_sphere(2.0, 0.3)
    moved = (SE3.rx(0.4) @ SE3.ry(1.0)).act(ball)
    assert moved.is_close(ball, 1e-15)
    close(SE3.trans(0, 0, 2).act(ball).about_origin(), ball.inertia + np.diag([8.0, 8.0, 0.0]))


@pytest.mark.parametrize(
    ("moments", "mass", "physical"),
    [
        ([1, 1, 1], 1.0, True),
        ([1, 1, 2], 1.0, True),
        ([1, 1, 2.1], 1.0, False),
        ([1, 1, -0.1], 1.0, False),
        ([1, 1, 1], -1.0, False),
    ],
)
def test_physical_bodies_obey_the_triangle_inequality(
    moments: list[float], mass: float, physical: bool
) -> None:
    assert bool(Inertia(mass, np.zeros(3), np.diag(np.array(moments, float))).is_physical()) is physical


@pytest.mark.parametrize("seed", range(5))
def test_point_masses_stay_physical_as_ten_parameters(seed: int) -> None:
    """Moments about the origin leave some 1e-17 kg m^2 of either sign about the centre of mass."""
    points = Inertia.from_point(np.full(50, 2.0), np.random.default_rng(seed).normal(size=(50, 3)))
    again = Inertia.from_parameters(1.1 * points.parameters())
    assert (np.linalg.eigvalsh(again.inertia) < 0.0).any()
    assert again.is_physical().all()
    hollow = Inertia(2.0, np.ones(3), np.diag([1.0, 1.0, -1e-9]))
    assert not hollow.is_physical(tolerance=0.0)


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("size", lambda: Inertia.from_box(1.0, (1.0, -1.0, 1.0))),
        ("radius", lambda: Inertia.from_sphere(1.0, -0.5)),
        ("radius", lambda: Inertia.from_cylinder(1.0, -0.5, 1.0)),
        ("length", lambda: Inertia.from_capsule(1.0, 0.5, -1.0)),
        ("length", lambda: Inertia.from_cone(1.0, 0.5, -1)),
    ],
)
def test_negative_lengths_are_refused(name, call) -> None:
    with pytest.raises(InputError, match=f"`{name}` is .*; expected zero or more"):
        call()
