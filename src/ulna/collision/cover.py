"""Spheres that cover solids together: balls as they are, everything else by as few spheres as the excess allows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from ulna.collision.centres import covered, place
from ulna.collision.polyhedra import interior, triangles
from ulna.collision.problem import Problem, problem
from ulna.collision.region import region
from ulna.collision.solids import Solid
from ulna.data_classes import dataclass
from ulna.geometry import Sphere
from ulna.spatial import SE3
from ulna.typing import Array, Floats

Cover = tuple[Floats, Floats, float]
"""Centres (n, 3), radii (n,), and how far they stick out at most, all in [m]."""

GREEDY = 1.25
"""How much larger the excess of the greedy cover is than what it comes to in the end, about."""


@final
@dataclass(frozen=True, eq=False)
class Task:
    """Solids to cover.

    Attributes:
        solid_balls: Centres (n, 3) and radii (n,) of the solids that are balls [m].
        problem: The others; None where there are none.
    """

    solid_balls: tuple[Floats, Floats]
    problem: Problem | None

    @property
    def is_done(self) -> bool:
        """Whether the balls cover everything."""
        return self.problem is None or self.problem.is_empty

    def count(self, e: float) -> int:
        """How many spheres it takes besides the balls.

        Args:
            e: How far they may stick out, about [m].

        Returns:
            The count.
        """
        return 0 if self.is_done or self.problem is None else self.problem.count(GREEDY * e)

    def solve(self, count: int) -> Cover:
        """The spheres.

        Args:
            count: How many besides the balls, at most.

        Returns:
            Centres, shape (n, 3) [m], radii, shape (n,) [m], and the excess [m].
        """
        if self.is_done or self.problem is None:
            return *self.solid_balls, 0.0
        c, r = covered(self.problem, place(self.problem, count))
        e = float((r + self.problem.region.signed_exactly(c)).max(initial=0.0))
        return np.vstack([self.solid_balls[0], c]), np.concatenate([self.solid_balls[1], r]), max(e, 0.0)


def task(solids: Sequence[Solid], places: Sequence[SE3], finest: float = 0.0) -> Task:
    """Solids to cover, made ready.

    Args:
        solids: Bounded solids.
        places: T_common_shape of each [m].
        finest: The least edge of the cells in which they are looked at [m].

    Returns:
        The task.

    Raises:
        InputError: If a solid is a plane.
        MissingExtra: If scipy is not installed.
    """
    balls = [
        (T.translation, s.shape.radius)
        for s, T in zip(solids, places, strict=True)
        if isinstance(s.shape, Sphere)
    ]
    solid_balls = np.array([c for c, _ in balls]).reshape(-1, 3), np.array([r for _, r in balls])
    others = [
        (T @ triangles(s).reshape(-1, 3)).reshape(-1, 3, 3)
        for s, T in zip(solids, places, strict=True)
        if not isinstance(s.shape, Sphere)
    ]
    if not others:
        return Task(solid_balls, None)

    def buried(corners: Floats) -> Array:
        """Which triangles are inside one of the shapes that are convex."""
        is_inside = np.zeros(len(corners), dtype=bool)
        for solid, at in zip(solids, places, strict=True):
            x = (at.inverse() @ corners.reshape(-1, 3)).reshape(corners.shape)
            is_inside |= interior(solid.shape, x).all(axis=1)
        return is_inside

    return Task(solid_balls, problem(region(np.concatenate(others), buried, finest), solid_balls))


def cover(
    solids: Sequence[Solid], places: Sequence[SE3], tolerance: float, most: int, finest: float = 0.0
) -> Cover:
    """Spheres around solids.

    Args:
        solids: Bounded solids.
        places: T_common_shape of each [m].
        tolerance: How far spheres may stick out, about [m].
        most: The largest number of spheres for a solid that is no ball.
        finest: The least edge of the cells in which they are looked at [m].

    Returns:
        Centres, shape (n, 3) [m], radii, shape (n,) [m], and how far they stick out at most [m].
    """
    ready = task(solids, places, finest)
    return ready.solve(min(ready.count(tolerance), most * len(solids)))
