"""Swift's names over Ulna's viewer: a simulator in the browser, with handles, buttons and sliders."""

from __future__ import annotations

from swift.Elements import Button, Checkbox, Label, Radio, Select, Slider, SwiftElement
from swift.Handle import AssemblyHandle
from swift.Swift import Swift
from ulna.compat.missing_names import missing_name as _missing_name

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

_LIGHTS = "The lights are those of the viewer's theme: `env.viewer.theme = 'dark'`, or an ulna.viewer.Theme."
_SERVER = "The page is served by ulna.Viewer: `env.viewer.url` is its address."
_ALTERNATIVES = {
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
    "phys": "Robots are stepped by `env.step`, and by ulna.sim.kinematic_step.",
}


def __getattr__(name: str) -> object:
    hint = _ALTERNATIVES.get(name, f"There are: {', '.join(__all__)}.")
    raise _missing_name(__name__, name, f"Ulna's package for Swift has no {name!r}. {hint}")
