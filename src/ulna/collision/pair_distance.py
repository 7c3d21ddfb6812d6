"""Distances of the solids of two links from each other, through coal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from ulna.collision import narrow
from ulna.collision.narrow import Narrow, Poses
from ulna.collision.solids import Solid
from ulna.spatial import SE3
from ulna.typing import Array, Floats


@final
class PairDistance:
    """Distances of the solids of two links, by how these stand to each other; not for two threads at once.

    Pairs of solids are numbered by the first, then by the second.

    Args:
        first: The solids of a link, of meshes convex parts.
        second: Those of another.
    """

    def __init__(self, first: Sequence[Solid], second: Sequence[Solid]) -> None:
        self._first, self._second = tuple(first), tuple(second)
        self.width = len(self._second)
        solids = (*first, *second)
        self._narrow = Narrow([narrow.geometry_of(solid, True) for solid in solids], np.zeros((1, 1)))
        self._centres = [solid.placement @ solid.bounds[0] for solid in solids]
        self._radii = np.array([solid.radius for solid in solids])

    def gaps(self, T: SE3) -> Floats:
        """Distances of balls around the solids.

        Args:
            T: T_a_b, poses of the second link's joint in the frame of that of the first, shape (n,) [m].

        Returns:
            Lower bounds of the distances of the solids, shape (n, pairs) [m].
        """
        n = len(self._first)
        centres = [np.linalg.norm(T @ c - a, axis=-1) for a in self._centres[:n] for c in self._centres[n:]]
        return np.stack(centres, axis=-1) - (self._radii[:n, None] + self._radii[n:]).ravel()

    def separations(self, T: SE3, pairs: Array) -> tuple[Floats, Floats]:
        """What coal says of one pair of solids each.

        Args:
            T: T_a_b, shape (n,) [m].
            pairs: Which pair, shape (n,).

        Returns:
            Signed distances, shape (n,) [m], and unit vectors from the first solid to the second, in the frame of the
            first link's joint, shape (n, 3).
        """
        poses, n, width = self._poses(T), len(self._first), self.width
        distances, normals = np.empty(len(pairs)), np.empty((len(pairs), 3))
        for row, pair in enumerate(pairs.tolist()):
            distances[row], normals[row] = self._narrow.separation(
                poses, row, pair // width, n + pair % width
            )
        return distances, normals

    def least(self, T: SE3) -> Floats:
        """Distances of the links; the depth is that of one pair of solids where they touch.

        Args:
            T: T_a_b, shape (n,) [m].

        Returns:
            Signed distances, shape (n,) [m].
        """
        bounds = self.gaps(T)
        least, rows = np.full(len(bounds), np.inf), np.arange(len(bounds))
        while len(rows):
            pairs = bounds[rows].argmin(axis=1)
            separations_of_pairs, _ = self.separations(SE3(T.rotation[rows], T.translation[rows]), pairs)
            bounds[rows, pairs] = np.inf
            least[rows] = np.minimum(least[rows], separations_of_pairs)
            rows = rows[(least[rows] > 0.0) & (bounds[rows].min(axis=1) < least[rows])]
        return least

    def _poses(self, T: SE3) -> Poses:
        """Poses of all solids, in the frame of the first link's joint."""
        count = len(T.translation)
        placed = [solid.placement for solid in self._first] + [T @ solid.placement for solid in self._second]
        R = np.stack([np.broadcast_to(X.rotation, (count, 3, 3)) for X in placed], axis=1)
        p = np.stack([np.broadcast_to(X.translation, (count, 3)) for X in placed], axis=1)
        return Poses(R, p, p, p)
