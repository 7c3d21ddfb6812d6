"""The controls of an environment: put into the panel, and heard in the thread of the script."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from swift._elements import SwiftElement
from ulna.errors import InputError, UnknownName


class Controls:
    """Controls in the order in which they were added.

    Args:
        panel: The panel of an `ulna.Viewer`.
    """

    def __init__(self, panel: Any) -> None:
        self.elements: dict[int, SwiftElement] = {}
        """The controls, by their number."""
        self._panel = panel
        self._named: dict[str, SwiftElement] = {}
        self._heard: deque[tuple[SwiftElement, Any]] = deque()
        self._at_once = threading.Event()

    def add(self, element: SwiftElement, name: str | None) -> None:
        """Put a control into the panel.

        Raises:
            InputError: It is there already, or one of its name.
        """
        if element.shown:
            raise InputError(f"This {type(element).__name__} ({element.label!r}) is in the panel already.")
        if name in self._named:
            raise InputError(f"There is a control named {name!r} already.")
        number = len(self.elements)
        element.show(self._panel, number, self._hear)
        self.elements[number] = element
        if name is not None:
            self._named[name] = element

    @property
    def values(self) -> dict[str, Any]:
        """What the named ones show."""
        return {name: element.state for name, element in self._named.items()} if self._named else {}

    def handle(self, events: Mapping[Any, Any] | None = None) -> None:
        """Call the functions of what was changed in the page, and of `events`: values by the number of the control.

        Raises:
            UnknownName: There is no control of that number.
        """
        for number, value in (events or {}).items():
            if int(number) not in self.elements:
                raise UnknownName("control", number, map(str, self.elements))
            self.elements[int(number)].choose(value)
        while self._heard:
            element, value = self._heard.popleft()
            element.choose(value)

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """While the script stands still within, what is done in the page is handled where it comes in."""
        self.handle()
        self._at_once.set()
        try:
            yield
        finally:
            self._at_once.clear()

    @property
    def waiting(self) -> int:
        """How many changes were heard that no step has handled yet."""
        return len(self._heard)

    def _hear(self, element: SwiftElement, value: Any) -> None:
        if self._at_once.is_set():
            element.choose(value)
        else:
            self._heard.append((element, value))
