"""A read-only dictionary by name, whose misses offer the nearest name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Generic, TypeVar

import numpy as np

from ulna.errors import UnknownAttribute, UnknownName

V = TypeVar("V")


class Named(Mapping[str, V], Generic[V]):
    """Values by name, in order; arrays among them are read-only.

    Args:
        kind: What one value is called in messages, for example ``"configuration"``.
        items: The values.
    """

    __slots__ = ("_items", "_kind")

    def __init__(self, kind: str, items: Mapping[str, V]) -> None:
        self._kind = kind
        self._items: dict[str, V] = dict(items)
        for value in self._items.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __getitem__(self, name: str) -> V:
        try:
            return self._items[name]
        except KeyError:
            raise UnknownName(self._kind, name, self._items) from None

    def __getattr__(self, name: str) -> V:
        if not name.startswith("_") and name in self._items:
            raise UnknownAttribute(f"Mapping of each {self._kind}", name, (), f'Write ["{name}"].')
        raise AttributeError(f"A mapping of each {self._kind} has no attribute {name!r}.")

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __contains__(self, name: object) -> bool:
        return name in self._items

    def get(self, key: str, default: Any = None) -> Any:
        """The value of a name, or a default.

        Args:
            key: The name.
            default: What is returned where there is no such name.

        Returns:
            The value, or the default.
        """
        return self._items.get(key, default)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mapping):
            return NotImplemented
        if self.keys() != other.keys():
            return False
        return all(np.array_equal(np.asarray(self[k]), np.asarray(other[k])) for k in self)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return Named, (self._kind, self._items)

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name!r}: {value!r}" for name, value in self._items.items()) + "}"
