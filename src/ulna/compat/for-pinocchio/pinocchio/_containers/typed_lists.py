"""Pinocchio's classes of lists, such as `StdVec_SE3`, whose entries are all of one kind."""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable
from functools import cache, partial
from typing import Any, ClassVar, Self

import numpy as np

from pinocchio._containers.arguments import (
    ArgumentError,
    SizeError,
    WrongShape,
    check_size,
    is_index,
    is_number,
)
from pinocchio._containers.arrays import StdVec, copied, copies, entries_of, is_float_array, numbers
from ulna.errors import excerpt

_SHAPES = {
    **dict.fromkeys(("StdVec_Vector3", "StdVec_Vec3s"), (3,)),
    "StdVec_Matrix6": (6, 6),
    "StdVec_Matrix6x": (6, None),
    "StdVec_MatrixXs": (None, None),
}
"""Sizes of arrays; None for any."""
_UNSIGNED = ("StdVec_Index",)
_new = list.__new__


class _ListClass(type):
    """The class of these classes: lists that belong to a model or a Data count as instances, too, by their entries."""

    _kind: Any

    def __instancecheck__(cls, instance: Any) -> bool:
        if isinstance(type(instance), _ListClass) or not isinstance(instance, StdVec):
            return type.__instancecheck__(cls, instance)
        return not instance or isinstance(list.__getitem__(instance, 0), cls._kind)


