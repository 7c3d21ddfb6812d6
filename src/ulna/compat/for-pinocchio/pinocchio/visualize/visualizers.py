"""The visualizers by name, and the default one."""

from __future__ import annotations

import os
from enum import Enum

from pinocchio.visualize.base_visualizer import BaseVisualizer
from pinocchio.visualize.gepetto_visualizer import GepettoVisualizer
from pinocchio.visualize.meshcat_visualizer import MeshcatVisualizer
from pinocchio.visualize.unsupported import Panda3dVisualizer, RVizVisualizer
from pinocchio.visualize.viser_visualizer import ViserVisualizer
from ulna.errors import UnknownName


class Visualizer(Enum):
    """Which visualizers there are."""

    BASE = BaseVisualizer
    GEPETTO = GepettoVisualizer
    MESHCAT = MeshcatVisualizer
    PANDA3D = Panda3dVisualizer
    RVIZ = RVizVisualizer
    VISER = ViserVisualizer

    @classmethod
    def default(cls) -> type[BaseVisualizer]:
        """What PINOCCHIO_VIEWER in the environment names, and else Gepetto's, which has most calls.

        Raises:
            UnknownName: PINOCCHIO_VIEWER names none.
        """
        name = os.environ.get("PINOCCHIO_VIEWER") or "gepetto"
        if name.upper() not in cls.__members__:
            known = [member.lower() for member in cls.__members__]
            raise UnknownName("visualizer", name, known, "PINOCCHIO_VIEWER in the environment names it.")
        return cls[name.upper()].value
