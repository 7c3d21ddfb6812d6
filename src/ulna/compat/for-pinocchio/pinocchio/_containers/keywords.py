"""Arguments as Pinocchio's overloads take them: by names that differ, and in orders that the types distinguish."""

from __future__ import annotations

import functools
import inspect
import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pinocchio._containers.arguments import (
    CONVERSIONS,
    OMITTED,
    ArgumentError,
    checked,
    is_flag,
    optional_parameters,
    written_in_cpp,
)

Result = TypeVar("Result")


def by_name(*orders: str) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Lets a function of positions be called by names, too.

    Args:
        orders: The names of each way to call it, in their order, `self` left out; those at the end may be left out.
    """
    ways = [order.split() for order in orders]

    def decorate(function: Callable[..., Result]) -> Callable[..., Result]:
        body = checked(function)
        before = 1 if function.__code__.co_varnames[:1] == ("self",) else 0  # pyright: ignore

        @functools.wraps(function)
        def general(*parts: Any, **named: Any) -> Result:
            if not named:
                return body(*parts)
            count = len(parts) - before
            for way in ways:
                rest = way[count : count + len(named)]
                if len(rest) == len(named) and named.keys() == set(rest):
                    return body(*parts, *(named[name] for name in rest))
            raise ArgumentError(
                f"{_title(function)} was given {count} arguments, and {', '.join(named)}; expected "
                + ", or ".join(f"({', '.join(way)})" for way in ways)
                + "."
            )

        called = _by_position(function, body, general)
        called.orders = ways
        called.arguments_checked = True
        return called

    return decorate


def _by_position(function: Any, body: Any, general: Any) -> Any:
    """The same as `general`, which takes any arguments, with a quick way for those given by position."""
    parameters = list(inspect.signature(function).parameters.values())
    if any(p.kind is not p.POSITIONAL_OR_KEYWORD for p in parameters):
        return general
    names = [p.name for p in parameters]
    needed = [p.name for p in parameters if p.default is p.empty]
    passed = [n if n in needed else f"{n}__default if {n} is absent__ else {n}" for n in names]
    missing = f" or {needed[-1]} is absent__" if needed else ""
    lines = f"""def {function.__name__}({"".join(f"{n}=absent__, " for n in names)}/, **named__):
    if named__{missing}:
        return general__(*[x for x in ({"".join(f"{n}, " for n in names)}) if x is not absent__], **named__)
    return body__({", ".join(passed)})"""
    scope: dict[str, Any] = {"absent__": object(), "general__": general, "body__": body}
    optional = optional_parameters(function)
    defaults = {p.name: OMITTED if p.name in optional else p.default for p in parameters}
    scope |= {f"{name}__default": x for name, x in defaults.items() if x is not inspect.Parameter.empty}
    exec(compile(lines, f"<positions of {function.__qualname__}>", "exec"), scope)
    return functools.update_wrapper(scope[function.__name__], function)


def reads_names(*orders: str) -> Callable[[Result], Result]:
    """Notes the names, in their order, of each way to call a function that reads them itself."""

    def decorate(function: Result) -> Result:
        function.orders = [order.split() for order in orders]  # type: ignore[attr-defined]
        return function

    return decorate


def the_one(function: str, named: Mapping[str, Any], names: Sequence[str]) -> Any:
    """The one argument, given by one of several names.

    Args:
        function: Name of the function, for messages.
        named: The keywords that were passed.
        names: The names that the argument may have.

    Returns:
        The argument.

    Raises:
        ArgumentError: There is none, there are several, or its name is another one.
    """
    if len(named) != 1 or not named.keys() <= set(names):
        passed = ", ".join(named) or "nothing"
        raise ArgumentError(f"{function} was given {passed}; expected one of {', '.join(names)}.")
    return next(iter(named.values()))


class Parameter(NamedTuple):
    """A parameter of an overload.

    Attributes:
        name: Its name.
        kind: The name of the class that its argument is of; empty for any.
        optional: Whether it may be left out.
        target: The parameter of the function that it is passed as.
    """

    name: str
    kind: str
    optional: bool
    target: str

    @classmethod
    def parse(cls, text: str) -> Parameter:
        """`name[:kind][?][>target]`."""
        text, _, target = text.partition(">")
        name, _, kind = text.rstrip("?").partition(":")
        return cls(name, kind, text.endswith("?"), target or name)

    def accepts(self, value: Any) -> bool:
        """Whether the overload may be meant where this argument is given here."""
        if self.kind == "bool":
            return is_flag(value)
        if self.kind == "int":
            return hasattr(value, "__index__") and not isinstance(value, (bool, np.bool_, np.ndarray))
        if self.kind == "matrix":
            return isinstance(value, (np.ndarray, list, tuple)) and np.ndim(value) == 2
        if self.kind == "list":
            return isinstance(value, (list, tuple))
        return not self.kind or any(cls.__name__ == self.kind for cls in type(value).__mro__)

    def __str__(self) -> str:
        text = f"{self.name}: {self.kind}" if self.kind else self.name
        return f"[{text}]" if self.optional else text


def overloads(*signatures: str) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Lets a function be called in several ways, of which the first that fits the arguments is taken.

    Its attribute `of_all_parameters` is the same function for calls with a value for every parameter, in their order,
    where those left out have their defaults, and the others may belong to another way.

    Args:
        signatures: The parameters of each way, as `Parameter.parse` reads them, `self` left out. The function itself
            takes all of them by name; what is None counts as left out, except in functions that Pinocchio has in C++.
    """
    ways = [[Parameter.parse(text) for text in signature.split()] for signature in signatures]

    def decorate(function: Callable[..., Result]) -> Callable[..., Result]:
        parameters = list(inspect.signature(function).parameters.values())
        method = parameters[0].name == "self"
        parameters = parameters[method:]
        resolution = _Resolution(function, parameters, ways)
        body, known = resolution.body, resolution.known

        @functools.wraps(function)
        def called(*args: Any, **named: Any) -> Result:
            parts = args[1:] if method else args
            if not named:
                picked = known.get(tuple(map(type, parts)))
                if picked is not None:
                    for place, dimensions in picked.dimensions:
                        if parts[place].ndim != dimensions:
                            break
                    else:
                        return body(*args[:method], *picked.values(parts + picked.defaults))
            return body(*args[:method], **resolution.chosen(parts, named))

        def of_all_parameters(*args: Any) -> Result:
            positional, named = _non_default(parameters, args[method:])
            return called(*args[:method], *positional, **named)

        called.orders = [[parameter.name for parameter in way] for way in ways]  # pyright: ignore
        called.arguments_checked = True  # pyright: ignore
        called.of_all_parameters = of_all_parameters  # pyright: ignore
        return called

    return decorate


