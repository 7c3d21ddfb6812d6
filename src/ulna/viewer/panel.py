"""What a user puts into the panel: sliders, buttons, menus, words, plots; without a page they keep their values."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, final

import numpy as np

from ulna.errors import InputError, ShapeError, UnknownName
from ulna.typing import ArrayLike, Floats
from ulna.viewer.controls import Control, Gizmo, position_wxyz
from ulna.viewer.page import Page

_MANY = 6  # choices from which on buttons become a menu
_INKS = ("#2563eb", "#dc2626", "#16a34a", "#d97706", "#7c3aed", "#0891b2", "#db2777", "#65a30d")


def nothing(_: Any) -> None:
    """Does nothing."""


@final
class Panel:
    """Controls beside the scene.

    Functions that handle a change are called with the new value on one thread, one after the other, of each control
    the newest only. Whatever the program sets itself calls no function.

    Args:
        page: The page they stand in, or None to keep values only.
    """

    def __init__(self, page: Page | None) -> None:
        self._page = page
        self._gui: Any = None if page is None else page.server.gui

    @contextlib.contextmanager
    def folder(self, label: str, open: bool = True) -> Iterator[None]:
        """Controls that are made within stand together under a heading."""
        if self._gui is None:
            yield
            return
        with self._gui.add_folder(label, expand_by_default=open):
            yield

    def slider(
        self,
        label: str,
        low: float,
        high: float,
        value: float | None = None,
        on_change: Callable[[float], None] = nothing,
        *,
        step: float | None = None,
        unit: str = "",
        hint: str | None = None,
    ) -> Control:
        """A slider from `low` to `high`, beginning at `value`.

        Raises:
            InputError: `low` is not below `high`, or a number is not finite.
        """
        start = low if value is None else value
        if not (np.isfinite([low, high, start]).all() and low < high):
            raise InputError(
                f"The slider {label!r} runs from {low} to {high}, at {start}; expected low < high."
            )
        step = (high - low) / 1000 if step is None else min(step, high - low)
        start = float(np.clip(start, low, high))
        if self._gui is None:
            return Control.kept(start)
        handle = self._gui.add_slider(
            _with(label, unit), min=low, max=high, step=step, initial_value=start, hint=hint
        )
        return self._wire(handle, on_change)

    def number(
        self, label: str, value: float = 0.0, on_change: Callable[[float], None] = nothing, *, unit: str = ""
    ) -> Control:
        """A number to type."""
        if self._gui is None:
            return Control.kept(float(value))
        return self._wire(self._gui.add_number(_with(label, unit), initial_value=float(value)), on_change)

    def checkbox(
        self, label: str, value: bool = False, on_change: Callable[[bool], None] = nothing
    ) -> Control:
        """A box to tick."""
        if self._gui is None:
            return Control.kept(bool(value))
        return self._wire(self._gui.add_checkbox(label, initial_value=bool(value)), on_change)

    def select(
        self,
        label: str,
        options: Sequence[str],
        value: str | None = None,
        on_change: Callable[[str], None] = nothing,
    ) -> Control:
        """A menu of which one is chosen.

        Raises:
            InputError: There are no options, or one twice.
            UnknownName: `value` is none of them.
        """
        options, value = _choices(label, options, value)
        if self._gui is None:
            return Control.kept(value)
        return self._wire(self._gui.add_dropdown(label, options, initial_value=value), on_change)

    def radio(
        self,
        label: str,
        options: Sequence[str],
        value: str | None = None,
        on_change: Callable[[str], None] = nothing,
    ) -> Control:
        """Boxes of which exactly one is ticked.

        Raises:
            InputError: There are no options, or one twice.
            UnknownName: `value` is none of them.
        """
        options, value = _choices(label, options, value)
        if self._gui is None:
            return Control.kept(value)
        with self._gui.add_folder(label):
            boxes = {o: self._gui.add_checkbox(o, initial_value=o == value) for o in options}
        out = Control.of_choice(boxes, value)
        for option, box in boxes.items():

            def ticked(_: Any, option: str = option) -> None:
                changed = out.value != option
                out.value = option  # also when the ticked one was clicked: one of them always is
                if changed:
                    on_change(option)

            self._listen(box.on_update, id(box), ticked, lambda: None)
        return out

    def button(self, label: str, on_click: Callable[[], None], *, hint: str | None = None) -> Control:
        """A button; `value` counts how often it was clicked."""
        out = Control.kept(0)

        def clicked(_: Any) -> None:
            out.value += 1
            on_click()

        if self._gui is not None:
            handle = self._gui.add_button(label, hint=hint)
            self._listen(handle.on_click, None, clicked, lambda: None)
        return out

    def buttons(self, label: str, options: Sequence[str], on_click: Callable[[str], None]) -> None:
        """A row of buttons, or a menu of many with one button to press; calls `on_click` with what was chosen."""
        options, _ = _choices(label, options, None)
        if self._gui is None:
            return
        if len(options) <= _MANY:
            handle = self._gui.add_button_group(label, options)
            self._listen(handle.on_click, None, on_click, lambda: handle.value)
        else:  # a menu alone would seem to have chosen its first, and could not choose the same again
            menu = self._gui.add_dropdown(label, options)
            self._listen(self._gui.add_button("Go").on_click, None, on_click, lambda: menu.value)

    def text(self, content: str = "") -> Control:
        """Words in Markdown; setting `value` replaces them."""
        if self._gui is None:
            return Control.kept(content)
        return Control(self._gui.add_markdown(content), "content")

    def plot(
        self, title: str, series: Sequence[str], *, seconds: float = 10.0, unit: str = "", height: int = 180
    ) -> Plot:
        """A plot of numbers over time; `add` a row to it as often as you like.

        Args:
            title: What stands over it.
            series: The name of each line.
            seconds: How much of the past it shows [s].
            unit: What the numbers are measured in.
            height: Height [pixels].
        """
        names, _ = _choices(title, series, None)
        out = Plot(names, seconds)
        if self._gui is not None and self._page is not None:
            lines = [{"label": n, "stroke": _INKS[k % len(_INKS)], "width": 2} for k, n in enumerate(names)]
            handle = self._gui.add_uplot(
                tuple(np.zeros(1) for _ in range(len(names) + 1)),
                ({"label": "t"}, *lines),
                title=_with(title, unit),
                scales={"x": {"time": False}},
                height=height,
            )
            self._page.each_tick(lambda: out._draw(handle))
        return out

    def gizmo(
        self, name: str, pose: Floats, on_drag: Callable[[tuple[Floats, str]], None], size: float = 0.2
    ) -> Gizmo:
        """A pose to drag; `on_drag` is called with (T_world_gizmo, "start" | "update" | "end").

        Raises:
            InputError: There is no page.
        """
        if self._page is None:
            raise InputError("There is no page to drag anything in.")
        page, (position, wxyz) = self._page, position_wxyz(pose)
        handle = page.server.scene.add_transform_controls(
            f"/(page)/{name}",
            scale=size,
            line_width=3.0,
            depth_test=False,
            opacity=0.9,
            position=position,
            wxyz=wxyz,
        )
        gizmo = Gizmo(handle)

        @handle.on_update
        async def _(event: Any) -> None:  # async: on viser's own loop, so that events stay in order
            gizmo.held = event.phase != "end"
            # starts and ends are never dropped, of updates only the newest counts
            page.notice(id(handle) if event.phase == "update" else None, on_drag, (gizmo.pose, event.phase))

        return gizmo

    def _wire(self, handle: Any, function: Callable[[Any], None]) -> Control:
        self._listen(handle.on_update, id(handle), function, lambda: handle.value)
        return Control(handle, "value")

    def _listen(
        self, register: Any, key: int | None, function: Callable[[Any], None], value: Callable[[], Any]
    ) -> None:
        page = self._page
        assert page is not None

        async def changed(event: Any) -> None:
            if event.client is not None:  # a value that the program set itself is no news
                page.notice(key, function, value())

        register(changed)


@final
class Plot:
    """Lines over time in the panel. Only as many rows are kept as `seconds` hold, at most some thousands."""

    _MOST = 4000

    def __init__(self, names: tuple[str, ...], seconds: float) -> None:
        self.names, self.seconds = names, seconds
        self._rows: list[tuple[float, Floats]] = []
        self._lock = threading.Lock()
        self._drawn_at, self._news = 0.0, False

    def add(self, t: float, values: ArrayLike) -> None:
        """Append a row: the time [s], and a number for each line.

        Raises:
            ShapeError: There are more or fewer numbers than lines.
        """
        row = np.atleast_1d(np.array(values, dtype=float))
        if row.shape != (len(self.names),):
            raise ShapeError(
                "values", row.shape, f"({len(self.names)},), one for each of {', '.join(self.names)}"
            )
        with self._lock:
            if self._rows and t < self._rows[-1][0]:  # time began anew
                self._rows.clear()
            self._rows.append((float(t), row))
            if len(self._rows) > self._MOST or self._rows[0][0] < t - 2 * self.seconds:
                first = next(k for k, (at, _) in enumerate(self._rows) if at >= t - self.seconds)
                self._rows = self._rows[max(first, len(self._rows) - self._MOST // 2) :]
            self._news = True

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._rows.clear()
            self._news = True

    @property
    def data(self) -> Floats:
        """What it shows: rows of the time and the numbers, shape (n, 1 + lines)."""
        with self._lock:
            newest = self._rows[-1][0] if self._rows else 0.0
            rows = [np.concatenate([[t], row]) for t, row in self._rows if t >= newest - self.seconds]
        return np.array(rows).reshape(-1, 1 + len(self.names))

    def _draw(self, handle: Any) -> None:
        now = time.monotonic()
        if self._news and now - self._drawn_at > 0.1:
            self._news, self._drawn_at = False, now
            data = self.data if self._rows else np.zeros((1, 1 + len(self.names)))
            handle.data = tuple(np.ascontiguousarray(column) for column in data.T)


def _with(label: str, unit: str) -> str:
    return f"{label} [{unit}]" if unit else label


def _choices(label: str, options: Sequence[str], value: str | None) -> tuple[tuple[str, ...], str]:
    names = tuple(str(o) for o in options)
    if not names or len(set(names)) != len(names):
        raise InputError(f"{label!r} has the choices {names}; expected at least one, and each once.")
    if value is not None and value not in names:
        raise UnknownName(f"choice of {label!r}", value, names)
    return names, names[0] if value is None else value
