"""The panel beside the scene: controls, plots, a robot's teach panel and the time line."""

from ulna.viewer.panel.panel import Panel as Panel
