"""Arguments by the names that Pinocchio gives them, for functions that take them in one order or another."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

from ulna.errors import InputError

Result = TypeVar("Result")


def by_name(*orders: str) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Lets a function of positions be called by names, too.

    Args:
        orders: The names of each way to call it, in their order, `self` left out; those at the end may be left out.
    """
    ways = [order.split() for order in orders]

    def decorate(function: Callable[..., Result]) -> Callable[..., Result]:
        before = 1 if function.__code__.co_varnames[:1] == ("self",) else 0  # pyright: ignore

        @functools.wraps(function)
        def called(*parts: Any, **named: Any) -> Result:
            if not named:
                return function(*parts)
            count = len(parts) - before
            for way in ways:
                rest = way[count : count + len(named)]
                if len(rest) == len(named) and named.keys() == set(rest):
                    return function(*parts, *(named[name] for name in rest))
            raise InputError(
                f"{function.__qualname__} was given {count} arguments, and {', '.join(named)}; expected "
                + ", or ".join(f"({', '.join(way)})" for way in ways)
                + "."
            )

        called.orders = ways  # pyright: ignore
        return called

    return decorate
