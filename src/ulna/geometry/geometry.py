"""A named shape placed on a link, with the material it is drawn in."""

from __future__ import annotations

import math
from dataclasses import field

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.geometry.shapes import Shape
from ulna.spatial import SE3


@dataclass(frozen=True)
class Material:
    """How a surface is drawn.

    Args:
        name: The name it has in the model file; may be empty.
        rgba: Red, green, blue and opacity, each from 0 to 1; None leaves the choice to the viewer.
        texture: An image file, or None.
    """

    name: str = ""
    rgba: tuple[float, float, float, float] | None = None
    texture: str | None = None

    def __post_init__(self) -> None:
        if self.rgba is None:
            return
        try:
            rgba = tuple(float(c) for c in self.rgba)
        except (TypeError, ValueError) as error:
            raise InputError(
                f"Material {self.name!r}: `rgba` is {self.rgba!r}; expected 4 numbers."
            ) from error
        if len(rgba) != 4 or not all(map(math.isfinite, rgba)):
            raise InputError(
                f"Material {self.name!r}: `rgba` is {rgba}; expected 4 finite numbers from 0 to 1."
            )
        object.__setattr__(self, "rgba", rgba)


@dataclass(frozen=True)
class Geometry:
    """A shape on a link.

    Args:
        name: Its name; may be empty, need not be unique.
        shape: The shape, in its own frame.
        placement: T_link_shape, the pose of the shape's frame in the link frame.
        material: How it is drawn; None leaves the choice to the viewer.
    """

    name: str
    shape: Shape
    placement: SE3 = field(default_factory=SE3.identity)
    material: Material | None = None
