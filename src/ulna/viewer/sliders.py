"""Controls of the panel with a number: one to type, and sliders whose limits and steps can change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.errors import InputError
from ulna.viewer.widgets import Valued, with_unit


class Number(Valued):
    """A number to type, with what it is measured in."""

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
        self._unit = str(unit)
        self._set("label", self._words())

    def _words(self) -> str:
        return with_unit(self._label, self._unit)

    def _checked(self, value: Any) -> float:
        number = float(value)
        if not math.isfinite(number):
            raise InputError(f"The {self._title()} is set to {number}; expected a finite number.")
        return number


@final
class Slider(Number):
    """A slider; what is outside its limits is brought to the nearer one."""

    __slots__ = ("_stepped",)

    def __init__(self, handle: Any, label: str, unit: str, stepped: bool) -> None:
        super().__init__(handle, label, unit)
        self._stepped = stepped

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
        low, high = (float(x) for x in limits)
        check_limits(self._label, low, high)
        value = min(max(self.value, low), high)
        self._set("min", min(low, self.low))  # the page never has the value outside
        self._set("max", max(high, self.high))
        self._set("value", value)
        self._set("min", low)
        self._set("max", high)
        self._fit(self.step if self._stepped else (high - low) / 1000)

    @property
    def step(self) -> float:
        """From one value to the next."""
        return float(self._handle.step)

    @step.setter
    def step(self, step: float) -> None:
        check_step(self._label, step)
        self._stepped = True
        self._fit(float(step))

    def _fit(self, step: float) -> None:
        self._set("step", min(step, self.high - self.low))
        self._set("precision", max(digits(x) for x in (self.low, self.high, self.step)))

    def _checked(self, value: Any) -> float:
        return min(max(super()._checked(value), self.low), self.high)


def check_limits(label: str, low: float, high: float, *more: float) -> None:
    """Refuse limits that are none.

    Raises:
        InputError: `low` is not below `high`, or a number is not finite.
    """
    if not (np.isfinite([low, high, *more]).all() and low < high):
        at = f", at {more[0]}" if more else ""
        raise InputError(f"The slider {label!r} runs from {low} to {high}{at}; expected low < high.")


def check_step(label: str, step: float) -> None:
    """Refuse a step that is none.

    Raises:
        InputError: It is not a finite number above zero.
    """
    if not (math.isfinite(step) and step > 0.0):
        raise InputError(f"The slider {label!r} is given steps of {step}; expected a number above zero.")


def digits(x: float) -> int:
    """How many digits after the point a number is written with, at most 6."""
    return next((k for k in range(6) if math.isclose(x, round(x, k), rel_tol=1e-9, abs_tol=1e-12)), 6)
