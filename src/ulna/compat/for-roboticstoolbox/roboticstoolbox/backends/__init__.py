"""What robots are drawn with: "swift" is Ulna's viewer, "pyplot" and "pyplot2" are matplotlib."""

from __future__ import annotations

import importlib
from typing import Any

from roboticstoolbox._common.errors import UnknownOption
from roboticstoolbox._common.module_aliases import add_module_aliases, name_in

_NAMES = ("swift", "pyplot", "pyplot2")
add_module_aliases(__name__, ())


def load_backend(name: str) -> Any:
    """A backend by its name, ready to be launched.

    Raises:
        UnknownOption: There is none of that name.
    """
    if name not in _NAMES:
        raise UnknownOption("backend", name, _NAMES)
    if name == "swift":
        from swift import Swift

        return Swift()
    from roboticstoolbox._plot.figure import PyPlot, PyPlot2

    return PyPlot() if name == "pyplot" else PyPlot2()


def __getattr__(name: str) -> Any:
    if name in ("ROS", "Dynamixel", "VPython"):
        raise AttributeError(
            f"The backend {name} is not offered; env.step of swift.Swift() drives the viewer, and robot.q is there to "
            "be sent to a real arm."
        )
    if name in ("swift", "PyPlot"):
        return importlib.import_module(f"roboticstoolbox.backends.{name}")
    return name_in(__name__, name)
