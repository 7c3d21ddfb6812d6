"""The face of Swift over Ulna's viewer: a simulator in the browser, with handles, buttons and sliders."""

from __future__ import annotations

from swift._choices import Checkbox as Checkbox
from swift._choices import Radio as Radio
from swift._choices import Select as Select
from swift._element import SwiftElement as SwiftElement
from swift._elements import Button as Button
from swift._elements import Label as Label
from swift._elements import Slider as Slider
from swift._handles import AssemblyHandle as AssemblyHandle
from swift._swift import Swift as Swift

__version__ = "2.1"
"""The version of Swift whose names these are."""

__all__ = [
    "AssemblyHandle",
    "Button",
    "Checkbox",
    "Label",
    "Radio",
    "Select",
    "Slider",
    "Swift",
    "SwiftElement",
]

_LIGHTS = "The lamps are those of the viewer's theme: `env.viewer.theme = 'dark'`, or one of ulna.viewer.theme.Theme."
_SERVER = "The page is served by ulna.Viewer: `env.viewer.url` is its address."
_INSTEAD = {
    "Light": _LIGHTS,
    "AmbientLight": _LIGHTS,
    "HemisphereLight": _LIGHTS,
    "DirectionalLight": _LIGHTS,
    "PointLight": _LIGHTS,
    "SpotLight": _LIGHTS,
    "SwiftServer": _SERVER,
    "SwiftSocket": _SERVER,
    "start_servers": _SERVER,
    "SwiftRoute": _SERVER,
    "phys": "Robots are stepped by ulna.sim: see ulna.sim.kinematic_step.",
}


def __getattr__(name: str) -> object:
    word = _INSTEAD.get(name, f"There are: {', '.join(__all__)}.")
    raise AttributeError(f"Ulna's face of Swift has no {name!r}. {word}")
