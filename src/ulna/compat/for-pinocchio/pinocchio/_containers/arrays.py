"""Shapes of arguments, printing of matrices, and lists whose entries are views: what all parts of the package share."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any, Generic, TypeVar

import numpy as np

from pinocchio._containers.arguments import (
    ArgumentError,
    IndexOutOfRange,
    NoSequence,
    WrongShape,
    check_size,
    is_index,
    is_number,
)
from pinocchio._containers.unknown_ids import known
from ulna.checks.arrays import real_array
from ulna.errors import excerpt
from ulna.typing import Floats

Item = TypeVar("Item")
AnyArray = TypeVar("AnyArray", bound="np.ndarray[Any, Any]")
_FLOAT = np.dtype(np.float64)
NO_INDEX = 2**64 - 1
"""What stands for the index of nothing, as in Pinocchio."""


def not_applicable(*_: Any) -> Any:
    """Stands where no kernel is bound yet, and is what a bound kernel calls for arguments that it does not take."""
    return NotImplemented


def is_float_array(value: Any) -> bool:
    """Whether a value is an array of floats that is no matrix of NumPy, and of no other class."""
    return type(value) is np.ndarray and value.dtype == _FLOAT


def vector(value: Any, size: int, name: str) -> Floats:
    """A vector: arrays of any number type, columns, `np.matrix`, lists and tuples are taken.

    Args:
        value: What was passed.
        size: Number of entries.
        name: Name of the argument, for messages.

    Returns:
        Array (size,).

    Raises:
        WrongShape: it has another size.
        InputError: it holds no numbers.
    """
    if is_float_array(value) and value.shape == (size,):
        return value
    array = numbers(value, name)
    if array.shape not in ((size,), (size, 1)) and not (isinstance(value, np.matrix) and array.size == size):
        raise WrongShape(name, array.shape, f"({size},)")
    return np.asarray(array).reshape(size)


def exact(value: Any, size: int, name: str) -> Floats:
    """A vector that compiled code can read: contiguous and aligned.

    Args:
        value: What was passed.
        size: Number of entries.
        name: Name of the argument, for messages.

    Returns:
        Array (size,).
    """
    return np.require(vector(value, size, name), float, ["C", "A"])


def matrix(value: Any, shape: tuple[int, ...], name: str) -> Floats:
    """An array of a given shape.

    Args:
        value: What was passed.
        shape: The shape.
        name: Name of the argument, for messages.

    Returns:
        Array (...) of that shape.

    Raises:
        WrongShape: it has another one.
        InputError: it holds no numbers.
    """
    array = numbers(value, name)
    if array.shape != shape:
        raise WrongShape(name, array.shape, str(shape))
    return array


def is_empty(value: Any) -> bool:
    """Whether a value is an array (0,), whose product with an object NumPy makes entry by entry: it is empty."""
    return isinstance(value, np.ndarray) and value.shape == (0,)


def rows_of(value: Any, rows: int, name: str) -> Floats:
    """A vector, or a matrix, of so many rows.

    Args:
        value: What was passed.
        rows: Number of rows.
        name: Name of the argument, for messages.

    Returns:
        Array (rows,) or (rows, k).

    Raises:
        WrongShape: it has another shape.
        DtypeError: it holds no real numbers.
    """
    array = numbers(value, name)
    if array.ndim not in (1, 2) or array.shape[0] != rows:
        raise WrongShape(name, array.shape, f"({rows},) or ({rows}, k)")
    return array


def numbers(value: Any, name: str) -> Floats:
    """An array of floats.

    Args:
        value: What was passed.
        name: Name of the argument, for messages.

    Returns:
        Array (...).

    Raises:
        ArgumentError: it is an object of the package that is no list.
        DtypeError: it holds complex numbers, texts, None, or other things that are no real numbers.
    """
    if type(value).__module__.startswith("pinocchio.") and not isinstance(value, list):
        raise ArgumentError(f"`{name}` is {excerpt(repr(value))}; expected an array of real numbers.")
    return real_array(name, value)


def real(value: Any, name: str) -> float:
    """An argument as one real number.

    Args:
        value: What was passed.
        name: Name of the argument, for messages.

    Returns:
        The number [any].

    Raises:
        ArgumentError: It is none.
    """
    if not is_number(value):
        raise ArgumentError(f"`{name}` is {excerpt(repr(value))}; expected a real number.")
    return float(value)


def index(value: Any, count: int, what: str, fix: str) -> int:
    """An index below a count.

    Args:
        value: What was passed.
        count: The count.
        what: What it is the index of, for messages.
        fix: Advice for messages.

    Returns:
        The index.

    Raises:
        ArgumentError: it is no whole number.
        IndexOutOfRange: it is one that has no entry; says what would be.
    """
    if type(value) is int and 0 <= value < count:
        return value
    if not is_index(value):
        raise ArgumentError(f"The {what} is given as {excerpt(repr(value))}; expected an index. {fix}")
    number = known(value).__index__()
    if not 0 <= number < count:
        there = f"expected 0 to {count - 1}" if count else "there are none"
        raise IndexOutOfRange(f"There is no {what} {value!r}; {there}. {fix}")
    return number


def text(array: Floats) -> str:
    """A matrix or a row as text: six significant digits, all entries equally wide."""
    entries = array.tolist()
    rows = entries if array.ndim == 2 else [entries]
    texts = [[f"{x:.6g}" for x in row] for row in rows]
    width = max([len(text_) for row in texts for text_ in row], default=0)
    return "\n".join([" ".join([text_.rjust(width) for text_ in row]) for row in texts])


def fixed(array: AnyArray) -> AnyArray:
    """A view of an array that is computed when it is read: entries cannot be assigned to, which would have no effect.

    Args:
        array: The array (...).

    Returns:
        The view.
    """
    view = array.view()
    view.flags.writeable = False
    return view


def alike(one: Any, other: Any) -> bool:
    """Whether two values are equal, of lists whether their entries are.

    Args:
        one: A value.
        other: Another one.

    Returns:
        Whether they are.
    """
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return isinstance(other, type(one)) and np.array_equal(one, other)
    return one is other or bool(one == other)


def _of_one_kind(first: Any, entry: Any) -> bool:
    """Whether an entry is of the kind of another one."""
    if isinstance(first, bool):
        return isinstance(entry, (bool, np.bool_)) or is_index(entry)
    if isinstance(first, int):
        return is_index(entry) or isinstance(entry, bool)
    if isinstance(first, float):
        return is_number(entry)
    kinds = type(first).__mro__[:-1]
    return isinstance(entry, kinds[:2])


_entry_at = list.__getitem__


def copied(entry: Any) -> Any:
    """A copy of an entry, by its own method where it has one: `copy.copy` takes some 1 us to find it."""
    return entry.copy() if hasattr(entry, "copy") else copy.copy(entry)


def copies(entries: Iterable[Any]) -> list[Any]:
    """A list of copies of entries."""
    try:
        return [entry.copy() for entry in entries]
    except AttributeError:  # some have no such method
        return [copied(entry) for entry in entries]


class StdVec(list[Item], Generic[Item]):
    """A list; what is assigned to an entry is copied into it, so that references to the entry see it.

    Slices are new lists, with copies of the entries. It has all functions of lists. As in Pinocchio, a list is equal to
    itself alone: compare `list(a) == list(b)`.

    Args:
        *parts: Nothing; entries; or how many entries, and what each is a copy of.
    """

    def __init__(self, *parts: Any) -> None:
        if len(parts) == 2 and is_index(parts[0]):
            check_size(parts[0], "size")
            super().__init__(copies([parts[1]] * int(parts[0])))
        else:
            try:
                super().__init__(*parts)
            except TypeError:
                raise ArgumentError(
                    f"A list was given {excerpt(repr(parts))}; expected its entries, or their number and one of them."
                ) from None

    def copy(self) -> StdVec[Item]:
        """A copy, with copies of the entries."""
        return self._like(copies(self))

    def _like(self, entries: list[Any]) -> StdVec[Item]:
        """A list of this kind of these entries, which it takes."""
        return type(self)(entries)

    __copy__ = copy

    def __getitem__(self, key: Any) -> Any:
        if key.__class__ is slice:
            return self._part(_entry_at(self, key))
        return _entry_at(self, key)

    def _part(self, entries: list[Any]) -> list[Item]:
        """Copies of some entries; arrays themselves, as in Pinocchio."""
        if entries and isinstance(entries[0], np.ndarray):
            return entries
        if entries and type(entries[0]) in (int, float, str, bool):
            return self._like(entries)
        return self._like(copies(entries))

    def __setitem__(self, key: Any, value: Any) -> None:
        if isinstance(key, slice):
            first, end, step = key.indices(len(self))
            places = range(first, end, step)
            one = bool(self) and _of_one_kind(_entry_at(self, 0), value)
            if one and first > end and step == 1:
                return  # as there
            entries = [value] if one else entries_of(value, "A list")
            if len(entries) != len(places):
                raise ArgumentError(
                    f"A list was given {excerpt(repr(value))}; expected {len(places)} entries."
                )
            for place, entry in zip(places, entries, strict=True):
                self[place] = entry
            return
        own: Any = self[key]
        if hasattr(own, "_assign"):
            own._assign(value)
        else:
            self._replace(key, self._checked(value))

    def _replace(self, key: Any, entry: Any) -> None:
        """Puts an entry, a new copy, in place of another one."""
        super().__setitem__(key, entry)

    def __contains__(self, entry: Any) -> bool:
        if isinstance(entry, (np.ndarray, list)) or (self and isinstance(_entry_at(self, 0), np.ndarray)):
            return any(alike(own, entry) for own in self)
        return super().__contains__(entry)

    def __eq__(self, other: object) -> bool:
        return self is other if isinstance(other, list) else NotImplemented

    def __ne__(self, other: object) -> bool:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    __hash__ = object.__hash__  # pyright: ignore[reportAssignmentType]

    def append(self, entry: Any) -> None:
        """Adds a copy of an entry at the end."""
        super().append(self._checked(entry))

    def extend(self, entries: Any) -> None:
        """Adds copies of entries at the end."""
        super().extend([self._checked(entry) for entry in entries_of(entries, "A list")])

    def _checked(self, entry: Any) -> Any:
        """A copy of a new entry, which is of the kind of the others.

        Raises:
            ArgumentError: It is of another kind.
        """
        if self and not _of_one_kind(_entry_at(self, 0), entry):
            kind = type(_entry_at(self, 0)).__name__
            raise ArgumentError(
                f"A list of {kind} was given {excerpt(repr(entry))}; expected another {kind}."
            )
        return copied(entry)

    def reserve(self, new_cap: int) -> None:
        """Nothing: lists grow by themselves.

        Args:
            new_cap: For how many entries there should be room; 0 to 2^32.
        """
        check_size(new_cap, "new_cap", 2**32)

    def id(self) -> int:
        """The identity of the list as a number."""
        return id(self)

    def tolist(self, deep_copy: bool = False) -> list[Item]:
        """A plain list.

        Args:
            deep_copy: Whether of copies of the entries.

        Returns:
            The list.
        """
        return [copied(entry) for entry in self] if deep_copy else list(self)


class ArrayRows(StdVec[Any]):
    """The rows of an array: what is assigned to an entry is written into the array."""

    def _replace(self, key: Any, entry: Any) -> None:
        row = _entry_at(self, key)
        if isinstance(row, np.ndarray):
            row[...] = (
                vector(entry, row.size, "entry") if row.ndim == 1 else matrix(entry, row.shape, "entry")
            )
        else:
            super()._replace(key, entry)

    def _like(self, entries: list[Any]) -> StdVec[Any]:
        return StdVec(entries)


ArrayRows.__name__ = "StdVec"  # as scripts see it


def entries_of(value: Any, name: str) -> list[Any]:
    """The entries of a sequence.

    Args:
        value: What was passed.
        name: What it was passed to, for messages.

    Returns:
        The entries.

    Raises:
        NoSequence: It has none.
    """
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        raise NoSequence(f"{name} was given {excerpt(repr(value))}; expected its entries in a list.")
    return list(value)


def views(cls: Any, block: Floats) -> StdVec[Any]:
    """One object of `cls` for each row of an array, its storage being that row."""
    return StdVec(cls._of(row) for row in block)