def without_overloads(
    direct: Callable[..., Any],
) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Tries a function that takes the usual arguments by position first, and the decorated one where it does not apply.

    Args:
        direct: It answers NotImplemented, or raises LookupError, TypeError, ValueError or AttributeError, where its
            arguments are not exactly what it takes.

    Returns:
        The decorator.
    """

    def decorate(function: Callable[..., Result]) -> Callable[..., Result]:
        @functools.wraps(function)
        def called(*args: Any, **named: Any) -> Result:
            if not named:
                try:
                    result: Any = direct(*args)
                except (LookupError, TypeError, ValueError, AttributeError):
                    result = NotImplemented
                if result is not NotImplemented:
                    return result
            return function(*args, **named)

        return called

    return decorate


_MOST_TYPES = 64
"""How many combinations of types of arguments are known, for each function."""


def _types(parts: tuple[Any, ...]) -> tuple[type, ...]:
    return tuple(map(type, parts))


class _Chosen(NamedTuple):
    """A way to call a function that types of arguments have led to.

    Attributes:
        values: Picks a value for each parameter out of the arguments, followed by `defaults`.
        defaults: The defaults of parameters.
        dimensions: Places of arrays, and the number of dimensions that each must have.
    """

    values: Callable[[tuple[Any, ...]], tuple[Any, ...]]
    defaults: tuple[Any, ...]
    dimensions: tuple[tuple[int, int], ...]


class _Places:
    """The parameters of a function in their order, and their defaults."""

    def __init__(self, function: Any, parameters: list[inspect.Parameter]) -> None:
        self._names = [parameter.name for parameter in parameters]
        optional = optional_parameters(function)
        self._defaults = tuple(OMITTED if p.name in optional else p.default for p in parameters)
        code = function.__code__  # a wrapper may take fewer arguments by position than its signature says
        by_position = bool(code.co_flags & inspect.CO_VARARGS) or code.co_argcount >= len(parameters)
        self._in_order = by_position and all(p.kind is p.POSITIONAL_OR_KEYWORD for p in parameters)

    def picked(
        self, way: list[Parameter], chosen: dict[str, Any], parts: tuple[Any, ...], at_dimensions: list[int]
    ) -> _Chosen | None:
        """How other arguments of the same types are passed on; None where some are left out.

        Args:
            way: The parameters of the overload that was chosen.
            chosen: The arguments by name.
            parts: The arguments.
            at_dimensions: Positions where an overload distinguishes arrays by their number of dimensions.

        Returns:
            What is remembered of these types.
        """
        targets = [parameter.target for parameter in way[: len(parts)]]
        missing = [
            name
            for name, default in zip(self._names, self._defaults, strict=True)
            if default is inspect.Parameter.empty and name not in chosen
        ]
        if not self._in_order or missing or targets != list(chosen) or len(self._names) < 2:
            return None
        places = [
            targets.index(name) if name in chosen else len(parts) + k for k, name in enumerate(self._names)
        ]
        arrays = [k for k in at_dimensions if k < len(parts) and isinstance(parts[k], np.ndarray)]
        dimensions = tuple((k, parts[k].ndim) for k in arrays)
        return _Chosen(operator.itemgetter(*places), self._defaults, dimensions)


class _Resolution:
    """Finds the overload that arguments mean, once for all arguments of the same types where these decide.

    Attributes:
        body: The function, its arguments checked.
        known: For types of arguments, which parameters they are.
    """

    def __init__(
        self, function: Any, parameters: list[inspect.Parameter], ways: list[list[Parameter]]
    ) -> None:
        self.body = checked(function)
        self.known: dict[Any, _Chosen] = {}
        self._ways, self._title = ways, _title(function)
        self._places, self._none_counts = _Places(function, parameters), written_in_cpp(function)
        self._at_dimensions = sorted({k for way in ways for k, x in enumerate(way) if x.kind == "matrix"})

    def chosen(self, parts: tuple[Any, ...], named: dict[str, Any]) -> dict[str, Any]:
        """The arguments by the names of the function's parameters.

        Args:
            parts: The arguments by position.
            named: Those by name.

        Returns:
            All of them.

        Raises:
            ArgumentError: No overload takes them.
        """
        parts = tuple(map(CONVERSIONS["SE3"], parts))
        rest = named if self._none_counts else {name: x for name, x in named.items() if x is not None}
        for k, way in enumerate(self._ways):
            chosen = _fitting(way, parts, rest, self._none_counts)
            if chosen is not None:
                if not named and _decided_by_types(self._ways[: k + 1], parts):
                    picked = self._places.picked(way, chosen, parts, self._at_dimensions)
                    if picked is not None and (len(self.known) < _MOST_TYPES or _types(parts) in self.known):
                        self.known[_types(parts)] = picked
                return chosen
        raise ArgumentError(_no_overload(self._title, parts, rest, self._ways))


def _decided_by_types(ways: list[list[Parameter]], parts: tuple[Any, ...]) -> bool:
    """Whether other arguments of the same types, and arrays of the same dimensions, lead to the same overload."""
    by_value = {"matrix": (list, tuple), "bool": (int, np.integer)}
    return not any(
        isinstance(part, by_value.get(parameter.kind, ())) and not isinstance(part, bool)
        for way in ways
        for parameter, part in zip(way, parts, strict=False)
    )


def general_case(function: Callable[..., Result]) -> Callable[..., Result]:
    """A function for calls with a value for every parameter, its arguments checked."""
    return getattr(function, "of_all_parameters", None) or checked(function)


def with_names(function: Callable[..., Result]) -> Callable[..., Result]:
    """A function of positions alone, taking its arguments by name; those left out have their defaults."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def called(**named: Any) -> Result:
        bound = signature.bind(**named)
        bound.apply_defaults()
        return function(*bound.args)

    return called


