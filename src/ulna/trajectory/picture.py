"""Draws trajectories over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import needed
from ulna.system.figures import displayed
from ulna.system.storage import save_figure
from ulna.trajectory.space import Poses
from ulna.trajectory.trajectory import Trajectory, register_operation


def plot(trajectory: Trajectory, path: str | Path | None = None, samples: int = 500) -> Any:
    """Point, velocity and acceleration over time, one line a joint; knots as thin lines when they are few.

    Args:
        trajectory: What to draw; of a pose, the origin is drawn and the rates of all six directions.
        path: Where to save the picture (.png, .svg, .pdf); None only makes it.
        samples: How many times to look at, besides the knots.

    Returns:
        A `matplotlib.figure.Figure`, which a notebook displays.

    Raises:
        MissingExtra: Matplotlib is not installed.
    """
    with needed("matplotlib", "plot", "Plotting a trajectory"):
        from matplotlib.figure import Figure  # pyright: ignore[reportMissingImports]
    t = trajectory.instants(samples)
    q, v, a = trajectory.state(t)
    names = list(trajectory.space.names)
    poses = isinstance(trajectory.space, Poses)
    points = q[:, :3, 3] if poses else q
    labels = names[:3] if poses else list(trajectory.space.columns)
    titles = ("position [m]" if poses else "position [rad or m]", "velocity [1/s]", "acceleration [1/s^2]")
    figure = displayed(Figure(figsize=(8.0, 7.5), layout="constrained"))
    panels = figure.subplots(3, 1, sharex=True)
    for panel, rows, which, title in zip(panels, (points, v, a), (labels, names, names), titles, strict=True):
        for column, name in zip(np.atleast_2d(rows.T), which, strict=True):
            panel.plot(t, column, linewidth=1.4, label=name)
        panel.set_ylabel(title)
        panel.grid(alpha=0.3)
        for knot in trajectory.knots if len(trajectory.knots) <= 40 else ():
            panel.axvline(knot, color="0.85", linewidth=0.6, zorder=0)
    if len(names) <= 16:
        panels[1].legend(loc="upper right", ncols=2, fontsize="small")
    panels[0].set_title(repr(trajectory).strip("<>"))
    panels[-1].set_xlabel("time [s]")
    if path is not None:
        save_figure(figure, path)
    return figure


register_operation("plot", plot)
