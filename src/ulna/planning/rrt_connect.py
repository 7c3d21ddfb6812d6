"""RRT-Connect as a procedure: two trees of free motions grow towards samples and towards each other.

| symbol | meaning | shape | unit |
|---|---|---|---|
| nodes | both trees, a node a column: lanes hold nodes when the nearest is searched | (2, n, capacity) | [rad, m] |
| radii | the domain of a node: it is not extended to samples farther away | (2, capacity) | [rad, m] |

Source: Kuffner and LaValle, RRT-Connect: an efficient approach to single-query path planning (ICRA 2000). The smaller
tree grows. Domains are those of Yershova, Jaillet, Simeon and LaValle, Dynamic-domain RRTs (ICRA 2005), which shrink
and grow as in Jaillet et al., Adaptive tuning of the sampling domain for dynamic-domain RRTs (IROS 2005). The places
of a tree that are not taken hold 1e15, whose squared distance stays finite.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Kernel,
    f32,
    procedure,
)
from ulna.planning.edges import edge_touches
from ulna.planning.trees import (
    Trees,
    add_node,
    add_node_with_cost,
    nearest_node,
    read_node,
    set_roots,
    tree_to_grow,
)

INT = np.int64
FREE_PLACE = 1e15
EVERYWHERE = 1e30
"""The domain of a node from which no extension has failed."""


class Growth(NamedTuple):
    """How trees grow.

    Attributes:
        step: How far anything moves at most between checked states [m].
        longest: The longest edge [rad, m].
        domain: The domain of a node once an extension has failed [rad, m].
        least_domain: The least one [rad, m].
        change: By which part a domain grows or shrinks [1].
    """

    step: f32
    longest: f32
    domain: f32
    least_domain: f32
    change: f32


@procedure
def _extend(kernel, tables, growth, trees, tree, sample, work, W):
    """Grows a tree towards a sample by one edge; the new node, or -1."""
    nearest, distance = nearest_node(trees.nodes, tree, trees.counts[tree], sample, W)
    radius = trees.radii[tree, nearest]
    if distance > radius:
        return -1
    read_node(trees.nodes, tree, nearest, trees.near)
    part = growth.longest / distance if distance > growth.longest else f32(1.0)
    for k in range(len(trees.near)):
        trees.new[k] = trees.near[k] + part * (sample[k] - trees.near[k])
    if edge_touches(kernel, tables, growth.step, trees.near, trees.new, work, W):
        shrunk = max(radius * (f32(1.0) - growth.change), growth.least_domain)
        trees.radii[tree, nearest] = growth.domain if radius > f32(1e29) else shrunk
        return -1
    if radius < f32(1e29):
        trees.radii[tree, nearest] = radius * (f32(1.0) + growth.change)
    return add_node(trees, tree, trees.new, nearest)


@procedure
def connect_straight(kernel, tables, growth, trees, tree, added, other, target, distance, HAS_COSTS, work, W):
    """Grows a tree from a node to a node of the other tree by edges along one line.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        growth: How trees grow.
        trees: Both trees; `trees.near` holds the node to begin with.
        tree: The tree that grows.
        added: The node to begin with.
        other: The other tree.
        target: The node of the other tree.
        distance: Their distance [rad, m].
        HAS_COSTS: Whether nodes have costs, a constant.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        Whether it got there.
    """
    read_node(trees.nodes, other, target, trees.aim)
    pieces = max(int(np.ceil(distance / growth.longest)), 1)
    last = added
    for piece in range(pieces):
        part = f32(1.0) / f32(pieces - piece)
        is_last = piece == pieces - 1
        for k in range(len(trees.near)):
            trees.new[k] = trees.aim[k] if is_last else trees.near[k] + part * (trees.aim[k] - trees.near[k])
        if edge_touches(kernel, tables, growth.step, trees.near, trees.new, work, W):
            return False
        if is_last:
            trees.meeting[tree] = last
            trees.meeting[other] = target
            return True
        if HAS_COSTS:
            last = add_node_with_cost(trees, tree, trees.new, last)
        else:
            last = add_node(trees, tree, trees.new, last)
        if trees.counts[tree] + W + 2 >= trees.nodes.shape[2]:
            return False
        for k in range(len(trees.near)):
            trees.near[k] = trees.new[k]
    return False


@procedure
def _connect(kernel, tables, growth, trees, tree, added, work, W):
    """Grows a tree from its newest node to the nearest one of the other tree; whether it got there."""
    other = 1 - tree
    read_node(trees.nodes, tree, added, trees.near)
    target, distance = nearest_node(trees.nodes, other, trees.counts[other], trees.near, W)
    return connect_straight(
        kernel, tables, growth, trees, tree, added, other, target, distance, False, work, W
    )


@procedure(constants={"W": 8})
def grow(
    kernel: Kernel, tables: Tables, growth: Growth, samples: Array2[f32], first: int, count: int,
    points: Array2[f32], touching: Array1[f32], roots: int, trees: Trees, work: Work, W: int,
) -> int:  # fmt: skip
    """Grows both trees with one sample after the other until they meet, or the samples or places are used up.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        growth: How trees grow.
        samples: Configurations, shape (at least count, n) [rad, m].
        first: The sample to begin with.
        count: How many samples there are.
        points: The start, then goals, shape (at least roots, n) [rad, m].
        touching: Above 0 for points that are no roots, shape (at least roots,).
        roots: How many points there are, with which both trees begin anew; 0 to go on with the trees.
        trees: Both trees; they are changed.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The number of the first sample that was not used; where the trees met, minus that.
    """
    if roots > 0:
        set_roots(trees, points, touching, roots)
    tree = 1
    for s in range(first, count):
        tree = tree_to_grow(trees, tree, W)
        if tree < 0:
            return s
        added = _extend(kernel, tables, growth, trees, tree, samples[s], work, W)
        if added >= 0 and _connect(kernel, tables, growth, trees, tree, added, work, W):
            return -s - 1
    return count


@procedure
def read_path(trees, path):
    """Writes the nodes from the start to the goal at which the trees met.

    Args:
        trees: Both trees, which have met.
        path: Receives the path, shape (room, n) [rad, m].

    Returns:
        How many there are; -1 if `path` has no room for them.
    """
    before = 0
    node = trees.meeting[0]
    while node >= 0:
        before += 1
        node = trees.parents[0, node]
    count = before
    node = trees.meeting[1]
    while node >= 0:
        count += 1
        node = trees.parents[1, node]
    if count > len(path):
        return -1
    node = trees.meeting[0]
    for i in range(before):
        read_node(trees.nodes, 0, node, path[before - 1 - i])
        node = trees.parents[0, node]
    node = trees.meeting[1]
    for i in range(before, count):
        read_node(trees.nodes, 1, node, path[i])
        node = trees.parents[1, node]
    return count
