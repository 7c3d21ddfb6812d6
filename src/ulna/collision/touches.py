"""Which links touch what in one configuration, and by how much, in float64."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

import numpy as np

from ulna.collision.clearance import Kind
from ulna.collision.pairs import LinkPair
from ulna.collision.sphere_kernels import sphere_kernel
from ulna.collision.spheres import Spheres, sphere_centres
from ulna.collision.table_checks import TableChecks
from ulna.collision.world import World
from ulna.model import Model
from ulna.typing import ArrayLike, Floats


class _SpheresInWorld(Protocol):
    """What is asked of a `SphereChecker` here; that class uses this module."""

    model: Model
    world: World
    spheres: Spheres
    covering: Spheres
    sphere_pairs: tuple[LinkPair, ...]
    table_checks: TableChecks
    attached_pairs: tuple[LinkPair, ...]
    carriers: dict[str, str]

    def static_groups(
        self, moving: Mapping[str, ArrayLike] | None = None
    ) -> list[tuple[Kind, tuple[str, ...], Floats, tuple[str, ...]]]: ...

    def cloud_distances(
        self, link: str, centres: Floats, moving: Mapping[str, ArrayLike] | None = None
    ) -> list[tuple[str, float]]: ...


def deepest_touch(
    checker: _SpheresInWorld, q: Floats, moving: Mapping[str, ArrayLike] | None = None, margin: float = 0.0
) -> tuple[float, str, str]:
    """The two things that are nearest to each other, or overlap most, by their spheres.

    Args:
        checker: The robot in its world.
        q: Configuration, shape (nq,) [rad, m].
        moving: Poses of moving obstacles by name, T_world_shape, shape (4, 4) [m].
        margin: By how much every link and attached object is larger when things are compared, so that it counts twice
            between two of them [m].

    Returns:
        Their clearance [m], negative where they overlap, less the margin that the world has for them; a link or
        attached object, and what is near it: an obstacle, another link or object.
    """
    placed = sphere_centres(checker.model, q, checker.spheres)
    by_tables = [
        (distance - (2.0 if is_moving else 1.0) * margin, distance, *names)
        for distance, *names, is_moving in checker.table_checks.each(q, placed)
    ]
    touches = [
        *by_tables,
        *((distance - margin, distance, *names) for distance, *names in _to_obstacles(checker, q, moving)),
        *((distance - 2.0 * margin, distance, *names) for distance, *names in _to_each_other(checker, q)),
    ]
    _, distance, link, other = min(touches, default=(np.inf, np.inf, "", ""))
    return distance, link, other


def _to_obstacles(
    checker: _SpheresInWorld, q: Floats, moving: Mapping[str, ArrayLike] | None
) -> Iterator[tuple[float, str, str]]:
    """The clearances of links from obstacles, and from links that do not move, by their real shapes."""
    spheres = checker.covering.links
    placed = sphere_centres(checker.model, q, checker.covering, checker.carriers)
    for kind, links, rows, owners in checker.static_groups(moving):
        for link in links:
            c, r = placed[link][:, None], spheres[link].radii[:, None]
            distances = sphere_kernel("signed", kind)(c, r, rows, 0.0).min(axis=0)
            part = int(distances.argmin())
            yield float(distances[part]), link, owners[part]
    for link, centres in placed.items():
        for owner, distance in checker.cloud_distances(link, centres, moving):
            yield distance, link, owner


def _to_each_other(checker: _SpheresInWorld, q: Floats) -> Iterator[tuple[float, str, str]]:
    """The clearances of moving links and objects from each other."""
    spheres = checker.covering.links
    placed = sphere_centres(checker.model, q, checker.covering, checker.carriers)
    still = {link.name for link in checker.model.links if link.joint < 0}
    for a, b in (*checker.sphere_pairs, *checker.attached_pairs):
        if a in still or b in still:
            continue  # these count by their real shapes, as obstacles do
        apart = np.linalg.norm(placed[a][:, None] - placed[b][None], axis=2) - checker.world.margin(a, b)
        yield float((apart - spheres[a].radii[:, None] - spheres[b].radii[None]).min()), a, b
