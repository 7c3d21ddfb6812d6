"""The stages of a search as one procedure, so that all of them run the same machine code of checks.

A plan that is asked for once in a while finds no instruction of it in the processor's caches: four procedures, each
with its own copy of the checks, then take 10 us longer than one.
"""

from __future__ import annotations

import numpy as np

from ulna.collision.lanes.touching import Work
from ulna.compiler.procedures import Array1, Array2, Kernel, f32, f64, procedure
from ulna.planning.edges import Proof, first_direct_goal, first_unproved_edge
from ulna.planning.rrt_connect import Growth, grow
from ulna.planning.shortcuts import shortened_path
from ulna.planning.trees import Trees

INT = np.int64

EXAMINE, START, GROW, SHORTEN, PROVE = 0, 1, 2, 3, 4
"""What `run_stage` can do: `START` examines, and grows where that is to be done."""

NOT_ALL_FREE = -2
"""What examining start and goals returns where one is out of limits or touches anything."""


@procedure
def _are_within(box, ends, points, count):
    """Writes ends to points in float32; whether all of them are within the box."""
    for i in range(count):
        for k in range(ends.shape[1]):
            if not (box[0, k] <= ends[i, k] and ends[i, k] <= box[1, k]):
                return False
            points[i, k] = f32(ends[i, k])
    return True


@procedure
def _examine(kernel, tables, step, box, ends, points, touching, count, work, W):
    """The first goal that a straight motion reaches; -1 where there is none, -2 where not all are free."""
    if not _are_within(box, ends, points, count):
        return NOT_ALL_FREE
    direct = first_direct_goal(kernel, tables, step, points, touching, count, work, W)
    for i in range(count):
        if touching[i] > 0:
            return NOT_ALL_FREE
    return direct


@procedure
def _root_of(trees, tree, node):
    """The root of a node."""
    while trees.parents[tree, node] >= 0:
        node = trees.parents[tree, node]
    return node


@procedure(constants={"W": 8})
def run_stage(
    numbers: Array1[INT], kernel: Kernel, proof: Proof, growth: Growth, box: Array2[f64], ends: Array2[f64],
    samples: Array2[f32], points: Array2[f32], touching: Array1[f32], trees: Trees, path: Array2[f32], work: Work,
    W: int,
) -> int:  # fmt: skip
    """Runs a stage of a search.

    Args:
        numbers: The stage; which sample, or edge of the path, to begin with; the number of the sample to end before,
            how many points the path has, or how often it is shortened; how many ends there are, with which new trees
            begin, 0 to go on with the trees; receives what was found before: shape (5,). That is for `EXAMINE` and
            `START` the number of the first goal that a straight motion reaches, among the ends, -1 where there is
            none, `NOT_ALL_FREE`; for `SHORTEN` the number of the path's goal among those that are free.
        kernel: From configurations to poses of the bodies, in lanes.
        proof: How it is proved that nothing touches; the search takes the smallest spheres.
        growth: How trees grow.
        box: Least and greatest positions of joints, shape (2, n) [rad, m].
        ends: The start, then goals, shape (room, n) [rad, m].
        samples: Configurations, shape (room, n) [rad, m].
        points: Receives the ends in float32, shape (room, n) [rad, m].
        touching: Above 0 for points that touch, shape (room,).
        trees: Both trees.
        path: A path, shape (room, n) [rad, m].
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        What `rrt_connect.grow`, `shortcuts.shortened_path` or `edges.first_unproved_edge` returns; 0 where there was
        nothing to do.
    """
    step, stage, first, count, roots = growth.step, numbers[0], numbers[1], numbers[2], numbers[3]
    if stage <= START:
        numbers[4] = _examine(kernel, proof.finest, step, box, ends, points, touching, roots, work, W)
        if stage == EXAMINE or numbers[4] != -1:
            return 0
    if stage <= GROW:
        return grow(
            kernel, proof.finest, growth, samples, first, count, points, touching, roots, trees, work, W
        )
    if stage == SHORTEN:
        numbers[4] = _root_of(trees, 1, trees.meeting[1])
        return shortened_path(kernel, proof.finest, step, trees, path, count, work, W)
    return first_unproved_edge(kernel, proof, path, first, count, work, W)
