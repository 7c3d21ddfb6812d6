"""Elementary transforms: rotations about and translations along an axis, by a constant or by a joint."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, ClassVar, Self

import numpy as np

from roboticstoolbox._common.poses import describe, matrix, to_planar, to_spatial
from ulna.errors import InputError
from ulna.formats.ets import ET as Transform
from ulna.spatial import SE3
from ulna.typing import Floats

_ROW = {"tx": 0, "ty": 1, "tz": 2, "Rx": 3, "Ry": 4, "Rz": 5, "R": 2}


class BaseET:
    """Base class of ET and ET2: an axis, and a constant or a joint."""

    _size = 4
    sequence_class: ClassVar[Any] = None
    """The class of products of such transforms; ETS and ETS2 set it, which are built on this module."""
    edits: ClassVar[int] = 0
    """How often any transform was made or changed; sequences compiled at an earlier count may be out of date."""

    def __setattr__(self, name: str, value: Any) -> None:
        BaseET.edits += 1
        super().__setattr__(name, value)

    def __init__(
        self,
        axis: str,
        eta: float | None = None,
        unit: str = "rad",
        jindex: int | None = None,
        flip: bool = False,
        qlim: Any = None,
        T: Floats | None = None,
        offset: float = 0.0,
    ) -> None:
        """The transform "Rx" to "tz" by `eta`, or of a joint if that is None; "SE3" and "SE2" by the pose `T`."""
        if unit not in ("rad", "deg"):
            raise InputError(f"`unit` is {unit!r}; expected 'rad' or 'deg'.")
        if hasattr(eta, "A") or isinstance(eta, str):
            raise InputError(f"ET.{axis}({eta!r}): expected an angle or a distance, or nothing for a joint.")
        self.axis = axis
        self.eta = math.radians(eta) if eta is not None and unit == "deg" and self.isrotation else eta
        self.jindex = jindex
        self.isflip = bool(flip)
        self.offset = offset
        self._T = T
        self._qlim = None if qlim is None else np.asarray(qlim, dtype=float)

    @property
    def kind(self) -> str:
        """The axis."""
        return self.axis

    @property
    def param(self) -> float | None:
        """The constant; None for a joint."""
        return self.eta

    @property
    def isjoint(self) -> bool:
        """Whether it moves."""
        return self.eta is None and self._T is None

    @property
    def isrotation(self) -> bool:
        """Whether it turns about an axis."""
        return self.axis[0] == "R"

    @property
    def istranslation(self) -> bool:
        """Whether it shifts along an axis."""
        return self.axis[0] == "t"

    @property
    def iselementary(self) -> bool:
        """Whether it is about one axis, not a whole pose."""
        return self._T is None

    @property
    def ax(self) -> str | None:
        """The letter of its axis."""
        return self.axis[1:] or "z" if self.iselementary else None

    @property
    def qlim(self) -> Floats | None:
        """Least and greatest joint coordinate, (2,)."""
        return self._qlim

    @qlim.setter
    def qlim(self, limits: Any) -> None:
        self._qlim = None if limits is None else np.asarray(limits, dtype=float)

    @property
    def s(self) -> Floats:
        """Which entry of a twist it moves, as a vector."""
        out = np.zeros(6 if self._size == 4 else 3, dtype=int)
        if self.iselementary:
            out[_ROW[self.axis]] = 1
        return out

    def A(self, q: float | None = None) -> Floats:
        """The matrix, for the joint coordinate `q` where it has one."""
        if self._T is not None:
            return self._T.copy()
        if not self.isjoint:
            return self._to_ulna().transform().matrix()
        symbol = hasattr(q, "free_symbols")
        value = (0.0 if q is None else q if symbol else float(q)) + self.offset
        return self._to_ulna().transform(value).matrix()

    @property
    def axis_func(self) -> Callable[[float], Floats] | None:
        """The matrix as a function of the angle or the distance; None for a whole pose."""
        if not self.iselementary:
            return None
        return lambda value: type(self)(self.axis, value).A()

    def inv(self) -> Self:
        """The inverse transform."""
        out = self._copy()
        if self._T is not None:
            out._T = np.linalg.inv(self._T)
        elif self.eta is not None:
            out.eta = -self.eta
        else:
            out.isflip = not self.isflip
        return out

    def __getattr__(self, name: str) -> Any:
        if name == "fknm":
            raise AttributeError(
                "`fknm` of a transform is the toolbox's compiled part; use A(q), or ETS.eval(q)."
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def _copy(self) -> Self:
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        return out

    def _to_ulna(self, joint: int | None = None) -> Transform:
        """The same transform in Ulna's terms, as joint number `joint`."""
        if self._T is not None:
            return Transform.se3(SE3.from_matrix(self._T))
        name = self.axis.lower() if len(self.axis) == 2 else "rz"
        if not self.isjoint:
            return Transform(name, float(self.eta))  # type: ignore[arg-type]
        limits = None if self._qlim is None else (float(self._qlim[0]), float(self._qlim[1]))
        return Transform(name, index=joint, flip=self.isflip, limits=limits)

    def __mul__(self, other: Any) -> Any:
        return self.sequence_class([self]) * other

    def __add__(self, other: Any) -> Any:
        return self * other

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BaseET) or type(self) is not type(other):
            return NotImplemented
        return repr(self) == repr(other)

    __hash__ = None  # type: ignore[assignment]

    def _text(self, q: str | None = None) -> str:
        if self._T is not None:
            return describe(self._T)
        if self.isjoint:
            shown = q if q is not None else "q" if self.jindex is None else f"q{self.jindex}"
            return f"{self.axis}({shown})"
        if self.isrotation:
            return f"{self.axis}({math.degrees(self.eta):.4g}°)"  # type: ignore[arg-type]
        return f"{self.axis}({self.eta:.4g})"

    def __str__(self) -> str:
        return self._text()

    def __repr__(self) -> str:
        parts = []
        if self._T is not None:
            parts.append(f"T={self._T!r}")
        if self.eta is not None:
            parts.append(f"param={self.eta}")
        if self.jindex is not None:
            parts.append(f"jindex={self.jindex}")
        if self.isflip:
            parts.append(f"flip={self.isflip}")
        if self._qlim is not None:
            parts.append(f"qlim={self._qlim!r}")
        return f"{type(self).__name__}.{self.axis}({', '.join(parts)})"


