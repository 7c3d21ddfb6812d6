"""Joining models: a gripper on an arm, two arms on a torso."""

from __future__ import annotations

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.model.builder import ModelBuilder
from ulna.model.check import checked_pose
from ulna.model.copying import copy_position
from ulna.model.model import Model
from ulna.spatial import SE3


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

    Names, limits, mimic relations, visuals, disabled pairs and groups of both stay. A configuration that both
    have is joined; one that only one has stands at neutral in the other.

    Args:
        base: The model that carries; it gives its gravity and, if `name` is None, its name.
        addition: The model that is carried.
        frame: The frame of `base` it is fixed to; None for its tool.
        placement: T_frame_addition, the place of the addition's world frame in that frame; None for the frame
            itself.
        prefix: Put before the names of the addition's links, joints, frames and groups.
        name: Name of the whole.
        tool: Name of the whole's tool frame. None takes the addition's tool where the addition is fixed to
            the body that carries the base's tool (or the base has no joints), else the base's.

    Returns:
        The joined model.

    Raises:
        UnknownName: `base` has no such frame.
        InputError: `prefix` is no string.
        ModelError: `placement` is no pose, or both use a name; another `prefix` fixes that.

    Example:
        >>> panda, ur5 = ulna.load("panda"), ulna.load("ur5")
        >>> two = panda.attach(ur5, "panda_link0", ulna.SE3(0.0, 1.0, 0.0), prefix="second_")
        >>> two.nq
        13
    """
    spot = base.frame(base.tool if frame is None else frame)
    if not isinstance(prefix, str):
        raise InputError(f"`prefix` is {short_repr(prefix)}; expected a string, such as 'left_'.")
    placement = None if placement is None else checked_pose("`placement`", placement)
    builder = ModelBuilder(base.name if name is None else name, base.source)
    builder.gravity = base.gravity
    builder.add_model(base)
    place = spot.origin if placement is None else spot.origin @ placement
    builder.add_model(addition, spot.link, place, prefix=prefix)
    if tool is None:
        at_tip = not base.joints or spot.joint == base.frame(base.tool).joint
        tool = _prefixed(addition, prefix) if at_tip else base.tool
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


def _prefixed(model: Model, prefix: str) -> str:
    """What the tool of a model is called where `prefix` stands before all names."""
    frame_name = model.frame(model.tool).name
    return model.tool.removesuffix(frame_name) + prefix + frame_name
