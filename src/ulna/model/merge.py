"""Joining models: a gripper on an arm, two arms on a torso."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ulna.errors import ModelError
from ulna.model.builder import ModelBuilder
from ulna.model.joints import Fixed
from ulna.model.model import Model
from ulna.model.parts import Joint, Link
from ulna.spatial import SE3
from ulna.typing import Floats


def attach(
    base: Model,
    addition: Model,
    frame: str | None = None,
    placement: SE3 | None = None,
    prefix: str = "",
    *,
    name: str | None = None,
    tool: str | None = None,
) -> Model:
    """Fixes one model to a frame of another.

    Names, limits, mimic relations, visuals, disabled pairs and groups of both stay. A configuration that both have
    is joined; one that only one has stands at neutral in the other.

    Args:
        base: The model that carries; it gives its gravity and, if `name` is None, its name.
        addition: The model that is carried.
        frame: The frame of `base` it is fixed to; None for its tool.
        placement: T_frame_addition, the place of the addition's world frame in that frame; None for the frame itself.
        prefix: Put before the names of the addition's links, joints, frames and groups.
        name: Name of the whole.
        tool: Name of the whole's tool frame. None takes the addition's tool where the addition is fixed to the body
            that carries the base's tool (or the base has no joints), else the base's.

    Returns:
        The joined model.

    Raises:
        UnknownName: `base` has no such frame.
        ModelError: both use a name; another `prefix` mends that.
    """
    spot = base.frame(base.tool if frame is None else frame)
    builder = ModelBuilder(base.name if name is None else name, base.source)
    builder.gravity = base.gravity
    builder.add_model(base)
    place = spot.origin if placement is None else spot.origin @ placement
    builder.add_model(addition, spot.link, place, prefix=prefix)
    if tool is None:
        at_tip = not base.joints or spot.joint == base.frame(base.tool).joint
        tool = prefix + addition.tool if at_tip else base.tool
    builder.set_tool(tool)
    joined = builder.build()
    for configuration in dict.fromkeys([*base.configurations, *addition.configurations]):
        q = np.array(joined.neutral)
        if configuration in base.configurations:
            copy_position(base, base.configurations[configuration], joined, q)
        if configuration in addition.configurations:
            copy_position(addition, addition.configurations[configuration], joined, q, prefix)
        builder.add_configuration(configuration, q)
    return builder.build() if len(base.configurations) + len(addition.configurations) else joined


def copy_position(old: Model, old_q: Floats, new: Model, new_q: Floats, prefix: str = "") -> None:
    """Writes into `new_q` the positions that `old_q` gives to the joints both models have."""
    for joint in old.joints:
        other = new._joint_places.get(prefix + joint.name)
        if joint.mimic is None and other is not None:
            there = new.joints[other]
            new_q[there.idx_q : there.idx_q + there.nq] = old_q[joint.idx_q : joint.idx_q + joint.nq]


def add_model(
    builder: ModelBuilder,
    model: Model,
    onto: str | None,
    placement: SE3 | None,
    prefix: str,
    mount: str | None,
    locked: Mapping[str, Floats],
) -> None:
    """Adds all of a model to a builder; see `ModelBuilder.add_model`."""
    if onto is not None:
        builder.require_link(onto, "The model is to be fixed to it; add it first.")
    _refuse_shared_names(builder, model, prefix)
    place = SE3.identity() if placement is None else placement
    for link in model.links:
        builder.add_link(prefix + link.name, link.inertia, link.visuals, link.collisions)
        joint = model.joint(link.parent_joint) if link.parent_joint in model.joint_names else None
        if link.parent is None:
            _connect_root(builder, model, link, joint, onto, place, prefix, mount, locked)
        elif joint is None:
            builder.add_joint(
                prefix + str(link.parent_joint), Fixed(), prefix + link.parent, prefix + link.name, link.origin,
                offset=link.offset,
            )  # fmt: skip
        else:
            _connect(builder, model, link, joint, prefix + link.parent, link.origin, prefix, locked)
    for frame in model.frames:
        if frame.kind in ("user", "tool"):
            builder.add_frame(prefix + frame.name, prefix + frame.link, frame.origin, kind=frame.kind)
    for a, b in model.disabled_pairs:
        builder.disable_pair(prefix + a, prefix + b)
    for group, names in model.groups.items():
        builder.add_group(prefix + group, [prefix + name for name in names])


def _refuse_shared_names(builder: ModelBuilder, model: Model, prefix: str) -> None:
    taken = set(builder.link_names())
    shared = [prefix + name for name in model.link_names if prefix + name in taken]
    if shared:
        raise ModelError(
            f"Model {model.name!r} has {len(shared)} link name{'s' if len(shared) > 1 else ''} that "
            f"{builder.name!r} has, too, such as {shared[0]!r}. "
            f"Give a prefix that tells them apart, such as prefix={model.name + '_'!r}."
        )


def _connect(
    builder: ModelBuilder,
    model: Model,
    link: Link,
    joint: Joint,
    parent: str | None,
    origin: SE3,
    prefix: str,
    locked: Mapping[str, Floats],
) -> None:
    """Adds a movable joint, or a fixed one in its place where it is locked; the parent None is the world."""
    name = prefix + joint.name
    if joint.name in locked:
        origin = origin @ joint.kind.transform(np.asarray(locked[joint.name], dtype=float))
        if parent is None:
            builder.root_joint(Fixed(), name, origin, offset=link.offset)
        else:
            builder.add_joint(name, Fixed(), parent, prefix + link.name, origin, offset=link.offset)
        return
    limits = {
        "lower": joint.limits.lower,
        "upper": joint.limits.upper,
        "velocity": joint.limits.velocity,
        "effort": joint.limits.effort,
        "damping": joint.damping,
        "friction": joint.friction,
        "armature": joint.armature,
    }
    if parent is None:
        builder.root_joint(joint.kind, name, origin, offset=link.offset, **limits)
        return
    mimic = None
    if joint.mimic is not None:
        mimic = (prefix + model.joints[joint.mimic.source].name, joint.mimic.multiplier, joint.mimic.offset)
    builder.add_joint(
        name, joint.kind, parent, prefix + link.name, origin, offset=link.offset, mimic=mimic, **limits
    )


def _connect_root(
    builder: ModelBuilder,
    model: Model,
    root: Link,
    joint: Joint | None,
    onto: str | None,
    placement: SE3,
    prefix: str,
    mount: str | None,
    locked: Mapping[str, Floats],
) -> None:
    """Puts the root link on the link `onto`, or on the world."""
    if joint is not None:
        _connect(builder, model, root, joint, onto, placement @ root.origin, prefix, locked)
        return
    own = root.parent_joint
    if onto is not None:
        name = mount or (prefix + own if own else f"{prefix}{root.name}_mount")
        builder.add_joint(name, Fixed(), onto, prefix + root.name, placement @ root.placement)
    elif own or placement != SE3.identity():
        name = mount or (prefix + own if own else "root_joint")
        builder.root_joint(Fixed(), name, placement @ root.origin, offset=root.offset)
