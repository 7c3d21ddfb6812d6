"""Curves of joint coordinates and of trajectories over time, in matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongShape, WrongType
from ulna.errors import MissingExtra
from ulna.typing import Floats

_TIME_LABELS = ("$q(t)$", r"$\dot{{q}}(t)$", r"$\ddot{q}(t)$", "t (seconds)")
_STEP_LABELS = ("$q(k)$", "$dq/dk$", "$d^2q/dk^2$", "k (step)")
"""Labels of positions, velocities and accelerations, and of the axis of time."""


def pyplot_of(purpose: str) -> Any:
    """The module matplotlib.pyplot.

    Raises:
        MissingExtra: matplotlib is not installed.
    """
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise MissingExtra("matplotlib", "toolbox", purpose) from None
    return plt


def xplot(
    x: Any,
    y: Any = None,
    wrist: bool = False,
    unwrap: bool = False,
    block: bool | None = False,
    labels: Any = None,
    loc: Any = None,
    grid: bool = True,
    stack: bool = False,
    **options: Any,
) -> Any:
    """Draws coordinates over time, a line each.

    Args:
        x: Times (m,); or the coordinates, where `y` is not passed.
        y: Coordinates, (m,) or (m, n).
        wrist: Whether the last three of six lines are dashed.
        unwrap: Whether jumps by whole turns are taken out.
        block: Whether to wait until the window is closed; None to show nothing.
        labels: Names of the coordinates, a list or text with spaces; "q0" and so on by default.
        loc: Where the legend is, as matplotlib names it.
        grid: Whether there is a grid.
        stack: Whether each coordinate has separate axes.
        **options: Those of matplotlib's `plot`.

    Returns:
        The axes of the figure, a list.

    Raises:
        WrongShape: There are not as many times as rows.
        WrongType: `labels` is neither text nor a list.
    """
    values = np.asarray(x if y is None else y, dtype=float)
    values = values[:, None] if values.ndim == 1 else values
    at = np.arange(len(values), dtype=float) if y is None else np.asarray(x, dtype=float)
    if at.shape != (len(values),):
        raise WrongShape("x", at.shape, f"({len(values)},), a time for each row of the coordinates")
    names = _labels(labels, values.shape[1])
    values = np.unwrap(values, axis=0) if unwrap else values
    plt = pyplot_of("xplot")
    figure, axis = plt.subplots(values.shape[1] if stack else 1, sharex=True, squeeze=False)
    if stack:
        _stacked(axis[:, 0], at, values, names, grid, options)
    else:
        _together(axis[0, 0], at, values, names, wrist, options)
        axis[0, 0].legend(loc=loc)
        axis[0, 0].grid(grid)
    axis[-1, 0].set_xlabel("Time (s)")
    if block is not None:
        plt.show(block=block)
    return figure.get_axes()


def _labels(labels: Any, count: int) -> list[str]:
    if labels is None:
        return [f"q{i}" for i in range(count)]
    if isinstance(labels, str):
        labels = labels.split(" ")
    if not isinstance(labels, (tuple, list)):
        raise WrongType(
            f"`labels` is {type(labels).__name__}; expected text with spaces, or a list of names."
        )
    return list(labels)


def _stacked(axes: Any, at: Floats, values: Floats, names: list[str], grid: bool, options: Any) -> None:
    for axis, column, name in zip(axes, values.T, names, strict=False):
        axis.plot(at, column, **options)
        axis.grid(grid)
        axis.set_ylabel(name)
        axis.set_xlim(at[0], at[-1])


def _together(axis: Any, at: Floats, values: Floats, names: list[str], wrist: bool, options: Any) -> None:
    for i, column in enumerate(values.T):
        dashed = {"linestyle": "--"} if wrist and values.shape[1] == 6 and i > 2 else {}
        axis.plot(at, column, label=names[i] if i < len(names) else None, **{**dashed, **options})
    axis.set_ylabel("Joint coordinates (rad,m)")


def plot_trajectory(trajectory: Any, block: bool | None, plotargs: Any, textargs: Any) -> Any:
    """Draws positions, velocities and accelerations of a trajectory over time.

    Args:
        trajectory: The trajectory.
        block: Whether to wait until the window is closed.
        plotargs: Keywords for Matplotlib's `plot`.
        textargs: Keywords for labels.

    Returns:
        The figure.
    """
    plt = pyplot_of("Trajectory.plot")
    lines = {"marker": "o", "markersize": 3} | (plotargs or {})
    text = {"fontsize": 12} | (textargs or {})
    labels = _TIME_LABELS if trajectory.istime else _STEP_LABELS
    rows = zip(labels, (trajectory.s, trajectory.sd, trajectory.sdd), strict=False)
    rows = [(label, values) for label, values in rows if values is not None]
    figure, axes = plt.subplots(len(rows), sharex=True, squeeze=False)
    for axis, (label, values) in zip(axes[:, 0], rows, strict=True):
        axis.plot(trajectory.t, values, **lines)
        axis.set_ylabel(label, **text)
        axis.set_xlim(trajectory.t[0], trajectory.t[-1])
        axis.grid(True)
    axes[-1, 0].set_xlabel(labels[-1], **text)
    if block:
        plt.show(block=True)
    return figure
