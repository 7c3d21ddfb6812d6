"""Named configurations of a model, as Pinocchio's map of strings and vectors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Self, final

import numpy as np

from pinocchio._containers.arguments import WrongShape, check_text
from pinocchio._containers.arrays import alike, numbers
from ulna.typing import Floats


@final
class Entry:
    """A name and its configuration: what iterating over a `StdMap_String_VectorXd` yields."""

    __slots__ = ("_data", "_key")

    def __init__(self, key: str, data: Floats) -> None:
        self._key, self._data = key, data

    def key(self) -> str:
        """The name."""
        return self._key

    def data(self) -> Floats:
        """The configuration, a live reference."""
        return self._data

    def __str__(self) -> str:
        return f"({self._key}, {self._data})"

    __repr__ = __str__


@final
class StdMap_String_VectorXd(dict[str, Floats]):
    """Configurations by their names; `keys()`, `values()` and `items()` are those of a dictionary.

    Iterating yields entries with `key()` and `data()`, as there, in the order of their names.
    """

    __hash__ = object.__hash__  # pyright: ignore[reportAssignmentType]

    def __iter__(self) -> Iterator[Any]:
        return iter([Entry(key, self[key]) for key in sorted(self.keys())])

    def _copied(self) -> StdMap_String_VectorXd:
        """A copy, with copies of the configurations."""
        out = StdMap_String_VectorXd.__new__(StdMap_String_VectorXd)
        for key, q in self.items():
            dict.__setitem__(out, key, q.copy())
        return out

    def __setitem__(self, key: str, value: Any) -> None:
        check_text(key, "key")
        q = numbers(value, key).copy()
        q = q.reshape(-1) if q.ndim == 2 and q.shape[1] == 1 else q
        if q.ndim != 1:
            raise WrongShape(key, q.shape, "(nq,)")
        super().__setitem__(key, q)

    def update(self, *others: Any, **named: Any) -> None:
        """Takes over the configurations of dictionaries.

        Args:
            *others: A dictionary of configurations, or pairs of names and configurations.
            **named: Configurations by their names.
        """
        for key, q in dict(*others, **named).items():
            self[key] = q

    def setdefault(self, key: str, default: Any = None) -> Floats:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The configuration of a name; what is given where there is none yet.

        Args:
            key: The name.
            default: The configuration (nq,).

        Returns:
            The configuration (nq,).
        """
        if key not in self:
            self[key] = default
        return self[key]

    def __ior__(self, others: Any) -> Self:  # pyright: ignore[reportIncompatibleMethodOverride]
        self.update(others)
        return self

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, dict):
            return NotImplemented
        return self.keys() == other.keys() and all(alike(q, other[key]) for key, q in self.items())

    def __ne__(self, other: object) -> bool:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray[Any, Any]:
        """What NumPy takes it for: the sequence of its entries, of numbers where there are none."""
        return np.array(list(self), dtype if dtype is not None or not self else object)
