"""Former names of arguments and attributes, which callers may still use."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])
C = TypeVar("C", bound=type)


def former_keywords(**names: str) -> Callable[[F], F]:
    """Has a function take keywords by their former names, too: `@former_keywords(words="text")`."""

    def decorate(function: F) -> F:
        @functools.wraps(function)
        def renamed(*args: Any, **keywords: Any) -> Any:
            for former in names.keys() & keywords.keys():
                if names[former] in keywords:
                    raise TypeError(
                        f"`{former}` is the former name of `{names[former]}`; expected one of them."
                    )
                keywords[names[former]] = keywords.pop(former)
            return function(*args, **keywords)

        return renamed  # type: ignore[return-value]

    return decorate


def former_fields(**names: str) -> Callable[[C], C]:
    """Has a dataclass take fields by their former names, too, and have attributes of these names."""

    def decorate(kind: C) -> C:
        kind.__init__ = former_keywords(**names)(kind.__init__)
        for former, name in names.items():
            setattr(kind, former, property(lambda self, name=name: getattr(self, name), doc=f"See `{name}`."))
        return kind

    return decorate
