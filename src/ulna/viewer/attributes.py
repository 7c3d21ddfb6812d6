"""Handles that are assigned to: a name they do not have is refused instead of kept where nobody looks."""

from __future__ import annotations

import abc
from collections.abc import Callable
from typing import Any, ClassVar

from ulna.errors import UnknownName


class FixedAttributes(abc.ABC):
    """Something whose properties with a setter can be assigned to, and nothing else."""

    __slots__ = ()
    _setters: ClassVar[dict[str, Callable[[Any, Any], None]]] = {}

    def __init_subclass__(cls) -> None:
        found = ((n, a) for c in reversed(cls.__mro__) for n, a in vars(c).items() if isinstance(a, property))
        cls._setters = {name: a.fset for name, a in found if a.fset is not None}

    def __setattr__(self, name: str, value: Any) -> None:
        setter = self._setters.get(name)
        if setter is not None:
            setter(self, value)
        elif name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            raise UnknownName(f"thing to assign of {self._title()}", name, self._setters)

    @abc.abstractmethod
    def _title(self) -> str:
        """What it is called in messages."""