def _non_default(
    parameters: list[inspect.Parameter], values: tuple[Any, ...]
) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """The values that differ from their defaults: by position up to the first that does not, then by name."""
    differs_from_default = [
        x is not OMITTED and (x is not p.default or x is None)
        for p, x in zip(parameters, values, strict=False)
    ]
    count = differs_from_default.index(False) if False in differs_from_default else len(values)
    rest = zip(parameters[count:], values[count:], differs_from_default[count:], strict=False)
    return values[:count], {p.name: x for p, x, differs in rest if differs}


def _fitting(
    way: list[Parameter], parts: tuple[Any, ...], named: dict[str, Any], none_counts: bool
) -> dict[str, Any] | None:
    """The arguments by the names of the function's parameters, or None where the overload does not take them.

    Args:
        way: The parameters of the overload.
        parts: The arguments without names.
        named: Those with names.
        none_counts: Whether None is an argument as any other; else it stands for one that was left out.

    Returns:
        The arguments.
    """
    places = {parameter.name for parameter in way[: len(parts)]}
    names = {parameter.name for parameter in way[len(parts) :]}
    if len(parts) > len(way) or named.keys() - names or places & named.keys():
        return None
    chosen: dict[str, Any] = {}
    for k, parameter in enumerate(way):
        if k >= len(parts) and parameter.name not in named and parameter.optional:
            continue
        value = parts[k] if k < len(parts) else named.get(parameter.name)
        if value is None and parameter.optional and not none_counts:
            continue
        if (value is None and parameter.kind != "bool") or not parameter.accepts(value):
            return None
        chosen[parameter.target] = value
    return chosen


def _no_overload(
    name: str, parts: tuple[Any, ...], named: dict[str, Any], ways: list[list[Parameter]]
) -> str:
    kinds = [type(x).__name__ for x in parts]
    kinds += [f"{key}={type(x).__name__}" for key, x in named.items()]
    expected = " or ".join(f"{name}({', '.join(map(str, way))})" for way in ways)
    return f"{name} was given ({', '.join(kinds)}); expected {expected}."


def _title(function: Callable[..., Any]) -> str:
    """The name of a function, that of its class for a constructor."""
    return function.__qualname__.removesuffix(".__init__")
