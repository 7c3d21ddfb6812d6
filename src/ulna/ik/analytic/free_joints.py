"""Other values of joints that turn freely in a singular pose, for branches that their first value does not lead to.

Where two axes are in line, an angle about them is free, and a closed form takes that of the base configuration. With
this value the other joints may not reach the goal, or not within their limits, though they do with another.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.ik.analytic.candidates import Source
from ulna.typing import Floats

_VALUES = 64  # how many values of a free joint are tried
_STEPS = 60


def free_branches(
    source: Source, T: Floats, base: Floats, centre: Floats, values: Floats, q: Floats, wanting: Any
) -> Any:
    """Which branches depend on the base configuration, as only those do in which a joint is free.

    Args:
        source: Where the branches come from.
        T: Goals, (m, 4, 4).
        base: Configurations (m, nq) [rad or m].
        centre: Where the arm's coordinates are wanted, (m, n) or (1, n).
        values: Values of the joint of a redundant arm that is held, (groups,).
        q: The branches with `base`, (m, groups, k, nq) [rad or m].
        wanting: The branches to ask about, (m, groups, k).

    Returns:
        Whether they do, (m, groups, k).
    """
    free = np.zeros(wanting.shape, dtype=bool)
    rows = np.flatnonzero(wanting.any(axis=(1, 2)))
    centres = np.broadcast_to(centre, (len(T), centre.shape[-1]))[rows]
    moved, _, _ = source.candidates(T[rows], _turned(source, base[rows], 1.0), centres, values, 0)
    free[rows] = wanting[rows] & (np.abs(moved - q[rows]) > 0.0).any(axis=-1)
    return free


def other_values(
    source: Source, T: Floats, base: Floats, centre: Floats, values: Floats, tolerances: tuple[float, float]
) -> tuple[Floats, Floats]:
    """The best of each branch of one pose, over values of joints that are free.

    Args:
        source: Where the branches come from.
        T: The goal, (4, 4).
        base: A configuration (nq,) [rad or m].
        centre: Where the arm's coordinates are wanted, (n,).
        values: Values of the joint of a redundant arm that is held, (groups,).
        tolerances: Distance [m] and angle [rad] at which the goal is reached.

    Returns:
        q (groups, k, nq), and its evaluation (groups, k, 3): within the limits where that can be, near `base` then.
    """
    offsets = np.linspace(-np.pi, np.pi, _VALUES, endpoint=False)
    count, position, rotation = len(offsets), *tolerances
    bases = _turned(source, np.repeat(base[None], count, axis=0), offsets[:, None])
    goals, centres = np.repeat(T[None], count, axis=0), np.repeat(centre[None], count, axis=0)
    q, evaluation, _ = source.candidates(goals, bases, centres, values, 0)
    reached = (evaluation[..., 0] <= position) & (evaluation[..., 1] <= rotation)
    missed = np.nan_to_num(evaluation[..., 0] + evaluation[..., 1], nan=np.inf)
    outside = np.where(evaluation[..., 2] > 0.5, 0.0, 10.0)
    best = np.where(reached, outside + np.abs(offsets)[:, None, None], 100.0 + missed).argmin(axis=0)[None]
    q = np.take_along_axis(q, best[..., None], axis=0)[0]
    found = np.take_along_axis(reached, best, axis=0)[0]
    rest = ~found & np.isfinite(q).all(axis=-1)
    count = int(rest.sum())
    q[rest] = source.refine(q[rest], np.repeat(T[None], count, axis=0), _STEPS)
    return source.evaluate(q, T, centre)


def _turned(source: Source, base: Floats, by: Any) -> Floats:
    """Configurations (m, nq) with all joints of the arm turned."""
    base = np.array(base)
    base[:, source.index] += by
    return base
