"""Which of many configurations touch anything, by spheres: as many at once as there are lanes.

float32 places every sphere wrongly by at most epsilon. With spheres larger by epsilon, what is free is free for sure;
with spheres smaller by epsilon, what touches touches for sure. What lies in between is left to float64.
"""

from __future__ import annotations

import threading
from typing import final

import numpy as np

from ulna.collision.lanes.single import StateCheck
from ulna.collision.lanes.tables import Scene, links_of
from ulna.collision.lanes.touching import (
    Tables,
    Work,
    near_box,
    near_cylinder,
    near_each_other,
    near_plane,
    place,
    placed_row,
)
from ulna.collision.pairs import LinkPair
from ulna.collision.point_grid import in_cloud, lane_touches, maybe_near
from ulna.collision.solids import Missing
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Kernel,
    all_of,
    any_of,
    f32,
    first_of,
    lane_numbers,
    procedure,
)
from ulna.errors import InputError
from ulna.model import Model
from ulna.typing import Array, Floats

_CHUNK = 4096  # configurations of a call, which cannot be interrupted: some milliseconds


@procedure
def _touching_obstacles(tables, g, is_touching, work, W):
    """The lanes in which a group touches boxes, cylinders or half spaces, and those that touched before."""
    row, r = 3 * g, tables.bounds[g, 3]
    boxes = len(tables.boxes)
    for k in range(boxes):
        if tables.masks[g, k] > 0 and any_of(near_box(tables.boxes, k, work.c, row, r, W) & ~is_touching):
            for s in range(tables.first[g], tables.first[g + 1]):
                c = placed_row(tables, g, s, work, W)
                is_touching = is_touching | near_box(tables.boxes, k, work.c, c, tables.spheres[s, 3], W)
    for k in range(len(tables.cylinders)):
        if tables.masks[g, boxes + k] > 0 and any_of(
            near_cylinder(tables.cylinders, k, work.c, row, r, W) & ~is_touching
        ):
            for s in range(tables.first[g], tables.first[g + 1]):
                c = placed_row(tables, g, s, work, W)
                is_touching = is_touching | near_cylinder(
                    tables.cylinders, k, work.c, c, tables.spheres[s, 3], W
                )
    for k in range(len(tables.planes)):
        if tables.plane_masks[g, k] > 0 and any_of(
            near_plane(tables.planes, k, work.c, row, r, W) & ~is_touching
        ):
            for s in range(tables.first[g], tables.first[g + 1]):
                c = placed_row(tables, g, s, work, W)
                is_touching = is_touching | near_plane(tables.planes, k, work.c, c, tables.spheres[s, 3], W)
    return is_touching


@procedure
def _touching_clouds(tables, g, is_touching, work, W):
    """The lanes in which a group touches clouds, and those that touched before."""
    for k in range(len(tables.clouds.poses)):
        margin = tables.cloud_margins[g, k]
        if margin >= 0:
            x, y, z = in_cloud(tables.clouds.poses, k, work.c, 3 * g, W)
            if any_of(maybe_near(tables.clouds, k, x, y, z, tables.bounds[g, 3] + margin, W) & ~is_touching):
                for s in range(tables.first[g], tables.first[g + 1]):
                    c, r = placed_row(tables, g, s, work, W), tables.spheres[s, 3] + margin
                    x, y, z = in_cloud(tables.clouds.poses, k, work.c, c, W)
                    is_open = maybe_near(tables.clouds, k, x, y, z, r, W) & ~is_touching
                    while any_of(is_open):
                        this = lane_numbers(W) == first_of(is_open)
                        if lane_touches(tables.clouds, k, x, y, z, r, this, W):
                            is_touching = is_touching | this
                        is_open = is_open & ~this
    return is_touching


@procedure
def _touching_pairs(tables, k, is_touching, work, W):
    """The lanes in which spheres of the groups of a pair touch, and those that touched before."""
    a, b = tables.pairs[k, 0], tables.pairs[k, 1]
    bound = tables.bounds[b, 3] + tables.pair_margins[k]
    if any_of(near_each_other(work.c, 3 * a, 3 * b, tables.bounds[a, 3] + bound, W) & ~is_touching):
        for n in range(tables.pairs[k, 2], tables.pairs[k, 3]):
            i = tables.rows[n, 0]
            r = tables.spheres[i, 3]
            row = placed_row(tables, a, i, work, W)
            if any_of(near_each_other(work.c, row, 3 * b, r + bound, W) & ~is_touching):
                for m in range(tables.rows[n, 1], tables.rows[n + 1, 1]):
                    j = tables.partners[m]
                    reach = r + tables.spheres[j, 3] + tables.pair_margins[k]
                    other = placed_row(tables, b, j, work, W)
                    is_touching = is_touching | near_each_other(work.c, row, other, reach, W)
    return is_touching


