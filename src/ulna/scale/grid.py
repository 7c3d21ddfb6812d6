"""A grid of voxels, and sets of directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.typing import Array, Floats

BELTS, SECTORS = 6, 9
DIRECTIONS = BELTS * SECTORS
"""How many directions are distinguished: belts of equal area around the vertical, cut into sectors."""


@final
@dataclass(frozen=True, eq=False)
class Grid:
    """Cubes of equal size, numbered with z fastest.

    Attributes:
        origin: The lowest corner of the first, (3,) [m].
        voxel: The length of their edges [m].
        shape: How many there are along x, y and z.
    """

    origin: Floats
    voxel: float
    shape: tuple[int, int, int]

    @classmethod
    def around(cls, low: Floats, high: Floats, voxel: float) -> Grid:
        """The grid that covers a box.

        Args:
            low: Its lowest corner, (3,) [m].
            high: Its highest corner, (3,) [m].
            voxel: The length of the edges [m].

        Returns:
            The grid; its voxels begin at multiples of their edge.
        """
        first, last = np.floor(low / voxel).astype(int), np.ceil(high / voxel).astype(int)
        x, y, z = np.maximum(last - first, 1).tolist()
        return cls(first * voxel, voxel, (x, y, z))

    @property
    def size(self) -> int:
        """How many voxels there are."""
        return int(np.prod(self.shape))

    def numbers(self, points: Floats) -> tuple[Array, Array]:
        """In which voxels points lie.

        Args:
            points: Points, (n, 3) [m].

        Returns:
            The numbers of their voxels, (n,), and which points lie in one, (n,).
        """
        place = np.floor((points - self.origin) * (1.0 / self.voxel)).astype(np.int32)
        x, y, z = place.T
        a, b, c = self.shape
        inside = (x >= 0) & (x < a) & (y >= 0) & (y < b) & (z >= 0) & (z < c)
        return (x.astype(np.int64) * b + y) * c + z, inside

    def centres(self, numbers: Array) -> Floats:
        """The centres of voxels, (n, 3) [m], from their numbers (n,)."""
        place = np.stack(np.unravel_index(numbers, self.shape), axis=-1)
        return self.origin + (place + 0.5) * self.voxel


def direction_numbers(axis: Floats) -> Array:
    """The numbers, (n,), of the directions that unit vectors (n, 3) point to."""
    belt = np.clip(((axis[:, 2] + 1.0) * (0.5 * BELTS)).astype(np.int64), 0, BELTS - 1)
    angle = np.arctan2(axis[:, 1], axis[:, 0])
    sector = np.clip(((angle + np.pi) * (SECTORS / (2.0 * np.pi))).astype(np.int64), 0, SECTORS - 1)
    return belt * SECTORS + sector


def bits(seen: Any) -> Array:
    """Truth values (n, DIRECTIONS) as one number each, (n,) uint64."""
    weights = np.uint64(1) << np.arange(DIRECTIONS, dtype=np.uint64)
    return np.where(seen, weights, np.uint64(0)).sum(axis=1, dtype=np.uint64)


def count_bits(sets: Array) -> Array:
    """How many directions are in sets (n,) uint64."""
    return np.bitwise_count(sets)