class TypedList(StdVec[Any], metaclass=_ListClass):
    """A list of entries of one kind, which are copied when they are put in.

    Args:
        *parts: Nothing; entries; or how many entries, and what each is a copy of.
        other: Entries.
        size: How many entries.
        value: What each is a copy of.
    """

    _kind: ClassVar[Any] = object
    _take: ClassVar[Any] = staticmethod(copy.copy)
    _shape: ClassVar[Any] = None
    """The shape of entries that are arrays of one shape."""
    _copies_itself: ClassVar[bool] = False
    """Whether entries have methods that make a copy, and that take over another entry."""
    _is_plain: ClassVar[bool] = False
    """Whether entries are numbers or texts."""

    def __init__(self, *parts: Any, other: Any = None, size: Any = None, value: Any = None) -> None:
        given = (*parts, *(part for part in (other, size, value) if part is not None))
        super().__init__()
        if len(given) == 2 and is_index(given[0]):
            count, entry = check_size(given[0], "size"), self._take(given[1])
            list.extend(self, self._copied([entry] * count))
        elif len(given) == 1:
            list.extend(self, self._all(given[0]))
        elif given:
            raise self._refused(given)

    def _all(self, entries: Any) -> list[Any]:
        """Copies of entries.

        Raises:
            ArgumentError: They are none of this kind, or no entries.
        """
        return [self._take(entry) for entry in entries_of(entries, type(self).__name__)]

    def _refused(self, given: Any) -> ArgumentError:
        return ArgumentError(
            f"{type(self).__name__} was given {excerpt(repr(given))}; expected entries in a list, or their number and "
            "one of them."
        )

    def _checked(self, entry: Any) -> Any:
        return self._take(entry)

    def append(self, entry: Any) -> None:
        """Adds a copy of an entry at the end."""
        usual = self._copies_itself and entry.__class__ is self._kind
        list.append(self, entry.copy() if usual else self._take(entry))

    def extend(self, entries: Any) -> None:
        """Adds copies of entries at the end."""
        list.extend(self, self._all(entries))

    def insert(self, place: Any, entry: Any) -> None:
        """Adds a copy of an entry.

        Args:
            place: Index of the entry that it stands before.
            entry: The entry.
        """
        super().insert(place, self._take(entry))

    def __setitem__(self, key: Any, value: Any) -> None:
        if self._copies_itself and value.__class__ is self._kind and key.__class__ is int:
            list.__getitem__(self, key)._assign(value)  # without a copy
            return
        if self._is_plain and key.__class__ is int:
            list.__setitem__(self, key, self._take(value))
            return
        if isinstance(key, slice):
            one = self._is_entry(value)
            first, end, step = key.indices(len(self))
            if one and first > end and step == 1:
                return  # as there
            list.__setitem__(self, key, self._all([value] if one else value))
            return
        if self._copies_itself and value.__class__ is self._kind:
            self[key]._assign(value)
            return
        usual = is_float_array(value) and value.shape == self._shape
        entry, own = value if usual else self._take(value), self[key]
        if isinstance(own, np.ndarray) and own.shape == entry.shape:
            own[...] = entry  # so that references to it see it
        else:
            super().__setitem__(key, entry)

    def _is_entry(self, value: Any) -> bool:
        """Whether a value is one entry, and no list of them."""
        if self._kind is bool and value is None:
            return True
        if self._kind in (float, int, bool):
            return isinstance(value, (float, int) if self._kind is float else int)
        if isinstance(self._kind, _ListClass):  # an entry can be given as a list of numbers
            return isinstance(value, self._kind) or (type(value) is list and all(map(is_index, value)))
        return isinstance(value, self._kind)

    def __contains__(self, entry: Any) -> bool:
        is_flag = self._kind is bool and (entry is None or is_index(entry))
        return super().__contains__(bool(entry) if is_flag else entry)

    def __iadd__(self, entries: Any) -> Self:  # pyright: ignore[reportIncompatibleMethodOverride]
        self.extend(entries)
        return self

    def __getitem__(self, key: Any) -> Any:
        if key.__class__ is not slice:
            return list.__getitem__(self, key)
        entries = list.__getitem__(self, key)
        return entries if self._kind is np.ndarray else self._copies(entries)

    def _copies(self, entries: list[Any]) -> Self:
        """A list of this kind, with copies of entries of another one."""
        made = _new(self.__class__)
        list.extend(made, self._copied(entries))
        return made

    def _copied(self, entries: list[Any]) -> list[Any]:
        """Copies of entries of this kind; numbers and texts themselves, which never change."""
        if self._copies_itself:
            return [entry.copy() for entry in entries]
        return entries if self._is_plain else copies(entries)

    def copy(self) -> Self:
        """A copy, with copies of the entries."""
        return self._copies(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return type(self)(copy.deepcopy(list(self), memo))

    def __reduce__(self) -> Any:
        return type(self), (list(self),)


@cache
def typed_list(name: str, kind: str) -> Any:
    """The class of lists of a name.

    Args:
        name: The name, such as "StdVec_SE3".
        kind: What its entries are: a class of the package by its name, float, int, bool, str, Floats, or Any.

    Returns:
        The class; `StdVec` itself where the kind is `Any`.
    """
    if kind == "Any":
        return StdVec
    members = _members(name, kind) | {
        "__module__": "pinocchio",
        "__qualname__": name,
        "__doc__": TypedList.__doc__,
    }
    return _ListClass(name, (TypedList,), members)


def _members(name: str, kind: str) -> dict[str, Any]:
    """The class of entries, and what makes one of what users pass."""
    if kind == "float":
        return {"_kind": float, "_take": staticmethod(partial(_number, name)), "_is_plain": True}
    if kind == "int":
        return {"_kind": int, "_take": staticmethod(partial(_whole, name)), "_is_plain": True}
    if kind == "bool":
        return {"_kind": bool, "_take": staticmethod(partial(_flag, name)), "_is_plain": True}
    if kind == "Floats":
        shape = None if None in _SHAPES[name] else _SHAPES[name]
        return {"_kind": np.ndarray, "_take": staticmethod(partial(_array, name)), "_shape": shape}
    cls = str if kind == "str" else getattr(sys.modules["pinocchio"], kind)
    make = cls if isinstance(cls, _ListClass) else None
    return {
        "_kind": cls,
        "_take": staticmethod(partial(_object, name, cls, make)),
        "_copies_itself": hasattr(cls, "copy") and hasattr(cls, "_assign"),
        "_is_plain": cls is str,
    }


def _wrong(name: str, entry: Any, expected: str) -> ArgumentError:
    return ArgumentError(f"{name} was given {excerpt(repr(entry))}; expected {expected}.")


def _number(name: str, entry: Any) -> float:
    if type(entry) is float:
        return entry
    if not is_number(entry):
        raise _wrong(name, entry, "a real number")
    return float(entry)


def _whole(name: str, entry: Any) -> int:
    if type(entry) is int and entry >= 0:
        return entry
    if not is_index(entry) and not isinstance(entry, bool):
        raise _wrong(name, entry, "a whole number")
    number = entry.__index__()
    if name in _UNSIGNED and number < 0:
        raise SizeError(f"{name} was given {number}; expected a whole number from 0.")
    return number


def _flag(name: str, entry: Any) -> bool:
    if not (entry is None or isinstance(entry, (bool, np.bool_)) or is_index(entry)):
        raise _wrong(name, entry, "True or False")
    return bool(entry)


def _array(name: str, entry: Any) -> Any:
    if is_float_array(entry) and entry.shape == _SHAPES[name]:
        return entry.copy("K")
    array, shape = np.array(numbers(entry, "entry"), dtype=float), _SHAPES[name]
    whole = (*array.shape, *([1] * (len(shape) - array.ndim)))  # a vector is one column
    fits = array.ndim > 0 and len(whole) == len(shape)
    if not fits or any(size not in (None, has) for size, has in zip(shape, whole, strict=True)):
        expected = ", ".join("n" if size is None else str(size) for size in shape)
        raise WrongShape("entry", array.shape, f"({expected})")
    return array


def _object(name: str, kind: type, make: Callable[[Any], Any] | None, entry: Any) -> Any:
    if not isinstance(entry, kind):
        if make is None or not isinstance(entry, list):
            raise _wrong(name, entry, f"a {kind.__name__}")
        return make(entry)
    return copied(entry)
