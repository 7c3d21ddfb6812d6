"""A base class whose instances refuse assignments that would have no effect."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError
from typing import Any, ClassVar

from ulna.errors import UnknownAttribute, excerpt, nearest


class FixedAttributes:
    """Assigning to a property with a setter works; any other public name raises.

    Other public attributes are annotated in the body of the class, or are slots; they are assigned once, by `__init__`.
    Classes that assign to private attributes in hot loops have slots instead, which cost nothing.
    """

    __slots__ = ()
    _setters: ClassVar[dict[str, Callable[[Any, Any], None]]] = {}
    _assigned_once: ClassVar[frozenset[str]] = frozenset()

    def __init_subclass__(cls) -> None:
        bodies = [vars(c) for c in reversed(cls.__mro__)]
        properties = {n: a for body in bodies for n, a in body.items() if isinstance(a, property)}
        cls._setters = {name: a.fset for name, a in properties.items() if a.fset is not None}
        declared = {
            n for body in bodies for part in ("__annotations__", "__slots__") for n in body.get(part, ())
        }
        cls._assigned_once = frozenset(n for n in declared if not n.startswith("_"))

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, value)
        elif (setter := self._setters.get(name)) is not None:
            setter(self, value)
        elif name in self._assigned_once and not _has(self, name):
            object.__setattr__(self, name, value)
        else:
            raise self._refusal(name)

    def _refusal(self, name: str) -> AttributeError:
        """The error for an assignment that would have no effect."""
        choices = sorted(self._setters)
        if _has(self, name):
            instead = f"Assign to one of: {', '.join(choices)}." if choices else "Make a new one."
            return FrozenInstanceError(
                f"`{excerpt(name)}` of {self._title()} cannot be assigned to. {instead}"
            )
        advice = (
            f"There are: {', '.join(choices)}." if choices else "Nothing can be assigned to; make a new one."
        )
        return UnknownAttribute(self._title(), name, choices, "" if nearest(name, choices) else advice)

    def _title(self) -> str:
        """What it is called in messages."""
        return type(self).__name__


def _has(instance: Any, name: str) -> bool:
    """Whether an instance has an attribute; a property is not asked for its value, which may raise."""
    if any(isinstance(vars(c).get(name), property) for c in type(instance).__mro__):
        return True
    try:
        object.__getattribute__(instance, name)
    except AttributeError:
        return False
    return True
