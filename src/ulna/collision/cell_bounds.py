"""How near two links come anywhere in cells of configurations of the joints between them.

| symbol | meaning | unit |
|---|---|---|
| c, h_k | middle of a cell, and half its width in joint k | [rad, m] |
| S_k, w_k | twist of joint k for one unit of its position, and how fast it turns | [1], [m], [1] |
| rho_k | greatest speed of a point of one link when joint k moves, with the joints between them at c | [m/rad], [1] |
| b | bound of how much nearer the links come in the cell than at c | [m] |
| n | direction from one solid to another at c, both on their sides of planes across it | [1] |
| R | bound of what the motion of a point adds to its first derivative | [m] |
| s_k | how much farther apart the links are proved to be at the end of the cell in joint k than at c | [m] |

Seen from between joints j and j + 1, joints 1 to j move the first link and the others the second. Move the joints
nearest to that place first: each then moves points of its link that stand as at c, so no point moves farther than the
sum of rho_k h_k, and b is the least of these sums over j. Links that slide along each other come nearer by far less: a
point x of a link moves along n by sum_k delta_k n (S_k x), and by R more at most, with abs(delta_k) <= h_k and
R = sum_ik h_i h_k w_i rho'_k / 2 with i nearer to the place than k, and rho' the greatest in the cell. Most points that
are far out move alike, so the planes are apart by v + sum_k s_k delta_k / h_k at least, where v is the least over the
points of what n x is, less sum_k abs(h_k n (S_k x) - s_k), less R. Any s are right; good ones are in the middle of what
the points that may touch do. What is proved for two solids is the better of d - b and of the distance of the planes;
for links the least of their solids, with the same s. Source: Schwarzer, Saha and Latombe, Adaptive dynamic collision
checking, IEEE Transactions on Robotics 21 (2005), for b, with lengths at c; the planes follow from Taylor's theorem.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple, final

import numpy as np

from ulna.algorithms.multibody.batch_shapes import broadcast_pose
from ulna.collision.joint_chains import JointChain
from ulna.collision.link_points import LinkPoints, LinkSpeeds, fewer_points, joined_points, solid_points
from ulna.collision.pair_distance import PairDistance
from ulna.collision.solids import Solid
from ulna.compiler.procedures import Array1, Array2, Array3, broadcast, f64, least_of, procedure
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_COAL = 2e-6  # upper bound of the error of coal's distances [m]
SLOPE_STEP = 2.5e-4
"""Slopes are multiples of this [m]."""

MOST_SLOPE = 127
"""The greatest slope, in steps."""

ENOUGH = 0.25
"""Where b is this part of the distance, the distance need not be known better."""


@final
class CellBounds:
    """Proved clearances of two links.

    Args:
        chain: The joints between them.
        solids: The solids of both.
    """

    def __init__(self, chain: JointChain, solids: tuple[Sequence[Solid], Sequence[Solid]]) -> None:
        self._chain = chain
        self._distance = PairDistance(*solids)
        self._sides = tuple(
            _Side(chain, those, is_first) for those, is_first in zip(solids, (True, False), strict=True)
        )

    def approach(self, q: Floats, half: Floats) -> Floats:
        """b of cells.

        Args:
            q: The middles, shape (n, nq) [rad, m].
            half: h by column, shape (columns,) [rad, m].

        Returns:
            Lengths, shape (n,) [m].
        """
        _, *poses = self._chain.poses(q)
        widths = self._chain.widths(half)
        return _least_approach(
            [side.speeds(T, len(q)) for side, T in zip(self._sides, poses, strict=True)], widths
        )[0]

    def proved(self, q: Floats, half: Floats) -> Proved:
        """Distances at the middles of cells, and what is proved for all of the cells.

        Args:
            q: The middles, shape (n, nq) [rad, m].
            half: h by column, shape (columns,) [rad, m].

        Returns:
            What is proved.
        """
        cells = self._cells(q, half)
        gaps = self._distance.gaps(cells.T)
        distance, slopes = gaps.min(axis=1), np.zeros((len(q), len(cells.widths)))
        clearance = distance - cells.b
        result = Proved(distance, clearance, np.zeros((len(q), len(half))), 0)
        rows = np.flatnonzero(~((distance > 0.0) & (cells.b <= ENOUGH * distance)))
        if len(rows):
            known = _Known(gaps, self._distance, cells.T)
            pairs = self._nearest(known, cells, rows)
            distance[rows] = known.distances[rows, pairs]
            clearance[rows] = distance[rows] - cells.b[rows] - _COAL
            is_near = (cells.b[rows] > ENOUGH * distance[rows]) & (distance[rows] > -cells.b[rows])
            rows, pairs = rows[is_near], pairs[is_near]
            slopes[rows] = self._slopes(known.normals[rows, pairs], pairs, cells, rows)
            clearance[rows] = self._least_of_pairs(known, pairs, cells, rows, slopes)
            result = result._replace(queries=known.queries)
        for j, (joint, sign) in enumerate(zip(self._chain.joints, self._signs(cells.split), strict=True)):
            result.slopes[:, self._chain.columns.index(joint.column)] += sign * slopes[:, j]
        return result

    def _nearest(self, known: _Known, cells: _Cells, rows: Array) -> Array:
        """The numbers of the pairs of solids that are nearest at the middles, or touch in all of the cell, (rows,)."""
        open_bounds, at = known.bounds[rows], np.arange(len(rows))
        while len(at):
            pairs, where = open_bounds[at].argmin(axis=1), rows[at]
            known.compute(where, pairs)
            planes = self._planes(known.normals[where, pairs], cells, where, None) - _COAL
            known.bounds[where] = np.maximum(known.bounds[where], planes)
            open_bounds[at, pairs] = np.inf
            open_bounds[at] = np.maximum(open_bounds[at], planes)
            least = known.distances[where].min(axis=1)
            at = at[(open_bounds[at].min(axis=1) < least) & (least > -cells.b[where])]
        return known.distances[rows].argmin(axis=1)

    def _cells(self, q: Floats, half: Floats) -> _Cells:
        T, *poses = self._chain.poses(q)
        widths = self._chain.widths(half)
        speeds = [side.speeds(X, len(q)) for side, X in zip(self._sides, poses, strict=True)]
        b, split = _least_approach(speeds, widths)
        remainder = np.add.reduce(
            [side.beyond(rho, widths, split) for side, rho in zip(self._sides, speeds, strict=True)]
        )
        return _Cells(
            T, [[broadcast_pose(X, q) for X in side] for side in poses], widths, b, split, remainder
        )

    def _signs(self, split: Array) -> list[Floats]:
        """For each joint 1 where it moves its link as its twist says when its column grows, else -1, shape (n,)."""
        return [
            np.where((k < split) == joint.is_upward, 1.0, -1.0) * np.sign(joint.step.multiplier)
            for k, joint in enumerate(self._chain.joints)
        ]

    def _slopes(self, n: Floats, pairs: Array, cells: _Cells, rows: Array) -> Floats:
        """s of pairs of solids for directions n, shape (rows, joints) [m], before signs."""
        width = self._distance.width
        n_b = cells.in_second(n, rows)
        first = self._sides[0].slopes(-n, pairs // width, cells, rows)
        second = self._sides[1].slopes(n_b, pairs % width, cells, rows)
        most = MOST_SLOPE // max(Counter(joint.column for joint in self._chain.joints).values())
        return np.clip(np.rint((first + second) / SLOPE_STEP), -most, most) * SLOPE_STEP

    def _least_of_pairs(
        self, known: _Known, pairs: Array, cells: _Cells, rows: Array, slopes: Floats
    ) -> Floats:
        """What is proved of all solids of the links, with slopes s, shape (rows,) [m]."""
        displacement_bounds = cells.b + np.abs(slopes).sum(axis=1)
        bounds = known.bounds - displacement_bounds[:, None]
        is_sharp, at = np.zeros(bounds.shape, dtype=bool), rows
        while True:
            known.compute(at, pairs)
            is_sharp[at, pairs] = True
            bounds[at, pairs] = np.maximum(
                bounds[at, pairs], known.bounds[at, pairs] - displacement_bounds[at]
            )
            n = known.normals[at, pairs]
            planes = self._planes(n, cells, at, slopes[at]) - cells.remainder[at, None] - _COAL
            bounds[at] = np.maximum(bounds[at], planes)
            pairs = bounds[at].argmin(axis=1)
            is_new = ~is_sharp[at, pairs]  # else what decides is known
            at, pairs = at[is_new], pairs[is_new]
            if not len(at):
                return bounds[rows].min(axis=1)

    def _planes(self, n: Floats, cells: _Cells, rows: Array, slopes: Floats | None) -> Floats:
        """How far planes across directions n that touch the solids are apart, (rows, pairs) [m].

        With slopes s it is what they are apart in the cells at least, but for R; without, at the middles.
        """
        first = self._sides[0].least(-n, cells, rows, slopes)
        second = self._sides[1].least(cells.in_second(n, rows), cells, rows, slopes)
        between = (n * cells.T.translation[rows]).sum(axis=-1)
        return (first[:, :, None] + second[:, None] + between[:, None, None]).reshape(
            len(rows), first.shape[1] * second.shape[1]
        )


@final
class Proved(NamedTuple):
    """What is proved of cells.

    Attributes:
        distance: At the middles, shape (n,) [m]; not above 0 where the links touch, and less where balls around the
            solids suffice.
        clearance: What is proved there, less what slopes do not say, shape (n,) [m].
        slopes: s by column, shape (n, columns) [m].
        queries: How often coal was asked.
    """

    distance: Floats
    clearance: Floats
    slopes: Floats
    queries: int


@final
class _Cells(NamedTuple):
    """Cells, and how the links stand at their middles: T_a_b, the links in the joints' frames, h by joint, b, j, R."""

    T: SE3
    poses: list[list[SE3]]
    widths: Floats
    b: Floats
    split: Array
    remainder: Floats

    def in_second(self, n: Floats, rows: Array) -> Floats:
        """Directions in the frame of the second link's joint, shape (rows, 3)."""
        return (np.swapaxes(self.T.rotation[rows], -1, -2) @ n[..., None])[..., 0]


