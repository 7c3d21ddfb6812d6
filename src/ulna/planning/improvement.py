"""Shorter paths once there is one: searches among paths that are shorter than the best so far, until samples run out.

The bound falls with each path that is found, so the best one approaches the shortest path as samples are added: with
certainty, in the limit, if the search below a bound finds a path wherever there is one (Hauser and Zhou 2016). Along
constraints every path begins new trees, whose nodes have no costs: paths become shorter, not certainly the shortest.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from ulna.planning.path_length import length
from ulna.planning.run import Run
from ulna.planning.samples import informed_samples
from ulna.planning.workspace import SLICE
from ulna.typing import Floats

LEAST_GAIN = 1e-3
"""The part by which a path has to be shorter than the best so far."""


def improved(
    run: Run,
    points: Floats,
    goal: int,
    box: tuple[Floats, Floats],
    shortened: Callable[[Run], tuple[Floats, int]],
    proved: Callable[[Run, Floats], Floats | None],
) -> tuple[Floats, int]:
    """The shortest path that a number of samples finds and that is proved free, or a path that is there already.

    Args:
        run: The call; its `improvements` receive times and lengths, its `used` how many samples were taken.
        points: The path, shape (n, nq) [rad, m].
        goal: The number of its goal.
        box: The least and the greatest coordinates of samples, shape (nq,) [rad, m].
        shortened: Returns the path at which the trees met, shortened, and the number of its goal.
        proved: Returns a path, maybe with more points, where all of it is proved; None where it is not.

    Returns:
        Points, shape (n, nq) [rad, m], and the number of the goal.
    """
    least = np.linalg.norm(run.goals - run.q0, axis=1).min()  # no path is shorter
    random = np.random.default_rng([run.options.seed, 1])
    left, roots, first, count = run.options.improve, run.roots, 0, 0
    _note(run, points)
    while left > 0 and not run.should_stop():
        bound = (1.0 - LEAST_GAIN) * length(points)
        if bound <= least:
            break
        if first >= count:
            first, count = 0, min(SLICE, left)
            storage = run.workspace.storage
            drawn = informed_samples(random, count, run.q0, run.goals, bound, *box)
            storage.hold_samples(None, 0, count, lambda drawn=drawn: drawn)
            storage.parts[:count] = random.random(count)
        result = run.workspace.grow_below(bound, first, count, roots)
        used = -result if result < 0 else result
        left, run.samples_used, roots = left - (used - first), run.samples_used + used - first, 0
        first = used
        if result < 0:
            found, number = shortened(run)
            free = proved(run, found) if length(found) < length(points) else None
            if free is not None and length(free) < length(points):
                points, goal = free, number
                _note(run, points)
            first, count, roots = 0, 0, run.roots
    return points, goal


def _note(run: Run, points: Floats) -> None:
    run.improvements.append((time.perf_counter() - run.start_time, length(points)))
