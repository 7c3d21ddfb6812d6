"""Which arguments of a user's function get arrays; the others keep their default values."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Container, Sequence
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError

_VARIADIC = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def parameters_of(f: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    """The arguments of a function that have names, in their order: all but `*args` and `**kwargs`.

    Raises:
        InputError: Python does not know them, as of some functions written in C.
    """
    try:
        parameters = inspect.signature(f).parameters
    except ValueError:
        raise InputError(
            f"Python does not know the arguments of {short_repr(f)}; expected a function written in Python, such as a "
            "lambda that calls it."
        ) from None
    return {name: p for name, p in parameters.items() if p.kind not in _VARIADIC}


def names_to_pass(f: Callable[..., Any], given: Container[str]) -> list[str]:
    """The arguments that have no default value, or are given, in their order.

    Args:
        f: The function.
        given: Names of arguments that are passed even if they have a default value.

    Returns:
        The names.
    """
    return [name for name, p in parameters_of(f).items() if name in given or p.default is p.empty]


def function_of(f: Callable[..., Any], names: Sequence[str]) -> Callable[..., Any]:
    """A function as one of some of its arguments; the others keep their default values.

    Args:
        f: The function.
        names: Names of its arguments.

    Returns:
        A function of the values of these arguments, in this order; `f` itself where these are its first ones.
    """
    signature = inspect.signature(f)
    first = list(signature.parameters.values())[: len(names)]
    if [p.name for p in first if p.kind is not p.KEYWORD_ONLY] == list(names):
        return f

    @functools.wraps(f)
    def function(*values: Any) -> Any:
        bound = inspect.BoundArguments(signature, dict(zip(names, values, strict=True)))  # type: ignore[arg-type]
        bound.apply_defaults()
        return f(*bound.args, **bound.kwargs)

    return function
