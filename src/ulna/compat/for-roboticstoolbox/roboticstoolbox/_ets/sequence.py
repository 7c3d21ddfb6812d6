"""Chains of elementary transforms as lists: composed, numbered, split, and printed."""

from __future__ import annotations

import math
from collections.abc import Iterable, MutableSequence
from typing import Any, Self

import numpy as np

from roboticstoolbox._common.class_registry import registered_class
from roboticstoolbox._common.errors import UnknownOption, WrongShape, WrongType
from roboticstoolbox._common.poses import matrix
from roboticstoolbox._ets.base_transform import BaseET
from roboticstoolbox._ets.compiled_chain import Chain
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.rewriting import Rewriting
from roboticstoolbox.tools.data import rtb_get_param
from ulna.errors import InputError
from ulna.typing import Floats


class BaseETS(Rewriting, MutableSequence):
    """Base class of ETS and ETS2: composition, numbering of joints, and changes of form."""

    _et: type[BaseET] = ET

    def __init__(self, arg: Any = None) -> None:
        """From nothing, a transform, a chain, or a list of these.

        Joints without a number are numbered from 0, all of them, or the last one when the others are in order.

        Raises:
            WrongType: Something else than transforms is in it.
            InputError: Some joints have a number and some have none.
        """
        self.data: list[Any] = []
        self._auto_jindex = False
        for item in [] if arg is None else [arg] if isinstance(arg, BaseET) else self._items(arg):
            self.data.extend(et._copy() for et in (item.data if isinstance(item, BaseETS) else [item]))
        self._number_joints()

    def _items(self, arg: Any) -> list[Any]:
        items = list(arg) if isinstance(arg, list | tuple | BaseETS) or hasattr(arg, "__next__") else [arg]
        for item in items:
            if not isinstance(item, self._et | type(self)):
                raise WrongType(
                    f"{item!r} is no {self._et.__name__}, of which a {type(self).__name__} is made."
                )
        return items

    def _number_joints(self) -> None:
        joints = self.joints()
        numbers = [et.jindex for et in joints]
        count = len(joints)
        if count and numbers[-1] is None and numbers[:-1] == list(range(count - 1)):
            joints[-1].jindex = count - 1
        elif count and all(number is None for number in numbers):
            for i, et in enumerate(joints):
                et.jindex = i
        elif None in numbers:
            raise InputError(
                "Some joints have a `jindex` and some have none; set it for all of them or for none."
            )
        else:
            return
        self._auto_jindex = True

    @classmethod
    def _from_transforms(cls, transforms: Iterable[BaseET]) -> Self:
        """A chain of copies of transforms, whose joints keep their numbers."""
        out = cls()
        out.data = [et._copy() for et in transforms]
        return out

    def _numbered(self, other: Any) -> list[BaseET]:
        """Transforms to insert: joints without a number take the next ones."""
        transforms = [other] if isinstance(other, BaseET) or not hasattr(other, "__iter__") else list(other)
        for item in transforms:
            if not isinstance(item, self._et):
                raise WrongType(
                    f"{item!r} is no {self._et.__name__}, of which a {type(self).__name__} is made."
                )
        following = max((et.jindex for et in self.data if et.isjoint), default=-1) + 1
        out = []
        for et in transforms:
            copy = et._copy()
            if copy.isjoint and copy.jindex is None:
                copy.jindex, following = following, following + 1
            out.append(copy)
        return out

    def __mul__(self, other: Any) -> Any:
        if hasattr(other, "ets") and not isinstance(other, (BaseET, BaseETS)):
            other = other.ets
        return type(self)([self, other]) if isinstance(other, self._et | type(self)) else NotImplemented

    def __rmul__(self, other: Any) -> Any:
        return type(self)(other) * self

    def __add__(self, other: Any) -> Any:
        return self * other

    def __iadd__(self, other: Any) -> Any:
        return self * other

    def __radd__(self, other: Any) -> Any:
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def insert(self, index: int, value: Any) -> None:
        """Inserts a transform, or a chain, before the one at `index`.

        Args:
            index: Place of the transform that comes after it.
            value: The transform or chain.
        """
        self.data[index:index] = self._numbered(value)

    def __len__(self) -> int:
        return len(self.data)

    def __setitem__(self, i: Any, value: Any) -> None:
        if isinstance(i, slice):
            self.data[i] = self._numbered(value)
            return
        (new,), replaced = self._numbered([value]), self.data[i]
        if new.isjoint and getattr(value, "jindex", None) is None and replaced.isjoint:
            new.jindex = replaced.jindex
        self.data[i] = new

    def __delitem__(self, i: Any) -> None:
        del self.data[i]

    def __getitem__(self, i: Any) -> Any:
        return type(self)(self.data[i]) if isinstance(i, slice) else self.data[i]

    @property
    def n(self) -> int:
        """How many joints it has."""
        return sum(et.isjoint for et in self.data)

    @property
    def m(self) -> int:
        """How many transforms it has."""
        return len(self.data)

    @property
    def jindices(self) -> Floats:
        """Which joint coordinate each joint takes, (n,)."""
        return np.array([et.jindex for et in self.data if et.isjoint], dtype=int)

    @property
    def structure(self) -> str:
        """A letter for each joint: R turns, P slides."""
        return "".join("R" if et.isrotation else "P" for et in self.data if et.isjoint)

    def joints(self) -> list[BaseET]:
        """The transforms that move."""
        return [et for et in self.data if et.isjoint]

    def joint_idx(self) -> Floats:
        """Where in the chain the joints are."""
        return np.array([i for i, et in enumerate(self.data) if et.isjoint], dtype=int)

    def jindex_set(self) -> set[int]:
        """The numbers of its joints."""
        return {et.jindex for et in self.joints() if et.jindex is not None}

    @property
    def qlim(self) -> Floats:
        """Joint limits, (2, n); a turn without limits has -pi and pi.

        Raises:
            ValueError: A sliding joint has none.
        """
        return limits_of(self.joints())

    @qlim.setter
    def qlim(self, limits: Any) -> None:
        values = np.asarray(limits, dtype=float)
        values = values.reshape(2, 1) if values.shape == (2,) and self.n == 1 else values
        if values.shape != (2, self.n):
            raise WrongShape("qlim", values.shape, f"(2, {self.n})")
        for et, pair in zip(self.joints(), values.T, strict=True):
            et.qlim = pair

    def plot(self, q: Any, *arguments: Any, **options: Any) -> Any:
        """Draws the chain as a robot; see `Robot.plot`.

        Args:
            q: Joint coordinates (n,) or (m, n) [rad or m].
            *arguments: Other arguments of `Robot.plot`.
            **options: Keywords of `Robot.plot`.

        Returns:
            The figure or environment.
        """
        return self._robot().plot(q, *arguments, **options)

    def teach(self, *arguments: Any, **options: Any) -> Any:
        """A slider for each joint beside the chain; see `Robot.teach`.

        Args:
            *arguments: Arguments of `Robot.teach`.
            **options: Keywords of `Robot.teach`.

        Returns:
            The figure or environment.
        """
        return self._robot().teach(*arguments, **options)

    def _robot(self) -> Any:
        return registered_class("Robot" if self._et is ET else "Robot2")(self, name="ETS")

    def random_q(self, i: int = 1) -> Floats:
        """Random joint coordinates within the limits, (n,) or (i, n)."""
        low, high = self.qlim
        q = np.random.default_rng().uniform(low, high, (i, self.n))
        return q[0] if i == 1 else q

    def inv(self) -> Self:
        """The chain from the end to the start."""
        return type(self)._from_transforms(et.inv() for et in reversed(self.data))

    def compile(self) -> Self:
        """The chain with constants between joints made one."""
        out: list[BaseET] = []
        T = np.eye(self._et._size)
        any_constant = False
        for et in [*self.data, None]:
            if et is not None and not et.isjoint:
                T, any_constant = T @ et.A(), True
                continue
            if any_constant and not np.array_equal(T, np.eye(len(T))):
                out.append(self._constant(T))
            T, any_constant = np.eye(self._et._size), False
            if et is not None:
                out.append(et)
        return type(self)._from_transforms(out)

    def _constant(self, T: Floats) -> BaseET:
        return self._et("SE3" if self._et._size == 4 else "SE2", T=T)

    def split(self, method: str = "last") -> list[Self]:
        """What is before the parts, the parts that one joint each moves, and what is after them.

        A part ends with its joint ("last"; nothing is before the first), or begins with it ("first"; nothing is after
        the last).
        """
        kind = method.lower()
        if kind not in ("last", "first"):
            raise UnknownOption("method of split", method, ("last", "first", "dh", "mdh"))
        parts: list[list[BaseET]] = [[], []] if kind == "last" else [[]]
        for et in self.data:
            if et.isjoint and kind == "first":
                parts.append([])
            parts[-1].append(et)
            if et.isjoint and kind == "last":
                parts.append([])
        if kind == "first":
            parts.append([])
        return [type(self)(part) for part in parts]

    def __str__(self, q: str | None = None) -> str:
        """The chain as text; joints are called by `q`, where {0} is their number and {1} that from 1."""
        if not self.data:
            return "SE3()"
        form = q or ("q" if self.n == 1 else "q{0}")
        shown = []
        for et in self.data:
            name = form.format(et.jindex, (et.jindex or 0) + 1) if et.isjoint else ""
            shown.append(et._text(f"{'-' if et.isflip else ''}{name}"))
        return (" ⊕ " if rtb_get_param("unicode") else " * ").join(shown)

    def __repr__(self) -> str:
        return f"[{', '.join(map(repr, self.data))}]"

    def __eq__(self, other: object) -> bool:
        return repr(self) == repr(other) if isinstance(other, BaseETS) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def _compiled(self, tool: Any) -> Chain:
        """The compiled chain; compiled again when a transform was changed."""
        cached = self.__dict__.get("_compiled_cache")
        if cached is None or cached[0] != BaseET.edits or cached[2] != self.data:
            key = [
                (et.kind, et.param, et.jindex, et.isflip, et.offset, str(et.qlim), str(et._T))
                for et in self.data
            ]
            chain = cached[1] if cached is not None and cached[3] == key else Chain(self.data)
            cached = self.__dict__["_compiled_cache"] = (BaseET.edits, chain, list(self.data), key)
        chain = cached[1]
        return chain if tool is None else chain.with_tool(matrix(tool))

    def __deepcopy__(self, memo: Any) -> Self:
        return type(self)._from_transforms(self.data)


def limits_of(joints: Iterable[BaseET]) -> Floats:
    """Limits of joints, (2, n)."""
    out = []
    for et in joints:
        if et.qlim is None and not et.isrotation:
            raise InputError(f"The sliding joint {et} has no limits; set its `qlim`.")
        out.append((-math.pi, math.pi) if et.qlim is None else et.qlim)
    return np.array(out, dtype=float).reshape(-1, 2).T
