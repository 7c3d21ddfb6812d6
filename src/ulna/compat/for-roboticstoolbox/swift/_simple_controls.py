"""Sliders, buttons and labels of the panel."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from swift._element import Setting, SwiftElement
from ulna.errors import InputError


class Slider(SwiftElement):
    """A slider.

    Args:
        cb: Called with the value.
        min: The least value.
        max: The largest value.
        step: From one value to the next.
        value: Where it starts.
        label: The text beside it.
        unit: What the value is measured in.
        precision: Digits that Swift shows; the panel shows those of `step`.
        desc: An older name of `label`.

    Raises:
        InputError: `min` is not below `max`, or `step` not above zero.
    """

    kind = "slider"
    min, max, step, unit, precision = Setting(float), Setting(float), Setting(float), Setting(), Setting(int)

    def __init__(
        self,
        cb: Callable[[float], Any] | None = None,
        min: float = 0,
        max: float = 100,
        step: float = 1,
        value: float = 0,
        label: str = "",
        unit: str = "",
        precision: int = 3,
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, desc)
        self.min, self.max, self.step = min, max, step
        self.unit, self.precision = unit, precision
        self._value = float(value)
        self._check()

    def _check(self) -> None:
        numbers = (self.min, self.max, self.step, self._value)
        if not (np.isfinite(numbers).all() and self.min < self.max and self.step > 0.0):
            raise InputError(
                f"The slider {self.label!r} would run from {self.min:g} to {self.max:g} in steps of {self.step:g}, at "
                f"{self._value:g}; expected min < max and a step above zero. To move both limits up, set `max` first."
            )

    @property
    def value(self) -> float:
        """Where it stands; assigning moves it and calls nothing."""
        return self._value

    @value.setter
    def value(self, value: float) -> None:
        self.update(value)
        self._refresh()

    def _build(self, panel: Any) -> list[Any]:
        label, changed = self.label or "slider", self._on_change
        return [panel.slider(label, self.min, self.max, self._value, changed, step=self.step, unit=self.unit)]

    def _synchronize(self, *controls: Any) -> None:
        (slider,) = controls
        slider.label, slider.unit = self.label or "slider", self.unit
        slider.limits = self.min, self.max
        slider.step, slider.value = self.step, self._value

    def update(self, e: float) -> None:
        """Take over a value; calls nothing."""
        if not math.isfinite(float(e)):
            raise InputError(f"The slider {self.label!r} is set to {e}; expected a finite number.")
        self._value = float(e)
        self._share()

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        names = ("min", "max", "step", "value", "unit", "precision")
        return {**super().to_dict(), **{name: getattr(self, name) for name in names}}


class Button(SwiftElement):
    """A button.

    Args:
        cb: Called with 0, as Swift does.
        label: The text on it.
        desc: An older name of `label`.
    """

    kind = "button"

    def _build(self, panel: Any) -> list[Any]:
        return [panel.button(self.label or "button", lambda: self._on_change(0))]

    def _synchronize(self, *controls: Any) -> None:
        controls[0].label = self.label or "button"

    def update(self, e: Any) -> None:
        """Nothing is to be taken over; calls nothing."""


class Label(SwiftElement):
    """A label.

    Args:
        label: The text.
        compact: Whether it is shown in one line, as labels always are here.
        desc: An older name of `label`.
    """

    kind = "label"

    def __init__(self, label: str = "", compact: bool = False, desc: str | None = None) -> None:
        self.compact = bool(compact)
        super().__init__(None, label, desc)

    def _build(self, panel: Any) -> list[Any]:
        return [panel.text(self.label)]

    def _synchronize(self, *controls: Any) -> None:
        controls[0].value = self.label

    def update(self, e: Any) -> None:
        """Nothing is to be taken over; calls nothing."""

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "compact": self.compact}
