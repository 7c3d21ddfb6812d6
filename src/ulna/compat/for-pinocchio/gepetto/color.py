"""Colours by name, as lists of red, green, blue, opacity from 0 to 1."""

from __future__ import annotations

import numpy as np


class Color(list):
    """Red, green, blue, opacity: `Color.red`, `Color("red")`, `Color(1, 0, 0)`, `Color.random()`."""

    def __init__(self, *rgba: object) -> None:
        values = rgba
        if len(rgba) == 1:
            values = tuple(getattr(Color, rgba[0])) if isinstance(rgba[0], str) else tuple(rgba[0])  # type: ignore[arg-type]
        numbers = [float(c) for c in values]  # type: ignore[arg-type]
        super().__init__([*numbers, 1.0] if len(numbers) == 3 else numbers)

    @staticmethod
    def random(alpha: float = 1.0) -> Color:
        """Any colour."""
        return Color(*np.random.default_rng().random(3), alpha)

    red: Color
    green: Color
    blue: Color
    white: Color
    black: Color
    grey: Color
    yellow: Color
    purple: Color
    orange: Color
    brown: Color
    lightRed: Color
    lightGreen: Color
    lightBlue: Color
    lightBlack: Color
    lightYellow: Color


_FULL = {
    "red": (1.0, 0.0, 0.0),
    "green": (0.0, 1.0, 0.0),
    "blue": (0.0, 0.0, 1.0),
    "white": (1.0, 1.0, 1.0),
    "black": (0.0, 0.0, 0.0),
    "grey": (0.5, 0.5, 0.5),
    "yellow": (1.0, 1.0, 0.0),
    "purple": (0.5, 0.0, 0.5),
    "orange": (1.0, 0.55, 0.0),
    "brown": (0.45, 0.3, 0.1),
}
for _name, _rgb in _FULL.items():
    setattr(Color, _name, Color(*_rgb))
for _name in ("red", "green", "blue", "black", "yellow"):
    setattr(Color, f"light{_name.capitalize()}", Color(*_FULL[_name], 0.4))
