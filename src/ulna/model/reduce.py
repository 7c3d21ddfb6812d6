"""Locking joints: the model with fewer joints in which some are fixed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.checks.values import names
from ulna.errors import UnknownName
from ulna.model.builder import ModelBuilder
from ulna.model.copying import copy_position
from ulna.model.model import Model
from ulna.model.positions import local_position, position
from ulna.typing import Floats


def lock_joints(model: Model, joints: Mapping[str, Any] | Iterable[str], q: Any = None) -> Model:
    """The model with some joints locked: their child links become rigidly attached to their parent links.

    Names, limits, visuals, frames, the tool and the configurations stay; the configurations lose the entries
    of the locked joints. The frame of a locked joint becomes that of a fixed joint. A mimic joint whose
    source is locked is locked where the source's position puts it.

    Args:
        model: The model.
        joints: Names of the joints to lock, at the position `q` gives them; or a dictionary from names to
            positions [rad, m], one number or (nq of the joint,).
        q: Configuration (nq,) at which the named joints are locked, the name of a configuration, or a dictionary;
            None for neutral. Joints with a position in `joints` ignore it.

    Returns:
        The reduced model.

    Raises:
        UnknownName: no movable joint of that name.
        InputError: `joints` is a single string.
    """
    positions: Mapping[str, Any] = (
        joints if isinstance(joints, Mapping) else dict.fromkeys(names("joints", joints))
    )
    configuration = np.array(model.neutral) if q is None else position(model, q)
    locked: dict[str, Floats] = {}
    for name, value in positions.items():
        if name not in model.joint_names:
            raise UnknownName("movable joint", name, model.joint_names, "Only movable joints can be locked.")
        joint = model.joint(name)
        if value is None:
            locked[name] = np.asarray(joint.kind.normalize(joint.q_of(configuration)))
        else:
            locked_position = local_position(joint.kind.nq, value, f"position to lock joint {name!r} at")
            locked[name] = np.asarray(joint.kind.normalize(locked_position))
            if joint.mimic is None:
                configuration[joint.idx_q : joint.idx_q + joint.nq] = locked_position
    for joint in model.joints:
        follows = joint.mimic is not None and model.joints[joint.mimic.source].name in locked
        if follows and joint.name not in locked:
            locked[joint.name] = np.asarray(joint.q_of(configuration))
    return rebuilt(model, locked=locked)


def rebuilt(
    model: Model, *, locked: Mapping[str, Floats] | None = None, root: Mapping[str, Any] | None = None
) -> Model:
    """The model built anew, with joints locked or with another root joint.

    Args:
        model: The robot.
        locked: For joints that become fixed, their position, shape (kind.nq,) [rad, m].
        root: Arguments of `ModelBuilder.root_joint`; None keeps the root joint.

    Returns:
        A new model.
    """
    builder = ModelBuilder(model.name, model.source)
    builder.gravity = model.gravity
    root_joint = model.links[0].parent_joint
    if root is not None and root["name"] != root_joint:
        groups = {name: tuple(j for j in joints if j != root_joint) for name, joints in model.groups.items()}
        model = replace(model, groups=groups)
    builder.add_model(model, locked=locked)
    if root is not None:
        builder.root_joint(**root)
    builder.set_tool(model.tool)
    bare = builder.build()
    for name, old in model.configurations.items():
        new = np.array(bare.neutral)
        copy_position(model, old, bare, new, leave=root["name"] if root is not None else None)
        builder.add_configuration(name, new)
    return builder.build() if model.configurations else bare
