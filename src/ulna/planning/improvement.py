"""Shorter paths once there is one: searches among paths that are shorter than the best so far, until samples run out.

The bound falls with each path that is found, so the best one approaches the shortest path as samples are added: with
certainty, in the limit, if the search below a bound finds a path wherever there is one (Hauser and Zhou 2016).
"""

from __future__ import annotations

import time

import numpy as np

from ulna.planning.path_length import length
from ulna.planning.run import Run
from ulna.planning.samples import informed_samples
from ulna.planning.workspace import SLICE
from ulna.typing import Floats

LEAST_GAIN = 1e-3
"""The part by which a path has to be shorter than the best so far."""


def improved(run: Run, points: Floats, goal: int, low: Floats, high: Floats) -> tuple[Floats, int]:
    """The shortest path that a number of samples finds and that is proved free, or a path that is there already.

    Args:
        run: The call; its `improvements` receive times and lengths, its `used` how many samples were taken.
        points: The path, shape (n, nq) [rad, m].
        goal: The number of its goal.
        low: The least coordinates of samples, shape (nq,) [rad, m].
        high: The greatest ones, shape (nq,) [rad, m].

    Returns:
        Points, shape (n, nq) [rad, m], and the number of the goal.
    """
    least = np.linalg.norm(run.goals - run.q0, axis=1).min()  # no path is shorter
    random = np.random.default_rng([run.options.seed, 1])
    left, roots, first, count = run.options.improve, run.roots, 0, 0
    _note(run, points)
    while left > 0 and not run.is_late():
        bound = (1.0 - LEAST_GAIN) * length(points)
        if bound <= least:
            break
        if first >= count:
            first, count = 0, min(SLICE, left)
            storage = run.workspace.storage
            storage.samples[:count] = informed_samples(random, count, run.q0, run.goals, bound, low, high)
            storage.parts[:count] = random.random(count)
        result = run.workspace.grow_below(bound, first, count, roots)
        used = -result if result < 0 else result
        left, run.used, roots = left - (used - first), run.used + used - first, 0
        first = used
        if result < 0:
            found, number = run.shortened()
            if length(found) < length(points) and not run.workspace.unproved(found):
                points, goal = found, number
                _note(run, points)
            first, count, roots = 0, 0, run.roots
    return points, goal


def _note(run: Run, points: Floats) -> None:
    run.improvements.append((time.perf_counter() - run.start_time, length(points)))
