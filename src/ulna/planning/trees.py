"""Two trees of configurations in arrays, as the procedures of planners share them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import (
    Array1,
    Array2,
    Array3,
    broadcast,
    f32,
    first_of,
    lane_numbers,
    least_of,
    procedure,
)

INT = np.int64


class Trees(NamedTuple):
    """Two trees; tree 0 grows from the start, tree 1 from the goals.

    Attributes:
        nodes: Configurations, (2, n, capacity) [rad, m].
        radii: How far a sample may be from a node, (2, capacity) [rad, m].
        costs: Lengths of the nodes' paths from their roots, where a search asks for them, (2, capacity) [rad, m].
        parents: The node from which each was grown, -1 for roots, (2, capacity).
        counts: How many nodes there are, (2,).
        meeting: The nodes at which the trees met, (2,).
        near: Working storage, (n,).
        new: Working storage, (n,).
        goal: Working storage, (n,).
        aim: Working storage, (n,).
    """

    nodes: Array3[f32]
    radii: Array2[f32]
    costs: Array2[f32]
    parents: Array2[INT]
    counts: Array1[INT]
    meeting: Array1[INT]
    near: Array1[f32]
    new: Array1[f32]
    goal: Array1[f32]
    aim: Array1[f32]


@procedure
def squared_distances(nodes, tree, i, q, W):
    """The squared distances of q from W nodes, in lanes.

    Args:
        nodes: Both trees' nodes, shape (2, n, capacity) [rad, m].
        tree: Which tree.
        i: The first node.
        q: A configuration, shape (n,) [rad, m].
        W: Lanes, a constant.

    Returns:
        The squares [rad^2, m^2].
    """
    total = broadcast(f32(0.0), W)
    for k in range(len(q)):
        d = nodes[tree, k, i : i + W] - q[k]
        total = total + d * d
    return total


@procedure
def nearest_node(nodes, tree, count, q, W):
    """The node of a tree that is nearest to q, and its distance.

    Args:
        nodes: Both trees' nodes, shape (2, n, capacity) [rad, m].
        tree: Which tree.
        count: How many nodes it has.
        q: A configuration, shape (n,) [rad, m].
        W: Lanes, a constant.

    Returns:
        Its number, and the distance [rad, m].
    """
    best = broadcast(f32(1e38), W)
    where_best = broadcast(0, W)
    for i in range(0, count, W):
        total = squared_distances(nodes, tree, i, q, W)
        closer = total < best
        best = np.where(closer, total, best)
        where_best = np.where(closer, lane_numbers(W) + i, where_best)
    least = least_of(best)
    lane = first_of(best == least)
    return where_best[lane % W], np.sqrt(least)


@procedure
def add_node(trees, tree, q, parent):
    """Appends a node to a tree.

    Args:
        trees: Both trees; one is changed.
        tree: Which one.
        q: The node, shape (n,) [rad, m].
        parent: The number of its parent; -1 for a root.

    Returns:
        Its number.
    """
    number = trees.counts[tree]
    for k in range(len(q)):
        trees.nodes[tree, k, number] = q[k]
    trees.parents[tree, number] = parent
    trees.radii[tree, number] = f32(1e30)
    trees.counts[tree] = number + 1
    return number


@procedure
def add_node_with_cost(trees, tree, q, parent):
    """Appends a node to a tree, with its cost; overwrites `trees.goal`.

    Args:
        trees: Both trees; one is changed.
        tree: Which one.
        q: The node, shape (n,) [rad, m].
        parent: The number of its parent.

    Returns:
        Its number.
    """
    number = add_node(trees, tree, q, parent)
    read_node(trees.nodes, tree, parent, trees.goal)
    trees.costs[tree, number] = trees.costs[tree, parent] + distance(trees.goal, q)
    return number


@procedure
def read_node(nodes, tree, number, q) -> None:
    """Copies a node into q.

    Args:
        nodes: Both trees' nodes, shape (2, n, capacity) [rad, m].
        tree: Which tree.
        number: The node.
        q: Receives it, shape (n,) [rad, m].
    """
    for k in range(len(q)):
        q[k] = nodes[tree, k, number]


@procedure
def set_roots(trees, points, touching, count) -> None:
    """Empties both trees and sets their roots: the first point, and those of the rest that are free.

    Args:
        trees: Both trees.
        points: Configurations, shape (at least count, n) [rad, m].
        touching: Above 0 for those that are not free, shape (at least count,).
        count: How many there are.
    """
    for tree in range(2):
        for number in range(trees.counts[tree]):
            for k in range(trees.nodes.shape[1]):
                trees.nodes[tree, k, number] = f32(1e15)
        trees.counts[tree] = 0
    for i in range(count):
        if touching[i] == 0:
            add_node(trees, min(i, 1), points[i], -1)


@procedure
def distance(a, b):
    """The distance of two configurations.

    Args:
        a: Shape (n,) [rad, m].
        b: Shape (n,) [rad, m].

    Returns:
        The distance [rad, m].
    """
    total = f32(0.0)
    for k in range(len(a)):
        total += (a[k] - b[k]) * (a[k] - b[k])
    return np.sqrt(total)


@procedure
def tree_to_grow(trees, tree, W):
    """Which tree takes the next sample: the other one where that is less than twice as large, else the same.

    Args:
        trees: Both trees.
        tree: The tree that took the last one.
        W: Lanes, a constant.

    Returns:
        Its number; -1 if a tree has no places left.
    """
    if max(trees.counts[0], trees.counts[1]) + W + 2 >= trees.nodes.shape[2]:
        return -1
    return 1 - tree if trees.counts[1 - tree] < 2 * trees.counts[tree] else tree
