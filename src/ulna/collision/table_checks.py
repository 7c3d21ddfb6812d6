"""Checks of pairs of links by tables of proved clearance, in float64; where a table proves nothing, by spheres."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any, final

import numpy as np

from ulna.collision import clearance as gap
from ulna.collision.pair_tables import PairTable
from ulna.collision.solids import Missing
from ulna.collision.sphere_kernels import sphere_kernel
from ulna.collision.spheres import LinkSpheres, Spheres
from ulna.collision.world import World
from ulna.model import Model
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.typing import Floats

_ROWS = 256  # configurations whose spheres are compared at once


@final
class TableChecks:
    """The pairs of a robot that have tables, in one world.

    Args:
        model: The robot.
        world: The world, which says how far links must stay apart.
        spheres: Spheres of the links.
        tables: The tables.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.
    """

    def __init__(
        self, model: Model, world: World, spheres: Spheres, tables: Sequence[PairTable], missing: Missing
    ) -> None:
        self._pairs = [_TablePair(model, world, spheres, table, missing) for table in tables]

    def __len__(self) -> int:
        return len(self._pairs)

    def least(self, q: Floats, placed: Mapping[str, Floats], limit: Floats) -> Floats:
        """The least clearances of all pairs, as far as they are below a limit.

        Args:
            q: Configurations, shape (n, nq) [rad, m].
            placed: Centres of the spheres by link, shape (n, spheres, 3) [m].
            limit: Lengths, shape (n,) [m].

        Returns:
            The lesser of limit and clearance, shape (n,) [m].
        """
        for pair in self._pairs:
            limit = np.minimum(limit, pair.clearance(q, placed, limit))
        return limit

    def each(self, q: Floats, placed: Mapping[str, Floats]) -> Iterator[tuple[float, str, str, bool]]:
        """The clearances of all pairs at one configuration.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            placed: Centres of the spheres by link, shape (spheres, 3) [m].

        Yields:
            The clearance [m], the names of a link that moves and of another, and whether that one moves, too.
        """
        rows = {name: np.asarray(centres)[None] for name, centres in placed.items()}
        for pair in self._pairs:
            (distance,) = pair.clearance(q[None], rows, np.full(1, np.inf))
            yield float(distance), *pair.names, pair.is_moving


@final
class _TablePair:
    """One pair that has a table; arguments as for `TableChecks`."""

    def __init__(
        self, model: Model, world: World, spheres: Spheres, table: PairTable, missing: Missing
    ) -> None:
        first, second = table.first, table.second
        if model.link(first).joint < 0:
            first, second = second, first
        self.names, self._table = (first, second), table
        self._margin = world.margin(first, second)
        self.is_moving = model.link(second).joint >= 0
        self._balls: tuple[LinkSpheres, LinkSpheres] = spheres.links[first], spheres.links[second]
        self._fixed_parts = partial(gap.fixed_parts, model, [(first, second)], missing)

    @cached_property
    def _parts(self) -> list[tuple[gap.Kind, Floats]]:
        """The numbers of the parts of the link that never moves; those of meshes take a second."""
        return [(part.kind, gap.row(part, SE3.identity())) for part, _ in self._fixed_parts()]

    def clearance(self, q: Floats, placed: Mapping[str, Floats], limit: Floats) -> Floats:
        """Clearances, less the margin, exact only where they are below the limits; arguments as for `least`."""
        result = self._table.clearance(q)
        is_unproved = result <= 0.0
        result = result - self._margin
        again = np.flatnonzero(result < limit if self.is_moving else is_unproved)
        for begin in range(0, len(again), _ROWS):
            rows = again[begin : begin + _ROWS]
            by_spheres = self._by_spheres(placed, rows) - self._margin
            if self.is_moving:  # the spheres may prove more
                by_spheres = np.maximum(np.where(is_unproved[rows], -np.inf, result[rows]), by_spheres)
            else:  # as in machine code, which has no spheres for these
                by_spheres = np.minimum(by_spheres, -self._margin)
            result[rows] = by_spheres
        return result

    def _by_spheres(self, placed: Mapping[str, Floats], rows: Any) -> Floats:
        """Signed distances by spheres, shape (rows,) [m]."""
        balls, centres = self._balls, placed[self.names[0]][rows]
        if self.is_moving:
            apart = np.linalg.norm(centres[:, :, None] - placed[self.names[1]][rows][:, None], axis=-1)
            return (apart - balls[0].radii[:, None] - balls[1].radii).min(axis=(1, 2))
        c, r = centres[:, :, None], balls[0].radii[:, None]
        least_of_pairs = [
            sphere_kernel("signed", kind)(c, r, numbers[None], 0.0).min(axis=(1, 2))
            for kind, numbers in self._parts
        ]
        return np.minimum.reduce(least_of_pairs)
