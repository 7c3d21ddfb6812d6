"""Along straight segments with rounded corners: parabolic and quintic blends.

| symbol | meaning | shape | unit |
|---|---|---|---|
| T | time of each segment | (k,) | [s] |
| tau | time of a blend, half of it before the corner and half behind | () | [s] |
| v | speed on each segment | (k, n) | [rad/s] |

Source: Craig, Introduction to Robotics (2005), section 7.3 (parabolic); Biagiotti & Melchiorri 2008, section 2.1.3
(quintic).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, UnknownName
from ulna.trajectory.inputs import not_repeating, positive, rows
from ulna.trajectory.polynomial import Polynomial, hermite
from ulna.typing import ArrayLike, Floats


def blended(
    points: ArrayLike,
    blend: float,
    segment_times: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    kind: Literal["parabolic", "quintic"] = "parabolic",
    ends: Literal["whole", "half"] = "whole",
) -> Polynomial:
    """Straight from way-point to way-point, each corner cut by a blend; from rest to rest.

    The way passes by the inner points, at v tau / 8 (parabolic) or 3/32 v tau (quintic) for a change v of velocity. The
    duration is the sum of the segment times.

    Args:
        points: Way-points in rows, (k + 1, n) [rad or m].
        blend: Time of each blend, tau [s].
        segment_times: Time of each segment, (k,) [s].
        velocity: Limits of speed on the segments instead, one or (n,) [rad/s or m/s]: each segment takes the
            time of its slowest joint, and at least two blends.
        kind: "parabolic": constant acceleration in the blends; "quintic": continuous acceleration.
        ends: How the motion leaves and reaches rest. "whole": in a whole blend inside the first and the last
            segment, whose straight part is a little faster for it; speeds stay within those of the segments.
            "half", for quintics: in half a blend that catches up with the straight line and is half as fast
            again as it, as the Robotics Toolbox's `mstraj` does.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, way-points repeat, or a segment is too short for its blends; names it.
        UnknownName: No such kind of blend or of ends.
    """
    _check_kinds(kind, ends)
    q, tau = rows("points", points), checked_duration("blend", blend)
    displacements = np.diff(q, axis=0)
    not_repeating("points", q, np.abs(displacements).max(axis=1))
    count = len(displacements)
    is_whole = ends == "whole"
    inside = np.zeros(count)  # what the blends from rest and to rest cost a segment beyond half a blend
    inside[0] += 0.5 * tau
    inside[-1] += 0.5 * tau
    cost = inside if is_whole else np.zeros(count)
    T = _durations(segment_times, velocity, displacements, tau, cost)
    v = displacements / (T - cost)[:, None]
    clock = np.concatenate([[0.0], np.cumsum(T)])
    first = tau if is_whole else 0.5 * tau
    knots, states, speeds = [0.0], [q[0]], [np.zeros(q.shape[1])]
    for k in range(count):
        begins = clock[k] + (first if k == 0 else 0.5 * tau)
        stops = clock[k + 1] - (first if k == count - 1 else 0.5 * tau)
        since = clock[k] + (
            0.5 * tau if is_whole and k == 0 else 0.0
        )  # when the straight line would leave its point
        for t in (begins, stops) if stops - begins > 1e-12 * clock[-1] else (begins,):
            knots.append(t)
            states.append(q[k] + (t - since) * v[k])
            speeds.append(v[k])
    knots.append(clock[-1])
    states.append(q[-1])
    speeds.append(np.zeros(q.shape[1]))
    a = None if kind == "parabolic" else np.zeros((len(knots), q.shape[1]))
    return hermite(np.array(knots), np.array(states), np.array(speeds), a, kind=f"{kind} blends")


def _check_kinds(kind: str, ends: str) -> None:
    if kind not in ("parabolic", "quintic"):
        raise UnknownName("kind of blend", kind, ("parabolic", "quintic"))
    if ends not in ("whole", "half"):
        raise UnknownName("kind of end", ends, ("whole", "half"))
    if ends == "half" and kind == "parabolic":
        raise InputError(
            'A parabolic blend of half the length misses the last point; expected kind="quintic" or ends="whole".'
        )


def _durations(
    segment_times: ArrayLike | None,
    velocity: ArrayLike | None,
    displacements: Floats,
    tau: float,
    cost: Floats,
) -> Floats:
    """The time of each segment, of which `cost` is spent on reaching or leaving rest; all are long enough to blend."""
    count, n = displacements.shape
    if (segment_times is None) == (velocity is None):
        raise InputError("Expected either `segment_times` or `velocity`; both or neither was given.")
    if velocity is not None:
        needed = (np.abs(displacements) / positive("velocity", velocity, n)).max(axis=1) + cost
        T = np.maximum(needed, 2.0 * tau)
    else:
        assert segment_times is not None
        T = np.atleast_1d(finite_array("segment_times", segment_times))
        if T.shape != (count,):
            raise InputError(
                f"`segment_times` has shape {T.shape}; expected ({count},), one for each segment."
            )
    least = np.full(count, tau) + cost
    if (least * (1.0 - 1e-12) > T).any():
        k = int(np.argmax(least > T))
        raise InputError(
            f"Segment {k}, from point {k} to point {k + 1}, lasts {T[k]:.6g} s, but its blends take {least[k]:.6g} s; "
            "expected a longer segment, or a shorter `blend`."
        )
    return T