@final
class _Known:
    """What is known of the distances of solids at the middles of cells.

    Args:
        gaps: Lower bounds of them, shape (n, pairs) [m].
        distance: Computes them with coal.
        T: T_a_b, shape (n,) [m].
    """

    def __init__(self, gaps: Floats, distance: PairDistance, T: SE3) -> None:
        self.bounds, self._distance, self._T = gaps.copy(), distance, T
        self._is_computed = np.zeros(gaps.shape, dtype=bool)
        self.distances, self.normals = np.full(gaps.shape, np.inf), np.zeros((*gaps.shape, 3))
        self.queries = 0

    def compute(self, rows: Array, pairs: Array) -> None:
        """Computes the distances of pairs that are not known, with coal."""
        is_new = ~self._is_computed[rows, pairs]
        rows, pairs = rows[is_new], pairs[is_new]
        if len(rows):
            separations, n = self._distance.separations(
                SE3(self._T.rotation[rows], self._T.translation[rows]), pairs
            )
            length = np.linalg.norm(n, axis=1, keepdims=True)
            self.distances[rows, pairs] = separations
            self.bounds[rows, pairs] = np.maximum(self.bounds[rows, pairs], separations - _COAL)
            self.normals[rows, pairs] = n / np.maximum(length, 1.0)  # a shorter direction proves less
            self._is_computed[rows, pairs] = True
            self.queries += len(rows)


