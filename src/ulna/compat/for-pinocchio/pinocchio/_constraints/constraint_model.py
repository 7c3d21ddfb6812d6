"""What constraints of all kinds have in common, and the class that stands for any of them."""

from __future__ import annotations

from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints.frame_pair import ConstraintSelectionType
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec, index
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.errors import excerpt

__all__ = ["ConstraintData", "ConstraintModel"]


class _NamedAndCompared:
    """The name and the comparison of constraints and their data, by what they hold."""

    __slots__ = ()

    def shortname(self) -> str:
        """The name of its class."""
        return type(self).__name__

    @classmethod
    def classname(cls) -> str:
        """The name of its class."""
        return cls.__name__

    def extract(self) -> Any:
        """The object itself: it is of the class of its kind."""
        return self

    def _slot_values(self) -> list[Any]:
        names = [name for cls in type(self).__mro__ for name in getattr(cls, "__slots__", ())]
        return [getattr(self, name) for name in names]

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(_equal(a, b) for a, b in zip(self._slot_values(), other._slot_values(), strict=True))

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return f"{self.shortname()}\n"

    __repr__ = __str__


class AnyConstraint(_NamedAndCompared):
    """A constraint that has data made by `createData`."""

    __slots__ = ()
    _sides: ClassVar[int] = 0
    """For each row, how many half-lines its force belongs to a product of; 0 where it may be anything."""

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows it has."""
        raise NotImplementedError

    def symmetricConeResidualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows its forces have as members of symmetric cones: of boxes two a row, of all space none."""
        return self._sides * self.residualSize(sel)

    def _joints_of_row(self, row: int) -> tuple[int, ...]:
        """The joints whose motion a row is of."""
        raise NotImplementedError

    def getRowSparsityPattern(self, model: Model, data: Data, constraint_data: Any, row_id: int) -> Any:
        """Which velocities of the model may move a row.

        Args:
            row_id: Index of the row.

        Returns:
            True for those that may (nv,).
        """
        row = index(
            row_id, self.residualSize(), "row of the constraint", "residualSize() says how many there are."
        )
        pattern = np.zeros(model.nv, dtype=bool)
        for first in self._joints_of_row(row):
            joint = first
            while joint:
                start = model.joints[joint].idx_v
                pattern[start : start + model.joints[joint].nvExtended] = True
                joint = model.parents[joint]
        return pattern

    def getRowIndexes(self, model: Model, data: Data, constraint_data: Any, row_id: int) -> StdVec[int]:
        """The indices of the velocities that may move a row.

        Args:
            row_id: Index of the row.

        Returns:
            Indices.
        """
        pattern = self.getRowSparsityPattern(model, data, constraint_data, row_id)
        return StdVec(np.flatnonzero(pattern).tolist())


class AnyConstraintData(_NamedAndCompared):
    """The data of a constraint."""

    __slots__ = ()


class _Variant(type):
    """A class that every constraint, or its data, is an instance of."""

    def __instancecheck__(cls, instance: Any) -> bool:
        return isinstance(instance, cls._kinds)  # type: ignore[attr-defined]

    def __call__(cls, *positional: Any, **named: Any) -> Any:
        values = (*positional, *(named[name] for name in named if name in cls._names))  # type: ignore[attr-defined]
        if len(values) != len(positional) + len(named) or len(values) != 1 or not isinstance(values[0], cls):
            shown = ", ".join(excerpt(repr(value)) for value in values) or "nothing"
            raise ArgumentError(f"{cls.__name__} was given {shown}; expected one object: {cls.__doc__}")
        one = values[0]
        return one.copy() if hasattr(one, "copy") else one


@final
class ConstraintModel(metaclass=_Variant):
    """A constraint of any kind: ConstraintModel(PointAnchorConstraintModel(...)) is a copy of what it is given."""

    _kinds, _names = AnyConstraint, ("other",)

    @by_name("other")
    def __init__(self, other: Any) -> None:
        """Not called: what is made is a copy of `other`."""


@final
class ConstraintData(metaclass=_Variant):
    """The data of a constraint of any kind, as `constraint.createData()` returns it."""

    _kinds, _names = AnyConstraintData, ("constraint_data",)

    @by_name("constraint_data")
    def __init__(self, constraint_data: Any) -> None:
        """Not called: what is made is `constraint_data`."""


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    return bool(a == b)
