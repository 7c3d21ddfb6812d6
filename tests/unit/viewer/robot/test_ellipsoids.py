"""Ellipsoids of inertia have the mass and the moments of their bodies, in axes that turn to the right."""

import numpy as np
import pytest

from ulna.errors import UnknownName
from ulna.model import Revolute
from ulna.model.builder import ModelBuilder
from ulna.spatial import SO3, Inertia
from ulna.viewer.robot.ellipsoids import _MAX_RATIO, check_kind, inertia_ellipsoids, manipulability_ellipsoid


def test_a_solid_ellipsoid_of_the_mass_has_the_inertia_of_the_link() -> None:
    rng = np.random.default_rng(3)
    builder = ModelBuilder("bodies").add_link("world")
    expected = []
    for k in range(40):
        radii, mass, com = rng.uniform(0.05, 0.4, 3), rng.uniform(0.5, 3.0), rng.normal(size=3)
        R = SO3.exp(rng.normal(size=3)).matrix
        solid = R @ np.asarray(Inertia.from_ellipsoid(mass, radii).inertia) @ R.T
        builder.add_link(f"l{k}", Inertia.from_com(mass, com, solid))
        builder.add_joint(f"j{k}", Revolute((0, 0, 1)), "world", f"l{k}")
        expected.append((radii, com, solid, mass))
    found = {number: (T, axes) for number, T, axes in inertia_ellipsoids(builder.build().links)}
    assert sorted(found) == list(range(1, 41))  # "world" has no mass
    for number, (radii, com, solid, mass) in enumerate(expected, start=1):
        T, axes = found[number]
        np.testing.assert_allclose(np.sort(axes), np.sort(radii), rtol=1e-9)
        np.testing.assert_allclose(T[:3, 3], com)
        assert np.linalg.det(T[:3, :3]) > 0.999
        again = T[:3, :3] @ np.asarray(Inertia.from_ellipsoid(mass, axes).inertia) @ T[:3, :3].T
        np.testing.assert_allclose(again, solid, atol=1e-12)


@pytest.mark.parametrize("kind", ["velocity", "force"])
def test_ellipsoids_of_jacobians_are_those_of_siciliano(kind: str) -> None:
    """Section 3.9: v.T (J J.T)^-1 v = 1 for velocities, f.T J J.T f = 1 for forces; the same axes, inverse lengths."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        J = rng.normal(size=(3, 6))
        T, axes = manipulability_ellipsoid(J, kind)
        R = T[:3, :3]
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(R) > 0.0 and (T[:3, 3] == 0.0).all()
        shape = R @ np.diag(axes**2) @ R.T
        np.testing.assert_allclose(
            shape, J @ J.T if kind == "velocity" else np.linalg.inv(J @ J.T), rtol=1e-8
        )


def test_singular_jacobians_have_ellipsoids_that_can_be_drawn() -> None:
    flat = np.diag([2.0, 0.5, 0.0])
    _, axes = manipulability_ellipsoid(flat)
    np.testing.assert_allclose(np.sort(axes), [1e-4, 0.5, 2.0])
    _, axes = manipulability_ellipsoid(flat, "force")
    np.testing.assert_allclose(np.sort(axes)[:2], [0.5, 2.0])
    assert axes.max() / axes.min() == pytest.approx(_MAX_RATIO)
    _, axes = manipulability_ellipsoid(np.zeros((3, 2)), "force")
    assert np.isfinite(axes).all()
    with pytest.raises(UnknownName, match="ellipsoid"):
        check_kind("torque")
