"""Chains of elementary transforms as lists: composed, numbered, split, and brought into other forms."""

from __future__ import annotations

import math
from collections import UserList
from collections.abc import Iterable
from typing import Any, Self

import numpy as np

from roboticstoolbox._common.class_registry import registered_class
from roboticstoolbox._common.poses import matrix
from roboticstoolbox._ets.compiled_chain import Chain
from roboticstoolbox._ets.elementary_transform import ET, BaseET
from ulna.errors import UnknownName
from ulna.typing import Floats


class BaseETS(UserList):
    """Base class of ETS and ETS2: composition, numbering of joints, and changes of form."""

    _et: type[BaseET] = ET

    def __init__(self, arg: Any = None) -> None:
        """From nothing, a transform, a list of them, or another chain.

        Raises:
            ValueError: Some joints have a number and some have none.
        """
        super().__init__()
        transforms = [] if arg is None else [arg] if isinstance(arg, BaseET) else list(arg)
        for item in transforms:
            if not isinstance(item, self._et):
                raise TypeError(
                    f"{item!r} is no {self._et.__name__}, of which a {type(self).__name__} is made."
                )
        self.data = [et._copy() for et in transforms]
        joints = [et for et in self.data if et.isjoint]
        missing = [et.jindex is None for et in joints]
        if any(missing) and not all(missing):
            raise ValueError(
                "Some joints have a `jindex` and some have none; set it for all of them or for none."
            )
        if all(missing):
            for i, et in enumerate(joints):
                et.jindex = i

    @classmethod
    def _from_transforms(cls, transforms: Iterable[BaseET]) -> Self:
        out = cls()
        out.data = [et._copy() for et in transforms]
        return out

    def _numbered(self, other: Any) -> list[BaseET]:
        """Transforms to append: joints without a number take the next ones."""
        transforms = [other] if isinstance(other, BaseET) else list(other)
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
        if not isinstance(other, (self._et, type(self))):
            return NotImplemented
        return type(self)._from_transforms([*self.data, *self._numbered(other)])

    def __rmul__(self, other: Any) -> Any:
        return type(self)(other) * self

    def __add__(self, other: Any) -> Any:
        return self * other

    def __iadd__(self, other: Any) -> Any:
        return self * other

    def append(self, item: Any) -> None:
        """Adds a transform, or a chain, at the end."""
        self.data.extend(self._numbered(item))

    def extend(self, other: Any) -> None:
        """Adds the transforms of a chain at the end."""
        self.append(other)

    def insert(self, i: int, item: Any) -> None:
        """Puts a transform, or a chain, before the one at `i`."""
        self.data[i:i] = self._numbered(item)

    def __getitem__(self, i: Any) -> Any:
        return type(self)._from_transforms(self.data[i]) if isinstance(i, slice) else self.data[i]

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

    def plot(self, q: Any, *arguments: Any, **options: Any) -> Any:
        """Draws the chain as a robot; see `Robot.plot`."""
        return self._robot().plot(q, *arguments, **options)

    def teach(self, *arguments: Any, **options: Any) -> Any:
        """A slider for each joint beside the chain; see `Robot.teach`."""
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
        if method not in ("last", "first"):
            raise UnknownName("method of split", method, ("last", "first"))
        parts: list[list[BaseET]] = [[], []] if method == "last" else [[]]
        for et in self.data:
            if et.isjoint and method == "first":
                parts.append([])
            parts[-1].append(et)
            if et.isjoint and method == "last":
                parts.append([])
        if method == "first":
            parts.append([])
        return [type(self)._from_transforms(part) for part in parts]

    def fixjoint(self, j: int, value: float, unit: str = "rad") -> Self:
        """The chain with the joint of number `j` held at `value`."""
        out = []
        for et in self.data:
            if et.isjoint and et.jindex == j:
                held = math.radians(value) if unit == "deg" and et.isrotation else value
                out.append(self._et(et.axis, -held if et.isflip else held))
                continue
            out.append(et)
        return type(self)._from_transforms(out)

    def merge(self, i: int) -> None:
        """Makes one constant of those at `i` and `i + 1`, which must be along the same axis.

        Raises:
            ValueError: They are not constants of one kind.
        """
        a, b = self.data[i], self.data[i + 1]
        if a.axis != b.axis or a.isjoint or b.isjoint:
            raise ValueError(f"{a} and {b} are not constants of the same kind, so they cannot be merged.")
        one = self._constant(a.A() @ b.A()) if a._T is not None else self._et(a.axis, a.eta + b.eta)
        self.data[i : i + 2] = [one]

    def merged(self, i: int) -> Self:
        """A copy on which `merge` was called."""
        return self._modified_copy("merge", i)

    def swap(self, i: int) -> None:
        """Exchanges those at `i` and `i + 1`, which must commute: both along or about one axis, or both shifts.

        Raises:
            ValueError: They do not commute.
        """
        a, b = self.data[i], self.data[i + 1]
        commute = (
            a.iselementary and b.iselementary and (a.ax == b.ax or (a.istranslation and b.istranslation))
        )
        if not commute:
            raise ValueError(f"{a} and {b} do not commute, so they cannot be swapped.")
        self.data[i], self.data[i + 1] = b, a

    def swapped(self, i: int) -> Self:
        """A copy on which `swap` was called."""
        return self._modified_copy("swap", i)

    def _modified_copy(self, what: str, *arguments: Any) -> Self:
        out = type(self)._from_transforms(self.data)
        getattr(out, what)(*arguments)
        return out

    def to_text(self, joint: str | None = None) -> str:
        """The chain as text; `joint` is what joints are called, "q{0}" by number."""
        if not self.data:
            return f"SE{self._et._size - 1}()"
        form = joint or ("q" if self.n == 1 else "q{0}")
        shown = []
        for et in self.data:
            sign = "-" if et.isflip else ""
            shown.append(et._text(sign + form.format(et.jindex)) if et.isjoint else et._text())
        return " ⊕ ".join(shown)

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        return f"[{', '.join(map(repr, self.data))}]"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, BaseETS) and repr(self) == repr(other)

    __hash__ = None  # type: ignore[assignment]

    def _compiled(self, tool: Any) -> Chain:
        """The compiled chain; compiled again when a transform was changed."""
        cached = self.__dict__.get("_compiled_cache")
        if cached is None or cached[0] != BaseET.edits or cached[2] != self.data:
            key = [
                (et.axis, et.eta, et.jindex, et.isflip, et.offset, str(et.qlim), str(et._T))
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
            raise ValueError(f"The sliding joint {et} has no limits; set its `qlim`.")
        out.append((-math.pi, math.pi) if et.qlim is None else et.qlim)
    return np.array(out, dtype=float).reshape(-1, 2).T
