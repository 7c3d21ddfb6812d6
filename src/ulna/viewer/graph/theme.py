"""Themes: colours of background, floor and text, and light intensities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ulna.checks.arrays import shaped_array
from ulna.checks.former_names import former_fields
from ulna.checks.values import flag, fraction, number, one_of
from ulna.errors import InputError

RGB = tuple[int, int, int]


@final
@former_fields(ink="text", lamps="light_factor", room="environment_intensity")
@dataclass(frozen=True)
class Theme:
    """Colours of background, floor and text, from 0 to 255, and the intensities of the lights.

    Args:
        dark: Whether panels are dark.
        top: The sky above.
        horizon: The sky where it meets the floor.
        floor: The floor.
        section: Lines of the floor every metre.
        cell: Lines of the floor every tenth of a metre.
        text: Labels.
        light_factor: Factor of the intensities of the lights; 1 in the light theme.
        environment_intensity: Intensity of the environment map.
        shadow: How dark shadows on the floor are, from 0 to 1.
    """

    dark: bool = False
    top: RGB = (142, 163, 187)
    horizon: RGB = (217, 225, 233)
    floor: RGB = (180, 190, 201)
    section: RGB = (141, 152, 166)
    cell: RGB = (169, 179, 191)
    text: RGB = (30, 41, 59)
    light_factor: float = 1.0
    environment_intensity: float = 0.30
    shadow: float = 0.42

    def __post_init__(self) -> None:
        flag("dark", self.dark)
        for name in ("top", "horizon", "floor", "section", "cell", "text"):
            rgb = shaped_array(name, getattr(self, name), 3)
            if rgb.min() < 0.0 or rgb.max() > 255.0 or (rgb % 1.0).any():
                raise InputError(f"`{name}` is {getattr(self, name)}; expected three integers from 0 to 255.")
        for name in ("light_factor", "environment_intensity"):
            number(name, getattr(self, name), "a strength from 0 to 100", least=0.0, most=100.0)
        fraction("shadow", self.shadow)


LIGHT = Theme()
DARK = Theme(
    dark=True,
    top=(13, 17, 24),
    horizon=(38, 46, 58),
    floor=(30, 36, 45),
    section=(74, 86, 104),
    cell=(46, 54, 66),
    text=(226, 232, 240),
    light_factor=0.85,
    environment_intensity=0.22,
    shadow=0.55,
)
_THEMES = {"light": LIGHT, "dark": DARK}


def theme_of(value: Theme | str) -> Theme:
    """A theme, or the one of that name.

    Raises:
        UnknownName: There is no theme of that name.
    """
    if isinstance(value, Theme):
        return value
    return _THEMES[one_of("theme", value, _THEMES)]
