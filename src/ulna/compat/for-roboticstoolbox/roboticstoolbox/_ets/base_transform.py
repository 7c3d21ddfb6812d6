"""The base class of elementary transforms: an axis, and a constant or a joint."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any, ClassVar, Self

import numpy as np

from roboticstoolbox._common.errors import WrongShape, WrongType
from roboticstoolbox._common.numbers import number, numbers
from roboticstoolbox._common.symbols import exact_entries, is_nothing, is_symbol
from roboticstoolbox._ets.joint_descriptor import current_name, parse_joint, shown_name
from roboticstoolbox._ets.transform_text import transform_repr, transform_text
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
        param: Any = None,
        axis_func: Callable[[Any], Any] | None = None,
        T: Floats | None = None,
        jindex: int | None = None,
        unit: str = "rad",
        flip: bool | None = None,
        qlim: Any = None,
        *,
        eta: Any = None,
        offset: Any = 0.0,
    ) -> None:
        """A transform.

        Args:
            axis: "Rx" to "tz"; "R" in the plane; "SE3" or "SE2" with a pose `T`.
            param: A constant [rad or m], number or symbol; the name of a joint such as "q2"; None for a joint.
            axis_func: The matrix as a function of the angle or the distance; that of `axis`.
            T: A constant pose, (4, 4) or (3, 3).
            jindex: Which joint coordinate it takes.
            unit: Of `param` and `offset`, "rad" or "deg".
            flip: Whether the joint coordinate counts backwards.
            qlim: Least and greatest joint coordinate, (2,).
            eta: The former name of `param`.
            offset: What is added to the joint coordinate [m, or in `unit`].

        Raises:
            InputError: An argument cannot be used.
        """
        self._kind, self._T, self._joint_name = axis, T, None
        param = current_name(param, eta)
        if isinstance(param, str):
            param, jindex, flip = self._named(param, jindex, flip)
        self._param = None
        in_degrees = axis[0] == "R" and unit.lower().startswith("deg")
        if param is not None:
            self._param = self._constant(
                math.radians(float(param)) if in_degrees and not is_symbol(param) else param
            )
        self._flip, self._jindex, self._offset = bool(flip), None, 0.0
        if jindex is not None:
            self.jindex = jindex
        self.qlim = qlim
        if axis_func is not None:
            self._check_axis_func(axis_func)
        if not is_nothing(offset, False):
            self.offset = math.radians(offset) if in_degrees and not is_symbol(offset) else offset

    def _named(self, name: str, jindex: int | None, flip: bool | None) -> tuple[Any, int | None, bool | None]:
        """A constant written as text, or the number and the direction that the name of a joint says."""
        try:
            return float(name), jindex, flip
        except ValueError:
            pass
        if jindex is not None or flip is not None:
            raise InputError(f"The name {name!r} says `jindex` and `flip` of the joint; leave these two out.")
        number, flipped = parse_joint(name)
        self._joint_name = shown_name(name)
        return None, number, flipped

    def _constant(self, value: Any) -> Any:
        if is_symbol(value):
            return value
        try:
            return float(value)
        except (TypeError, ValueError):
            raise WrongType(
                f"ET.{self._kind}({value!r}): expected an angle, a distance, a symbol or the name of a joint."
            ) from None

    def _check_axis_func(self, axis_func: Callable[[Any], Any]) -> None:
        expected = type(self)(self._kind).A(0.7)
        if np.shape(axis_func(0.7)) != expected.shape or not np.allclose(axis_func(0.7), expected):
            raise InputError(f"`axis_func` is not the motion of {self._kind!r}; leave it out.")

    @property
    def kind(self) -> str:
        """What it does: "Rx" to "tz", "R", "SE3" or "SE2"."""
        return self._kind

    @property
    def axis(self) -> str:
        """The former name of `kind`."""
        warnings.warn("ET.axis is the former name of ET.kind", DeprecationWarning, stacklevel=2)
        return self._kind

    @property
    def param(self) -> Any:
        """The constant [rad or m]; None for a joint. Setting it makes a constant of a joint."""
        return self._param

    @param.setter
    def param(self, value: Any) -> None:
        if not self.iselementary:
            raise WrongType(f"{self} is a whole pose, which has no `param`; make a new one by ET.SE3(T).")
        self._param = self._constant(value)

    @property
    def eta(self) -> Any:
        """The former name of `param`."""
        warnings.warn("ET.eta is the former name of ET.param", DeprecationWarning, stacklevel=2)
        return self._param

    @eta.setter
    def eta(self, value: Any) -> None:
        warnings.warn("ET.eta is the former name of ET.param", DeprecationWarning, stacklevel=2)
        self.param = value

    @property
    def offset(self) -> Any:
        """What is added to the joint coordinate, after its sign [rad or m]; a number or a symbol."""
        return self._offset

    @offset.setter
    def offset(self, value: Any) -> None:
        if not self.isjoint:
            raise WrongType(f"{self} is no joint, so it has no `offset`; set its `param`.")
        symbolic = is_symbol(value) and not is_nothing(value, self.isrotation)
        self._offset = value if symbolic else 0.0 if is_symbol(value) else float(value)

    @property
    def jindex(self) -> int | None:
        """Which joint coordinate it takes."""
        return self._jindex

    @jindex.setter
    def jindex(self, j: Any) -> None:
        if not isinstance(j, int | np.integer) or j < 0:
            raise InputError(f"`jindex` is {j!r}; expected an integer of 0 or more.")
        self._jindex = int(j)

    @property
    def qlim(self) -> Floats | None:
        """Least and greatest joint coordinate, (2,) [rad or m]."""
        return self._qlim

    @qlim.setter
    def qlim(self, limits: Any) -> None:
        values = None if limits is None else np.array(numbers("qlim", limits)).ravel()
        if values is not None and values.shape != (2,):
            raise WrongShape("qlim", np.shape(numbers("qlim", limits)), "(2,)")
        self._qlim = values

    @property
    def isflip(self) -> bool:
        """Whether the joint coordinate counts backwards."""
        return self._flip

    @property
    def isjoint(self) -> bool:
        """Whether it moves."""
        return self._param is None and self._T is None

    @property
    def isrotation(self) -> bool:
        """Whether it turns about an axis."""
        return self._kind[0] == "R"

    @property
    def istranslation(self) -> bool:
        """Whether it shifts along an axis."""
        return self._kind[0] == "t"

    @property
    def iselementary(self) -> bool:
        """Whether it is about one axis, not a whole pose."""
        return self._kind[0] != "S"

    @property
    def ax(self) -> str | None:
        """The letter of its axis; None for a whole pose, and for a turn in the plane."""
        return self._kind[1] if self.iselementary and len(self._kind) == 2 else None

    @property
    def s(self) -> Floats:
        """Which entry of a twist it moves, as a vector (6,), (3,) in the plane."""
        out = np.zeros(6 if self._size == 4 else 3, dtype=int)
        if self.iselementary:
            out[_ROW[self._kind]] = 1
        return out

    @property
    def _is_symbolic(self) -> bool:
        """Whether its constant, its offset or its pose holds symbols."""
        return any(map(is_symbol, (self._param, self._offset))) or getattr(
            self._T, "dtype", None
        ) == np.dtype(object)

    def A(self, q: Any = 0.0) -> Floats:
        """The matrix, (4, 4), or (3, 3) in the plane; for the joint coordinate `q` where it has one."""
        if self._T is not None:
            return self._T.copy()
        value = self._param
        if self.isjoint:
            value = q if is_symbol(q) else number("q", q)
            value = (-value if self._flip else value) + self._offset
        elif not is_symbol(value):
            return self._to_ulna().transform().matrix()
        A = Transform(self._name_in_ulna(), index=0).transform(value).matrix()
        return exact_entries(A) if A.dtype == object else A

    @property
    def axis_func(self) -> Callable[[Any], Floats] | None:
        """The matrix as a function of the angle or the distance; None for a whole pose."""
        return (lambda value: type(self)(self._kind).A(value)) if self.iselementary else None

    def inv(self) -> Self:
        """The inverse transform."""
        out = self._copy()
        if self._T is not None:
            out._T = np.linalg.inv(self._T)
        elif self._param is not None:
            out._param = -self._param
        else:
            out._flip, out._offset = not self._flip, -self._offset
        return out

    fknm = property(
        lambda self: self, doc="The handle of the Toolbox's compiled functions: the transform itself."
    )

    def _copy(self) -> Self:
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        return out

    def _name_in_ulna(self) -> str:
        return self._kind.lower() if len(self._kind) == 2 else "rz"

    def _to_ulna(self, joint: int | None = None) -> Transform:
        """The same transform in Ulna's terms, as joint number `joint`; without the offset of a joint."""
        if self._T is not None:
            return Transform.se3(SE3.from_matrix(self._T))
        name = self._name_in_ulna()
        if not self.isjoint:
            value: Any = self._param
            return Transform(name, float(value))
        limits = None if self._qlim is None else (float(self._qlim[0]), float(self._qlim[1]))
        return Transform(name, index=joint, flip=self.isflip, limits=limits)

    def _parts_in_ulna(self, joint: int | None = None) -> list[Transform]:
        """The same in Ulna's terms: a joint, after a constant where it has an offset."""
        shift = [Transform(self._name_in_ulna(), float(self._offset))] if self._offset != 0 else []
        return [*shift, self._to_ulna(joint)]

    def __mul__(self, other: Any) -> Any:
        return self.sequence_class([self]) * other

    def __add__(self, other: Any) -> Any:
        return self * other

    def __radd__(self, other: Any) -> Any:
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __eq__(self, other: object) -> bool:
        return repr(self) == repr(other)

    __hash__ = None  # type: ignore[assignment]

    def _text(self, q: str = "q") -> str:
        return transform_text(self, q)

    def __str__(self) -> str:
        return transform_text(self, "q" if self._jindex is None else f"q{self._jindex}")

    def __repr__(self) -> str:
        return transform_repr(self)
