"""Colours as people write them: names of CSS and matplotlib, hexadecimal, numbers from 0 to 1, integers to 255."""

from __future__ import annotations

import string
from collections.abc import Iterable
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import fraction, short_repr
from ulna.errors import InputError, UnknownName
from ulna.typing import ArrayLike, Floats

RGB = tuple[float, float, float]
"""Red, green, blue (sRGB), each from 0 to 1."""

RGBA = tuple[float, float, float, float]
"""Red, green, blue (sRGB) and opacity, each from 0 to 1."""

_ROUNDING = 1e-6  # what arithmetic leaves beyond 0 and 1

Colour = str | Iterable[float]
"""What `colour` understands."""

_CSS = """
aliceblue f0f8ff, antiquewhite faebd7, aqua 00ffff, aquamarine 7fffd4, azure f0ffff, beige f5f5dc, bisque
ffe4c4, black 000000, blanchedalmond ffebcd, blue 0000ff, blueviolet 8a2be2, brown a52a2a, burlywood deb887,
cadetblue 5f9ea0, chartreuse 7fff00, chocolate d2691e, coral ff7f50, cornflowerblue 6495ed, cornsilk fff8dc,
crimson dc143c, cyan 00ffff, darkblue 00008b, darkcyan 008b8b, darkgoldenrod b8860b, darkgray a9a9a9,
darkgreen 006400, darkgrey a9a9a9, darkkhaki bdb76b, darkmagenta 8b008b, darkolivegreen 556b2f, darkorange
ff8c00, darkorchid 9932cc, darkred 8b0000, darksalmon e9967a, darkseagreen 8fbc8f, darkslateblue 483d8b,
darkslategray 2f4f4f, darkslategrey 2f4f4f, darkturquoise 00ced1, darkviolet 9400d3, deeppink ff1493,
deepskyblue 00bfff, dimgray 696969, dimgrey 696969, dodgerblue 1e90ff, firebrick b22222, floralwhite fffaf0,
forestgreen 228b22, fuchsia ff00ff, gainsboro dcdcdc, ghostwhite f8f8ff, gold ffd700, goldenrod daa520, gray
808080, green 008000, greenyellow adff2f, grey 808080, honeydew f0fff0, hotpink ff69b4, indianred cd5c5c,
indigo 4b0082, ivory fffff0, khaki f0e68c, lavender e6e6fa, lavenderblush fff0f5, lawngreen 7cfc00,
lemonchiffon fffacd, lightblue add8e6, lightcoral f08080, lightcyan e0ffff, lightgoldenrodyellow fafad2,
lightgray d3d3d3, lightgreen 90ee90, lightgrey d3d3d3, lightpink ffb6c1, lightsalmon ffa07a, lightseagreen
20b2aa, lightskyblue 87cefa, lightslategray 778899, lightslategrey 778899, lightsteelblue b0c4de,
lightyellow ffffe0, lime 00ff00, limegreen 32cd32, linen faf0e6, magenta ff00ff, maroon 800000,
mediumaquamarine 66cdaa, mediumblue 0000cd, mediumorchid ba55d3, mediumpurple 9370db, mediumseagreen 3cb371,
mediumslateblue 7b68ee, mediumspringgreen 00fa9a, mediumturquoise 48d1cc, mediumvioletred c71585,
midnightblue 191970, mintcream f5fffa, mistyrose ffe4e1, moccasin ffe4b5, navajowhite ffdead, navy 000080,
oldlace fdf5e6, olive 808000, olivedrab 6b8e23, orange ffa500, orangered ff4500, orchid da70d6,
palegoldenrod eee8aa, palegreen 98fb98, paleturquoise afeeee, palevioletred db7093, papayawhip ffefd5,
peachpuff ffdab9, peru cd853f, pink ffc0cb, plum dda0dd, powderblue b0e0e6, purple 800080, rebeccapurple
663399, red ff0000, rosybrown bc8f8f, royalblue 4169e1, saddlebrown 8b4513, salmon fa8072, sandybrown
f4a460, seagreen 2e8b57, seashell fff5ee, sienna a0522d, silver c0c0c0, skyblue 87ceeb, slateblue 6a5acd,
slategray 708090, slategrey 708090, snow fffafa, springgreen 00ff7f, steelblue 4682b4, tan d2b48c, teal
008080, thistle d8bfd8, tomato ff6347, turquoise 40e0d0, violet ee82ee, wheat f5deb3, white ffffff,
whitesmoke f5f5f5, yellow ffff00, yellowgreen 9acd32
"""
"""Names and values of the CSS Color Module, level 4."""

_MATPLOTLIB = """
r ff0000, g 008000, b 0000ff, c 00bfbf, m bf00bf, y bfbf00, k 000000, w ffffff, tab:blue 1f77b4, tab:orange
ff7f0e, tab:green 2ca02c, tab:red d62728, tab:purple 9467bd, tab:brown 8c564b, tab:pink e377c2, tab:gray
7f7f7f, tab:grey 7f7f7f, tab:olive bcbd22, tab:cyan 17becf, c0 1f77b4, c1 ff7f0e, c2 2ca02c, c3 d62728, c4
9467bd, c5 8c564b, c6 e377c2, c7 7f7f7f, c8 bcbd22, c9 17becf
"""
"""Names that matplotlib has besides: its letters, and the colours of its lines."""