@procedure
def touching_lanes(tables, work, W):
    """The lanes in which anything touches.

    Args:
        tables: What is checked against what.
        work: Holds the poses; the rest is overwritten.
        W: Lanes, a constant.

    Returns:
        A mask.
    """
    is_touching = lane_numbers(W) < 0
    for s in range(len(tables.spheres)):
        work.is_placed[s] = 0
    for g in range(len(tables.bodies)):
        place(tables.bounds, g, work.pose, tables.bodies[g], work.c, 3 * g, W)
    for i in range(len(tables.bodies)):
        g = len(tables.bodies) - 1 - i
        is_touching = _touching_obstacles(tables, g, is_touching, work, W)
        is_touching = _touching_clouds(tables, g, is_touching, work, W)
        if all_of(is_touching):
            return is_touching
    for k in range(len(tables.pairs)):
        is_touching = _touching_pairs(tables, k, is_touching, work, W)
        if all_of(is_touching):
            return is_touching
    return is_touching


@procedure(constants={"W": 8})
def which_touch(
    kernel: Kernel, tables: Tables, points: Array2[f32], touching: Array1[f32], count: int, work: Work, W: int
) -> None:
    """Writes 1 for each configuration in which anything touches, else 0.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        points: Configurations, shape (at least count, n) [rad, m].
        touching: Receives the answers, shape (at least count,).
        count: How many configurations there are.
        work: Working storage.
        W: Lanes, a constant.
    """
    for first in range(0, count, W):
        for lane in range(W):
            i = min(first + lane, count - 1)
            for k in range(points.shape[1]):
                work.q[k, lane] = points[i, k]
        kernel(work.q, work.pose)
        is_touching = touching_lanes(tables, work, W)
        for lane in range(min(W, count - first)):
            touching[first + lane] = f32(0.0)
        while any_of(is_touching):
            lane = first_of(is_touching)
            if first + lane < count:
                touching[first + lane] = f32(1.0)
            is_touching = is_touching & (lane_numbers(W) != lane)


def batch_scene(
    model: Model, world: World, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing
) -> Scene | None:
    """What checks of a robot in a world share.

    Args:
        model: The robot.
        world: The obstacles, and what links carry.
        spheres: Spheres of the links.
        pairs: Pairs of links to check against each other.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.

    Returns:
        The scene; None where float32 does not do: joints whose positions are no plain numbers, nothing that moves, or
        something more than 100 m away.
    """
    try:
        scene = Scene(links_of(model, spheres, pairs, missing), spheres, pairs, world, missing)
        scene.tables(0.0)
    except InputError:
        return None
    return scene


@final
class BatchCheck:
    """Which of many configurations touch anything, or come nearer than a reach: by float32, with proof.

    Args:
        scene: The robot and the world.
        reach: How near counts as touching, added once to every distance [m].
    """

    def __init__(self, scene: Scene, reach: float) -> None:
        self._scene = scene
        with np.errstate(over="ignore"):  # whatever is within a reach of inf touches
            self._larger, self._smaller = (scene.check_tables(reach, sign) for sign in (1.0, -1.0))
        self._range = scene.robot.range
        self._procedure = which_touch.specialized(W=scene.lanes)
        self._storage = threading.local()
        self.state = StateCheck(scene, self._larger, self._smaller)
        """The check of single configurations."""

    def run(self, q: Floats) -> tuple[Array, Array]:
        """Looks at configurations.

        Args:
            q: Configurations, shape (n, nq) [rad, m].

        Returns:
            Which touch, and which are in doubt and counted as touching: those between the two passes, and those
            out of the range in which the bounds of rounding hold; truth values (n,).
        """
        with np.errstate(over="ignore"):  # what is inf in float32 is out of range, and in doubt
            q32 = np.ascontiguousarray(q, np.float32)
        touching = self._pass(self._larger, q32)
        rows = np.flatnonzero(touching)
        is_doubtful = np.zeros(len(q), dtype=bool)
        is_doubtful[rows] = ~self._pass(self._smaller, q32[rows])
        is_doubtful |= ~((q >= self._range[0]) & (q <= self._range[1])).all(axis=1)
        return touching | is_doubtful, is_doubtful

    def _pass(self, tables: Tables, q: Array) -> Array:
        touching = np.zeros(len(q), np.float32)
        work = getattr(self._storage, "work", None)
        if work is None:
            work = self._storage.work = self._scene.moving.work()
        for first in range(0, len(q), _CHUNK):
            part = slice(first, first + _CHUNK)
            rows = q[part]
            self._procedure(self._scene.robot.kernel, tables, rows, touching[part], len(rows), work)
        return touching > 0.0
