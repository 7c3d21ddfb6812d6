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

    def __missing__(self, number: Any) -> SwiftElement:
        if isinstance(number, str) and number.isdecimal() and int(number) in self:
            return self[int(number)]
        raise UnknownObject("control", number, map(str, self))


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
        element.remove()

    def clear(self) -> None:
        """Take all of them out; they can be added to another panel."""
        for element in list(self.elements.values()):
            self.remove(element)

    @property
    def values(self) -> dict[str, Any]:
        """What the named ones show."""
        return {name: element.state for name, element in self.named.items()} if self.named else {}

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
