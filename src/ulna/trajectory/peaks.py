"""The greatest values of functions of time that are smooth between knots, found by bounds, so that none is missed.

Each interval is sampled at five times from inside. The Bernstein coefficients of the quartic through them bound the
values on the interval (`quartics`): exactly for quartics, and else the better the shorter it is. Intervals whose
bound is above the best value found so far are cut in four, until the bounds are close to it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.trajectory.quartics import NODES, TO_HALVES
from ulna.typing import Floats

_END_OFFSET = 1e-9  # how far inside an interval its ends are sampled, in parts of its length
_SAME = 1e-9  # how near to a knot a time is that knot, in parts of the whole
_ROUNDS, _MOST = 12, 20_000  # rounds of cutting, and intervals in one of them


@dataclass(frozen=True)
class Peaks:
    """The greatest values of k functions.

    Attributes:
        value: The greatest found, (k,).
        bound: What none exceeds, (k,); for quartics for certain.
        time: When each value was found, (k,) [s].
    """

    value: Floats
    bound: Floats
    time: Floats


def greatest(f: Callable[[Floats], Floats], knots: Floats, samples: int, tolerance: Floats) -> Peaks:
    """The greatest values of functions over all time.

    Args:
        f: Times (m,) to values (m, k).
        knots: Times between which they are smooth, increasing, (p + 1,) [s].
        samples: How many times are looked at, at least.
        tolerance: How close bounds must come to the values found, (k,).

    Returns:
        Greatest values, their times, and bounds that no value exceeds.
    """
    even = np.linspace(knots[0], knots[-1], max(samples // (len(NODES) - 1), 1) + 1)
    between = np.concatenate([0.5 * (knots[:-1] + knots[1:]), even])
    edges = np.unique(np.concatenate([knots, between[_apart(between, knots)]]))
    begin, end = edges[:-1], edges[1:]
    value, time, settled = None, np.zeros(0), np.full(tolerance.shape, -np.inf)
    for round in range(_ROUNDS):
        t = _inside(begin, end)
        values = f(t.reshape(-1)).reshape(*t.shape, -1)
        flat = values.reshape(-1, values.shape[-1])
        at = flat.argmax(axis=0)
        here, when = flat[at, np.arange(at.size)], t.reshape(-1)[at]
        if value is None:
            value, time = here, when
        value, time = np.maximum(value, here), np.where(here > value, when, time)
        bounds = (TO_HALVES @ values).max(axis=1)
        open_ = (bounds > value + tolerance).any(axis=1)
        last = round == _ROUNDS - 1 or 4 * np.count_nonzero(open_) > _MOST or not open_.any()
        settled = np.maximum(settled, bounds[slice(None) if last else ~open_].max(axis=0, initial=-np.inf))
        if last:
            break
        begin, end = _quartered(begin[open_], end[open_])
    assert value is not None
    return Peaks(value, np.maximum(value, settled), time)


def _apart(times: Floats, knots: Floats) -> Any:
    """Which times are no knots but for rounding: an interval from one to the other is too short to be sampled."""
    after = np.clip(np.searchsorted(knots, times), 1, len(knots) - 1)
    gap = np.minimum(np.abs(times - knots[after - 1]), np.abs(knots[after] - times))
    return gap > _SAME * (knots[-1] - knots[0])


def _inside(begin: Floats, end: Floats) -> Floats:
    """Five times in each interval, (m, 5): the ends from inside, since a derivative may jump there."""
    h = (end - begin)[:, None]
    t = begin[:, None] + h * NODES
    t[:, 0] += _END_OFFSET * h[:, 0]
    t[:, -1] = end - _END_OFFSET * h[:, 0]
    return np.maximum(np.minimum(t, np.nextafter(end, -np.inf)[:, None]), begin[:, None])


def _quartered(begin: Floats, end: Floats) -> tuple[Floats, Floats]:
    cuts = begin[:, None] + (end - begin)[:, None] * NODES
    cuts[:, -1] = end
    return cuts[:, :-1].reshape(-1), cuts[:, 1:].reshape(-1)
