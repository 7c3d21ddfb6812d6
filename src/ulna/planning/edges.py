"""Straight motions between configurations, checked in steps so short that nothing can touch in between.

| symbol | meaning | shape | unit |
|---|---|---|---|
| a, b | the ends, q(t) = a + t (b - a) | (n,) | [rad, m] |
| rho_lk | bound of how far a point of body l moves when joint k moves by one | (L, n) | [m/rad], [1] |
| travel | max over l of sum over k of rho_lk abs(b_k - a_k) | () | [m] |
| d | longest way that any point moves between two states that are checked | () | [m] |

A state is checked with all spheres larger by d / 2, so between two free states, of which each point is at most d / 2
away from one, nothing touches: two links that move towards each other are both larger. Source: Schwarzer, Saha and
Latombe, Adaptive dynamic collision checking, IEEE Transactions on Robotics 21 (2005), for the bound. The lanes lie far
apart on the motion, so that an obstacle in the middle is met early (Thomason, Kingston and Kavraki, ICRA 2024).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.collision.lanes.touching import Tables, Work, block_touches
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Kernel,
    broadcast,
    f32,
    greatest_of,
    lane_numbers,
    procedure,
)


class Proof(NamedTuple):
    """How it is proved that nothing touches on an edge.

    Attributes:
        tables: What is checked against what, with spheres larger by half of `step`.
        finer: The same with spheres larger by an eighth of it.
        finest: The same with spheres larger by a thirty-second of it.
        step: How far anything moves at most between states [m].
    """

    tables: Tables
    finer: Tables
    finest: Tables
    step: f32


@procedure(contract=True)
def _travel_of(reach, a, b, W):
    """How far any point of the robot moves at most from a to b [m]."""
    greatest = broadcast(f32(0.0), W)
    for i in range(0, reach.shape[1], W):
        total = broadcast(f32(0.0), W)
        for k in range(len(a)):
            total = total + reach[k, i : i + W] * abs(b[k] - a[k])
        greatest = np.maximum(greatest, total)
    return greatest_of(greatest)


@procedure
def blocks_of_edge(tables, step, a, b, W):
    """How many blocks of W states are checked on the way from a to b.

    Args:
        tables: What is checked against what.
        step: d, the longest way between two states [m].
        a: Where the motion begins, shape (n,) [rad, m].
        b: Where it ends, shape (n,) [rad, m].
        W: Lanes, a constant.

    Returns:
        The number of blocks, at least 1.
    """
    return 1 + int(_travel_of(tables.reach, a, b, W) / (step * f32(W)))


@procedure
def _first_touching_block(
    kernel, tables, a, b, lane_stride, block_stride, offset, count, begin, end, work, W
):
    """The first of some blocks of states on the way from a to b in which anything touches; -1 where nothing does.

    State l of block i is at a part (l lane_stride + i block_stride + offset) / count of the way.
    """
    for block in range(begin, end):
        t = (lane_numbers(W, f32) * lane_stride + (f32(block) * block_stride + offset)) / count
        for k in range(len(a)):
            work.q[k, 0:W] = a[k] + t * (b[k] - a[k])
        kernel(work.q, work.c)
        if block_touches(tables, work, W):
            return block
    return -1


@procedure
def edge_touches(kernel, tables, step, a, b, work, W):
    """Whether anything touches on the way from a to b; a itself is not checked, b is.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        step: d, by half of which the spheres in the tables are larger [m].
        a: Where the motion begins, shape (n,) [rad, m].
        b: Where it ends, shape (n,) [rad, m].
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    blocks = blocks_of_edge(tables, step, a, b, W)
    return (
        _first_touching_block(
            kernel, tables, a, b, f32(blocks), f32(1.0), f32(1.0), f32(blocks * W), 0, blocks, work, W
        )
        >= 0
    )


@procedure
def state_touches(kernel, tables, a, work, W):
    """Whether anything touches in a configuration.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        a: The configuration, shape (n,) [rad, m].
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    one = f32(1.0)
    return _first_touching_block(kernel, tables, a, a, one, one, one, one, 0, 1, work, W) >= 0


@procedure
def _first_touching_interval(kernel, tables, a, b, begin, end, count, work, W):
    """The first of the intervals begin to end, of count, that touches in a middle of one of its W parts; or -1."""
    width = f32(W)
    return _first_touching_block(
        kernel, tables, a, b, f32(1.0), width, f32(0.5), f32(count) * width, begin, end, work, W
    )


@procedure
def _is_interval_proved(kernel, proof, a, b, number, count, work, W):
    """Whether nothing can touch in an interval, of count, by spheres that are larger by less."""
    i = 4 * number
    while True:
        i = _first_touching_interval(kernel, proof.finer, a, b, i, 4 * number + 4, 4 * count, work, W)
        if i < 0:
            return True
        if _first_touching_interval(kernel, proof.finest, a, b, 4 * i, 4 * i + 4, 16 * count, work, W) >= 0:
            return False
        i += 1


@procedure
def _is_edge_proved(kernel, proof, a, b, work, W):
    """Whether nothing can touch between a and b, both included."""
    count = blocks_of_edge(proof.tables, proof.step, a, b, W)
    i = 0
    while True:
        i = _first_touching_interval(kernel, proof.tables, a, b, i, count, count, work, W)
        if i < 0:
            return True
        if not _is_interval_proved(kernel, proof, a, b, i, count, work, W):
            return False
        i += 1


@procedure(constants={"W": 8})
def first_unproved_edge(
    kernel: Kernel, proof: Proof, path: Array2[f32], first: int, count: int, work: Work, W: int
) -> int:
    """The first edge of a path of which it cannot be proved that nothing touches on it.

    Intervals that touch by large spheres and long steps are divided into four, with spheres and steps of a fourth, and
    these once more.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        proof: How it is proved.
        path: The path; rows beyond it do not count, shape (room, n) [rad, m].
        first: The edge to begin with.
        count: How many points the path has; a single one counts as an edge.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The number of the edge, or -1.
    """
    if count == 1 and not _is_edge_proved(kernel, proof, path[0], path[0], work, W):
        return 0
    for i in range(first, count - 1):
        if not _is_edge_proved(kernel, proof, path[i], path[i + 1], work, W):
            return i
    return -1


@procedure
def _look_at_points(kernel, tables, points, touching, count, work, W):
    """Writes 1 for each of the first points in which anything touches, else 0."""
    for i in range(count):
        touching[i] = f32(int(state_touches(kernel, tables, points[i], work, W)))


@procedure(constants={"W": 8})
def first_direct_goal(
    kernel: Kernel, tables: Tables, step: f32, points: Array2[f32], touching: Array1[f32], count: int, work: Work,
    W: int,
) -> int:  # fmt: skip
    """Looks which of a start and goals touch anything, and for the first goal that a straight motion reaches.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        step: How far anything moves at most between checked states [m].
        points: The start, then goals, shape (at least count, n) [rad, m].
        touching: Receives 1 for points that touch, else 0, shape (at least count,).
        count: How many points there are.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The number of the goal among the points, or -1.
    """
    _look_at_points(kernel, tables, points, touching, count, work, W)
    if touching[0] > 0:
        return -1
    for i in range(1, count):
        if touching[i] == 0 and not edge_touches(kernel, tables, step, points[0], points[i], work, W):
            return i
    return -1