def _least_approach(speeds: Sequence[Floats], widths: Floats) -> tuple[Floats, Array]:
    """b, shape (n,), and the numbers of joints that move the first link there, shape (n,)."""
    by_first, by_second = (rho * widths for rho in speeds)
    zero = np.zeros((len(by_first), 1))
    first = np.concatenate([zero, np.cumsum(by_first, axis=1)], axis=1)
    second = np.concatenate([zero, np.cumsum(by_second[:, ::-1], axis=1)], axis=1)[:, ::-1]
    sums = first + second
    split = sums.argmin(axis=1)
    return np.take_along_axis(sums, split[:, None], axis=1)[:, 0], split


@final
class _Side:
    """One of the links, and the joints as seen from it; arguments as for `CellBounds`."""

    def __init__(self, chain: JointChain, solids: Sequence[Solid], is_first: bool) -> None:
        self._chain, self._is_first = chain, is_first
        parts = [solid_points(solid) for solid in solids]
        self._link = LinkSpeeds(fewer_points(joined_points(parts)))
        self._columns, self._starts = _columns(parts)

    def speeds(self, poses: Sequence[SE3], count: int) -> Floats:
        """rho by joint, shape (count, joints); `poses` are those of the link in the joints' frames."""
        speeds_of_links = [self._link.of(X, S, count) for X, S in zip(poses, self._chain.twists, strict=True)]
        return np.stack(speeds_of_links, axis=1)

    def _moved_by(self, widths: Floats, split: Array) -> Floats:
        """h of the joints that move this link, 0 of the others, shape (n, joints)."""
        numbers = np.arange(len(widths))
        is_mine = numbers < split[:, None] if self._is_first else numbers >= split[:, None]
        return np.where(is_mine, widths, 0.0)

    def beyond(self, rho: Floats, widths: Floats, split: Array) -> Floats:
        """R, shape (n,)."""
        h, turning = self._moved_by(widths, split), self._chain.turning
        order = range(len(widths)) if self._is_first else range(len(widths) - 1, -1, -1)  # from the link on
        moved, total, done = np.zeros(len(rho)), np.zeros(len(rho)), list[tuple[int, Floats]]()
        for k in order:
            greatest = rho[:, k] + turning[k] * moved
            for i, other in done:
                total += h[:, k] * h[:, i] * turning[k] * other
            total += 0.5 * h[:, k] ** 2 * turning[k] * greatest
            moved += greatest * h[:, k]
            done.append((k, greatest))
        return total

    def _affine(self, n: Floats, cells: _Cells, rows: Array) -> Floats:
        """Along n, and by joint h n (S x), as functions of x, shape (rows, 1 + joints, 4)."""
        poses = cells.poses[0 if self._is_first else 1]
        h = self._moved_by(cells.widths, cells.split[rows])
        affine = np.zeros((len(n), 1 + len(cells.widths), 4))
        affine[:, 0, :3] = n
        for k, (X, S) in enumerate(zip(poses, self._chain.twists, strict=True)):
            R, t = X.rotation[rows], X.translation[rows]
            n_k = (R @ n[..., None])[..., 0]
            across = np.cross(n_k, S.angular)
            along = (np.swapaxes(R, -1, -2) @ across[..., None])[..., 0]
            constant = n_k @ np.asarray(S.linear, dtype=float) + (across * t).sum(axis=-1)
            affine[:, 1 + k, :3], affine[:, 1 + k, 3] = h[:, k, None] * along, h[:, k] * constant
        return affine

    def least(self, n: Floats, cells: _Cells, rows: Array, slopes: Floats | None) -> Floats:
        """How far out solids are at least along directions, less what slopes s do not say, shape (rows, solids)."""
        out = np.empty((len(n), len(self._starts) - 1))
        if slopes is None:
            affine = np.zeros((len(n), 1, 4))
            affine[:, 0, :3] = n
        else:
            affine = self._affine(n, cells, rows)
            h = self._moved_by(cells.widths, cells.split[rows])
            affine[:, 1:, 3] -= np.where(h > 0.0, slopes, 0.0)
        if len(n):
            _least_out(self._columns, self._starts, affine, out)
        return out

    def slopes(self, n: Floats, solids: Array, cells: _Cells, rows: Array) -> Floats:
        """The middle of what joints do, along directions, to the points of a solid that may touch, (rows, joints)."""
        out = np.zeros((len(n), len(cells.widths)))
        if len(n):
            near = 0.5 * cells.b[rows]
            _middles(self._columns, self._starts, self._affine(n, cells, rows), solids, near, out)
        return out


