"""Named configurations of a model, as Pinocchio's map of strings and vectors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import numbers
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
        q = numbers(value, key).copy()
        super().__setitem__(key, q.reshape(-1) if q.ndim == 2 and q.shape[1] == 1 else q)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray[Any, Any]:
        """What NumPy takes it for: the sequence of its entries, of numbers where there are none."""
        return np.array(list(self), dtype if dtype is not None or not self else object)
