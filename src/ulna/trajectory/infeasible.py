"""Error messages for a path that cannot be followed under limits: where, and which limits exclude each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.constraint_rows import Bounds
from ulna.trajectory.survey import TINY
from ulna.typing import Floats

_NEXT_SET = "controllable set of the next grid point"


@dataclass(frozen=True, eq=False)
class Problem:
    """A path on a grid with its limits: rows a, b, low and high at the start of each segment, and maybe at its end."""

    s: Floats
    D: Floats
    names: Sequence[str]
    tangent: Floats
    speeds: Bounds
    labels: Callable[[Sequence[str]], list[str]]
    start: Sequence[Floats]
    end: Sequence[Floats]
    cap: Floats

    def check_rate(self, which: str, rate: float, k: int, low: float, high: float) -> None:
        """Checks that the squared rate at grid point k is between `low` and `high`.

        Args:
            which: "start" or "end", for the message.
            rate: Rate of the path parameter [1/s].
            k: Number of the grid point.
            low: Least squared rate [1/s^2].
            high: Greatest squared rate [1/s^2].

        Raises:
            InputError: If it is not; names the limit that excludes it.
        """
        if not 0.0 <= rate < np.inf:
            raise InputError(
                f"`{which}_rate` is {rate}; expected a rate of the path parameter, zero or above [1/s]."
            )
        x, slack = rate * rate, 1e-9 * (1.0 + abs(high))
        if low - slack <= x <= high + slack:
            return
        if x > self.cap[k]:
            tangent = self.tangent[0, 0] if k == 0 else self.tangent[k - 1, -1]
            speed = np.where(tangent > 0.0, self.speeds.high, -self.speeds.low)
            fastest = speed / np.maximum(np.abs(tangent), TINY)
            reason = f"above that the speed of {self.names[int(np.argmin(fastest))]!r} exceeds its limit"
        else:
            reason = self._conflict(k, np.array([x]))
        raise InputError(
            f"`{which}_rate` is {rate:g} 1/s, but {self._at(k)} only {np.sqrt(max(low, 0.0)):.6g} to "
            f"{np.sqrt(high):.6g} 1/s can be kept along the path: {reason}."
        )

    def raise_empty_set(self, K: Floats, k: int, at_rest: str) -> None:
        """Raises for grid point k, the last one from which the end cannot be reached: its controllable set is
        empty.

        Args:
            K: Controllable sets of the grid points, (N + 1, 2) [1/s^2].
            k: Number of the grid point.
            at_rest: Sentence on the limits that the robot exceeds at rest; see `static_violation`.

        Raises:
            InputError: Always; names the limits that exclude each other.
        """
        reason = self._conflict(
            k, np.append(0.0, np.geomspace(1e-9, 1.0, 200)) * min(self.cap[k], 1e6), K[k + 1]
        )
        raise InputError(
            f"No motion along the path keeps the limits {self._at(k)}: {reason}. {at_rest}"
            "Raise one of them, or smooth the path there."
        )

    def _at(self, k: int) -> str:
        return f"at s = {self.s[k]:.6g} of {self.s[-1]:.6g} (grid point {k})"

    def _conflict(self, k: int, trials: Floats, following: Any = None) -> str:
        """The rows on segment k that exclude each other at each squared rate in `trials`, where they do so least."""
        D, labels = self.D[k], self.labels(self.names)
        a, b, low, high = (part[k] if part.ndim > 1 else part for part in self.start)
        if self.end:
            a1, b1, low1, high1 = (part[k] if part.ndim > 1 else part for part in self.end)
            a, b = np.append(a, a1 + D * b1), np.append(b, b1)
            low, high, labels = np.append(low, low1), np.append(high, high1), labels * 2
        if following is not None:  # the next x = x + D u lies in its controllable set
            a, b = np.append(a, D), np.append(b, 1.0)
            low, high, labels = (
                np.append(low, following[0]),
                np.append(high, following[1]),
                [*labels, _NEXT_SET],
            )
        x = trials[:, None]
        safe = np.where(np.abs(a) > TINY, a, TINY)
        ends = np.stack([(low - b * x) / safe, (high - b * x) / safe])
        least, most = ends.min(axis=0), ends.max(axis=0)
        gap = least.max(axis=1) - most.min(axis=1)
        trial = int(np.argmin(gap))
        i, j = int(np.argmax(least[trial])), int(np.argmin(most[trial]))
        if labels[i] == labels[j]:
            return f"the {labels[i]} alone exceeds its limit"
        return f"the {labels[i]} and the {labels[j]} exclude each other".replace("the the", "the")
