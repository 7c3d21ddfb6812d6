"""Attributes that take values of one kind each: whatever else is assigned to them raises."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, ClassVar, NoReturn, Self, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, is_flag
from pinocchio._containers.arrays import NO_INDEX, StdVec, alike, index, numbers, real, vector
from ulna.errors import InputError, excerpt

AttributeKind = Callable[[Any, str, Any], Any]
"""What is stored, of an object, the name of its attribute, and a value that is assigned to it."""


@final
class ReadOnlyAttribute(InputError, AttributeError, TypeError):
    """An attribute that is computed, or kept by its object, was assigned to.

    Pinocchio raises an AttributeError, or, where it takes values of one type, a TypeError for others.
    """


class CheckedAttributes:
    """Objects whose attributes take values of one kind each, as `_kinds` says; those it does not name take any."""

    __slots__ = ()
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        inherited = [base.__dict__.get("_kinds", {}) for base in reversed(cls.__mro__)]
        cls._kinds = {name: kind for kinds in inherited for name, kind in kinds.items()}

    def __setattr__(self, name: str, value: Any) -> None:
        kind = self._kinds.get(name)
        if kind is computed and _holds(self, name, value):
            return
        object.__setattr__(self, name, value if kind is None else kind(self, name, value))

    def _with_same(self) -> Self:
        """A new object that holds the same values, without looking at them again."""
        out = object.__new__(type(self))
        vars(out).update(vars(self))
        return out

    def _keep(self, **values: Any) -> None:
        """Stores values of attributes as they are, also where users cannot assign to them."""
        store = object.__setattr__
        for name, value in values.items():
            store(self, name, value)


def _holds(target: CheckedAttributes, name: str, value: Any) -> bool:
    """Whether an attribute holds a value already."""
    try:
        return alike(getattr(target, name), value)
    except (ArithmeticError, AttributeError, TypeError, ValueError):  # it cannot be read now, or be compared
        return False


def refused(name: str, value: Any, expected: str) -> ArgumentError:
    """The error for a value that an attribute does not take.

    Args:
        name: Name of the attribute.
        value: What was assigned.
        expected: What it takes.

    Returns:
        The error to raise.
    """
    return ArgumentError(f"`{name}` is set to {excerpt(repr(value))}; expected {expected}.")


def read_only(target: Any, name: str, value: Any) -> NoReturn:
    """The kind of attributes that users read only.

    Args:
        target: The object.
        name: Name of the attribute.
        value: What was assigned.

    Raises:
        ReadOnlyAttribute: Always.
    """
    raise ReadOnlyAttribute(
        f"`{name}` of a {type(target).__name__} is set to {excerpt(repr(value))}; it can be read only."
    )


def computed(target: Any, name: str, value: Any) -> NoReturn:
    """The kind of attributes that are computed here, and stored in Pinocchio: what they hold may be assigned to them.

    Args:
        target: The object.
        name: Name of the attribute.
        value: What was assigned, which is not what it holds.

    Raises:
        ReadOnlyAttribute: Always.
    """
    read_only(target, name, value)


def text(target: Any, name: str, value: Any) -> str:
    """The kind of attributes that are a text.

    Args:
        target: The object, which is not looked at.
        name: Name of the attribute.
        value: What was assigned.

    Returns:
        The text.

    Raises:
        ArgumentError: It is none.
    """
    if isinstance(value, bytes):
        with suppress(UnicodeDecodeError):
            return value.decode()
    if not isinstance(value, str):
        raise refused(name, value, "a text")
    return value


def number(target: Any, name: str, value: Any) -> float:
    """The kind of attributes that are one real number.

    Args:
        target: The object, which is not looked at.
        name: Name of the attribute.
        value: What was assigned.

    Returns:
        The number [any].
    """
    return real(value, name)


def whole(target: Any, name: str, value: Any) -> int:
    """The kind of attributes that are a count, or an index.

    Args:
        target: The object, which is not looked at.
        name: Name of the attribute.
        value: What was assigned.

    Returns:
        The number.
    """
    return int(index(value, NO_INDEX + 1, f"`{name}`", "It is a whole number from 0."))


def flag(target: Any, name: str, value: Any) -> bool:
    """The kind of attributes that say yes or no.

    Args:
        target: The object, which is not looked at.
        name: Name of the attribute.
        value: What was assigned.

    Returns:
        Whether it says yes.

    Raises:
        ArgumentError: It says neither.
    """
    if not (is_flag(value) or isinstance(value, int)):
        raise refused(name, value, "True or False")
    return bool(value)


def entries(target: Any, name: str, value: Any) -> Any:
    """The kind of attributes that are an array: values are copied, and keep its shape.

    Args:
        target: The object.
        name: Name of the attribute.
        value: What was assigned.

    Returns:
        An array of its own.

    Raises:
        WrongShape: The value has another shape.
    """
    present = getattr(target, name, None)
    if present is None or present.ndim != 1:
        return np.array(numbers(value, name))
    return np.array(vector(value, present.size, name))


def one_of(cls: type | tuple[type, ...], expected: str = "") -> AttributeKind:
    """The kind of attributes that hold an object of a class; those that can be changed are copied.

    Args:
        cls: The class.
        expected: What a message says was expected.

    Returns:
        The kind.
    """
    wanted = expected or f"a pinocchio.{cls.__name__}"  # type: ignore[union-attr]

    def kind(target: Any, name: str, value: Any) -> Any:
        if not isinstance(value, cls):
            raise refused(name, value, wanted)
        if not hasattr(value, "_assign"):
            return value
        present = getattr(target, name, None)
        if present is None:
            return value.copy()
        if present is not value:
            present._assign(value)
        return present

    return kind


def list_of(entry: type | tuple[type, ...], expected: str, made: type[StdVec[Any]] = StdVec) -> AttributeKind:
    """The kind of attributes that are a list with entries of a class.

    Args:
        entry: The class of entries, or several.
        expected: What a message says was expected.
        made: The class of the list.

    Returns:
        The kind.
    """

    def kind(_: Any, name: str, value: Any) -> StdVec[Any]:
        return made(checked_list(name, value, entry, expected))

    return kind


def checked_list(name: str, value: Any, cls: type | tuple[type, ...], expected: str) -> list[Any]:
    """The entries of a list, which are of a class.

    Args:
        name: Name of the attribute.
        value: What was assigned.
        cls: The class, or several.
        expected: What a message says was expected.

    Returns:
        The entries.

    Raises:
        ArgumentError: It is no list, or an entry is of another class.
    """
    if not isinstance(value, (list, tuple)):
        raise refused(name, value, expected)
    found = list(value)
    wrong = [entry for entry in found if not isinstance(entry, cls)]
    if wrong:
        raise refused(name, wrong[0], expected)
    return found


def assigned_entries(cls: type, expected: str) -> AttributeKind:
    """The kind of attributes that are a list of live entries, each of which takes over one that is assigned.

    Args:
        cls: The class of the entries.
        expected: What a message says was expected.

    Returns:
        The kind.
    """

    def kind(target: Any, name: str, value: Any) -> StdVec[Any]:
        present = getattr(target, name)
        present[:] = checked_list(name, value, cls, expected)
        return present

    return kind
