"""Joints whose moving frame is the end of a chain of turns, each by a multiple of one of the joint's angles.

| symbol | meaning | unit |
|---|---|---|
| T_k | pose of the moving frame of turn k in that of the turn before | [m, 1] |
| S_k | motion subspace of turn k: its ratio times its axis, constant in its own frame | [1] |

Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 5.3, for the recursion along the chain.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import NamedTuple

from ulna.model.joints.axes import ZERO, rotation_about, unit
from ulna.model.joints.joint_kind import ElementaryJoint, VectorKind
from ulna.model.joints.turning import Revolute
from ulna.numeric import vector
from ulna.spatial import SE3, Motion
from ulna.spatial.batched import column
from ulna.typing import Array


class Turn(NamedTuple):
    """A turn of the chain: by a multiple of one of the joint's angles, after a slide along z."""

    slide: float
    """How far its fixed frame lies along the z axis of the frame before [m]."""
    kind: Revolute
    """The axis."""
    coordinate: int
    """Which of the joint's angles turns it."""
    ratio: float
    """By how many times that angle it turns."""


class TurnChain(VectorKind):
    """A kind that is a chain of turns between constant slides along z; q is its angles [rad]."""

    @property
    @abstractmethod
    def turns(self) -> tuple[Turn, ...]:
        """The turns, from the fixed frame outward; the last one moves the moving frame."""

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the product of the turns."""
        first, *others = self._poses(q)
        for T in others:
            first = first @ T
        return first

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The sums of the turns' columns by angle, in the moving frame."""
        columns = [Motion.zero()] * self.nv
        for turn, T in zip(self.turns, self._poses(q), strict=True):
            columns = [T.act_inverse(c) for c in columns]
            columns[turn.coordinate] = columns[turn.coordinate] + _column(turn)
        return tuple(columns)

    def bias(self, q: Array, v: Array) -> Motion:
        """(dS/dt) v, by the recursion a' = X a + V x (S v) along the turns (Featherstone, eq. 5.8)."""
        velocity, total = Motion.zero(), Motion.zero()
        for turn, T in zip(self.turns, self._poses(q), strict=True):
            rate, s = column(v[..., turn.coordinate]), _column(turn)
            twist = Motion(rate * s.linear, rate * s.angular)
            velocity = T.act_inverse(velocity) + twist
            total = T.act_inverse(total) + velocity.cross(twist)
        return total

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """The turns."""
        parts = []
        for turn in self.turns:
            place, placement = placement @ SE3.trans(0.0, 0.0, turn.slide), SE3.identity()
            parts.append(ElementaryJoint(place, turn.kind, turn.coordinate, turn.coordinate, turn.ratio))
        return tuple(parts)

    def _poses(self, q: Array) -> Iterator[SE3]:
        """The pose of the moving frame of each turn in that of the turn before."""
        for turn in self.turns:
            R = rotation_about(turn.kind.axis, turn.ratio * q[..., turn.coordinate])
            yield SE3(R, vector(0.0, 0.0, turn.slide))


def _column(turn: Turn) -> Motion:
    return Motion(ZERO, turn.ratio * unit(turn.kind.axis))