@procedure
def _distance_out(columns, affine, row, i, W):
    """n x - r of the points from number i on, in lanes [m]."""
    x, y, z = columns[0, i : i + W], columns[1, i : i + W], columns[2, i : i + W]
    return affine[row, 0, 0] * x + affine[row, 0, 1] * y + affine[row, 0, 2] * z - columns[3, i : i + W]


@procedure(constants={"W": 8})
def _least_out_in_lanes(
    columns: Array2[f64], starts: Array1[np.int64], affine: Array3[f64], out: Array2[f64], W: int
) -> None:
    """Writes for directions and solids the least of n x - r - sum_k abs(a_k x + c_k) over the points x of the solid.

    Args:
        columns: Coordinates and radii of the points, filled up to whole registers for each solid, (4, points) [m].
        starts: Where the points of a solid begin, (solids + 1,).
        affine: n, 0; then a_k, c_k by joint, (rows, 1 + joints, 4) [1], [m].
        out: Receives the lengths, (rows, solids) [m].
        W: Lanes, a constant.
    """
    for row in range(len(out)):
        for solid in range(out.shape[1]):
            least = broadcast(f64(1e30), W)
            for i in range(starts[solid], starts[solid + 1], W):
                x, y, z = columns[0, i : i + W], columns[1, i : i + W], columns[2, i : i + W]
                value = _distance_out(columns, affine, row, i, W)
                for k in range(1, affine.shape[1]):
                    a, b, c = affine[row, k, 0], affine[row, k, 1], affine[row, k, 2]
                    value = value - abs(a * x + b * y + c * z + affine[row, k, 3])
                least = np.minimum(least, value)
            out[row, solid] = least_of(least)


