"""RRT-Connect as a procedure: two trees of free motions grow towards samples and towards each other.

Source: Kuffner and LaValle, RRT-Connect: an efficient approach to single-query path planning (ICRA 2000); the smaller
tree grows, as in Thomason, Kingston and Kavraki, Motions in microseconds via vectorized sampling-based planning (ICRA
2024). A tree lies in columns, (n, capacity), so that lanes hold nodes when the nearest one is searched; places that are
not taken hold 1e15, whose squared distance stays finite.
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import (
    Array1,
    Array2,
    Array3,
    Kernel,
    broadcast,
    f32,
    first_of,
    lane_numbers,
    least_of,
    procedure,
)
from ulna.planning.edges import edge_touches
from ulna.planning.touching import Tables

INT = np.int64
FREE_PLACE = 1e15


@procedure
def _nearest_node(nodes, tree, count, q, W):
    """The node of a tree that is nearest to q, and its distance."""
    best = broadcast(f32(1e38), W)
    where_best = broadcast(0, W)
    for i in range(0, count, W):
        total = broadcast(f32(0.0), W)
        for k in range(len(q)):
            d = nodes[tree, k, i : i + W] - q[k]
            total = total + d * d
        closer = total < best
        best = np.where(closer, total, best)
        where_best = np.where(closer, lane_numbers(W) + i, where_best)
    least = least_of(best)
    lane = first_of(best == least)
    return where_best[lane % W], np.sqrt(least)


@procedure
def _add_node(nodes, parents, counts, tree, q, parent):
    """Appends a node to a tree; returns its number."""
    number = counts[tree]
    for k in range(len(q)):
        nodes[tree, k, number] = q[k]
    parents[tree, number] = parent
    counts[tree] = number + 1
    return number


@procedure
def _read_node(nodes, tree, number, q):
    """Copies a node into q."""
    for k in range(len(q)):
        q[k] = nodes[tree, k, number]


@procedure
def _towards(a, b, distance, longest, result):
    """The point on the way from a to b, at most `longest` from a."""
    part = f32(1.0)
    if distance > longest:
        part = longest / distance
    for k in range(len(a)):
        result[k] = a[k] + part * (b[k] - a[k]) if part < 1.0 else b[k]


@procedure(constants={"W": 8})
def grow(
    kernel: Kernel, tables: Tables, reach: Array2[f32], step: f32, longest: f32, samples: Array2[f32],
    nodes: Array3[f32], parents: Array2[INT], counts: Array1[INT], meeting: Array1[INT],
    near: Array1[f32], new: Array1[f32], goal: Array1[f32], q: Array2[f32], c: Array2[f32], W: int,
) -> int:  # fmt: skip
    """Grows both trees with one sample after the other until they meet, or the samples or places are used up.

    Args:
        kernel: From configurations to centres of spheres, in lanes.
        tables: What is checked against what.
        reach: Bounds of motion, shape (L, n) [m/rad], [1].
        step: How far anything moves at most between checked states [m].
        longest: The longest edge [rad, m].
        samples: Configurations, shape (samples, n) [rad, m].
        nodes: Both trees, shape (2, n, capacity) [rad, m].
        parents: The node that each node was grown from, -1 for roots, shape (2, capacity).
        counts: How many nodes the trees have, shape (2,).
        meeting: Receives the nodes of both trees at which they meet, shape (2,).
        near: Working storage, shape (n,).
        new: Working storage, shape (n,).
        goal: Working storage, shape (n,).
        q: Working storage, shape (n, W) [rad, m].
        c: Working storage, shape (3 (L + S), W) [m].
        W: Lanes, a constant.

    Returns:
        How many samples were used; where the trees met, minus that.
    """
    for s in range(len(samples)):
        if max(counts[0], counts[1]) + 2 >= nodes.shape[2] - W:
            return s
        tree = 0 if counts[0] <= counts[1] else 1
        nearest, distance = _nearest_node(nodes, tree, counts[tree], samples[s], W)
        _read_node(nodes, tree, nearest, near)
        _towards(near, samples[s], distance, longest, new)
        if edge_touches(kernel, tables, reach, step, near, new, q, c, W):
            continue
        added = _add_node(nodes, parents, counts, tree, new, nearest)
        # the other tree comes as near as it can
        other = 1 - tree
        for k in range(len(new)):
            goal[k] = new[k]
        last, left = _nearest_node(nodes, other, counts[other], goal, W)
        while True:
            _read_node(nodes, other, last, near)
            _towards(near, goal, left, longest, new)
            if edge_touches(kernel, tables, reach, step, near, new, q, c, W):
                break
            if left <= longest:
                meeting[tree] = added
                meeting[other] = last
                return -s - 1
            if counts[other] + 2 >= nodes.shape[2] - W:
                break
            last = _add_node(nodes, parents, counts, other, new, last)
            left = left - longest
    return len(samples)
