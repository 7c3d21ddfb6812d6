"""Which of many configurations touch anything, by spheres: as many at once as there are lanes.

float32 places every sphere wrongly by at most epsilon. With spheres larger by epsilon, what is free is free for sure;
with spheres smaller by epsilon, what touches touches for sure. What lies in between is left to float64.
"""

from __future__ import annotations

import threading
from typing import final

import numpy as np

from ulna.collision.lanes.moving import links_of
from ulna.collision.lanes.primitives import (
    centre,
    near_each_other,
    near_plane,
    near_point,
    within_obstacle,
)
from ulna.collision.lanes.single import DOUBTFUL, FREE, StateCheck
from ulna.collision.lanes.table_lookup import table_clearance
from ulna.collision.lanes.tables import Scene
from ulna.collision.lanes.touching import (
    Tables,
    Work,
    bound_row,
    extent_of,
    lanes_near_cloud,
    on_body,
    overlapping,
    pair_in_doubt,
    place_bounds,
    placed_row,
)
from ulna.collision.pair_tables import PairTable
from ulna.collision.pairs import LinkPair
from ulna.collision.point_grid import lane_touches
from ulna.collision.solids import Missing
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Kernel,
    all_of,
    any_of,
    count_of,
    f32,
    f64,
    first_of,
    lane_numbers,
    procedure,
)
from ulna.errors import InputError
from ulna.model import Model
from ulna.typing import Array, Floats

_CHUNK = 32768  # configurations of a call, which cannot be interrupted: some milliseconds


@procedure(contract=True)
def _lane_with_obstacle(tables, g, k, less, lane, R, W):
    """2 if a group touches an obstacle in one lane for sure, 1 if it may, else 0: lanes hold spheres; R: the poses."""
    at = tables.bodies[g] * W + lane
    t, answer = at + 9 * W, 0
    for s in range(tables.first[g], tables.first[g + 1], W):
        u, v, w = tables.columns[0, s : s + W], tables.columns[1, s : s + W], tables.columns[2, s : s + W]
        x = R[at] * u + R[at + W] * v + R[at + 2 * W] * w + R[t]
        y = R[at + 3 * W] * u + R[at + 4 * W] * v + R[at + 5 * W] * w + R[t + W]
        z = R[at + 6 * W] * u + R[at + 7 * W] * v + R[at + 8 * W] * w + R[t + 2 * W]
        r, is_one = tables.columns[3, s : s + W], lane_numbers(W) < tables.first[g + 1] - s
        if any_of(within_obstacle(tables, k, x, y, z, r) & is_one):
            if any_of(within_obstacle(tables, k, x, y, z, r - less) & is_one):
                return 2
            answer = 1
    return answer


