"""The panel: sliders, buttons, menus, text, plots; without a page the controls store their values."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar, final

import numpy as np

from ulna.checks.values import count, duration, flag, function, number, text
from ulna.errors import InputError
from ulna.typing import Floats
from ulna.viewer.page import Page
from ulna.viewer.page.gizmo import Gizmo, add_gizmo
from ulna.viewer.panel.choices import ButtonMenu, Buttons, Choice, RadioBoxes, checked_choices
from ulna.viewer.panel.controls import Button, Checkbox, Control, Folder, OfflineHandle, Text, with_unit
from ulna.viewer.panel.plot import LINE_COLOURS, Plot
from ulna.viewer.panel.sliders import Number, Slider, check_limits, check_step

_MAX_BUTTONS = 6  # choices from which on buttons become a menu
_C = TypeVar("_C", bound=Control)


def ignore_value(_: Any) -> None:
    """Does nothing."""


@final
class Panel:
    """Controls beside the scene.

    Functions that handle a change are called with the new value on one thread, one after the other, of each control
    the newest only. Assignments of the program call no function. The returned control can be assigned to at any time:
    its value, label, limits, options, whether it is visible or disabled; and be removed.

    Args:
        page: The page, or None to store values only.
    """

    def __init__(self, page: Page | None) -> None:
        self._page = page
        self._gui: Any = None if page is None else page.server.gui
        self._open_folders = threading.local()  # folders that this thread is within

    @contextlib.contextmanager
    def folder(self, label: str, open: bool = True) -> Iterator[Folder]:
        """Controls that are made within stand together under a heading."""
        heading = self._add("folder", label, expand_by_default=flag("open", open))
        out = self._register(Folder(heading, label))
        around = getattr(self._open_folders, "folder", None)
        with heading:
            self._open_folders.folder = out
            try:
                yield out
            finally:
                self._open_folders.folder = around

    def slider(
        self,
        label: str,
        low: float,
        high: float,
        value: float | None = None,
        on_change: Callable[[float], None] = ignore_value,
        *,
        step: float | None = None,
        unit: str = "",
        hint: str | None = None,
    ) -> Slider:
        """A slider from `low` to `high`, beginning at `value`.

        Raises:
            InputError: `low` is not below `high`, `step` is not above zero, or a number is not finite.
        """
        text("label", label)
        function("on_change", on_change)
        low, high = check_limits(label, low, high)
        start = min(max(low if value is None else number("value", value), low), high)
        each = (high - low) / 1000 if step is None else min(check_step(label, step), high - low)
        handle = self._add("slider", with_unit(label, unit), start, min=low, max=high, step=each, hint=hint)
        return self._register_listening(Slider(handle, label, unit, step is not None), on_change)

    def number(
        self,
        label: str,
        value: float = 0.0,
        on_change: Callable[[float], None] = ignore_value,
        *,
        unit: str = "",
    ) -> Number:
        """A number to type."""
        text("label", label)
        function("on_change", on_change)
        handle = self._add("number", with_unit(label, unit), number("value", value))
        return self._register_listening(Number(handle, label, unit), on_change)

    def checkbox(
        self, label: str, value: bool = False, on_change: Callable[[bool], None] = ignore_value
    ) -> Checkbox:
        """A box to tick."""
        function("on_change", on_change)
        return self._register_listening(
            Checkbox(self._add("checkbox", label, flag("value", value)), label), on_change
        )

    def select(
        self,
        label: str,
        options: Sequence[str],
        value: str | None = None,
        on_change: Callable[[str], None] = ignore_value,
    ) -> Choice:
        """A menu of which one is chosen.

        Raises:
            InputError: There are no options, or one twice.
            UnknownName: `value` is none of them.
        """
        names, chosen = checked_choices(label, options, value)
        function("on_change", on_change)
        return self._register_listening(
            Choice(self._add("dropdown", label, chosen, options=names), label), on_change
        )

    def radio(
        self,
        label: str,
        options: Sequence[str],
        value: str | None = None,
        on_change: Callable[[str], None] = ignore_value,
    ) -> Choice:
        """Boxes of which exactly one is ticked.

        Raises:
            InputError: There are no options, or one twice.
            UnknownName: `value` is none of them.
        """
        names, chosen = checked_choices(label, options, value)
        function("on_change", on_change)

        def make(option: str, ticked: bool) -> Any:
            box = self._add("checkbox", option, ticked)

            def clicked(_: Any) -> None:
                changed = boxes.value != option
                boxes.value = option  # also when the ticked one was clicked: one of them always is
                if changed:
                    on_change(option)

            self._listen(box, "on_update", clicked, lambda: None, lambda: out.removed)
            return box

        boxes = RadioBoxes(self._add("folder", label), names, chosen, make)
        out = self._register(Choice(boxes, label))
        return out

    def button(self, label: str, on_click: Callable[[], None], *, hint: str | None = None) -> Button:
        """A button; `value` counts how often it was clicked."""
        function("on_click", on_click)
        out = self._register(Button(self._add("button", label, hint=hint), label))

        def clicked(_: Any) -> None:
            out.count()
            on_click()

        self._listen(out._handle, "on_click", clicked, lambda: None, lambda: out.removed, each=True)
        return out

    def buttons(self, label: str, options: Sequence[str], on_click: Callable[[str], None]) -> Buttons:
        """A row of buttons, or a menu of many with one button to press; calls `on_click` with what was chosen."""
        names, _ = checked_choices(label, options, None)
        function("on_click", on_click)
        if len(names) <= _MAX_BUTTONS:
            handle = self._add("button_group", label, options=names, value=names[0])
        else:
            handle = ButtonMenu(
                self._add("dropdown", label, names[0], options=names), self._add("button", "Go")
            )
        out = self._register(Buttons(handle, label))

        def pressed(option: str) -> None:
            out.press(option)
            on_click(option)

        self._listen(handle, "on_click", pressed, lambda: handle.value, lambda: out.removed, each=True)
        return out

    def text(self, content: str = "") -> Text:
        """Words in Markdown; setting `value` replaces them."""
        checked = text("content", content)
        return self._register(
            Text(OfflineHandle(content=checked) if self._gui is None else self._gui.add_markdown(checked))
        )

    def plot(
        self, title: str, series: Sequence[str], *, seconds: float = 10.0, unit: str = "", height: int = 180
    ) -> Plot:
        """A plot of numbers over time; `add` a row to it as often as you like.

        Args:
            title: Its title.
            series: The name of each line.
            seconds: How much of the past it shows [s].
            unit: What the numbers are measured in.
            height: Height [pixels].
        """
        names, _ = checked_choices(title, series, None)
        heading, span = with_unit(text("title", title), unit), duration("seconds", seconds)
        count("height", height, 20, 4000)
        if self._gui is None or self._page is None:
            return self._register(Plot(OfflineHandle(title=heading), title, unit, names, span, ignore_value))
        lines = [
            {"label": n, "stroke": LINE_COLOURS[k % len(LINE_COLOURS)], "width": 2}
            for k, n in enumerate(names)
        ]
        handle = self._gui.add_uplot(
            tuple(np.zeros(1) for _ in range(len(names) + 1)),
            ({"label": "t"}, *lines),
            title=heading,
            scales={"x": {"time": False}},
            height=height,
        )
        page = self._page
        out = Plot(handle, title, unit, names, span, lambda plot: page.remove_tick(plot.draw))
        page.add_tick(out.draw)
        return self._register(out)

    def gizmo(
        self, name: str, pose: Floats, on_drag: Callable[[tuple[Floats, str]], None], size: float = 0.2
    ) -> Gizmo:
        """A pose to drag; `on_drag` is called with (T_world_gizmo, "start" | "update" | "end").

        Raises:
            InputError: There is no page.
        """
        if self._page is None:
            raise InputError("There is no page to drag anything in.")
        return add_gizmo(self._page, name, pose, on_drag, size)

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
