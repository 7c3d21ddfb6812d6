"""Visualizers by the names that scripts know; those that are offered draw into Ulna's viewer."""

from __future__ import annotations

from pinocchio.visualize.base_visualizer import BaseVisualizer as BaseVisualizer
from pinocchio.visualize.gepetto_visualizer import GepettoVisualizer as GepettoVisualizer
from pinocchio.visualize.meshcat_visualizer import MeshcatVisualizer as MeshcatVisualizer
from pinocchio.visualize.unsupported import Panda3dVisualizer as Panda3dVisualizer
from pinocchio.visualize.unsupported import RVizVisualizer as RVizVisualizer
from pinocchio.visualize.viser_visualizer import ViserVisualizer as ViserVisualizer
from pinocchio.visualize.visualizers import Visualizer as Visualizer
