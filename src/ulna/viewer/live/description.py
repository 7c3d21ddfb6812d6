"""The description of a robot for its page: links, sliders, frames to drag, configurations, bounds, as plain data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Floats
from ulna.viewer.live.draggable import DraggableFrame
from ulna.viewer.robot.slider_coordinates import SliderCoordinate, slider_coordinates


def description(robot: Any, frames: Sequence[DraggableFrame], start: Floats, title: str) -> dict[str, Any]:
    """What a page must know of a robot besides its meshes and its code.

    Args:
        robot: The robot.
        frames: The frames to drag.
        start: Configuration the page begins with, (nq,) [rad or m].
        title: The title.

    Returns:
        Numbers, texts and lists that JSON can hold.
    """
    model: Model = robot.model
    groups = _groups(model)
    return {
        "name": model.name,
        "title": title,
        "nq": model.nq,
        "joints": sum(j.mimic is None for j in model.joints),
        "links": list(model.link_names),
        "start": start.tolist(),
        "quaternions": [entries[0] for entries in model.quaternions],
        "configurations": {name: np.asarray(q).tolist() for name, q in robot.configurations.items()},
        "sliders": [_slider(model, s, groups) for s in slider_coordinates(robot)],
        "frames": [_frame(model, f) for f in frames],
    }


def _frame(model: Model, draggable: DraggableFrame) -> dict[str, Any]:
    frame = draggable.frame
    return {
        "name": frame.name,
        "link": model.link_index(frame.link),
        "offset": _numbers(frame.origin),
        "turns": draggable.turns,
        "moves": [model.joints[j].idx_q for j in draggable.joints],
    }


def _slider(model: Model, slider: SliderCoordinate, groups: Sequence[str]) -> dict[str, Any]:
    joint = model.joints[slider.joint]
    link = model.link(joint.child_link)
    axis = getattr(joint.kind, "axis", None)
    turns = slider.unit == "rad"
    label = slider.label.removesuffix(f" [{slider.unit}]")
    group = groups[slider.joint]
    prefix = group.partition(":")[0].replace(" ", "_")
    return {
        "label": label.removeprefix(f"{prefix}_").removesuffix("_joint") or label,
        "hint": slider.hint,
        "group": group,
        "low": slider.low,
        "high": slider.high,
        "bounded": slider.bounded,
        "angle": turns,
        "index": slider.index,
        "part": -1 if slider.part is None else slider.part,
        "turns": turns,
        "axis": None if axis is None or slider.part is not None else list(axis),
        "link": model.link_index(link.name),
        "place": _numbers(link.offset.inverse()),
    }


def _groups(model: Model) -> list[str]:
    """A heading for each joint: the words that the joints of its unbranched row have in common, and their ends."""
    first: list[int] = []  # the joint that begins each joint's row
    for k, joint in enumerate(model.joints):
        alone = joint.parent >= 0 and len(model.children(joint.parent)) == 1
        first.append(first[joint.parent] if alone else k)
    names = [_words(joint.name) for joint in model.joints]
    return [
        _heading([names[j] for j in range(len(names)) if first[j] == first[k]]) for k in range(len(names))
    ]


def _words(name: str) -> list[str]:
    words = name.replace("-", "_").split("_")
    return words[:-1] if len(words) > 1 and words[-1] == "joint" else words


def _heading(names: Sequence[list[str]]) -> str:
    """One for joints in a row, of which each is a list of words: `left: shoulder to wrist`."""
    begin, end = names[0], names[-1]
    shared = [a for k, a in enumerate(begin) if all(n[: k + 1] == begin[: k + 1] for n in names)]
    rest = [n[len(shared)] if len(n) > len(shared) else "" for n in (begin, end)]
    if len(names) == 1 or not all(rest):
        return " ".join(shared) or begin[0]
    ends = " to ".join(dict.fromkeys(rest))
    return f"{' '.join(shared)}: {ends}" if shared else ends


def bounds(points: Floats, floor: float) -> dict[str, Any]:
    """The box that a camera shows, and the height of the floor.

    Args:
        points: Points of the robot, (n, 3) [m].
        floor: Height of the floor [m].

    Returns:
        The box and the floor [m].
    """
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (-np.ones(3), np.ones(3))
    return {"min": _short(low), "max": _short(high), "floor": float(floor)}


def grid_step(points: Floats) -> float:
    """Width of the grid that vertices are rounded to [m]: a twenty thousandth of the robot's size."""
    size = float(np.ptp(points, axis=0).max()) if len(points) else 1.0
    return math.ldexp(1.0, round(math.log2(max(size, 1e-3) / 20_000.0)))


def _short(values: Floats) -> list[float]:
    return [round(float(x), 5) for x in values]


def _numbers(T: SE3) -> list[float]:
    return [float(x) for x in np.asarray(T.matrix(), dtype=float).reshape(-1)]
