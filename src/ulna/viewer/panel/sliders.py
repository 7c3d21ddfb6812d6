"""Controls with a number: number fields, and sliders whose limits and steps can change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, final

from ulna.checks.arrays import shaped_array
from ulna.checks.values import number, text
from ulna.errors import InputError
from ulna.viewer.panel.controls import ValueControl, with_unit


class Number(ValueControl):
    """A number to type, with what it is measured in.

    Args:
        handle: The control of viser.
        label: Its label.
        unit: What the number is measured in.
    """

    __slots__ = ("_unit",)

    def __init__(self, handle: Any, label: str, unit: str) -> None:
        super().__init__(handle, label)
        self._unit = unit

    @property
    def unit(self) -> str:
        """What it is measured in."""
        return self._unit

    @unit.setter
    def unit(self, unit: str) -> None:
        self._unit = text("unit", unit)
        self._set("label", self._label_text())

    def _label_text(self) -> str:
        return with_unit(self._label, self._unit)

    def _checked(self, value: Any) -> float:
        return number(f"value of the {self._title()}", value)


@final
class Slider(Number):
    """A slider; what is outside its limits is brought to the nearer one.

    Args:
        handle: The control of viser.
        label: Its label.
        unit: What the number is measured in.
        stepped: Whether the step was chosen by the user.
    """

    __slots__ = ("_step_chosen",)

    def __init__(self, handle: Any, label: str, unit: str, stepped: bool) -> None:
        super().__init__(handle, label, unit)
        self._step_chosen = stepped

    @property
    def low(self) -> float:
        """The least value."""
        return float(self._handle.min)

    @low.setter
    def low(self, low: float) -> None:
        self.limits = (low, self.high)

    @property
    def high(self) -> float:
        """The largest value."""
        return float(self._handle.max)

    @high.setter
    def high(self, high: float) -> None:
        self.limits = (self.low, high)

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the largest value, to be assigned together; the value stays within them."""
        return self.low, self.high

    @limits.setter
    def limits(self, limits: Sequence[float]) -> None:
        low, high = check_limits(self._label, *shaped_array("limits", limits, 2))
        value = min(max(self.value, low), high)
        self._set("min", min(low, self.low))  # the page never has the value outside
        self._set("max", max(high, self.high))
        self._set("value", value)
        self._set("min", low)
        self._set("max", high)
        self._apply_step(self.step if self._step_chosen else (high - low) / 1000)

    @property
    def step(self) -> float:
        """From one value to the next."""
        return float(self._handle.step)

    @step.setter
    def step(self, step: float) -> None:
        step = check_step(self._label, step)
        self._step_chosen = True
        self._apply_step(step)

    def _apply_step(self, step: float) -> None:
        self._set("step", min(step, self.high - self.low))
        self._set("precision", max(decimals(x) for x in (self.low, self.high, self.step)))

    def _checked(self, value: Any) -> float:
        return min(max(super()._checked(value), self.low), self.high)


def check_limits(label: str, low: Any, high: Any) -> tuple[float, float]:
    """Check the limits of a slider.

    Args:
        label: Its label, for messages.
        low: Its least value.
        high: Its largest value.

    Returns:
        Both as floats.

    Raises:
        InputError: They are not finite numbers, or `low` is not below `high`.
    """
    least, most = number("low", low), number("high", high)
    if not least < most:
        raise InputError(f"The slider {label!r} runs from {least} to {most}; expected low < high.")
    return least, most


def check_step(label: str, step: Any) -> float:
    """Check the step of a slider.

    Args:
        label: Its label, for messages.
        step: The step.

    Returns:
        The step [any].

    Raises:
        InputError: It is not a finite number above zero.
    """
    return number(f"step of {label}", step, "a number above zero", above=0.0)


def decimals(x: float) -> int:
    """How many digits after the point a number is written with, at most 6."""
    return next((k for k in range(6) if math.isclose(x, round(x, k), rel_tol=1e-9, abs_tol=1e-12)), 6)
