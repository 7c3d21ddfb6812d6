"""RRT-Connect along constraints, as a procedure: trees grow by short steps that are moved back to the constraints.

Source: Berenson, Srinivasa, Ferguson and Kuffner, Manipulation planning on constraint manifolds (ICRA 2009), the
planner CBiRRT: samples are projected, and a tree is extended towards one as long as projected steps come nearer.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import Array1, Array2, Kernel, f32, procedure
from ulna.planning.edges import edge_touches
from ulna.planning.rrt_connect import Growth
from ulna.planning.trees import Trees, add_node, distance, nearest_node, read_node, set_roots, tree_to_grow


class Projection(NamedTuple):
    """How configurations are moved back to the constraints.

    Attributes:
        inputs: Of the step: a configuration, weights of joints, the constraints' numbers; shape (size, 1).
        outputs: Of the step: changes, and the violation; shape (n + 1, 1).
        low: The least positions, shape (n,) [rad, m].
        high: The greatest ones, shape (n,) [rad, m].
        violation: What is left of the violation at most, in tolerances [-].
        rounds: The most steps.
        stride: How long motions between nodes are [rad, m].
    """

    inputs: Array2[f32]
    outputs: Array2[f32]
    low: Array1[f32]
    high: Array1[f32]
    violation: f32
    rounds: int
    stride: f32


@procedure
def _is_within(low, q, high):
    """Whether q is within limits."""
    outside = 0
    for k in range(len(q)):
        if q[k] < low[k] or q[k] > high[k]:
            outside += 1
    return outside == 0


@procedure
def _project(step, projection, q):
    """Moves q to the constraints; whether it got there, within the limits."""
    n = len(q)
    for _ in range(projection.rounds):
        for k in range(n):
            projection.inputs[k, 0] = q[k]
        step(projection.inputs, projection.outputs)
        if projection.outputs[n, 0] <= projection.violation:
            return _is_within(projection.low, q, projection.high)
        for k in range(n):
            q[k] += projection.outputs[k, 0]
    return False


@procedure
def _walk(kernel, tables, growth, step, projection, trees, tree, first, goal, work, W):
    """Grows a tree from a node towards a configuration on the constraints: the newest node, or -1 - that at the end."""
    last = first
    read_node(trees.nodes, tree, first, trees.near)
    left = distance(trees.near, goal)
    while trees.counts[tree] + W + 2 < trees.nodes.shape[2]:
        if left <= projection.stride:
            if edge_touches(kernel, tables, growth.step, trees.near, goal, work, W):
                return last
            return -last - 1
        part = projection.stride / left
        for k in range(len(goal)):
            trees.new[k] = trees.near[k] + part * (goal[k] - trees.near[k])
        if not _project(step, projection, trees.new):
            return last
        ahead = distance(trees.new, goal)
        if ahead > left - f32(0.1) * projection.stride:
            return last
        if distance(trees.near, trees.new) > f32(2.0) * projection.stride:
            return last
        if edge_touches(kernel, tables, growth.step, trees.near, trees.new, work, W):
            return last
        last = add_node(trees, tree, trees.new, last)
        for k in range(len(goal)):
            trees.near[k] = trees.new[k]
        left = ahead
    return last


@procedure(constants={"W": 8})
def grow_along(
    kernel: Kernel, tables: Tables, growth: Growth, samples: Array2[f32], first: int, count: int, points: Array2[f32],
    touching: Array1[f32], roots: int, trees: Trees, step: Kernel, projection: Projection, work: Work, W: int,
) -> int:  # fmt: skip
    """Grows both trees along the constraints with one sample after the other until they meet.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        growth: How trees grow; only its step counts.
        samples: Configurations, shape (at least count, n) [rad, m].
        first: The sample to begin with.
        count: How many samples there are.
        points: The start, then goals, shape (at least roots, n) [rad, m].
        touching: Above 0 for points that are no roots, shape (at least roots,).
        roots: How many points there are, with which both trees begin anew; 0 to go on with the trees.
        trees: Both trees; they are changed.
        step: From a configuration to the step back to the constraints, and the violation, one sample.
        projection: How configurations are moved back.
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
        for k in range(len(trees.aim)):
            trees.aim[k] = samples[s, k]
        if not _project(step, projection, trees.aim):
            continue
        nearest, _ = nearest_node(trees.nodes, tree, trees.counts[tree], trees.aim, W)
        newest = _walk(kernel, tables, growth, step, projection, trees, tree, nearest, trees.aim, work, W)
        if newest < 0:
            newest = add_node(trees, tree, trees.aim, -newest - 1)
        if newest == nearest:
            continue
        other = 1 - tree
        read_node(trees.nodes, tree, newest, trees.goal)
        nearest, _ = nearest_node(trees.nodes, other, trees.counts[other], trees.goal, W)
        last = _walk(kernel, tables, growth, step, projection, trees, other, nearest, trees.goal, work, W)
        if last < 0:
            trees.meeting[tree] = newest
            trees.meeting[other] = -last - 1
            return -s - 1
    return count


@procedure(constants={"W": 8})
def walk_between(
    kernel: Kernel, tables: Tables, growth: Growth, points: Array2[f32], touching: Array1[f32], trees: Trees,
    step: Kernel, projection: Projection, work: Work, W: int,
) -> int:  # fmt: skip
    """Walks along the constraints from the first point to the second, as straight as they allow.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        growth: Its step counts.
        points: Both points, shape (at least 2, n) [rad, m].
        touching: Above 0 for points that touch, shape (at least 2,).
        trees: Receives the path, the nodes of its first tree, in order.
        step: From a configuration to the step back to the constraints, and the violation, one sample.
        projection: How configurations are moved back.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        Whether it got there, 1 or 0.
    """
    set_roots(trees, points, touching, 2)
    return int(_walk(kernel, tables, growth, step, projection, trees, 0, 0, points[1], work, W) < 0)


@procedure
def project_all(
    step: Kernel, projection: Projection, points: Array2[f32], done: Array1[f32], count: int
) -> int:
    """Moves points to the constraints.

    Args:
        step: From a configuration to the step back to the constraints, and the violation, one sample.
        projection: How configurations are moved back.
        points: Configurations, shape (at least count, n); they are changed [rad, m].
        done: Receives 1 for those that got there, within the limits, else 0, shape (at least count,).
        count: How many there are.

    Returns:
        How many got there.
    """
    total = 0
    for i in range(count):
        done[i] = f32(0.0)
        if _project(step, projection, points[i]):
            done[i] = f32(1.0)
            total += 1
    return total
