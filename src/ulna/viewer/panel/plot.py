"""Plots in the panel: lines over time, of which the newest rows are kept."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, final

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import duration, number
from ulna.errors import ShapeError
from ulna.system import forks
from ulna.typing import ArrayLike, Floats
from ulna.viewer.panel.controls import LabelledControl, with_unit

LINE_COLOURS = ("#2563eb", "#dc2626", "#16a34a", "#d97706", "#7c3aed", "#0891b2", "#db2777", "#65a30d")


@final
class Plot(LabelledControl):
    """Lines over time in the panel. Only as many rows are kept as `seconds` hold, at most some thousands.

    Args:
        handle: What stands for it in the page.
        label: Its title.
        unit: What the numbers are measured in.
        names: The name of each line.
        seconds: How much of the past it shows [s].
        forget: Called when it is removed.
    """

    __slots__ = ("_changed", "_drawn_at", "_lock", "_names", "_on_remove", "_rows", "_seconds", "_unit")
    _MAX_ROWS = 4000
    _label_attribute = "title"

    def __init__(
        self,
        handle: Any,
        label: str,
        unit: str,
        names: tuple[str, ...],
        seconds: float,
        forget: Callable[[Plot], None],
    ) -> None:
        super().__init__(handle, label)
        self._names, self._seconds, self._unit, self._on_remove = names, seconds, unit, forget
        self._rows: list[tuple[float, ...]] = []  # the time, and the numbers
        self._lock = forks.lock()
        self._drawn_at, self._changed = 0.0, False

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each line."""
        return self._names

    @property
    def seconds(self) -> float:
        """How much of the past it shows [s]."""
        return self._seconds

    @seconds.setter
    def seconds(self, seconds: float) -> None:
        span = duration("seconds", seconds)
        with self._lock:
            self._seconds, self._changed = span, True

    def _label_text(self) -> str:
        return with_unit(self._label, self._unit)

    def add(self, t: float, values: ArrayLike) -> None:
        """Append a row.

        Args:
            t: The time [s]; one before that of the last row clears the plot.
            values: A number for each line, (n,).

        Raises:
            ShapeError: The count of numbers is not that of lines.
        """
        row, t = np.atleast_1d(finite_array("values", values)), number("t", t, "a time [s]")
        if row.shape != (len(self._names),):
            raise ShapeError(
                "values", row.shape, f"({len(self._names)},), one for each of {', '.join(self._names)}"
            )
        with self._lock:
            if self._rows and t < self._rows[-1][0]:  # time restarted
                self._rows.clear()
            self._rows.append((t, *row.tolist()))
            if len(self._rows) > self._MAX_ROWS or self._rows[0][0] < t - 2 * self._seconds:
                first = next(k for k, one in enumerate(self._rows) if one[0] >= t - self._seconds)
                self._rows = self._rows[max(first, len(self._rows) - self._MAX_ROWS // 2) :]
            self._changed = True

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._rows.clear()
            self._changed = True

    @property
    def data(self) -> Floats:
        """What it shows: rows of the time and the numbers, shape (n, 1 + lines)."""
        with self._lock:
            newest = self._rows[-1][0] if self._rows else 0.0
            rows = [row for row in self._rows if row[0] >= newest - self._seconds]
        return np.array(rows, dtype=float).reshape(-1, 1 + len(self._names))

    def remove(self) -> None:
        """Remove it from the panel. May be called twice."""
        self._on_remove(self)
        super().remove()

    def draw(self) -> None:
        """Show what is new, ten times a second at most."""
        now = time.monotonic()
        if self._changed and not self._removed and now - self._drawn_at > 0.1:
            self._changed, self._drawn_at = False, now
            data = self.data if self._rows else np.zeros((1, 1 + len(self._names)))
            self._handle.data = tuple(np.ascontiguousarray(column) for column in data.T)
