"""Lists that take notice of every change of theirs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from pinocchio._containers.arrays import StdVec

_List = TypeVar("_List", bound=type[StdVec[Any]])
_CHANGES = (
    *("append", "extend", "insert", "pop", "remove", "clear", "reverse", "sort"),
    *("__setitem__", "__delitem__", "__iadd__", "__imul__"),
)
"""The methods that change a list."""


def before_changes(notice: Callable[[Any], object], *left_out: str) -> Callable[[_List], _List]:
    """Decorates a class of lists, which scripts see as `StdVec`.

    Args:
        notice: A function of the list, called before each change.
        *left_out: Methods before which it is not called.

    Returns:
        The decorator.
    """

    def decorate(cls: _List) -> _List:
        for name in set(_CHANGES) - set(left_out):
            setattr(cls, name, _watched(getattr(cls, name), notice))
        cls.__name__ = "StdVec"
        return cls

    return decorate


def _watched(change: Any, notice: Callable[[Any], object]) -> Any:
    def method(self: Any, *args: Any, **options: Any) -> Any:
        notice(self)
        return change(self, *args, **options)

    method.__name__, method.__doc__ = change.__name__, change.__doc__
    return method
