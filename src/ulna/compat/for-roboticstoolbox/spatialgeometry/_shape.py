"""What all shapes have: a pose in a tree of frames, a colour, a velocity, and a way to be drawn."""

from __future__ import annotations

import abc
import copy
import warnings
from typing import Any, ClassVar, Self

import numpy as np

from spatialgeometry._colour import rgba
from spatialgeometry._node import _ORIGIN, SceneNode, matrix_of
from ulna.checks.arrays import finite_array
from ulna.errors import InputError, ShapeError
from ulna.spatial import matrix_to_quat_xyzw
from ulna.typing import Floats
from ulna.viewer.colours import RGBA

__all__ = ["Shape"]

_GREY: RGBA = (0.3, 0.3, 0.3, 1.0)


class Shape(SceneNode, abc.ABC):
    """A shape in a tree of frames.

    Args:
        pose: T_parent_shape, an SE3 or an array (4, 4).
        color: A name, "#rrggbb", or three or four numbers from 0 to 1 or to 255; grey when not given.
        stype: The kind's name; that of the class when not given.
        base: An older name of `pose`.
        kwargs: `scene_parent`, `scene_children`.

    Raises:
        InputError, ShapeError, NonFiniteError: An argument is not what it should be.
    """

    kind: ClassVar[str] = "shape"
    lengths: ClassVar[tuple[str, ...]] = ()
    """Attributes with its dimensions, in the order of its description."""
    _has_colours: ClassVar[bool] = False
    """Whether it has colours where none was passed: those of axes or of a file."""

    def __init__(
        self, pose: Any = None, color: Any = None, stype: str | None = None, base: Any = None, **kwargs: Any
    ) -> None:
        if pose is not None and base is not None:
            raise InputError("Give `pose` or its older name `base`, not both.")
        if base is not None:
            warnings.warn("`base` of a shape is the former name of `pose`", FutureWarning, stacklevel=3)
        self.stype = stype or self.kind
        self.changes = 0
        """How often its colour or its size changed; whoever draws it looks here."""
        self._coloured, self._rgba, self._v = (
            color is not None,
            _GREY if color is None else rgba(color),
            np.zeros(6),
        )
        at = base if pose is None else pose
        super().__init__(pose=_ORIGIN if at is None else at, **kwargs)

    def draw(self, viewer: Any, name: str) -> None:
        """Add it to an `ulna.Viewer` under a name, at the origin.

        Args:
            viewer: The viewer.
            name: Name of the node.
        """
        self._draw(viewer, name)
        self._set_colour(viewer[name])

    @abc.abstractmethod
    def _draw(self, viewer: Any, name: str) -> None: ...

    def _set_colour(self, handle: Any) -> None:
        """Gives a handle of the viewer this shape's colour and opacity."""
        keeps_colours = self._has_colours and not self._coloured
        handle.color, handle.opacity = None if keeps_colours else self._rgba[:3], self._rgba[3]

    @property
    def color(self) -> RGBA:
        """Red, green, blue and opacity from 0 to 1; anything that names a colour can be assigned."""
        return self._rgba

    @color.setter
    def color(self, color: Any) -> None:
        self._coloured, self._rgba = color is not None, _GREY if color is None else rgba(color)
        self.changes += 1

    @property
    def opacity(self) -> float:
        """From 0, not to be seen, to 1."""
        return self._rgba[3]

    @opacity.setter
    def opacity(self, opacity: float) -> None:
        if not 0.0 <= opacity <= 1.0:
            raise InputError(f"`opacity` is {opacity}; expected a number from 0 to 1.")
        self._rgba = (*self._rgba[:3], float(opacity))
        self.changes += 1

    def set_alpha(self, alpha: float) -> None:
        """Set the opacity: an older name of it; above 1 it counts to 255."""
        warnings.warn("set_alpha is the former name of the property opacity", FutureWarning, stacklevel=2)
        self.opacity = alpha / 255.0 if alpha > 1.0 else alpha

    @property
    def v(self) -> Floats:
        """Its velocity in the world, linear [m/s] and angular [rad/s], shape (6,); what a simulation moves it by."""
        return self._v

    @v.setter
    def v(self, v: Any) -> None:
        out = finite_array("v", v).reshape(-1)
        if out.shape != (6,):
            raise ShapeError("v", np.shape(v), "(6,): linear [m/s], then angular [rad/s]")
        self._v = out

    @property
    def base(self) -> Any:
        """An older name of the pose, as an SE3."""
        from spatialmath import SE3  # pyright: ignore[reportMissingImports]

        return SE3(self.T, check=False)

    @base.setter
    def base(self, pose: Any) -> None:
        self._pose = matrix_of(pose, "base")

    @property
    def collision(self) -> bool:
        """Whether it can be collided with."""
        return False

    def bounds(self, world: bool = False) -> Floats:
        """Least and largest x, y, z, shape (3, 2) [m], in its frame or in the world's.

        Raises:
            NotImplementedError: It has no extent.
        """
        points = self._box()
        if world:
            points = self._wT[:3, :3] @ points + self._wT[:3, 3:]
        return np.stack([points.min(axis=1), points.max(axis=1)], axis=1)

    def corners(self, world: bool = False) -> Floats:
        """The corners of the box with `bounds`, along the axes of its frame or of the world, shape (3, 8) [m]."""
        return box_corners(self.bounds(world))

    def extents(self, world: bool = False) -> Floats:
        """The edges of the box with `bounds`, shape (3,) [m]."""
        return np.ptp(self.bounds(world), axis=1)

    def _box(self) -> Floats:
        """Corners of a box around it, in its frame, shape (3, n)."""
        raise NotImplementedError(f"{type(self).__name__} has no box around it; solids and meshes have.")

    def copy(self) -> Self:
        """The same shape in the same place, attached to nothing, with nothing on it."""
        out = copy.copy(self)
        out._pose, out._parent, out._children = self._wT.copy(), None, []
        out._v = self._v.copy()
        return out

    def fk_dict(self) -> dict[str, Any]:
        """Its place in the world: "t" (3) [m] and "q", a quaternion x y z w."""
        return {
            "t": self._wT[:3, 3].tolist(),
            "q": np.asarray(matrix_to_quat_xyzw(self._wT[:3, :3])).tolist(),
        }

    def to_dict(self) -> dict[str, Any]:
        """What it is and where, in plain numbers."""
        r, g, b = (int(255 * c + 1e-9) for c in self._rgba[:3])
        sizes = {name: np.asarray(getattr(self, name)).tolist() for name in self.lengths}
        look = {"v": self._v.tolist(), "color": r << 16 | g << 8 | b, "opacity": self.opacity}
        return {"stype": self.stype, **self.fk_dict(), **look, **sizes}

    def __repr__(self) -> str:
        from spatialmath import SE3  # pyright: ignore[reportMissingImports]

        sizes = [f"{name}={np.asarray(getattr(self, name)).tolist()!r}" for name in self.lengths]
        look = [f"color=({', '.join(str(round(c, 3)) for c in self._rgba[:3])})"]
        look += [f"opacity={self.opacity:g}"] if self.opacity < 1.0 else []
        where = SE3(self.T, check=False).strline()
        return f"{type(self).__name__}({', '.join([*sizes, *look])}, pose={where!r})"


def box_corners(bounds: Floats) -> Floats:
    """The corners (3, 8) of a box from its least and largest x, y, z, (3, 2)."""
    return np.array(np.meshgrid(*bounds, indexing="ij")).reshape(3, 8)


def positive(name: str, value: Any, least: float = 0.0) -> float:
    """A finite number that is not too small.

    Args:
        name: Name of the argument, for messages.
        value: What was passed.
        least: Smallest value [-].

    Returns:
        The number, in the unit of `value` [-].

    Raises:
        InputError: It is none.
    """
    try:
        out = float(value)
    except (TypeError, ValueError):
        out = np.nan
    if not np.isfinite(out) or out < least:
        raise InputError(f"`{name}` is {value!r}; expected a number of at least {least:g}.")
    return out


class Length:
    """A size of a shape: a number of at least zero; setting it has the shape drawn anew."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, shape: Any, owner: type | None = None) -> Any:
        return self if shape is None else shape.__dict__[self._name]

    def __set__(self, shape: Any, value: Any) -> None:
        shape.__dict__[self._name] = positive(self._name, value)
        shape.changes = getattr(shape, "changes", 0) + 1
