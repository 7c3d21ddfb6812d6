"""Ellipsoids of inertia have the mass and the moments of their bodies, in axes that turn to the right."""

import numpy as np

from ulna.model import Revolute
from ulna.model.builder import ModelBuilder
from ulna.spatial import SO3, Inertia
from ulna.viewer.robot.ellipsoids import inertia_ellipsoids


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
