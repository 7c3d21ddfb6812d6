"""Visualizers by the names that scripts know; all of them draw into Ulna's viewer."""

from __future__ import annotations

import os

from pinocchio.visualize.base_visualizer import BaseVisualizer as BaseVisualizer
from pinocchio.visualize.gepetto_visualizer import GepettoVisualizer as GepettoVisualizer
from pinocchio.visualize.meshcat_visualizer import MeshcatVisualizer as MeshcatVisualizer
from pinocchio.visualize.viser_visualizer import ViserVisualizer as ViserVisualizer
from ulna.errors import UnknownName

_NAMED = {"gepetto": GepettoVisualizer, "meshcat": MeshcatVisualizer, "viser": ViserVisualizer}


class Visualizer(BaseVisualizer):
    """Which of the visualizers is the default one."""

    @staticmethod
    def default() -> type[BaseVisualizer]:
        """What PINOCCHIO_VIEWER in the environment names, and else Gepetto's, which has most calls."""
        name = os.environ.get("PINOCCHIO_VIEWER") or "gepetto"
        if name not in _NAMED:
            raise UnknownName("visualizer", name, _NAMED, "PINOCCHIO_VIEWER in the environment names it.")
        return _NAMED[name]
