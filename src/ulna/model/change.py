"""Models with one thing changed: tool, named configuration, gravity, root joint, pairs not to check."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from ulna.errors import InputError, ModelError
from ulna.model.check import checked_gravity, checked_name, checked_pose
from ulna.model.joints import JointKind
from ulna.model.joints.axes import snap_pose
from ulna.model.model import Model
from ulna.model.parts import Frame
from ulna.model.positions import position
from ulna.model.reduce import rebuilt
from ulna.spatial import SE3
from ulna.typing import ArrayLike


def with_tool(model: Model, frame: str, placement: SE3 | None = None, name: str = "tool") -> Model:
    """The model with another tool.

    Args:
        model: The model.
        frame: The frame that is the tool; or, with a `placement`, the frame it is placed in.
        placement: T_frame_tool, for a tool that is not a frame yet [m].
        name: Name of the new frame; a tool of that name made before is replaced.

    Returns:
        A new model.

    Raises:
        UnknownName: no frame is named `frame`.
        InputError: a `name` without a `placement`.
        ModelError: `name` is taken by something that is not a tool.
    """
    base = model.frame(frame)
    if placement is None:
        if name != "tool":
            raise InputError(
                f"`name` is {name!r}, which a new frame would have; expected a `placement`, too, such as SE3(): "
                f"without one the frame {frame!r} itself is the tool."
            )
        return replace(model, tool=frame)
    checked_name("tool", name)
    taken = next((f for f in model.frames if f.name == name and f.kind != "tool"), None)
    if taken is not None:
        raise ModelError(
            f"The name {name!r} is that of a {taken.kind.replace('_', ' ')} frame; give another `name`."
        )
    origin = snap_pose(base.origin @ checked_pose(f"tool {name!r}", placement))
    pose = snap_pose(model.link(base.link).placement @ origin)
    others = tuple(f for f in model.frames if f.name != name)
    return replace(
        model, frames=(*others, Frame(name, base.joint, pose, "tool", base.link, origin)), tool=name
    )


def with_configuration(model: Model, name: str, q: Any) -> Model:
    """The model with a named position.

    Args:
        model: The model.
        name: Name of the position; one of that name is replaced.
        q: The position, shape (nq,) [rad, m]; or a dictionary from joint names to positions, the others at neutral.

    Returns:
        A new model.
    """
    checked_name("configuration", name)
    configurations = {**model.configurations, name: position(model, q, f"configuration {name!r}")}
    return replace(model, configurations=configurations)


def with_gravity(model: Model, gravity: ArrayLike) -> Model:
    """The model under another acceleration of free fall.

    Args:
        model: The robot.
        gravity: Acceleration of free fall in the world frame, shape (3,) [m/s^2].

    Returns:
        A new model.

    Raises:
        ModelError: it is not three finite numbers.
    """
    return replace(model, gravity=checked_gravity(gravity))


def with_root_joint(
    model: Model, kind: JointKind, name: str = "root_joint", placement: SE3 | None = None, **limits: Any
) -> Model:
    """The model with its root link connected to the world by a joint, in place of the one it may have.

    Configurations stay; in them the new joint stands at neutral.

    Args:
        model: The model.
        kind: `FreeFlyer()` for a robot that walks or flies; `Fixed()` to stand it elsewhere.
        name: Name of the joint.
        placement: T_world_joint [m]; None for the world's origin.
        **limits: `lower`, `upper`, `velocity` and `effort` as for `ModelBuilder.add_joint`.

    Returns:
        A new model.
    """
    return rebuilt(model, root={"kind": kind, "name": name, "placement": placement, **limits})


def with_disabled_pairs(model: Model, pairs: Iterable[tuple[str, str]]) -> Model:
    """The model with more pairs of links that need no collision check.

    Args:
        model: The robot.
        pairs: Pairs of link names.

    Returns:
        A new model.

    Raises:
        UnknownName: no link of that name.
    """
    added = set()
    for a, b in pairs:
        first, second = sorted((model.link(a).name, model.link(b).name))
        added.add((first, second))
    return replace(model, disabled_pairs=tuple(sorted({*model.disabled_pairs, *added})))
