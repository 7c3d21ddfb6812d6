"""Joints that only slide: prismatic along one axis, and free translation in space."""

from __future__ import annotations

from typing import ClassVar

from ulna.data_classes import dataclass
from ulna.model.joints.axes import EYE, ZERO, Axis, axis_name, scaled_axis, unit, unit_axis
from ulna.model.joints.joint_kind import Coordinate, VectorKind, length
from ulna.spatial import SE3, Motion
from ulna.typing import Array


@dataclass(frozen=True)
class Prismatic(VectorKind):
    """Slides along an axis; q is the distance [m].

    Args:
        axis: Direction in the fixed frame; scaled to length 1.
    """

    axis: Axis = (0.0, 0.0, 1.0)
    name: ClassVar[str] = "prismatic"
    symbol: ClassVar[str] = "P"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (length(),)

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_axis(self.axis))

    def describe(self) -> str:
        """A short label for tables."""
        return f"prismatic {axis_name(self.axis)}"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a translation by q along the axis."""
        return SE3(EYE, scaled_axis(self.axis, q[..., 0]))

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """(axis; 0)."""
        return (Motion(unit(self.axis), ZERO),)


@dataclass(frozen=True)
class Translation(VectorKind):
    """Slides freely in space without turning; q is (x, y, z) [m]."""

    name: ClassVar[str] = "translation"
    symbol: ClassVar[str] = "T"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (length("x"), length("y"), length("z"))

    def describe(self) -> str:
        """A short label for tables."""
        return "translation"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: a translation by q."""
        return SE3(EYE, q)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The three linear unit motions."""
        return tuple(Motion(EYE[i], ZERO) for i in range(3))
