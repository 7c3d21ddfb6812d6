"""The box of a robot's joint limits: what is outside of it, and where samples are drawn."""

from __future__ import annotations

from operator import le
from typing import final

import numpy as np

from ulna.model import Model
from ulna.typing import Array, Floats

_ROUNDING = 1e-9  # [rad, m]


@final
class JointBox:
    """The limits of the joints of a model, with an allowance for rounding.

    Args:
        model: The robot; positions of its joints are plain numbers.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self.low, self.high = model.lower_position - _ROUNDING, model.upper_position + _ROUNDING
        self.has_limit = np.isfinite(self.low) & np.isfinite(self.high)
        self.is_bounded = bool(self.has_limit.all())
        """Whether all joints have limits."""
        self.key = self.low.tobytes(), self.high.tobytes()
        """What decides the box."""
        self._lists: tuple[list[float], list[float]] = self.low.tolist(), self.high.tolist()

    def holds(self, q: Floats) -> bool:
        """Whether one configuration is within the limits; for a few numbers lists are faster than arrays.

        Args:
            q: Configuration, shape (nq,) [rad, m].

        Returns:
            The truth value.
        """
        values, (low, high) = q.tolist(), self._lists
        return all(map(le, low, values)) and all(map(le, values, high))

    def clipped(self, points: Array) -> Floats:
        """Points of a search, in float64: what rounding to float32 has moved out of the limits is moved onto them.

        Args:
            points: Configurations, shape (n, nq) [rad, m].

        Returns:
            Points, shape (n, nq) [rad, m].
        """
        return np.minimum(np.maximum(points, self._model.lower_position), self._model.upper_position)

    def violations(self, q: Floats) -> str:
        """Joints that are out of limits, by how much, as text; empty where none is.

        Args:
            q: Configuration, shape (nq,) [rad, m].

        Returns:
            The text.
        """
        if self.holds(q):
            return ""
        texts = []
        for joint in self._model.joints:
            for k in range(joint.idx_q, joint.idx_q + joint.nq):
                if not self.low[k] <= q[k] <= self.high[k]:
                    limits = f"[{self.low[k] + _ROUNDING:.4g}, {self.high[k] - _ROUNDING:.4g}]"
                    texts.append(f"joint {joint.name!r} is at {q[k]:.4g}, its limits are {limits}")
        return "; ".join(texts)

    def sampled(self, q0: Floats, goals: Floats, fixed_coordinates: Array | None) -> tuple[Floats, Floats]:
        """Where samples are drawn: joints without limits turn up to half a turn beyond start and goals.

        Args:
            q0: The start, shape (nq,) [rad, m].
            goals: The goals, shape (n, nq) [rad, m].
            fixed_coordinates: Which coordinates stay where the start has them, shape (nq,); None for none.

        Returns:
            The least and the greatest positions, each of shape (nq,) [rad, m].
        """
        low, high = self._model.lower_position, self._model.upper_position
        if not self.is_bounded:
            ends = np.vstack([q0, goals])
            low = np.where(np.isfinite(low), low, ends.min(axis=0) - np.pi)
            high = np.where(np.isfinite(high), high, ends.max(axis=0) + np.pi)
        if fixed_coordinates is not None:
            low, high = (np.where(fixed_coordinates, q0, limit) for limit in (low, high))
        return low, high
