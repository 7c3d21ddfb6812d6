"""How near two links come anywhere in cells of configurations of the joints between them.

| symbol | meaning | unit |
|---|---|---|
| c, h_k | middle of a cell, and half its width in joint k | [rad, m] |
| S_k, w_k | twist of joint k for one unit of its position, and how fast it turns | [1], [m], [1] |
| rho_k | greatest speed of a point of one link when joint k moves, with the joints between them at c | [m/rad], [1] |
| b | bound of how much nearer the links come in the cell than at c | [m] |
| n | direction from one solid to another at c, both on their sides of planes across it | [1] |
| R | bound of what the motion of a point adds to its first derivative | [m] |

Seen from between joints j and j + 1, joints 1 to j move the first link and the others the second. Move the joints
nearest to that place first: each then moves points of its link that stand as at c, so no point moves farther than the
sum of rho_k h_k, and b is the least of these sums over j. Links that slide along each other come nearer by far less: a
point x of the second link moves along n by no more than sum_k h_k abs(n (S_k x)) + R, and points that are farther out
may move farther. R = sum_ik h_i h_k w_i rho'_k / 2 with i nearer to the place than k, and rho' the greatest in the
cell. What is proved for two solids is the better of d - b and of the distance of the planes; for links the least of
their solids. Source: Schwarzer, Saha and Latombe, Adaptive dynamic collision checking, IEEE Transactions on Robotics
21 (2005), for b, with lengths at c; the planes follow from Taylor's theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.collision.joint_chains import JointChain
from ulna.collision.link_points import LinkPoints, fewer_points, joined_points, solid_points
from ulna.collision.pair_distance import PairDistance
from ulna.collision.solids import Solid
from ulna.compiler.procedures import Array1, Array2, Array3, broadcast, f64, least_of, procedure
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_COAL = 2e-6  # by how much coal's distances may be wrong, with room to spare [m]
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

    def proved(self, q: Floats, half: Floats) -> tuple[Floats, Floats, int]:
        """Distances at the middles of cells, and what is proved for all of the cells.

        Args:
            q: The middles, shape (n, nq) [rad, m].
            half: h by column, shape (columns,) [rad, m].

        Returns:
            Distances, shape (n,) [m], not above 0 where the links touch, and less where balls around them suffice;
            clearances, shape (n,) [m], of which only positive ones are proved; and how often coal was asked.
        """
        T, *poses = self._chain.poses(q)
        T = _rows([T], slice(None), len(q))[0]
        widths = self._chain.widths(half)
        speeds = [side.speeds(X, len(q)) for side, X in zip(self._sides, poses, strict=True)]
        b, split = _least_approach(speeds, widths)
        remainder = np.add.reduce(
            [side.beyond(rho, widths, split) for side, rho in zip(self._sides, speeds, strict=True)]
        )
        gaps = self._distance.gaps(T)
        bounds, distance = gaps - b[:, None], gaps.min(axis=1)
        rows = np.flatnonzero(~((distance > 0.0) & (b <= ENOUGH * distance)))
        distance[rows], is_asked, asked = np.inf, np.zeros(bounds.shape, dtype=bool), 0
        while True:
            pairs = bounds[rows].argmin(axis=1)
            is_new = ~is_asked[rows, pairs]  # else what decides is known
            rows, pairs = rows[is_new], pairs[is_new]
            if not len(rows):
                return distance, bounds.min(axis=1), asked
            found, normals = self._distance.ask(SE3(T.rotation[rows], T.translation[rows]), pairs)
            asked += len(rows)
            is_asked[rows, pairs] = True
            distance[rows] = np.minimum(distance[rows], found)
            bounds[rows, pairs] = np.maximum(bounds[rows, pairs], found - b[rows] - _COAL)
            apart = found > 1e-5
            rows, n = rows[apart], normals[apart]
            planes = self._planes(n, T, poses, rows, widths, split) - remainder[rows, None] - _COAL
            bounds[rows] = np.maximum(bounds[rows], planes)

    def _planes(
        self, n: Floats, T: SE3, poses: Sequence[Sequence[SE3]], rows: Array, widths: Floats, split: Array
    ) -> Floats:  # fmt: skip
        """How far planes across directions n that touch the solids are apart at least, but for R, (rows, pairs)."""
        n_b = (np.swapaxes(T.rotation[rows], -1, -2) @ n[..., None])[..., 0]
        here = [_rows(X, rows, len(split)) for X in poses]
        first = self._sides[0].least(-n, here[0], widths, split[rows])
        second = self._sides[1].least(n_b, here[1], widths, split[rows])
        between = (n * T.translation[rows]).sum(axis=-1)
        return (first[:, :, None] + second[:, None] + between[:, None, None]).reshape(
            len(rows), first.shape[1] * second.shape[1]
        )


def _rows(poses: Sequence[SE3], rows: Any, count: int) -> list[SE3]:
    """Some rows of poses, of which some may be one for all rows."""
    return [
        SE3(
            np.broadcast_to(X.rotation, (count, 3, 3))[rows], np.broadcast_to(X.translation, (count, 3))[rows]
        )
        for X in poses
    ]


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
        self._link = fewer_points(joined_points(parts))
        self._columns, self._starts = _columns(parts)

    def speeds(self, poses: Sequence[SE3], count: int) -> Floats:
        """rho by joint, shape (count, joints); `poses` are those of the link in the joints' frames."""
        found = [self._link.speed(T, S) for T, S in zip(poses, self._chain.twists, strict=True)]
        return np.stack([np.broadcast_to(rho, (count,)) for rho in found], axis=1)

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

    def least(self, n: Floats, poses: Sequence[SE3], widths: Floats, split: Array) -> Floats:
        """How far out solids are at least along directions, less what first derivatives allow, shape (rows, solids)."""
        h = self._moved_by(widths, split)
        affine = np.zeros((len(n), 1 + len(widths), 4))
        affine[:, 0, :3] = n
        for k, (T, S) in enumerate(zip(poses, self._chain.twists, strict=True)):
            n_k = (T.rotation @ n[..., None])[..., 0]
            across = np.cross(n_k, S.angular)
            along = (np.swapaxes(T.rotation, -1, -2) @ across[..., None])[..., 0]
            constant = n_k @ np.asarray(S.linear, dtype=float) + (across * T.translation).sum(axis=-1)
            affine[:, 1 + k, :3], affine[:, 1 + k, 3] = h[:, k, None] * along, h[:, k] * constant
        out = np.empty((len(n), len(self._starts) - 1))
        if len(n):
            _least_out(self._columns, self._starts, affine, out)
        return out


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
                value = (
                    affine[row, 0, 0] * x
                    + affine[row, 0, 1] * y
                    + affine[row, 0, 2] * z
                    - columns[3, i : i + W]
                )
                for k in range(1, affine.shape[1]):
                    a, b, c = affine[row, k, 0], affine[row, k, 1], affine[row, k, 2]
                    value = value - abs(a * x + b * y + c * z + affine[row, k, 3])
                least = np.minimum(least, value)
            out[row, solid] = least_of(least)


_LANES = 8
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
