"""A base class whose instances accept assignments to their properties only."""

from __future__ import annotations

import abc
from collections.abc import Callable
from typing import Any, ClassVar

from ulna.errors import UnknownName


class FixedAttributes(abc.ABC):
    """Assigning to a property with a setter works; any other public name raises `UnknownName`."""

    __slots__ = ()
    _setters: ClassVar[dict[str, Callable[[Any, Any], None]]] = {}

    def __init_subclass__(cls) -> None:
        properties = (
            (n, a) for c in reversed(cls.__mro__) for n, a in vars(c).items() if isinstance(a, property)
        )
        cls._setters = {name: a.fset for name, a in properties if a.fset is not None}

    def __setattr__(self, name: str, value: Any) -> None:
        setter = self._setters.get(name)
        if setter is not None:
            setter(self, value)
        elif name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            raise UnknownName(f"settable property of {self._title()}", name, self._setters)

    @abc.abstractmethod
    def _title(self) -> str:
        """What it is called in messages."""
