"""Classes that lower modules make objects of and higher modules define; the package registers where they are found."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

_LOADERS: dict[str, Callable[[], Any]] = {}


def register_class(name: str, load: Callable[[], Any]) -> None:
    """Registers the function that returns a class; it is called when the class is needed first.

    Args:
        name: Name of the class.
        load: Returns the class.
    """
    _LOADERS[name] = load


def registered_class(name: str) -> Any:
    """The class that was registered by that name."""
    return _LOADERS[name]()