@procedure
def _with_obstacle(tables, g, k, less, maybe, sure, work, W):
    """The lanes in which a group may touch the obstacle of column k, and does for sure, and those known before."""
    x, y, z = centre(work.c, bound_row(tables, g), W)
    near = within_obstacle(tables, k, x, y, z, tables.bounds[g, 3]) & ~sure
    count = tables.first[g + 1] - tables.first[g]
    if 4 * count_of(near) * ((count + W - 1) // W) < 3 * count:  # few configurations: the spheres in lanes
        while any_of(near):
            lane = first_of(near)
            this, answer = (
                lane_numbers(W) == lane,
                _lane_with_obstacle(tables, g, k, less, lane, work.c, W),
            )
            if answer > 0:
                maybe = maybe | this
            if answer > 1:
                sure = sure | this
            near = near & ~this
    else:
        for s in range(tables.first[g], tables.first[g + 1]):
            x, y, z = centre(work.c, placed_row(tables, g, s, work, W), W)
            maybe = maybe | within_obstacle(tables, k, x, y, z, tables.spheres[s, 3])
            sure = sure | within_obstacle(tables, k, x, y, z, tables.spheres[s, 3] - less)
    return maybe, sure


@procedure
def _with_obstacles(tables, g, less, maybe, sure, work, W):
    """The lanes in which a group may touch boxes, cylinders or half spaces, and does, and those known before."""
    r, row = tables.bounds[g, 3], bound_row(tables, g)
    x, y, z, to_x, to_y, to_z = extent_of(tables, g, r, work, W)
    for i in range(0, tables.extents.shape[1], W):
        overlap = overlapping(tables, g, i, x, y, z, to_x, to_y, to_z, W)
        while any_of(overlap):
            lane = first_of(overlap)
            maybe, sure = _with_obstacle(tables, g, i + lane, less, maybe, sure, work, W)
            overlap = overlap & (lane_numbers(W) != lane)
    for k in range(len(tables.planes)):
        if tables.plane_masks[g, k] > 0 and any_of(near_plane(tables.planes, k, work.c, row, r, W) & ~sure):
            for s in range(tables.first[g], tables.first[g + 1]):
                c, r = placed_row(tables, g, s, work, W), tables.spheres[s, 3]
                maybe = maybe | near_plane(tables.planes, k, work.c, c, r, W)
                sure = sure | near_plane(tables.planes, k, work.c, c, r - less, W)
    return maybe, sure


@procedure
def _with_cloud(tables, g, k, less, maybe, sure, work, W):
    """The lanes in which a group may touch a cloud, and does for sure, and those known before."""
    apart = tables.cloud_margins[g, k] + tables.clouds.numbers[k, 1]
    reach = tables.bounds[g, 3] + apart
    square, x, y, z = lanes_near_cloud(tables, k, bound_row(tables, g), reach, work, W)
    if any_of((square <= reach * reach) & ~sure):
        for s in range(tables.first[g], tables.first[g + 1]):
            span = tables.spans[s] + apart
            is_open = (square <= span * span) & ~sure
            if any_of(is_open):
                row, reach = placed_row(tables, g, s, work, W), tables.spheres[s, 3] + apart
                near, x, y, z = lanes_near_cloud(tables, k, row, reach, work, W)
                is_open = is_open & (near <= reach * reach)
                while any_of(is_open):
                    this = lane_numbers(W) == first_of(is_open)
                    if lane_touches(tables.clouds, k, x, y, z, reach, this, W):
                        maybe = maybe | this
                        if lane_touches(tables.clouds, k, x, y, z, reach - less, this, W):
                            sure = sure | this
                    is_open = is_open & ~this
    return maybe, sure


@procedure
def _surely_unproved(tables, k, less, in_doubt, work, W):
    """The lanes of `in_doubt` in which the table of a pair, if it has one, does not prove a smaller reach either."""
    g = tables.grids.of_pair[k]
    if g >= 0:
        reach = tables.grids.pair_reach[k] - f32(2.0) * less
        return in_doubt & (table_clearance(tables.grids, g, work.q, W) <= reach)
    return in_doubt


@procedure
def _with_fixed_links(tables, less, maybe, sure, work, W):
    """The lanes in which links may touch links that never move, by tables, and do, and those known before."""
    for k in range(len(tables.grids.fixed)):
        apart = table_clearance(tables.grids, tables.grids.fixed[k], work.q, W)
        maybe = maybe | (apart <= tables.grids.fixed_reach[k])
        sure = sure | (apart <= tables.grids.fixed_reach[k] - less)
    return maybe, sure


@procedure
def _with_pair(tables, k, less, maybe, sure, work, W):
    """The lanes in which spheres of the groups of a pair may touch, and do for sure, and those known before."""
    a, b = tables.pairs[k, 0], tables.pairs[k, 1]
    in_doubt = pair_in_doubt(tables, k, work, W) & ~sure
    if any_of(in_doubt):
        bound = tables.bounds[b, 3] + tables.pair_margins[k]
        surely = _surely_unproved(tables, k, less, in_doubt, work, W)
        x, y, z = on_body(tables.bodies[a], work.c, bound_row(tables, b), W)
        for n in range(tables.pairs[k, 2], tables.pairs[k, 3]):
            i = tables.rows[n, 0]
            if any_of(near_point(tables.spheres, i, x, y, z, bound, W) & in_doubt & ~sure):
                row = placed_row(tables, a, i, work, W)
                for m in range(tables.rows[n, 1], tables.rows[n + 1, 1]):
                    j = tables.partners[m]
                    reach = tables.spheres[i, 3] + tables.spheres[j, 3] + tables.pair_margins[k]
                    other = placed_row(tables, b, j, work, W)
                    maybe = maybe | (near_each_other(work.c, row, other, reach, W) & in_doubt)
                    sure = sure | (near_each_other(work.c, row, other, reach - f32(2.0) * less, W) & surely)
    return maybe, sure


@procedure
def touching_lanes(tables, less, maybe, sure, work, W):
    """The lanes in which anything may touch, and in which it does for sure.

    Args:
        tables: What is checked against what, with spheres larger by what float32 may place them wrongly.
        less: By how much spheres that touch for sure are smaller [m].
        maybe: Lanes that are known to be the one.
        sure: Lanes that are known to be the other, or are not asked for.
        work: Holds the poses; the rest is overwritten.
        W: Lanes, a constant.

    Returns:
        Two masks.
    """
    place_bounds(tables, work, W)
    for i in range(len(tables.bodies)):
        g = len(tables.bodies) - 1 - i
        maybe, sure = _with_obstacles(tables, g, less, maybe, sure, work, W)
        for k in range(len(tables.clouds.poses)):
            if tables.cloud_margins[g, k] >= 0:
                maybe, sure = _with_cloud(tables, g, k, less, maybe, sure, work, W)
        if all_of(sure):
            return maybe, sure
    maybe, sure = _with_fixed_links(tables, less, maybe, sure, work, W)
    for k in range(len(tables.pairs)):
        maybe, sure = _with_pair(tables, k, less, maybe, sure, work, W)
        if all_of(sure):
            return maybe, sure
    return maybe, sure


@procedure
def _read_lanes(points, low, high, first, q, W):
    """Copies W configurations into lanes, beyond the last the last; which are out of the range, and not copied."""
    outside = lane_numbers(W) < 0
    for lane in range(W):
        i = min(first + lane, len(points) - 1)
        is_inside = True
        for k in range(len(q)):
            is_inside = is_inside and low[k] <= points[i, k] and points[i, k] <= high[k]
        if is_inside:
            for k in range(len(q)):
                q[k, lane] = f32(points[i, k])
        else:
            outside = outside | (lane_numbers(W) == lane)
    return outside


@procedure(constants={"W": 8})
def which_touch(
    kernel: Kernel, tables: Tables, less: f32, low: Array1[f64], high: Array1[f64], points: Array2[f64],
    answers: Array1[f32], work: Work, W: int,
) -> None:  # fmt: skip
    """Writes for each configuration what `classified_state` returns for it: free, touching, or in doubt.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what, with spheres larger by what float32 may place them wrongly.
        less: By how much spheres that touch for sure are smaller [m].
        low: From where on the bounds of rounding hold, shape (n,) [rad, m].
        high: Up to where, shape (n,) [rad, m].
        points: Configurations, shape (count, n) [rad, m].
        answers: Receives the answers, shape (count filled up to whole registers,).
        work: Working storage.
        W: Lanes, a constant.
    """
    for first in range(0, len(points), W):
        outside = _read_lanes(points, low, high, first, work.q, W)
        kernel(work.q, work.c)
        maybe, sure = touching_lanes(tables, less, outside, outside, work, W)
        answer = np.where(maybe, np.where(sure & ~outside, f32(1.0), f32(2.0)), f32(0.0))
        answers[first : first + W] = answer


def batch_scene(
    model: Model, world: World, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing,
    tables: tuple[PairTable, ...],
) -> Scene | None:  # fmt: skip
    """What checks of a robot in a world share.

    Args:
        model: The robot.
        world: The obstacles, and what links carry.
        spheres: Spheres of the links.
        pairs: Pairs of links to check against each other.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.
        tables: Tables of proved clearance of some of the pairs.

    Returns:
        The scene; None where float32 does not do: joints whose positions are no plain numbers, nothing that moves, or
        something more than 100 m away.
    """
    try:
        scene = Scene(links_of(model, spheres, pairs, missing, tables), spheres, pairs, world, missing)
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
            self._larger, smaller = (scene.check_tables(reach, sign) for sign in (1.0, -1.0))
        less = np.float32(2.0 * scene.moving.rounding)
        is_small = (self._larger.spheres[:, 3] <= less).any()
        self._less = np.float32(np.nan) if is_small else less  # nan: nothing touches for sure
        self._procedure = which_touch.specialized(W=scene.lanes)
        self._storage = threading.local()
        self.state = StateCheck(scene, self._larger, smaller)
        """The check of single configurations."""

    def run(self, q: Floats) -> tuple[Array, Array]:
        """Looks at configurations.

        Args:
            q: Configurations, shape (n, nq) [rad, m].

        Returns:
            Which touch, and which are in doubt and counted as touching: those between the two passes, and those
            out of the range in which the bounds of rounding hold; truth values (n,).
        """
        work = getattr(self._storage, "work", None)
        if work is None:
            work = self._storage.work = self._scene.moving.work()
        lanes, robot = self._scene.lanes, self._scene.robot
        answers = np.empty(-(-len(q) // lanes) * lanes, np.float32)
        for first in range(0, len(q), _CHUNK):
            rows = np.ascontiguousarray(q[first : first + _CHUNK])
            part = answers[first : first + -(-len(rows) // lanes) * lanes]
            self._procedure(robot.kernel, self._larger, self._less, *robot.range, rows, part, work)
        answers = answers[: len(q)]
        return answers != FREE, answers == DOUBTFUL
