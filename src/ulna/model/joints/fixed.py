"""The joint that does not move; a model's builder merges it into the body before it."""

from __future__ import annotations

from typing import ClassVar

from ulna.data_classes import dataclass
from ulna.model.joints.axes import EYE, ZERO
from ulna.model.joints.joint_kind import Coordinate, VectorKind
from ulna.spatial import SE3, Motion
from ulna.typing import Array


@dataclass(frozen=True)
class Fixed(VectorKind):
    """Holds the child still on its parent; no q, no v."""

    name: ClassVar[str] = "fixed"
    symbol: ClassVar[str] = ""
    coordinates: ClassVar[tuple[Coordinate, ...]] = ()

    def describe(self) -> str:
        """A short label for tables."""
        return "fixed"

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the identity."""
        return SE3(EYE, ZERO)

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """No columns."""
        return ()
