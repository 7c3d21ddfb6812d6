"""What binds a robot beyond its joints, as frozen data: contacts with the world, loops between two of its frames.

A constraint names frames; `frame_pairs` finds them in a model. A loop says that its second frame moves with its first,
seen from the world; a contact says so of an anchor that stands still. Forces act on the first frame, and opposite
ones on the second.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import fields
from typing import Any, Literal, NamedTuple, TypeAlias, final, get_args

import numpy as np

from ulna.checks.arrays import shaped_array
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.model.joints.axes import constant
from ulna.model.model import Model
from ulna.spatial import SE3

Axes: TypeAlias = Literal["local_world_aligned", "local"]
"""The axes along which a constraint and its forces are written: those of the world, or of its first frame."""


class End(NamedTuple):
    """One side of a constraint."""

    joint: int
    """The joint that carries it; -1 for the world."""
    placement: SE3
    """Its pose in the moving frame of that joint."""


class FramePair(NamedTuple):
    """A constraint with its frames in a model."""

    first: End
    second: End | None
    """None for an anchor in the world, which is an argument of the functions that need it."""
    size: Literal[3, 6]
    """How many rows: the motion of a point, or of a frame, linear part first."""
    local: bool
    """Whether its rows are written along the axes of the first frame."""


class Constraint(ABC):
    """What binds a frame of a robot to the world or to another frame. Equal constraints share their kernels."""

    axes: Axes
    _key: tuple[Any, ...]
    _hash: int

    @property
    @abstractmethod
    def size(self) -> Literal[3, 6]:
        """How many motions it takes, and how many entries its force has."""

    @abstractmethod
    def ends(self) -> tuple[tuple[str, SE3], ...]:
        """The frames it names, each with a pose in it; a contact names one."""

    @property
    def is_contact(self) -> bool:
        """Whether it holds to an anchor in the world."""
        return len(self.ends()) == 1

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if field.name.startswith("frame") and not isinstance(value, str):
                raise InputError(f"`{field.name}` is {value!r}; expected the name of a frame.")
            if field.name.startswith("point"):
                object.__setattr__(self, field.name, _point(field.name, value))
            if field.name.startswith("placement"):
                object.__setattr__(self, field.name, _placement(field.name, value))
        if self.axes not in get_args(Axes):
            raise UnknownName("axes of a constraint", self.axes, get_args(Axes))
        key = (type(self), *(getattr(self, field.name) for field in fields(self)))  # type: ignore[arg-type]
        object.__setattr__(self, "_key", key)
        object.__setattr__(self, "_hash", hash(key))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Constraint) and self._key == other._key

    def __hash__(self) -> int:
        return self._hash


@final
@dataclass(frozen=True, eq=False)
class PointContact(Constraint):
    """A point of a frame stays where it is in the world, as a point foot or a fingertip does; it may turn about it.

    Attributes:
        frame: Name of the frame.
        point: The point in it [m].
        axes: Axes of the force: "local_world_aligned" or "local".
    """

    frame: str
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axes: Axes = "local_world_aligned"

    @property
    def size(self) -> Literal[3, 6]:
        """Three."""
        return 3

    def ends(self) -> tuple[tuple[str, SE3], ...]:
        """The frame, with the point."""
        return ((self.frame, _at(self.point)),)


@final
@dataclass(frozen=True, eq=False)
class FrameContact(Constraint):
    """A frame stays where it is in the world and does not turn, as a flat foot or a clamped hand.

    Attributes:
        frame: Name of the frame.
        placement: Pose in it of the frame that is held: there the moment is taken, along its axes if `axes` is "local".
        axes: Axes of force and moment: "local_world_aligned" or "local".
    """

    frame: str
    placement: SE3 = SE3.identity()
    axes: Axes = "local_world_aligned"

    @property
    def size(self) -> Literal[3, 6]:
        """Six."""
        return 6

    def ends(self) -> tuple[tuple[str, SE3], ...]:
        """The frame, with the placement."""
        return ((self.frame, self.placement),)


@final
@dataclass(frozen=True, eq=False)
class PointLoop(Constraint):
    """A point of one frame and a point of another stay together: a ball joint that closes a loop.

    Attributes:
        frame_a: Name of the frame the force acts on.
        frame_b: Name of the frame the opposite force acts on.
        point_a: The point in the one [m].
        point_b: The point in the other [m].
        axes: Axes of the force: "local_world_aligned" or, for those of `frame_a`, "local".
    """

    frame_a: str
    frame_b: str
    point_a: tuple[float, float, float] = (0.0, 0.0, 0.0)
    point_b: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axes: Axes = "local_world_aligned"

    @property
    def size(self) -> Literal[3, 6]:
        """Three."""
        return 3

    def ends(self) -> tuple[tuple[str, SE3], ...]:
        """Both frames, with their points."""
        return (self.frame_a, _at(self.point_a)), (self.frame_b, _at(self.point_b))


@final
@dataclass(frozen=True, eq=False)
class FrameLoop(Constraint):
    """Two frames of the robot stay together in place and turn: a weld that closes a loop.

    Attributes:
        frame_a: Name of the frame the force acts on.
        frame_b: Name of the frame the opposite force acts on.
        placement_a: Pose in the one of the frame that is held.
        placement_b: Pose in the other of the frame it is held to.
        axes: Axes of force and moment: "local_world_aligned" or, for those of `frame_a`, "local".
    """

    frame_a: str
    frame_b: str
    placement_a: SE3 = SE3.identity()
    placement_b: SE3 = SE3.identity()
    axes: Axes = "local_world_aligned"

    @property
    def size(self) -> Literal[3, 6]:
        """Six."""
        return 6

    def ends(self) -> tuple[tuple[str, SE3], ...]:
        """Both frames, with their placements."""
        return (self.frame_a, self.placement_a), (self.frame_b, self.placement_b)


def listed(constraints: Any) -> tuple[Constraint, ...]:
    """The constraints of a list; one alone counts as one.

    Raises:
        InputError: There is something else among them, or nothing.
    """
    listing = tuple(constraints) if isinstance(constraints, (list, tuple)) else (constraints,)
    if not all(isinstance(constraint, Constraint) for constraint in listing):
        raise InputError(
            f"`constraints` is {constraints!r}; expected a list of PointContact, FrameContact, PointLoop or FrameLoop."
        )
    if not listing:
        raise InputError(
            "`constraints` is empty; expected one or more. `forward_dynamics` is what nothing binds."
        )
    return listing


def frame_pairs(model: Model, constraints: Sequence[Constraint] | Constraint) -> tuple[FramePair, ...]:
    """The constraints with their frames looked up in a model.

    Args:
        model: The robot.
        constraints: The constraints, or one.

    Returns:
        One frame_pair a constraint.

    Raises:
        UnknownName: There is no such frame.
        InputError: They are no constraints; or no joint can move what one of them holds.
    """
    return tuple(_frame_pair(model, constraint) for constraint in listed(constraints))


def _frame_pair(model: Model, constraint: Constraint) -> FramePair:
    ends = []
    for name, pose in constraint.ends():
        frame = model.frame(name)
        ends.append(End(frame.joint, frame.placement @ pose))
    first, second = (ends[0], None) if constraint.is_contact else ends
    if second is None and first.joint < 0:
        raise InputError(
            f"{constraint} holds a frame that no joint moves, so that it binds nothing; name a frame that moves."
        )
    if second is not None and first.joint == second.joint:
        raise InputError(
            f"{constraint} is between frames of one body, so that it binds nothing; name frames of different bodies."
        )
    return FramePair(first, second, constraint.size, constraint.axes == "local")


def _at(point: tuple[float, float, float]) -> SE3:
    return SE3(np.eye(3), np.array(point))


def _point(name: str, value: Any) -> tuple[float, ...]:
    point = shaped_array(name, value, 3, fix="A point in the frame [m].")
    return tuple(point.tolist())


def _placement(name: str, value: Any) -> SE3:
    """A read-only copy: constraints are keys of kernels."""
    if not isinstance(value, SE3) or value.batch_shape:
        raise InputError(f"`{name}` is {value!r}; expected one SE3, the pose in the frame.")
    return SE3(constant(value.rotation), constant(value.translation))
