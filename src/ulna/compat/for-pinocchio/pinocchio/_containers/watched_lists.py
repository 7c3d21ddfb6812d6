"""Lists that take notice of every change of theirs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from pinocchio._containers.arrays import StdVec

_List = TypeVar("_List", bound=type[StdVec[Any]])
CHANGES = (
    *("append", "extend", "insert", "pop", "remove", "clear", "reverse", "sort"),
    *("__setitem__", "__delitem__", "__iadd__", "__imul__"),
)
"""The methods that change a list."""
READS = ("__reversed__", "__add__", "__mul__", "__rmul__", "__contains__", "index", "count")
"""Methods that read entries of a list, besides `__getitem__` and `__iter__`."""


def before_changes(notice: Callable[[Any], object], *left_out: str) -> Callable[[_List], _List]:
    """Decorates a class of lists, which scripts see as `StdVec`.

    Args:
        notice: A function of the list, called before each change.
        *left_out: Methods before which it is not called.

    Returns:
        The decorator.
    """

    def decorate(cls: _List) -> _List:
        watch(cls, notice, *(name for name in CHANGES if name not in left_out))
        cls.__name__ = "StdVec"
        return cls

    return decorate


def watch(lists: type[StdVec[Any]], notice: Callable[[Any], object], *names: str) -> None:
    """Has a function called before methods of a class of lists.

    Args:
        lists: The class.
        notice: A function of the list.
        *names: The names of the methods.
    """
    for name in names:
        setattr(lists, name, _watched(getattr(lists, name), notice))


def _watched(change: Any, notice: Callable[[Any], object]) -> Any:
    def method(self: Any, *args: Any, **options: Any) -> Any:
        notice(self)
        return change(self, *args, **options)

    method.__name__, method.__doc__ = change.__name__, change.__doc__
    return method
