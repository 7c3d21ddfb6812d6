"""The arm between two places of a robot's tree, as axes in space: what closed forms are made from.

| symbol | meaning | shape, unit |
|---|---|---|
| h_i, p_i | axis of joint i with all angles of the arm at 0 | Line, in the arm's base |
| M | pose of the frame in the arm's base with all angles at 0 | SE3 [m] |
| x_i | the joint's own position, scale * q[index] + offset (a mimic joint's follows its source) | [rad] or [m] |

The pose of the frame is base(q) E_1(x_1) ... E_n(x_n) M (Brockett's product of exponentials; Murray, Li & Sastry 1994,
3.1).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np

from ulna.algorithms.multibody.tree import Step, chain, tip_pose
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.ik.analytic.lines import Line, turn_about
from ulna.model import Frame, Model, Prismatic, Revolute
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_MAX_JOINTS = 7  # joints that a closed form, with one of them held, can have

Motion = Literal["turn", "slide", "other"]


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint of the arm, or the part of a joint that has one coordinate."""

    name: str
    motion: Motion
    line: Line
    index: int
    """Where its coordinate stands in q."""
    index_v: int
    scale: float
    offset: float

    def move(self, x: Any) -> SE3:
        """E(x)."""
        if self.motion == "turn":
            return turn_about(self.line, x)
        return SE3(np.eye(3), self.line.direction * x)


@dataclass(frozen=True, eq=False)
class Arm:
    """A chain of joints that move, the others held still.

    Attributes:
        axes: The joints, from the base to the frame; two may share a coordinate.
        end: M.
        before: The steps that carry the arm, held still; they count by their pose.
    """

    axes: tuple[Axis, ...]
    end: SE3
    before: tuple[Step, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints, from the base to the frame."""
        return tuple(axis.name for axis in self.axes)

    @property
    def indices(self) -> tuple[int, ...]:
        """Places of the arm's coordinates in q, each once."""
        return tuple(dict.fromkeys(axis.index for axis in self.axes))

    @property
    def indices_v(self) -> tuple[int, ...]:
        """Places of the arm's coordinates in v, each once."""
        return tuple(dict.fromkeys(axis.index_v for axis in self.axes))

    @property
    def is_independent(self) -> bool:
        """Whether each joint has its own coordinate."""
        return len(self.indices) == len(self.axes)

    def base(self, q: Array) -> SE3:
        """T_world_base where the joints before the arm are held at `q`."""
        return tip_pose(self.before, q, SE3.identity())


def movable(model: Model, frame: Frame) -> tuple[str, ...]:
    """Names of the joints between the world and the frame that have one coordinate, from the world outwards.

    Args:
        model: The robot.
        frame: The frame.

    Returns:
        The names, each once.
    """
    names = [s.joint.name for s in chain(model, frame) if s.kind.nq == s.kind.nv == 1]
    return tuple(dict.fromkeys(names))


def usual(model: Model, frame: Frame) -> tuple[str, ...]:
    """Names of the joints that are meant when none are named: the last ones that move the frame by seven coordinates.

    Of more than seven those that turn come first, so that the finger of a gripper does not count among them. A joint
    that mimics another one of them has no coordinate, and comes on top.

    Args:
        model: The robot.
        frame: The frame.

    Returns:
        The names, from the world outwards.
    """
    parts = [s for s in chain(model, frame) if s.kind.nq == s.kind.nv == 1]
    turning = [s for s in parts if isinstance(s.kind, Revolute)]
    if len(_places(parts)) > _MAX_JOINTS and len(_places(turning)) >= _MAX_JOINTS:
        parts = turning
    names: list[str] = []
    for name in reversed(dict.fromkeys(s.joint.name for s in parts)):
        if names and len(_places(s for s in parts if s.joint.name in (name, *names))) > _MAX_JOINTS:
            break
        names.append(name)
    return tuple(reversed(names))


def _places(parts: Iterable[Step]) -> set[int]:
    """Where the coordinates of steps that have one each stand in q."""
    return {s.joint.idx_q + s.start_q for s in parts}


def arm_of(model: Model, frame: Frame, joints: Sequence[str], q_fixed: Floats) -> Arm:
    """The arm of those joints that carries the frame; joints between them are held as in `q_fixed`.

    Args:
        model: The robot.
        frame: The frame.
        joints: Names of the joints that move.
        q_fixed: Configuration of the others, (nq,).

    Returns:
        The arm.

    Raises:
        UnknownName: a joint does not stand between the world and the frame, or has several coordinates.
        InputError: no joint is given.
    """
    steps = chain(model, frame)
    choices = movable(model, frame)
    for name in joints:
        if name not in choices:
            raise UnknownName("joint that moves the frame", name, choices, f"The frame is {frame.name!r}.")
    coordinates = {s.joint.idx_q + s.start_q for s in steps if s.joint.name in joints}
    moving = [i for i, s in enumerate(steps) if s.kind.nq == 1 and s.joint.idx_q + s.start_q in coordinates]
    if not moving:
        raise InputError(f"No joint moves the frame {frame.name!r}; expected names out of {choices}.")
    first = moving[0]
    zero = np.array(q_fixed, dtype=float)
    T = SE3.identity()
    axes = []
    for i, step in enumerate(steps[first:], first):
        T = T @ step.placement
        if i not in moving:
            T = T @ step.transform(zero)
            continue
        kind = step.kind
        motion: Motion = "other"
        direction = np.array([0.0, 0.0, 1.0])
        if isinstance(kind, (Revolute, Prismatic)):
            motion, direction = ("turn" if isinstance(kind, Revolute) else "slide"), np.array(kind.axis)
        axes.append(
            Axis(
                step.joint.name,
                motion,
                Line(T.rotation @ direction, np.array(T.translation)),
                step.joint.idx_q + step.start_q,
                step.joint.idx_v + step.start_v,
                step.multiplier,
                step.shift,
            )
        )
    return Arm(tuple(axes), T @ frame.placement, tuple(steps[:first]))
