"""What spheres must cover, as a k-centre problem: points, centres to choose from, and what each choice costs.

| symbol | meaning | shape | unit |
|---|---|---|---|
| C | excess of a sphere about c that just covers x: abs(x - c) + s(c) | (n, m) | [m] |
| e | the largest excess | | [m] |

Source of the greedy cover: Chvatal, A greedy heuristic for the set-covering problem, Mathematics of Operations Research
4 (1979). `ulna.collision.centres` goes on from there.
"""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

import numpy as np

from ulna.collision.region import Region, thinned
from ulna.data_classes import dataclass
from ulna.typing import Array, Floats

_SAMPLES = 800  # points that decide where centres go first
_POINTS = 4000  # points that decide where they go then
_CANDIDATES = 1000  # centres to choose from first, of each kind: all, near the surface, at the surface
_RATIO = 1.06  # of two neighbouring values of e that are tried


@final
@dataclass(frozen=True, eq=False)
class Problem:
    """A region to cover, made ready.

    Attributes:
        region: The region.
        pieces: The triangles to cover, shape (p, 3, 3) [m].
        points: x, of the surface as fine as the pieces, and of the inside, shape (n, 3) [m].
        samples: Fewer of them, shape (m, 3) [m].
        candidates: Centres to choose from, shape (k, 3) [m].
        cost: C of samples and candidates, shape (m, k) [m].
    """

    region: Region
    pieces: Floats
    points: Floats
    samples: Floats
    candidates: Floats
    cost: Floats
    _covers: dict[int, list[int]] = field(default_factory=dict)

    @property
    def is_empty(self) -> bool:
        """Whether nothing is left to cover."""
        return not len(self.pieces)

    def count(self, e: float) -> int:
        """How many spheres the greedy cover takes.

        Args:
            e: The largest excess [m].

        Returns:
            The count; a large number where no candidates do.
        """
        return 0 if self.is_empty else len(self._cover(_level(e))) or 10**6

    def _cover(self, level: int) -> list[int]:
        if level not in self._covers:
            self._covers[level] = _greedy(self.cost, _RATIO**level)
        return self._covers[level]

    def start(self, count: int) -> list[int]:
        """The greedy cover with the least excess that takes at most `count` spheres.

        Args:
            count: How many.

        Returns:
            Indices of candidates.
        """
        high = _level(float(self.cost.max())) + 1
        low = _level(1e-4)
        while high - low > 1:
            middle = (low + high) // 2
            spheres = self._cover(middle)
            low, high = (low, middle) if 0 < len(spheres) <= count else (middle, high)
        return self._cover(high)


def _level(e: float) -> int:
    """The number of the largest excess tried that is not above e."""
    return int(np.floor(np.log(e) / np.log(_RATIO) + 1e-9))


def problem(region: Region, existing: tuple[Floats, Floats] | None = None) -> Problem:
    """A region to cover.

    Args:
        region: The region.
        existing: Centres (n, 3) and radii (n,) of spheres that are there already [m]; what they hold needs no others.

    Returns:
        The problem.
    """
    inside = region.centres(region.inside)
    several = inside, region.centres(region.shallow), region.centres(region.wall)
    candidates = np.vstack([thinned(x, _CANDIDATES) for x in several])
    pieces, corners = region.pieces, region.corners
    if existing is not None and len(existing[1]):
        pieces = pieces[~_held(pieces, *existing)]
        corners, inside = (x[~_held(x[:, None], *existing)] for x in (corners, inside))
    surface = np.vstack([thinned(corners, _SAMPLES), corners[_outermost(corners)]])
    samples = np.vstack([surface, thinned(inside, _SAMPLES // 4)])
    cost = distances_between(samples, candidates) + region.signed(candidates).astype(np.float32)
    points = np.vstack([thinned(corners, _POINTS), surface[-60:], thinned(inside, _POINTS // 4)])
    return Problem(region, pieces, points, samples, candidates, cost)


def _held(triangles: Floats, c: Floats, r: Floats) -> Array:
    """Which triangles (or points) are wholly within one of some spheres."""
    is_inside = np.zeros(len(triangles), dtype=bool)
    for centre, radius in zip(c, r, strict=True):
        is_inside |= (sum((triangles[..., k] - centre[k]) ** 2 for k in range(3)) <= radius**2).all(axis=1)
    return is_inside


def _outermost(points: Floats) -> Array:
    """The points that are farthest in some of many directions."""
    if not len(points):
        return np.zeros(0, dtype=int)
    directions = np.random.default_rng(0).standard_normal((3, 60))
    return np.unique((directions.T @ points.T).argmax(axis=1))


def squared_distances(a: Floats, b: Floats) -> Floats:
    """Squared distances of points from points.

    Args:
        a: Shape (n, 3) [m].
        b: Coordinates by rows, which numpy adds several times as fast, shape (3, m) [m].

    Returns:
        Squares, shape (n, m) [m^2].
    """
    total = np.subtract.outer(a[:, 0], b[0]) ** 2
    for axis in (1, 2):
        apart = np.subtract.outer(a[:, axis], b[axis])
        total += np.multiply(apart, apart, out=apart)
    return total


def distances_between(a: Floats, b: Floats) -> Floats:
    """Distances of points from points, in float32.

    Args:
        a: Shape (n, 3) [m].
        b: Shape (m, 3) [m].

    Returns:
        Distances, shape (n, m) [m].
    """
    a, b = a.astype(np.float32), b.astype(np.float32)  # type: ignore[assignment]
    squared: Any = squared_distances(a, np.ascontiguousarray(b.T))
    return np.sqrt(squared, out=squared)


def _greedy(cost: Floats, e: float) -> list[int]:
    """Candidates that cover all samples with an excess of at most e; none if that cannot be."""
    covers = cost <= e
    gains = covers.sum(axis=0, dtype=np.int32)
    open_ = np.ones(len(cost), dtype=bool)
    chosen: list[int] = []
    while open_.any():
        best = int(gains.argmax())
        if gains[best] == 0:
            return []
        chosen.append(best)
        new = open_ & covers[:, best]
        gains -= covers[new].sum(axis=0, dtype=np.int32)
        open_ &= ~new
    return chosen
