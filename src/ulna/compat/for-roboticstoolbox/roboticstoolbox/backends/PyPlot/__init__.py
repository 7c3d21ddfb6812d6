"""matplotlib by the toolbox's name."""

from __future__ import annotations

from roboticstoolbox._plot.figure import PyPlot as PyPlot
from roboticstoolbox._plot.figure import PyPlot2 as PyPlot2

__all__ = ["PyPlot", "PyPlot2"]