NAMES, _MATPLOTLIB_NAMES = (
    {name: digits for name, digits in (pair.split() for pair in text.split(","))}
    for text in (_CSS, _MATPLOTLIB)
)

_RANGE_HINT = "Numbers from 0 to 255 are divided by 255, or given as integers, one of them above 1."


def colour(value: Colour) -> RGBA:
    """Red, green, blue and opacity within 0..1.

    Args:
        value: A name of CSS ("tomato") or of matplotlib ("r", "C0", "tab:blue"), "#rrggbb", "#rrggbbaa" or "#rgb", or
            three or four numbers from 0 to 1, or integers from 0 to 255 of which one is above 1; three are opaque.

    Raises:
        UnknownName: If there is no colour of that name; offers the nearest.
        InputError: If it is no colour at all.
    """
    rgb, opacity = colour_parts(value)
    return (*rgb, 1.0 if opacity is None else opacity)


def colour_parts(value: Colour) -> tuple[RGB, float | None]:
    """Red, green, blue, and the opacity where it is stated: by a fourth number, or the last digits of "#rrggbbaa".

    Args:
        value: As for `colour`.

    Raises:
        UnknownName, InputError: It is no colour.
    """
    if isinstance(value, str):
        return _parsed(value)
    try:
        components = np.asarray(value if isinstance(value, np.ndarray) else list(value))
    except (TypeError, ValueError):
        components = np.zeros(0)
    if (
        components.shape not in ((3,), (4,))
        or components.dtype.kind not in "fiu"
        or not np.isfinite(components).all()
    ):
        raise InputError(
            "A colour is a name, '#rrggbb', or 3 or 4 finite numbers from 0 to 1 (red, green, blue, opacity); "
            f"got {short_repr(value)}."
        )
    r, g, b, *a = colour_values("color", components).tolist()
    return (r, g, b), a[0] if a else None


def faded(color: Colour | None, opacity: float) -> tuple[RGB | None, float]:
    """A colour without its opacity, and the product of both opacities.

    Args:
        color: As for `colour`; None for the colours that a thing has.
        opacity: Another opacity, from 0 to 1 [-].

    Returns:
        Red, green, blue, or None, and the opacity.

    Raises:
        UnknownName, InputError: One of them is none.
    """
    rgb, own = (None, None) if color is None else colour_parts(color)
    return rgb, _product(own, opacity)


def faded_colours(colors: Any, opacity: float) -> tuple[Any, float]:
    """As `faded`, for one colour, rows (n, 3), or None.

    Args:
        colors: As for `colours_parts`.
        opacity: Another opacity, from 0 to 1 [-].

    Returns:
        The colours, and the opacity.
    """
    rgb, own = colours_parts(colors)
    return rgb, _product(own, opacity)


def _product(own: float | None, opacity: float) -> float:
    return fraction("opacity", opacity) * (1.0 if own is None else own)


def colours_parts(colors: Any) -> tuple[Any, float | None]:
    """As `colour_parts`; rows (n, 3) and None remain as they are, without an opacity.

    Args:
        colors: One colour, or rows (n, 3), or None.

    Raises:
        UnknownName, InputError, NonFiniteError: They are none.
    """
    if colors is None or (not isinstance(colors, str) and finite_array("colors", colors).shape != (4,)):
        return colors, None
    return colour_parts(colors)


def colour_values(name: str, value: ArrayLike) -> Floats:
    """Numbers from 0 to 1, from such, or from integers that go up to 255.

    Args:
        name: Name of the argument, for messages.
        value: Numbers (...) from 0 to 1, or integers from 0 to 255.

    Returns:
        Numbers (...) from 0 to 1.

    Raises:
        InputError, NonFiniteError: They are none.
        InputError: They are out of range.
        NonFiniteError: nan or inf.
    """
    out = finite_array(name, value)
    raw = np.asarray(value)
    if out.size and raw.dtype.kind in "iu" and (raw.dtype == np.uint8 or out.max() > 1.0):
        out = out / 255.0
    if out.size and not (out.min() >= -_ROUNDING and out.max() <= 1.0 + _ROUNDING):
        raise InputError(f"`{name}` is {short_repr(value)}; expected numbers from 0 to 1. {_RANGE_HINT}")
    return np.clip(out, 0.0, 1.0)


def _parsed(text: str) -> tuple[RGB, float | None]:
    name = text.replace(" ", "").lower()
    digits = NAMES.get(name) or _MATPLOTLIB_NAMES.get(name) or (text[1:] if text.startswith("#") else "")
    if len(digits) in (3, 4):
        digits = "".join(2 * d for d in digits)
    if len(digits) not in (6, 8) or not set(digits) <= set(string.hexdigits):
        raise UnknownName("colour", text, NAMES, "Or '#rrggbb', or three numbers from 0 to 1.")
    r, g, b, *a = (int(digits[k : k + 2], 16) / 255.0 for k in range(0, len(digits), 2))
    return (r, g, b), a[0] if a else None
