"""Straight motions between configurations, checked in steps so short that nothing can touch in between.

| symbol | meaning | shape | unit |
|---|---|---|---|
| a, b | the ends, q(t) = a + t (b - a) | (n,) | [rad, m] |
| rho_lk | bound of how far a point of link l moves when joint k moves by one | (L, n) | [m/rad], [1] |
| travel | max over l of sum over k of rho_lk abs(b_k - a_k) | () | [m] |
| d | longest way that any point moves between two states that are checked | () | [m] |

A state is checked with all spheres larger by d / 2, so between two free states, of which each point is at most d / 2
away from one, nothing touches: two links that move towards each other are both larger. Source: Schwarzer, Saha and
Latombe, Adaptive dynamic collision checking, IEEE Transactions on Robotics 21 (2005), for the bound.
"""

from __future__ import annotations

from ulna.compiler.procedures import Array1, Array2, Kernel, broadcast, f32, lane_numbers, procedure
from ulna.planning.touching import Tables, block_touches


@procedure
def _travel_of(reach, a, b):
    """How far any point of the robot moves at most from a to b [m]."""
    greatest = f32(0.0)
    for link in range(reach.shape[0]):
        total = f32(0.0)
        for k in range(reach.shape[1]):
            total += reach[link, k] * abs(b[k] - a[k])
        greatest = max(greatest, total)
    return greatest


@procedure
def edge_touches(kernel, tables, reach, step, a, b, q, c, W):
    """Whether anything touches on the way from a to b; a itself is not checked, b is.

    Args:
        kernel: From configurations to centres of spheres, in lanes.
        tables: What is checked against what.
        reach: rho, shape (L, n) [m/rad], [1].
        step: d, by half of which the spheres in the tables are larger [m].
        a: Where the motion begins, shape (n,) [rad, m].
        b: Where it ends, shape (n,) [rad, m].
        q: Working storage, shape (n, W) [rad, m].
        c: Working storage, shape (3 (L + S), W) [m].
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    blocks = 1 + int(_travel_of(reach, a, b) / (step * f32(W)))
    count = f32(blocks * W)
    for block in range(blocks):
        # the lanes lie far apart, so that obstacles in the middle are met early
        t = (lane_numbers(W, f32) * f32(blocks) + f32(block + 1)) / count
        for k in range(len(a)):
            q[k, 0:W] = a[k] + t * (b[k] - a[k])
        kernel(q, c)
        if block_touches(tables, c, W):
            return True
    return False


@procedure(constants={"W": 8})
def first_edge_that_touches(
    kernel: Kernel, tables: Tables, reach: Array2[f32], step: f32, points: Array2[f32], q: Array2[f32],
    c: Array2[f32], W: int,
) -> int:  # fmt: skip
    """The first edge of a path that touches anything; the first point is checked, too.

    Args:
        kernel: From configurations to centres of spheres, in lanes.
        tables: What is checked against what.
        reach: rho, shape (L, n) [m/rad], [1].
        step: d, by half of which the spheres in the tables are larger [m].
        points: Configurations, shape (points, n) [rad, m].
        q: Working storage, shape (n, W) [rad, m].
        c: Working storage, shape (3 (L + S), W) [m].
        W: Lanes, a constant.

    Returns:
        The number of the edge; -1 where nothing touches.
    """
    for k in range(points.shape[1]):
        q[k, 0:W] = broadcast(points[0, k], W)
    kernel(q, c)
    if block_touches(tables, c, W):
        return 0
    for i in range(len(points) - 1):
        if edge_touches(kernel, tables, reach, step, points[i], points[i + 1], q, c, W):
            return i
    return -1


@procedure(constants={"W": 8})
def which_touch(
    kernel: Kernel, tables: Tables, points: Array2[f32], touching: Array1[f32], q: Array2[f32], c: Array2[f32],
    W: int,
) -> None:  # fmt: skip
    """Writes 1 for each configuration in which anything touches, else 0.

    Args:
        kernel: From configurations to centres of spheres, in lanes.
        tables: What is checked against what.
        points: Configurations, shape (points, n) [rad, m].
        touching: Receives the answers, shape (points,).
        q: Working storage, shape (n, W) [rad, m].
        c: Working storage, shape (3 (L + S), W) [m].
        W: Lanes, a constant.
    """
    for i in range(len(points)):
        for k in range(points.shape[1]):
            q[k, 0:W] = broadcast(points[i, k], W)
        kernel(q, c)
        touching[i] = f32(int(block_touches(tables, c, W)))
