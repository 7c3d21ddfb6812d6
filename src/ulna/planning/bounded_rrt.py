"""RRT-Connect among paths that are shorter than a bound, as a procedure: repeated, paths approach the shortest one.

| symbol | meaning | unit |
|---|---|---|
| c | cost of a node: the length of its path from its root | [rad, m] |
| h | the distance to the nearest root of the other tree, which no path from a node is shorter than | [rad, m] |
| B | the bound: the length of the best path so far | [rad, m] |

A sample has a configuration x and a cost c(x), drawn from what a path below the bound allows: its distance to a root
<= c(x) <= B - h. It is extended from the node that is nearest in configuration and cost among those that reach x at no
more than c(x). Nodes with c + h >= B are not added, and trees meet only where both costs and the way between them are
below the bound. Before a node is added, the node near it from which its cost is the least is tried as its parent.

Source: Wilson, Thomason, Kingston, Kavraki and Gammell, AORRTC: almost-surely asymptotically optimal planning with
RRT-Connect (2025), after Hauser and Zhou, Asymptotically optimal planning by feasible kinodynamic planning in a
state-cost space (IEEE T-RO 2016). Choice of parents: Karaman and Frazzoli, Sampling-based algorithms for optimal
motion planning (IJRR 2011).
"""

from __future__ import annotations

import numpy as np

from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Kernel,
    broadcast,
    f32,
    first_of,
    lane_numbers,
    least_of,
    procedure,
)
from ulna.planning.edges import edge_touches
from ulna.planning.rrt_connect import Growth, connect_straight
from ulna.planning.trees import (
    Trees,
    add_node_with_cost,
    distance,
    read_node,
    set_roots,
    squared_distances,
    tree_to_grow,
)


@procedure
def _to_roots(trees, tree, q):
    """The distance of q from the nearest root of a tree."""
    least = f32(1e38)
    for number in range(trees.counts[tree]):
        if trees.parents[tree, number] >= 0:
            break
        total = f32(0.0)
        for k in range(len(q)):
            d = trees.nodes[tree, k, number] - q[k]
            total += d * d
        least = min(least, total)
    return np.sqrt(least)


@procedure
def _least(values, numbers, W):
    """The number beside the least value; -1 where all are 1e38."""
    least = least_of(values)
    if least > f32(1e37):
        return -1
    return numbers[first_of(values == least) % W]


@procedure
def _nearest_with_cost(trees, tree, q, cost, W):
    """The node nearest to q in configuration and cost among those that reach q at no more than a cost; -1 for none."""
    best = broadcast(f32(1e38), W)
    where_best = broadcast(0, W)
    for i in range(0, trees.counts[tree], W):
        total = squared_distances(trees.nodes, tree, i, q, W)
        less = cost - trees.costs[tree, i : i + W]
        measure = np.where(np.sqrt(total) <= less, total + less * less, broadcast(f32(1e38), W))
        closer = measure < best
        best = np.where(closer, measure, best)
        where_best = np.where(closer, lane_numbers(W) + i, where_best)
    return _least(best, where_best, W)


@procedure
def _cheapest_within(trees, tree, q, reach, W):
    """The node not farther from q than a reach from which the cost of q is the least; -1 for none."""
    best = broadcast(f32(1e38), W)
    where_best = broadcast(0, W)
    for i in range(0, trees.counts[tree], W):
        distances = np.sqrt(squared_distances(trees.nodes, tree, i, q, W))
        cost = np.where(distances <= reach, distances + trees.costs[tree, i : i + W], broadcast(f32(1e38), W))
        closer = cost < best
        best = np.where(closer, cost, best)
        where_best = np.where(closer, lane_numbers(W) + i, where_best)
    return _least(best, where_best, W)


@procedure
def _extend_below(kernel, tables, growth, trees, tree, sample, part, bound, work, W):
    """Grows a tree towards a sample by one edge; the new node, or -1."""
    least, rest = _to_roots(trees, tree, sample), _to_roots(trees, 1 - tree, sample)
    if least + rest >= bound:
        return -1
    nearest = _nearest_with_cost(trees, tree, sample, least + part * (bound - rest - least), W)
    if nearest < 0:
        return -1
    read_node(trees.nodes, tree, nearest, trees.near)
    length = distance(trees.near, sample)
    scale = growth.longest / length if length > growth.longest else f32(1.0)
    for k in range(len(trees.near)):
        trees.new[k] = trees.near[k] + scale * (sample[k] - trees.near[k])
    ahead = _to_roots(trees, 1 - tree, trees.new)
    if trees.costs[tree, nearest] + scale * length + ahead >= bound:
        return -1
    parent = _cheapest_within(trees, tree, trees.new, growth.longest, W)
    if parent >= 0 and parent != nearest:
        read_node(trees.nodes, tree, parent, trees.near)
        if not edge_touches(kernel, tables, growth.step, trees.near, trees.new, work, W):
            return add_node_with_cost(trees, tree, trees.new, parent)
        read_node(trees.nodes, tree, nearest, trees.near)
    if edge_touches(kernel, tables, growth.step, trees.near, trees.new, work, W):
        return -1
    return add_node_with_cost(trees, tree, trees.new, nearest)


@procedure
def _connect_below(kernel, tables, growth, trees, tree, added, bound, work, W):
    """Grows a tree from its newest node to the nearest node of the other by which the bound holds; whether it did."""
    other = 1 - tree
    read_node(trees.nodes, tree, added, trees.near)
    target = _nearest_with_cost(trees, other, trees.near, bound - trees.costs[tree, added], W)
    if target < 0:
        return False
    read_node(trees.nodes, other, target, trees.aim)
    length = distance(trees.near, trees.aim)
    if trees.costs[tree, added] + length + trees.costs[other, target] >= bound:
        return False
    return connect_straight(kernel, tables, growth, trees, tree, added, other, target, length, True, work, W)


@procedure(constants={"W": 8})
def grow_below(
    kernel: Kernel, tables: Tables, growth: Growth, samples: Array2[f32], parts: Array1[f32], first: int, count: int,
    points: Array2[f32], touching: Array1[f32], roots: int, bound: f32, trees: Trees, work: Work, W: int,
) -> int:  # fmt: skip
    """Grows both trees with one sample after the other until they meet by a path shorter than a bound.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        growth: How trees grow; domains are not used.
        samples: Configurations, shape (at least count, n) [rad, m].
        parts: For each sample, where its cost lies in the interval that the bound allows, from 0 to 1,
            shape (at least count,).
        first: The sample to begin with.
        count: How many samples there are.
        points: The start, then goals, shape (at least roots, n) [rad, m].
        touching: Above 0 for points that are no roots, shape (at least roots,).
        roots: How many points there are, with which both trees begin anew; 0 to go on with the trees.
        bound: What the path is to be shorter than [rad, m].
        trees: Both trees; they are changed.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        The number of the first sample that was not used; where the trees met, minus that.
    """
    if roots > 0:
        set_roots(trees, points, touching, roots)
        for tree in range(2):
            for number in range(trees.counts[tree]):
                trees.costs[tree, number] = f32(0.0)
    tree = 1
    for s in range(first, count):
        tree = tree_to_grow(trees, tree, W)
        if tree < 0:
            return s
        added = _extend_below(kernel, tables, growth, trees, tree, samples[s], parts[s], bound, work, W)
        if added >= 0 and _connect_below(kernel, tables, growth, trees, tree, added, bound, work, W):
            return -s - 1
    return count