def _maker(axis: str) -> Any:
    def make(
        cls: Any, param: float | None = None, unit: str = "rad", *, eta: float | None = None, **joint: Any
    ) -> Any:
        value = eta if param is None else param
        if axis[0] == "t":
            return cls(axis, value, **joint)
        return cls(axis, value, unit, **joint)

    motion = f"A turn about {axis[1:] or 'z'}" if axis[0] == "R" else f"A shift along {axis[1]}"
    make.__doc__ = f"{motion} by a constant `param` (formerly `eta`), or by a joint (jindex, flip, qlim)."
    make.__name__ = axis
    return classmethod(make)


class ET(BaseET):
    """An elementary transform in space: ET.Rx to ET.Rz, ET.tx to ET.tz, or a constant pose ET.SE3."""

    Rx, Ry, Rz = _maker("Rx"), _maker("Ry"), _maker("Rz")
    tx, ty, tz = _maker("tx"), _maker("ty"), _maker("tz")

    @classmethod
    def SE3(cls, T: Any, **_: Any) -> ET:
        """A constant pose: an SE3 or a matrix (4, 4)."""
        return cls("SE3", T=matrix(T).copy())


class ET2(BaseET):
    """An elementary transform in the plane: ET2.R, ET2.tx, ET2.ty, or a constant pose ET2.SE2."""

    _size = 3

    R, tx, ty = _maker("R"), _maker("tx"), _maker("ty")

    @classmethod
    def SE2(cls, T: Any, **_: Any) -> ET2:
        """A constant pose: an SE2 or a matrix (3, 3)."""
        return cls("SE2", T=matrix(T, 3).copy())

    def A(self, q: float | None = None) -> Floats:
        """The matrix (3, 3), for the joint coordinate `q` where it has one."""
        if self._T is not None:
            return self._T.copy()
        return to_planar(super().A(q))

    def _to_ulna(self, joint: int | None = None) -> Transform:
        if self._T is None:
            return super()._to_ulna(joint)
        return Transform.se3(SE3.from_matrix(to_spatial(self._T)))
