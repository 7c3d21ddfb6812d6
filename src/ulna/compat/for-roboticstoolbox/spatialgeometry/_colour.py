"""Colours as people write them: names, hex, 0 to 255 or 0 to 1, with or without opacity."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import RGBA, colour


def rgba(value: Any) -> RGBA:
    """Red, green, blue and opacity from 0 to 1.

    Args:
        value: A name of CSS, or of matplotlib where that is installed, "#rrggbb", "#rrggbbaa", or three or four
            numbers: from 0 to 255 where one is above 1, else from 0 to 1.

    Raises:
        InputError: It is no colour.
        UnknownName: There is no colour of that name.
    """
    if isinstance(value, str):
        try:
            return colour(value)
        except UnknownName:
            converted = _of_matplotlib(value)
            if converted is None:
                raise
            return converted
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.shape not in ((3,), (4,)) or not (numbers.min() >= 0.0 and numbers.max() <= 255.0):
        raise InputError(
            f"`color` is {value!r}; expected a name, '#rrggbb', or three or four numbers from 0 to 1, or to 255."
        )
    return colour((numbers / 255.0 if numbers.max() > 1.0 else numbers).tolist())


def _of_matplotlib(name: str) -> RGBA | None:
    """A colour that matplotlib knows: "r", "tab:blue", "xkcd:sky" ..."""
    try:
        from matplotlib.colors import to_rgba  # pyright: ignore[reportMissingImports]
    except ImportError:
        return None
    try:
        r, g, b, a = to_rgba(name)
    except ValueError:
        return None
    return float(r), float(g), float(b), float(a)
