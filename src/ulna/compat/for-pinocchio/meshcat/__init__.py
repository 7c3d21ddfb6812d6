"""MeshCat's tree of named objects, drawn into Ulna's viewer, without a separate server."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meshcat import geometry as geometry
    from meshcat import transformations as transformations
    from meshcat import visualizer as visualizer
    from meshcat.visualizer import Visualizer as Visualizer

__version__ = "0.3.2"
_MODULES = ("geometry", "path", "transformations", "visualizer")

__all__ = ["Visualizer", "geometry", "transformations", "visualizer"]


def __getattr__(name: str) -> Any:
    if name == "Visualizer":
        return importlib.import_module("meshcat.visualizer").Visualizer
    if name in _MODULES:
        return importlib.import_module(f"meshcat.{name}")
    if name == "animation":
        raise AttributeError(
            "MeshCat's animations are not offered: `viz.play(q_trajectory, dt)` moves a robot."
        )
    raise AttributeError(f"module 'meshcat' has no attribute {name!r}; it has {', '.join(__all__)}.")


def __dir__() -> list[str]:
    return sorted({*__all__, *globals()})
