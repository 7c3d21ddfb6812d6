"""The controls of an environment: put into the panel; their callbacks run in the thread of the script."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from swift._element import SwiftElement
from ulna.errors import InputError, UnknownName, ViewerError


class UnknownObject(UnknownName, KeyError, IndexError, ValueError):
    """There is nothing of that name or number; Swift raises one of these, which depends on what was passed."""

    __str__ = Exception.__str__  # that of KeyError prints the message in quotes


class Elements(dict[int, SwiftElement]):
    """Controls by their number, which may be text, as Swift's keys are."""

    def __missing__(self, key: Any) -> SwiftElement:
        if key in self:
            return self[_number(key)]
        raise UnknownObject("control", key, map(str, self))

    def __contains__(self, key: Any) -> bool:
        return super().__contains__(_number(key))

    def get(self, key: Any, default: Any = None) -> Any:
        """The control of that number, or `default` where there is none."""
        return super().get(_number(key), default)


def _number(key: Any) -> Any:
    """The number that a text says, else the key itself."""
    return int(key) if isinstance(key, str) and key.isdecimal() else key


def not_open_error() -> ViewerError:
    """What to raise where an environment is used that was not launched, or was closed."""
    return ViewerError("The environment is not open. Call env.launch() first.")


class Controls:
    """Controls in the order in which they were added.

    Args:
        panel: The panel of an `ulna.Viewer`; None where there is none yet.
    """

    def __init__(self, panel: Any) -> None:
        self.elements = Elements()
        """The controls, by their number."""
        self._panel, self._count = panel, 0
        self.named: dict[str, SwiftElement] = {}
        """Those with a name."""
        self.values: dict[str, Any] = {}
        """What named sliders and menus show, kept up to date."""
        self.events: deque[tuple[SwiftElement, Any]] = deque()
        """Changes that no step has handled yet."""
        self._immediate = threading.Event()

    def add(self, element: SwiftElement, name: str | None) -> None:
        """Put a control into the panel.

        Args:
            element: The control.
            name: Its name among the values that callbacks receive, or None.

        Raises:
            InputError: It is there already, or one of its name.
            ViewerError: There is no panel.
        """
        if self._panel is None:
            raise not_open_error()
        if element.shown:
            raise InputError(f"This {type(element).__name__} ({element.label!r}) is in the panel already.")
        if name in self.named:
            raise InputError(f"There is a control named {name!r} already.")
        element.show(self._panel, self._count, self._enqueue)
        self.elements[self._count] = element
        self._count += 1
        if name is not None:
            self.named[name] = element
            element.share(self.values, name)

    def remove(self, element: SwiftElement) -> None:
        """Take a control out of the panel; it can be added again.

        Raises:
            UnknownObject: It is not there.
        """
        if element.id is None or self.elements.get(element.id) is not element:
            present = (f"{number}: {type(e).__name__} {e.label!r}" for number, e in self.elements.items())
            raise UnknownObject(
                "control in the panel", f"{type(element).__name__} {element.label!r}", present
            )
        del self.elements[element.id]
        self.named = {name: e for name, e in self.named.items() if e is not element}
        element.share(None)
        element.remove()

    def clear(self) -> None:
        """Take all of them out; they can be added to another panel."""
        for element in list(self.elements.values()):
            self.remove(element)

    def handle(self, events: Mapping[Any, Any] | None = None) -> None:
        """Call the functions of changes in the page, and of `events`: values by the number of the control.

        Raises:
            UnknownObject: There is no control of that number.
        """
        if events:
            for number, value in events.items():
                self.elements[int(number)].choose(value)
        while self.events:
            element, value = self.events.popleft()
            if element.shown:
                element.choose(value)

    @contextmanager
    def handling_immediately(self) -> Iterator[None]:
        """While the script waits in this context, the thread that receives events of the page handles them."""
        self.handle()
        self._immediate.set()
        try:
            yield
        finally:
            self._immediate.clear()

    @property
    def waiting(self) -> int:
        """Number of changes that no step has handled yet."""
        return len(self.events)

    def _enqueue(self, element: SwiftElement, value: Any) -> None:
        if self._immediate.is_set():
            element.choose(value)
        else:
            self.events.append((element, value))
