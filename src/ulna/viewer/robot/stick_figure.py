"""Stick figures of robots in matplotlib plots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import checked_robot, flag, fraction, short_repr
from ulna.errors import InputError, needed
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour, faded
from ulna.viewer.robot.configuration import checked_configuration

_LINK_COLOUR, _JOINT_COLOUR, _SHADOW_COLOUR = "#33518f", "#e08a1e", "#00000022"
_AXIS_COLOURS = ("#db3338", "#33a847", "#2963eb")


def stick_figure(
    robot: Any,
    q: ArrayLike | None = None,
    ax: Any = None,
    *,
    frames: Sequence[str] = (),
    tool: bool = True,
    color: Colour = _LINK_COLOUR,
    alpha: float = 1.0,
    shadow: bool = True,
) -> Any:
    """Draw a robot as a stick figure.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration (nq,) [rad or m], neutral by default; (n, nq) for several, the last one in full colour.
        ax: Axes of matplotlib in three dimensions; new ones when not given.
        frames: Frames to draw as three short arrows.
        tool: Whether to draw the tool's frame.
        color: Colour of the links.
        alpha: Opacity, from 0 to 1 [-].
        shadow: Whether to draw the figure on the floor, too.

    Returns:
        The axes, with equal scales.

    Raises:
        MissingExtra: matplotlib is not installed.
        ShapeError, NonFiniteError, UnknownName: An argument does not fit the robot.
        InputError: The axes are not three-dimensional, or an option is out of range.
    """
    configurations = _configurations(checked_robot(robot), q)
    if not isinstance(frames, list | tuple) or not all(isinstance(f, str) for f in frames):
        raise InputError(f"`frames` is {short_repr(frames)}; expected a list of names of frames.")
    link_colour, alpha = faded(color, fraction("alpha", alpha))
    if ax is not None and getattr(ax, "name", "") != "3d":
        raise InputError(
            f"`ax` is {short_repr(ax)}; expected axes of matplotlib in three dimensions (projection='3d')."
        )
    flag("tool", tool)
    flag("shadow", shadow)
    pairs = _connected_links(robot)
    extra = [*frames, robot.tool] if tool else list(frames)
    poses = np.asarray(robot.fk(configurations[-1], list(extra))) if extra else np.zeros((0, 4, 4))
    ax = _new_axes() if ax is None else ax
    everything = [np.zeros((1, 3))]
    for k, configuration in enumerate(configurations):
        last = k == len(configurations) - 1
        strength = alpha if last else 0.25 * alpha
        segments = _segments(robot, configuration, pairs)
        everything.append(segments.reshape(-1, 3))
        for a, b in segments:
            ax.plot(*np.stack([a, b]).T, color=link_colour, lw=3.5, alpha=strength, solid_capstyle="round")
            if shadow and last:
                ax.plot([a[0], b[0]], [a[1], b[1]], [0, 0], color=_SHADOW_COLOUR, lw=3)
        joints = _joints(robot, configuration)
        ax.scatter(*joints.T, color=_JOINT_COLOUR, s=32, alpha=strength, depthshade=False, zorder=5)
        everything.append(joints)
    _show_all(ax, np.concatenate(everything), poses)
    return ax


def _new_axes() -> Any:
    with needed("matplotlib", "plot", "Drawing stick figures"):
        import matplotlib.pyplot as plt
    return plt.figure(figsize=(6, 6)).add_subplot(projection="3d")


def _show_all(ax: Any, points: Floats, frames: Floats) -> None:
    """Scales the axes to show points (n, 3), and draws frames (k, 4, 4) in proportion."""
    reach = float(np.ptp(points, axis=0).max()) or 1.0
    for T in frames:
        for axis in range(3):
            tip = T[:3, 3] + 0.1 * reach * T[:3, axis]
            ax.plot(*np.stack([T[:3, 3], tip]).T, color=_AXIS_COLOURS[axis], lw=2)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    for axis, centre in zip("xyz", middle, strict=True):
        getattr(ax, f"set_{axis}lim")(centre - 0.6 * reach, centre + 0.6 * reach)
    ax.set_box_aspect((1, 1, 1))


def _configurations(robot: Any, q: ArrayLike | None) -> list[Floats]:
    if q is None:
        return [np.array(robot.neutral)]
    many = finite_array("q", q)
    if many.ndim == 2 and len(many):
        return [checked_configuration(robot, one) for one in many]
    return [checked_configuration(robot, many)]


def _connected_links(robot: Any) -> list[tuple[int, int]]:
    """Pairs of numbers of links that are joined."""
    number = {link.name: k for k, link in enumerate(robot.model.links)}
    return [(number[link.parent], k) for k, link in enumerate(robot.model.links) if link.parent is not None]


def _segments(robot: Any, q: Floats, pairs: list[tuple[int, int]]) -> Floats:
    """Both ends of each stick in the world [m], shape (n, 2, 3); links at one place are left out."""
    origins = np.asarray(robot.link_poses(q))[:, :3, 3]
    out = np.array([(origins[a], origins[b]) for a, b in pairs]).reshape(-1, 2, 3)
    return out[np.linalg.norm(out[:, 1] - out[:, 0], axis=1) > 1e-9]


def _joints(robot: Any, q: Floats) -> Floats:
    """Where the movable joints are in the world [m], shape (n, 3)."""
    poses = np.asarray(robot.link_poses(q))
    number = {link.name: k for k, link in enumerate(robot.model.links)}
    moved = [number[joint.child_link] for joint in robot.model.joints]
    back = [robot.model.links[k].offset.inverse().matrix() for k in moved]
    return np.array([(poses[k] @ T)[:3, 3] for k, T in zip(moved, back, strict=True)]).reshape(-1, 3)
