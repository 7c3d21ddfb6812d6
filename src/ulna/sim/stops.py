"""The position limits of a robot as stops: which joints are beyond them, and the velocities that belong to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ulna.model import Joint, Model
from ulna.spatial import SE3
from ulna.typing import Array, Floats


@final
@dataclass(frozen=True, eq=False)
class Stops:
    """The position limits of a robot; those of bases and balls bound positions only, for they have no rate each.

    Attributes:
        lower: Lower limits, shape (nq,) [rad, m].
        upper: Upper limits, shape (nq,) [rad, m].
        at_q: The coordinates that have a rate each, as indices of q.
        at_v: Those rates, as indices of v, in the same order.
        nv: Number of rates of the robot.
    """

    lower: Floats
    upper: Floats
    at_q: Array
    at_v: Array
    nv: int

    @classmethod
    def of(cls, model: Model) -> Stops:
        """The stops of a robot."""
        parts = [part for joint in model.joints if joint.mimic is None for part in _parts(joint)]
        at_q = [q + k for q, _, count in parts for k in range(count)]
        at_v = [v + k for _, v, count in parts for k in range(count)]
        places = np.array(at_q, dtype=int), np.array(at_v, dtype=int)
        return cls(model.lower_position, model.upper_position, *places, model.nv)

    def contains(self, q: Floats) -> bool:
        """Whether a configuration, shape (nq,) [rad, m], is beyond no limit."""
        return not ((q < self.lower) | (q > self.upper)).any()

    def beyond(self, q: Floats) -> tuple[Array, Array]:
        """Which rates belong to joints below their lower, and above their upper limit.

        Args:
            q: Configuration, shape (nq,) [rad, m].

        Returns:
            Two arrays of truth values, each of shape (nv,).
        """
        low, high = np.zeros(self.nv, dtype=bool), np.zeros(self.nv, dtype=bool)
        low[self.at_v] = (q < self.lower)[self.at_q]
        high[self.at_v] = (q > self.upper)[self.at_q]
        return low, high

    def held(self, q: Floats, low: Array, high: Array) -> Floats:
        """A configuration with joints at their limits, and the others within theirs.

        Args:
            q: Configuration, shape (nq,) [rad, m].
            low: Which rates belong to joints that rest on their lower limit, shape (nv,).
            high: Which ones on their upper limit, shape (nv,).

        Returns:
            Configuration, shape (nq,) [rad, m].
        """
        q = np.clip(q, self.lower, self.upper)
        for at_limit, limit in ((low, self.lower), (high, self.upper)):
            places = self.at_q[at_limit[self.at_v]]
            q[places] = limit[places]
        return q


def _parts(joint: Joint) -> list[tuple[int, int, int]]:
    """For each part of a joint with as many rates as coordinates: the first coordinate, the first rate, how many."""
    kind = joint.kind
    if kind.nq == kind.nv:
        return [(joint.idx_q, joint.idx_v, kind.nv)]
    parts = kind.elementary_joints(SE3.identity())
    return [
        (joint.idx_q + p.start_q, joint.idx_v + p.start_v, p.kind.nv) for p in parts if p.kind.nq == p.kind.nv
    ]
