"""The panel: sliders, buttons, menus, text, plots; without a page the controls store their values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from ulna.checks.values import count, duration, flag, function, number, text
from ulna.errors import InputError
from ulna.typing import Floats
from ulna.viewer.page.gizmo import Gizmo, add_gizmo
from ulna.viewer.panel.choices import ButtonMenu, Buttons, Choice, RadioBoxes, checked_choices
from ulna.viewer.panel.controls import Button, Checkbox, OfflineHandle, Text, with_unit
from ulna.viewer.panel.panel_base import PanelBase
from ulna.viewer.panel.plot import LINE_COLOURS, Plot
from ulna.viewer.panel.sliders import Number, Slider, check_limits, check_step

_MAX_BUTTONS = 6  # choices from which on buttons become a menu


def ignore_value(_: Any) -> None:
    """Does nothing."""


@final
class Panel(PanelBase):
    """Controls beside the scene.

    Functions that handle a change are called with the new value on one thread, one after the other, of each control
    the newest only. Assignments of the program call no function. The returned control can be assigned to at any time:
    its value, label, limits, options, whether it is visible or disabled; and be removed.

    Args:
        page: The page, or None to store values only.
    """

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
        """Add a slider.

        Args:
            label: The text beside it.
            low: The least value [any].
            high: The largest value [any].
            value: The first value [any]; `low` when not given.
            on_change: Called with the new value when a user changes it.
            step: From one value to the next [any]; a thousandth of the range when not given.
            unit: The unit, shown in brackets.
            hint: Text shown while the pointer is over it.

        Returns:
            The slider; its value, limits, step, label and unit can be assigned to.

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
        """Add a number field.

        Args:
            label: The text beside it.
            value: The first value [any].
            on_change: Called with the new value when a user changes it.
            unit: The unit, shown in brackets.

        Returns:
            The number field.

        Raises:
            InputError: `value` is no finite number.
        """
        text("label", label)
        function("on_change", on_change)
        handle = self._add("number", with_unit(label, unit), number("value", value))
        return self._register_listening(Number(handle, label, unit), on_change)

    def checkbox(
        self, label: str, value: bool = False, on_change: Callable[[bool], None] = ignore_value
    ) -> Checkbox:
        """Add a checkbox.

        Args:
            label: The text beside it.
            value: Whether it is checked at first.
            on_change: Called with the new value when a user changes it.

        Returns:
            The checkbox.

        Raises:
            InputError: `value` is not True or False.
        """
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
        """Add a menu.

        Args:
            label: The text beside it.
            options: What can be chosen, each once.
            value: The first choice; the first option when not given.
            on_change: Called with the new value when a user changes it.

        Returns:
            The menu.

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
        """Add radio boxes, of which exactly one is checked.

        Args:
            label: The text beside it.
            options: What can be chosen, each once.
            value: The first choice; the first option when not given.
            on_change: Called with the new value when a user changes it.

        Returns:
            The boxes.

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
        """Add a button; its `value` counts clicks.

        Args:
            label: The text on it.
            on_click: Called when it is clicked.
            hint: Text shown while the pointer is over it.

        Returns:
            The button.

        Raises:
            InputError: `on_click` is no function.
        """
        function("on_click", on_click)
        out = self._register(Button(self._add("button", label, hint=hint), label))

        def clicked(_: Any) -> None:
            out.count()
            on_click()

        self._listen(out._handle, "on_click", clicked, lambda: None, lambda: out.removed, each=True)
        return out

    def buttons(self, label: str, options: Sequence[str], on_click: Callable[[str], None]) -> Buttons:
        """Add a row of buttons; many options become a menu with one button.

        Args:
            label: The text beside it.
            options: The texts on the buttons, each once.
            on_click: Called with the option that is clicked.

        Returns:
            The buttons.

        Raises:
            InputError: There are no options, or one twice.
        """
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

        Returns:
            The plot.
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
        """Add a pose to drag to the scene; see `ulna.viewer.page.gizmo.add_gizmo`.

        Args:
            name: Its name.
            pose: T_world_gizmo, (4, 4).
            on_drag: Called with (T_world_gizmo (4, 4), "start" | "update" | "end").
            size: Length of its axes [m].

        Returns:
            The gizmo.

        Raises:
            InputError: There is no page.
        """
        if self._page is None:
            raise InputError("There is no page to drag anything in.")
        return add_gizmo(self._page, name, pose, on_drag, size)
