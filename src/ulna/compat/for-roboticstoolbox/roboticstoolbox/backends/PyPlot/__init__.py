"""matplotlib by the toolbox's name."""

from __future__ import annotations

import importlib
from typing import Any

from roboticstoolbox._plot.figure import PyPlot as PyPlot
from roboticstoolbox._plot.figure import PyPlot2 as PyPlot2

__all__ = ["EllipsePlot", "PyPlot", "PyPlot2", "RobotPlot", "RobotPlot2"]
_MODULES = ("EllipsePlot", "RobotPlot", "RobotPlot2")


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f"{__name__}.{name}")


def __dir__() -> list[str]:
    return __all__
