"""Checks of joints: limits in degrees, joints that cannot move, limits of thousands of turns, drives without power."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ulna.diagnosis.finding import Finding
from ulna.model import Model
from ulna.model.parts import Joint

_TWO_TURNS = 4.0 * math.pi
"""Beyond two turns either way, a limit in radians is rare, and one in degrees common [rad]."""

_MANY_TURNS = 1000.0
"""Beyond this it is neither: such limits stand for none [rad]."""

_FAST = 100.0
"""Few joints turn faster; 90 to 360 degrees a second are common [rad/s]."""

_LEAVES = 4
"""How many leaf links a note names."""

_MAX_USUAL_TRAVEL = 20.0
"""No slide is longer; in millimetres many are [m]."""

_MANY_METRES = 1e5
"""Beyond this it is neither: such limits stand for none [m]."""


def joint_findings(model: Model) -> Iterator[Finding]:
    """Findings about the joints of a model."""
    for joint in model.joints:
        if joint.kind.nq == 1 and joint.kind.nv == 1:
            yield from _single_axis_findings(joint)
    links, joints = set(model.link_names), {joint.name for joint in model.joints}
    for name in sorted(links & joints):
        yield Finding(
            "note",
            "shared-name",
            f"{name!r}",
            "a link and a joint have this name",
            'Asked for by name, the frame is that of the link; the frame of the joint is "joint:NAME".',
        )
    yield from _neutral_findings(model)
    yield from _tool_findings(model)


def _tool_findings(model: Model) -> Iterator[Finding]:
    """A note where other joints move other leaf links than the tool, which may be one finger of a gripper."""
    parents = {link.parent for link in model.links}
    leaves = {link.name: link.joint for link in model.links if link.name not in parents}
    carrier = leaves.get(model.tool)
    others = [name for name, joint in leaves.items() if joint not in (carrier, model.links[0].joint)]
    if carrier is None or not others:
        return
    shown = ", ".join(map(repr, others[:_LEAVES])) + (", ..." if len(others) > _LEAVES else "")
    yield Finding(
        "note",
        "several-tools",
        f"tool {model.tool!r}",
        f"it is one of several leaf links that joints move; others are {shown}",
        "Choose the frame you mean: ulna.load(..., tool=NAME) or robot.with_tool(NAME).",
    )


def _single_axis_findings(joint: Joint) -> Iterator[Finding]:
    name = f"joint {joint.name!r}"
    is_rotary = type(joint.kind).__name__ in ("Revolute", "Continuous")
    yield from _range_findings(joint, name, is_rotary)
    if joint.mimic is None:
        yield from _drive_findings(name, joint.limits.velocity[0], joint.limits.effort[0], is_rotary)


def _range_findings(joint: Joint, name: str, is_rotary: bool) -> Iterator[Finding]:
    lower, upper = joint.limits.lower[0], joint.limits.upper[0]
    kind = type(joint.kind).__name__
    is_sliding = kind == "Prismatic"
    if lower == upper:
        yield Finding(
            "warning",
            "stuck",
            name,
            f"it cannot move: lower = upper = {lower:g}",
            "Give it its range, or make it a fixed joint.",
        )
    unusual = _unusual_angles if is_rotary else _unusual_travel if is_sliding else None
    finding = None if unusual is None else unusual(name, lower, upper)
    if finding is not None:
        yield finding
    elif kind in ("Revolute", "Prismatic") and not math.isfinite(upper - lower):
        yield Finding(
            "note",
            "unlimited",
            name,
            "it has no position limits on at least one side",
            "Give it lower and upper." if is_sliding else "Give it lower and upper, or make it continuous.",
        )


def _unusual_angles(name: str, lower: float, upper: float) -> Finding | None:
    """Limits [rad] that look like degrees, or like none at all."""
    largest = _largest(lower, upper)
    if largest > _MANY_TURNS:
        return Finding(
            "note",
            "endless",
            name,
            f"limits {lower:g} to {upper:g} rad stand for none",
            "Make it a continuous joint, so that samples and searches do not take the range literally.",
        )
    if largest > _TWO_TURNS:
        return Finding(
            "warning",
            "degrees",
            name,
            f"limits {lower:g} to {upper:g} rad look like degrees; these would be "
            f"{math.radians(lower):.4g} to {math.radians(upper):.4g} rad",
            "URDF has radians: multiply by pi/180.",
        )
    return None


def _unusual_travel(name: str, lower: float, upper: float) -> Finding | None:
    """Limits [m] that look like millimetres, or like none at all."""
    largest = _largest(lower, upper)
    if largest > _MANY_METRES:
        return Finding(
            "note",
            "endless",
            name,
            f"limits {lower:g} to {upper:g} m stand for none",
            "Give it the range of the real joint; samples and searches take limits literally.",
        )
    if largest > _MAX_USUAL_TRAVEL:
        return Finding(
            "warning",
            "millimetres",
            name,
            f"limits {lower:g} to {upper:g} m look like millimetres",
            "URDF has metres: divide by 1000.",
        )
    return None


def _largest(lower: float, upper: float) -> float:
    """The finite limit that is farthest from zero; 0 where there is none."""
    return max((abs(x) for x in (lower, upper) if math.isfinite(x)), default=0.0)


def _drive_findings(name: str, velocity: float, effort: float, is_rotary: bool) -> Iterator[Finding]:
    if velocity == 0.0:
        yield Finding(
            "warning",
            "no-velocity",
            name,
            "its velocity limit is zero, which counts as none known",
            "Give it the greatest speed of its drive, or leave the attribute out for no limit.",
        )
    if is_rotary and math.isfinite(velocity) and velocity > _FAST:
        yield Finding(
            "note",
            "fast",
            name,
            f"its velocity limit is {velocity:g} rad/s; in degrees per second that would be "
            f"{math.radians(velocity):.4g} rad/s",
            "Look whether the file has degrees per second.",
        )
    if effort == 0.0:
        yield Finding(
            "warning",
            "no-effort",
            name,
            "its effort limit is zero, which counts as none known",
            "Give it the greatest torque or force of its drive, or leave the attribute out for no limit.",
        )


def _neutral_findings(model: Model) -> Iterator[Finding]:
    q = np.asarray(model.neutral)
    outside = (q < model.lower_position) | (q > model.upper_position)
    names = model.position_names
    for k in np.flatnonzero(outside):
        yield Finding(
            "note",
            "neutral-outside",
            f"joint {names[k]!r}",
            f"its neutral position 0 is outside its limits {model.lower_position[k]:g} to {model.upper_position[k]:g}",
            "Start from a named configuration or robot.random_configuration() instead of zeros.",
        )
