"""Joint kinds with axes of rotation: revolute, continuous, helical, cylindrical and universal."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model.joints.axes import (
    ZERO,
    Axis,
    axis_name,
    rotate_about,
    rotation_about,
    scaled_axis,
    unit,
    unit_axis,
)
from ulna.model.joints.joint_kind import Coordinate, ElementaryJoint, VectorKind, angle, length
from ulna.model.joints.sliding import Prismatic
from ulna.numeric import ceil, cross
from ulna.spatial import SE3, Motion
from ulna.spatial.batched import column
from ulna.typing import Array


def wrap(x: Any) -> Any:
    """The angle in (-pi, pi] equal to `x` modulo 2 pi; values already in that interval are returned unchanged."""
    return x - 2.0 * math.pi * ceil((x - math.pi) / (2.0 * math.pi))


@dataclass(frozen=True)
class Revolute(VectorKind):
    """Turns about an axis, usually between limits; q is the angle [rad].

    Args:
        axis: Axis in the fixed frame; scaled to length 1.

    Example:
        >>> from ulna.model import Revolute
        >>> leaf = ulna.Inertia.from_box(9.0, (0.9, 0.04, 2.0))
        >>> builder = ulna.ModelBuilder("door").add_link("frame").add_link("leaf", leaf)
        >>> builder = builder.add_joint("hinge", Revolute((0, 0, 1)), "frame", "leaf", lower=0.0, upper=1.6)
        >>> ulna.Robot(builder.build()).joint_names
        ('hinge',)
    """

    axis: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "revolute"
    symbol: ClassVar[str] = "R"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle(),)

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_axis(self.axis))

    def describe(self) -> str:
        """A short label for tables."""
        return f"{self.name} {axis_name(self.axis)}"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a rotation by q about the axis."""
        return SE3(rotation_about(self.axis, q[..., 0]), ZERO)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """(0; axis)."""
        return (Motion(ZERO, unit(self.axis)),)


@dataclass(frozen=True)
class Continuous(Revolute):
    """Turns about an axis without limits; q is the angle [rad], and q and q + 2 pi are the same pose.

    Args:
        axis: Axis in the fixed frame; scaled to length 1.
    """

    name: ClassVar[str] = "continuous"

    def difference(self, q0: Array, q1: Array) -> Array:
        """The shortest signed angle from q0 to q1, in (-pi, pi]."""
        return wrap(q1 - q0)

    def normalize(self, q: Array) -> Array:
        """The same pose with q in (-pi, pi]."""
        return wrap(q)


@dataclass(frozen=True)
class Helical(VectorKind):
    """Helical (screw) joint: a rotation about an axis and a proportional translation along it; q is the angle [rad].

    Args:
        axis: Axis in the fixed frame; scaled to length 1.
        pitch: Advance per angle [m/rad].
    """

    axis: Axis = (0.0, 0.0, 1.0)
    pitch: float = 0.0
    name: ClassVar[str] = "helical"
    symbol: ClassVar[str] = "H"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle(),)

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_axis(self.axis))
        object.__setattr__(self, "pitch", number("pitch", self.pitch, "a finite number [m/rad]"))

    def describe(self) -> str:
        """A short label for tables."""
        return f"helical {axis_name(self.axis)}, {self.pitch:g} m/rad"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a rotation by q about the axis and a translation by pitch * q along it."""
        return SE3(rotation_about(self.axis, q[..., 0]), scaled_axis(self._advance, q[..., 0]))

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """(pitch * axis; axis)."""
        return (Motion(unit(self._advance), unit(self.axis)),)

    @property
    def _advance(self) -> Axis:
        x, y, z = (self.pitch * a for a in self.axis)
        return (x, y, z)


@dataclass(frozen=True)
class Cylindrical(VectorKind):
    """Slides along an axis and turns about it, independently; q is the distance [m] and the angle [rad].

    Args:
        axis: Axis in the fixed frame; scaled to length 1.
    """

    axis: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "cylindrical"
    symbol: ClassVar[str] = "C"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (length("d"), angle("theta"))

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_axis(self.axis))

    def describe(self) -> str:
        """A short label for tables."""
        return f"cylindrical {axis_name(self.axis)}"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a translation by q1 along the axis and a rotation by q2 about it."""
        return SE3(rotation_about(self.axis, q[..., 1]), scaled_axis(self.axis, q[..., 0]))

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """(axis; 0) and (0; axis)."""
        return Motion(unit(self.axis), ZERO), Motion(ZERO, unit(self.axis))

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """A prismatic and a revolute joint, whose frames and regrouped inertias take fewer operations."""
        return (
            ElementaryJoint(placement, Prismatic(self.axis), 0, 0, 1.0),
            ElementaryJoint(SE3.identity(), Revolute(self.axis), 1, 1, 1.0),
        )


@dataclass(frozen=True)
class Universal(VectorKind):
    """Turns about a first axis, then about a second one that the first carries; q is both angles [rad].

    Args:
        axis1: First axis, in the fixed frame; scaled to length 1.
        axis2: Second axis, in the moving frame; scaled to length 1, not parallel to the first.
    """

    axis1: Axis = (1.0, 0.0, 0.0)
    axis2: Axis = (0.0, 1.0, 0.0)
    name: ClassVar[str] = "universal"
    symbol: ClassVar[str] = "U"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle("1"), angle("2"))

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis1", unit_axis(self.axis1, "axis1"))
        object.__setattr__(self, "axis2", unit_axis(self.axis2, "axis2"))
        if np.linalg.norm(np.cross(self.axis1, self.axis2)) < 1e-9:
            raise InputError(
                f"Universal: `axis1` {self.axis1} and `axis2` {self.axis2} are parallel; "
                "expected two directions. For one axis use Revolute."
            )

    def describe(self) -> str:
        """A short label for tables."""
        return f"universal {axis_name(self.axis1)}, {axis_name(self.axis2)}"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: R(axis1, q1) R(axis2, q2)."""
        return SE3(rotation_about(self.axis1, q[..., 0]) @ rotation_about(self.axis2, q[..., 1]), ZERO)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The first axis as the moving frame sees it, R(axis2, q2)^T axis1, and the second axis."""
        return Motion(ZERO, self._first(q)), Motion(ZERO, unit(self.axis2))

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """Two revolute joints."""
        return (
            ElementaryJoint(placement, Revolute(self.axis1), 0, 0, 1.0),
            ElementaryJoint(SE3.identity(), Revolute(self.axis2), 1, 1, 1.0),
        )

    def bias(self, q: Array, v: Array) -> Motion:
        """d/dt (R(axis2, q2)^T axis1) v1 = (S1 x axis2) v1 v2."""
        return Motion(ZERO, column(v[..., 0] * v[..., 1]) * cross(self._first(q), unit(self.axis2)))

    def _first(self, q: Array) -> Array:
        return rotate_about(self.axis2, -q[..., 1], self.axis1)