@procedure(constants={"W": 8})
def _middles_in_lanes(
    columns: Array2[f64], starts: Array1[np.int64], affine: Array3[f64], solids: Array1[np.int64], near: Array1[f64],
    out: Array2[f64], W: int,
) -> None:  # fmt: skip
    """Writes the middles of what a_k x + c_k are at the points of a solid that are nearly the least far out.

    Args:
        columns: As for `_least_out_in_lanes`.
        starts: As for `_least_out_in_lanes`.
        affine: n, 0; then a_k, c_k by joint, (rows, 1 + joints, 4) [1], [m].
        solids: Whose points count, by number, (rows,).
        near: How much farther out these are than the first, (rows,) [m].
        out: Receives the middles, (rows, joints) [m].
        W: Lanes, a constant.
    """
    for row in range(len(out)):
        begin, end = starts[solids[row]], starts[solids[row] + 1]
        least = broadcast(f64(1e30), W)
        for i in range(begin, end, W):
            least = np.minimum(least, _distance_out(columns, affine, row, i, W))
        limit = least_of(least) + near[row]
        for k in range(1, affine.shape[1]):
            a, b, c, d = affine[row, k, 0], affine[row, k, 1], affine[row, k, 2], affine[row, k, 3]
            low, high = broadcast(f64(1e30), W), broadcast(f64(1e30), W)
            for i in range(begin, end, W):
                x, y, z = columns[0, i : i + W], columns[1, i : i + W], columns[2, i : i + W]
                value = _distance_out(columns, affine, row, i, W)
                moved = a * x + b * y + c * z + d
                low = np.where(value <= limit, np.minimum(low, moved), low)
                high = np.where(value <= limit, np.minimum(high, -moved), high)
            out[row, k - 1] = f64(0.5) * (least_of(low) - least_of(high))


_LANES = 8
_middles = _middles_in_lanes.specialized(W=_LANES)
_least_out = _least_out_in_lanes.specialized(W=_LANES)


def _columns(parts: Sequence[LinkPoints]) -> tuple[Floats, Array]:
    """The points of solids as `_least_out_in_lanes` takes them, and where those of each begin."""
    counts = [-(-len(part.radii) // _LANES) * _LANES for part in parts]
    starts = np.cumsum([0, *counts])
    columns = np.zeros((4, int(starts[-1])))
    columns[3] = -1e30  # farther out than anything
    for part, start in zip(parts, starts.tolist(), strict=False):
        columns[:3, start : start + len(part.radii)] = part.centres.T
        columns[3, start : start + len(part.radii)] = part.radii
    return columns, starts
