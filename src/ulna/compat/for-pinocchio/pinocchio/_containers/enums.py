"""The enumerations: frames, geometries, references, arguments, conventions."""

from __future__ import annotations

import enum
from typing import Any

from pinocchio._containers.arguments import ArgumentError
from ulna.algorithms.multibody.references import Reference

__all__ = [
    "ACCELERATION",
    "ARG0",
    "ARG1",
    "ARG2",
    "ARG3",
    "ARG4",
    "BODY",
    "COLLISION",
    "FIXED_JOINT",
    "JOINT",
    "LOCAL",
    "LOCAL_WORLD_ALIGNED",
    "OP_FRAME",
    "POSITION",
    "SENSOR",
    "VELOCITY",
    "VISUAL",
    "WORLD",
    "ArgumentPosition",
    "Convention",
    "FrameType",
    "GeometryType",
    "KinematicLevel",
    "ReferenceFrame",
]


class _Named(enum.IntEnum):
    """Numbers with names; printed by their name. `names` and `values` of a class lead to its members."""

    __hash__ = int.__hash__  # that of Enum is slow

    def __init_subclass__(cls) -> None:
        cls.names = dict(cls.__members__)  # type: ignore[attr-defined]
        cls.values = {int(member): member for member in cls}  # type: ignore[attr-defined]

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"pinocchio.{type(self).__name__}.{self.name}"


class FrameType(_Named):
    """What a frame belongs to; values combine with `|` for searches."""

    OP_FRAME = 1
    JOINT = 2
    FIXED_JOINT = 4
    BODY = 8
    SENSOR = 16


class ReferenceFrame(_Named):
    """In which axes, and at which point, velocities are written."""

    WORLD = 0
    LOCAL = 1
    LOCAL_WORLD_ALIGNED = 2


class GeometryType(_Named):
    """What a geometry is for."""

    VISUAL = 0
    COLLISION = 1


class ArgumentPosition(_Named):
    """Which argument to differentiate by."""

    ARG0 = 0
    ARG1 = 1
    ARG2 = 2
    ARG3 = 3
    ARG4 = 4


class Convention(_Named):
    """In which frames an algorithm works inside; the results are the same."""

    WORLD = 0
    LOCAL = 1


class KinematicLevel(_Named):
    """Up to which derivative."""

    POSITION = 0
    VELOCITY = 1
    ACCELERATION = 2


OP_FRAME, JOINT, FIXED_JOINT, BODY, SENSOR = FrameType
WORLD, LOCAL, LOCAL_WORLD_ALIGNED = ReferenceFrame
VISUAL, COLLISION = GeometryType
ARG0, ARG1, ARG2, ARG3, ARG4 = ArgumentPosition
POSITION, VELOCITY, ACCELERATION = KinematicLevel

_REFERENCES: dict[int, Reference] = {0: "world", 1: "local", 2: "local_world_aligned"}


def reference_of(rf: Any) -> Reference:
    """Ulna's name of a ReferenceFrame.

    Raises:
        InputError: it is none; a plain number does not say what it means.
    """
    if not isinstance(rf, ReferenceFrame):
        raise ArgumentError(f"The reference frame is {rf!r}; expected LOCAL, WORLD or LOCAL_WORLD_ALIGNED.")
    return _REFERENCES[rf]
