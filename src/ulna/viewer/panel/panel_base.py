"""The base of the panel: adding controls, folders, and calling functions when a user changes a control."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import flag, text
from ulna.viewer.page import Page
from ulna.viewer.panel.controls import Control, Folder, OfflineHandle

_C = TypeVar("_C", bound=Control)


class PanelBase(FixedAttributes):
    """Adds controls to a page, or stores their values without one.

    Args:
        page: The page, or None.
    """

    def __init__(self, page: Page | None) -> None:
        self._page = page
        self._gui: Any = None if page is None else page.server.gui
        self._open_folders = threading.local()  # folders that this thread is within

    @contextlib.contextmanager
    def folder(self, label: str, open: bool = True) -> Iterator[Folder]:
        """Add a folder; controls that are added within the context belong to it.

        Args:
            label: Its heading.
            open: Whether it is expanded at first.

        Returns:
            A context that yields the folder.
        """
        heading = self._add("folder", label, expand_by_default=flag("open", open))
        out = self._register(Folder(heading, label))
        around = getattr(self._open_folders, "folder", None)
        with heading:
            self._open_folders.folder = out
            try:
                yield out
            finally:
                self._open_folders.folder = around

    def _add(self, kind: str, label: str, *value: Any, **more: Any) -> Any:
        """A control of the page, or its substitute without a page."""
        text("label", label)
        if more.get("hint") is not None:
            text("hint", more["hint"])
        if self._gui is None:
            return OfflineHandle(label=label, **({"value": value[0]} if value else {}), **more)
        more.pop("value", None)
        add = getattr(self._gui, f"add_{kind}")
        return add(label, **more, **({"initial_value": value[0]} if value else {}))

    def _register(self, control: _C) -> _C:
        around = getattr(self._open_folders, "folder", None)
        if around is not None:
            around.add_child(control)
        return control

    def _register_listening(self, control: Any, on_change: Callable[[Any], None]) -> Any:
        handle = control._handle
        self._listen(handle, "on_update", on_change, lambda: handle.value, lambda: control.removed)
        return self._register(control)

    def _listen(
        self,
        handle: Any,
        event: str,
        function: Callable[[Any], None],
        value: Callable[[], Any],
        removed: Callable[[], bool],
        each: bool = False,
    ) -> None:
        """Call `function` with the result of `value` when a user changed it: with the newest only, or with `each`."""
        page = self._page
        if page is None or page.closed:
            return

        def call(value: Any) -> None:
            if not removed():
                function(value)

        async def changed(event: Any) -> None:
            if event.client is not None:  # not for a value that the program set
                page.post_event(None if each else id(handle), call, value())

        getattr(handle, event)(changed)
