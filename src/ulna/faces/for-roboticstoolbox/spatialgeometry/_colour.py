"""Colours as people write them: names, hex, 0 to 255 or 0 to 1, with or without opacity."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError, MissingExtra

RGBA = tuple[float, float, float, float]


def rgba(colour: Any) -> RGBA:
    """Red, green, blue and opacity from 0 to 1.

    Args:
        colour: A name that matplotlib knows, "#rrggbb", "#rrggbbaa", or three or four numbers: from 0 to 255 where
            one is above 1, else from 0 to 1.

    Raises:
        InputError: It is no colour.
        MissingExtra: It is a name, and matplotlib, which knows the names, is not installed.
    """
    if isinstance(colour, str):
        return _named(colour)
    try:
        values = np.asarray(colour, dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.shape not in ((3,), (4,)) or not np.isfinite(values).all():
        raise InputError(f"`color` is {colour!r}; expected a name, '#rrggbb', or three or four numbers.")
    values = values / 255.0 if values.max() > 1.0 else values
    if values.min() < 0.0 or values.max() > 1.0:
        raise InputError(f"`color` is {colour!r}; expected numbers from 0 to 1, or from 0 to 255.")
    r, g, b, a = (*values.tolist(), 1.0)[:4]
    return r, g, b, a


def _named(name: str) -> RGBA:
    if name.startswith("#") and len(name) in (7, 9):
        try:
            r, g, b, a = (int(name[k : k + 2] or "ff", 16) / 255.0 for k in (1, 3, 5, 7))
        except ValueError:
            raise InputError(f"`color` is {name!r}; expected '#rrggbb' or '#rrggbbaa'.") from None
        return r, g, b, a
    try:
        from matplotlib.colors import to_rgba  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtra("matplotlib", "plot", "Colours by name") from None
    try:
        r, g, b, a = to_rgba(name)
    except ValueError:
        raise InputError(
            f"`color` is {name!r}; expected a colour that matplotlib knows, or '#rrggbb'."
        ) from None
    return float(r), float(g), float(b), float(a)
