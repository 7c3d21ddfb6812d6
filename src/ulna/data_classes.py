"""Data classes as `dataclasses.dataclass` makes them, at a tenth of the time.

`dataclasses` writes up to six methods of each class as text and compiles them, 0.3 ms a class, which was a third of
`import ulna`. Here the fields are still those of `dataclasses` (`fields`, `replace`, `asdict` and `match` work), but
only `__init__` is written as text, when the class is first used; the other methods are closures. They behave in the
same way, errors and pickles included. `order`, `unsafe_hash` and `InitVar` are not supported.
"""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import MISSING
from operator import attrgetter
from typing import TYPE_CHECKING, Any


def _dataclass(
    cls: type | None = None,
    /,
    *,
    frozen: bool = False,
    init: bool = True,
    repr: bool = True,
    eq: bool = True,
    kw_only: bool = False,
    slots: bool = False,
) -> Any:
    """Makes a class a data class; the arguments are those of `dataclasses.dataclass`."""

    def make(cls: type) -> type:
        with _thawed(cls):
            made: Any = dataclasses.dataclass(
                cls, init=False, repr=False, eq=False, kw_only=kw_only, slots=slots
            )
        if slots and getattr(vars(made).get("__weakref__"), "__objclass__", made) is not made:
            del made.__weakref__  # before 3.11.3 that of the class without slots stays, and raises
        parameters = made.__dataclass_params__
        parameters.init, parameters.repr, parameters.eq, parameters.frozen = init, repr, eq, frozen
        attributes, fields = vars(made), dataclasses.fields(made)
        if init and "__init__" not in attributes:
            made.__init__ = _LaterInit(made)
        if repr and "__repr__" not in attributes:
            made.__repr__ = _repr([field.name for field in fields if field.repr])
        if eq:
            _compare(made, [field.name for field in fields if field.compare], frozen)
        if frozen:
            _freeze(made, [field.name for field in fields], slots)
        return made

    return make if cls is None else make(cls)


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = _dataclass


@contextmanager
def _thawed(cls: type) -> Iterator[None]:
    """While this lasts, bases count as data that changes; else `dataclasses` would write methods that refuse."""
    frozen = [p for base in cls.__mro__[1:] if (p := vars(base).get("__dataclass_params__")) and p.frozen]
    for parameters in frozen:
        parameters.frozen = False
    try:
        yield
    finally:
        for parameters in frozen:
            parameters.frozen = True


class _Factory:
    """Stands for a value that is made anew for each record."""

    def __repr__(self) -> str:
        return "<factory>"


class _LaterInit:
    """Stands for `__init__` until it is first looked up."""

    def __init__(self, cls: Any) -> None:
        self._class = cls

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        made = _init(self._class)
        self._class.__init__ = made
        return made.__get__(instance, owner)


def _init(cls: Any) -> Any:
    """`__init__`, from its text."""
    names: dict[str, Any] = {"_set": object.__setattr__, "_missing": _Factory()}
    fields = dataclasses.fields(cls)
    positional = [_argument(field, names) for field in fields if field.init and not field.kw_only]
    by_name = [_argument(field, names) for field in fields if field.init and field.kw_only]
    values = {field.name: _value(field, names) for field in fields}
    lines = [f"  _set(self, {name!r}, {value})" for name, value in values.items() if value]
    lines += ["  self.__post_init__()"] * hasattr(cls, "__post_init__")
    arguments = ", ".join(["self", *positional, *["*"] * bool(by_name), *by_name])
    text = "\n ".join([f" def __init__({arguments}):", *(lines or ["  pass"]), "return __init__"])
    made: dict[str, Any] = {}
    exec(f"def make({', '.join(names)}):\n{text}", {"__name__": cls.__module__}, made)
    init = made["make"](**names)
    init.__qualname__ = f"{cls.__qualname__}.__init__"
    init.__annotations__ = {field.name: field.type for field in fields if field.init} | {"return": None}
    return init


def _argument(field: dataclasses.Field[Any], names: dict[str, Any]) -> str:
    """A field among the arguments, with its default value."""
    if field.default_factory is not MISSING:
        names[f"_factory_{field.name}"] = field.default_factory
        return f"{field.name}=_missing"
    if field.default is MISSING:
        return field.name
    names[f"_default_{field.name}"] = field.default
    return f"{field.name}=_default_{field.name}"


def _value(field: dataclasses.Field[Any], names: dict[str, Any]) -> str:
    """The text of what a field is set to; empty where the class holds it."""
    made = f"_factory_{field.name}()"
    if field.default_factory is MISSING:
        return field.name if field.init else ""
    names[f"_factory_{field.name}"] = field.default_factory
    return f"{made} if {field.name} is _missing else {field.name}" if field.init else made


def _tuple_of(names: Sequence[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that returns the values of some fields."""
    if not names:
        return lambda record: ()
    get = attrgetter(*names)
    return get if len(names) > 1 else lambda record: (get(record),)


def _repr(names: Sequence[str]) -> Callable[[Any], str]:
    @reprlib.recursive_repr()
    def __repr__(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _compare(cls: Any, names: Sequence[str], frozen: bool) -> None:
    """Gives a class `__eq__` and `__hash__`, unless it has its own; data that changes has no hash."""
    values, attributes = _tuple_of(names), vars(cls)

    def __eq__(self: Any, other: Any) -> bool:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(values(self))

    has_hash = "__hash__" in attributes and not (
        attributes["__hash__"] is None and "__eq__" in attributes
    )  # None: set by Python
    if "__eq__" not in attributes:
        cls.__eq__ = __eq__
    if not has_hash:
        cls.__hash__ = __hash__ if frozen else None


def _freeze(cls: Any, names: Sequence[str], slots: bool) -> None:
    """Has instances of a class refuse assignments: of any name, and of fields where a class derives from it."""
    fixed, values, attributes = frozenset(names), _tuple_of(names), vars(cls)

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in fixed:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in fixed:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    def __getstate__(self: Any) -> list[Any]:
        return list(values(self))

    def __setstate__(self: Any, state: Sequence[Any]) -> None:
        for name, value in zip(names, state, strict=True):
            object.__setattr__(self, name, value)

    if "__setattr__" in attributes or "__delattr__" in attributes:
        raise TypeError(f"{cls.__qualname__} defines __setattr__ or __delattr__; frozen data classes cannot.")
    cls.__setattr__, cls.__delattr__ = __setattr__, __delattr__
    if slots and "__getstate__" not in attributes:  # else pickles of slots would be read by assignments
        cls.__getstate__, cls.__setstate__ = __getstate__, __setstate__
