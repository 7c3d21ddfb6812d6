"""Coordinates of a configuration that sliders set: joint coordinates, and roll, pitch, yaw of rotations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.spatial import SE3, matrix_to_rpy, quat_xyzw_to_matrix
from ulna.typing import Floats


@final
@dataclass(frozen=True)
class SliderCoordinate:
    """One number of a configuration that a slider sets.

    `read` returns its value in a configuration; `write` returns the configuration with another value of it.

    Attributes:
        label: The joint's name, shortened, and the unit.
        hint: The joint, its kind and its range, as text.
        low: Least value [rad or m].
        high: Greatest value [rad or m].
        step: Width of a step of the slider [rad or m].
        joint: Index of the joint.
        index: Its entry in q, or the first entry of the quaternion.
        part: 0, 1 or 2 where it is roll, pitch or yaw of the quaternion; None where it is the entry itself.
        unit: "rad" or "m".
        bounded: Whether the joint has both limits.
    """

    label: str
    hint: str
    low: float
    high: float
    step: float
    joint: int
    index: int
    part: int | None
    unit: str
    bounded: bool
    read: Callable[[Floats], float]
    write: Callable[[Floats, float], Floats]


def slider_coordinates(robot: Any) -> list[SliderCoordinate]:
    """The numbers of a robot's configuration that sliders can set: coordinates, and angles for rotations."""
    out, model = [], robot.model
    for number, joint in enumerate(model.joints):
        if joint.mimic is not None:
            continue
        short, entries = _without_common_prefix(joint.name, robot.joint_names), joint.kind.coordinates
        k = 0
        while k < len(entries):
            i = joint.idx_q + k
            if entries[k].unit == "":  # a quaternion, four entries
                out += [_angle(short, joint, number, i, axis) for axis in range(3)]
                k += 4
            else:
                label = short if len(entries) == 1 else f"{short} {entries[k].name}"
                out.append(_coordinate(label, joint, number, i, entries[k].unit, model))
                k += 1
    return out


def _coordinate(label: str, joint: Any, number: int, i: int, unit: str, model: Any) -> SliderCoordinate:
    turning = unit == "rad"
    free = np.pi if turning else 1.0
    lower, upper = float(model.lower_position[i]), float(model.upper_position[i])
    bounded = np.isfinite(lower) and np.isfinite(upper)
    low, high = (lower if np.isfinite(lower) else -free), (upper if np.isfinite(upper) else free)
    if turning and bounded:
        span = f"{np.rad2deg(low):.0f}° to {np.rad2deg(high):.0f}°"
    else:
        span = f"{low:.3g} to {high:.3g} {unit}" if bounded else "no limits"
    step = 0.001 if high - low > 0.2 else max((high - low) / 500, 1e-6)
    if high - low < 1e-9:
        high = low + 1e-6

    def write(q: Floats, value: float) -> Floats:
        q = q.copy()
        q[i] = np.clip(
            value, lower, upper
        )  # the slider's steps do not end on the limits; the robot's numbers do
        return q

    hint = f"{joint.name} ({joint.kind.describe()}), {span}"
    place = number, i, None, unit, bool(bounded)
    return SliderCoordinate(f"{label} [{unit}]", hint, low, high, step, *place, lambda q: float(q[i]), write)


def _angle(label: str, joint: Any, number: int, i: int, axis: int) -> SliderCoordinate:
    name = ("roll", "pitch", "yaw")[axis]
    reach = np.pi / 2 if axis == 1 else np.pi

    def rpy(q: Floats) -> Floats:
        return np.asarray(matrix_to_rpy(quat_xyzw_to_matrix(q[i : i + 4])), dtype=float)

    def write(q: Floats, value: float) -> Floats:
        q, angles = q.copy(), rpy(q)
        angles[axis] = value
        q[i : i + 4] = SE3.from_rpy(angles).quat_xyzw()
        return q

    hint = f"{joint.name} ({joint.kind.describe()}), {name} of its rotation"
    place = number, i, axis, "rad", False
    return SliderCoordinate(
        f"{label} {name} [rad]", hint, -reach, reach, 0.001, *place, lambda q: float(rpy(q)[axis]), write
    )


def _without_common_prefix(name: str, names: tuple[str, ...]) -> str:
    """A joint's name without what all joints' names begin with."""
    if len(names) < 2:
        return name
    first, last = min(names), max(names)
    common = 0
    while common < min(len(first), len(last)) and first[common] == last[common]:
        common += 1
    cut = name.rfind("_", 0, common) + 1  # whole words only
    return name[cut:] or name
