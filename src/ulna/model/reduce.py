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
from ulna.model.parts import Joint
from ulna.model.positions import local_position, position
from ulna.typing import Floats


def lock_joints(model: Model, joints: Mapping[str, Any] | Iterable[str], q: Any = None) -> Model:
    """The model with some joints locked: their child links become rigidly attached to their parent links.

    Names, limits, visuals, frames, the tool and the configurations stay; the configurations lose the entries
    of the locked joints. The frame of a locked joint becomes that of a fixed joint. A mimic joint is locked with
    the joint that it follows, where that one's position puts it; so is one that follows a mimic joint.

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
    at = _locked_positions(model, positions, np.array(model.neutral) if q is None else position(model, q))
    locked = {model.joints[k].name: np.asarray(model.joints[k].kind.normalize(x)) for k, x in at.items()}
    for joint in model.joints:
        if joint.name not in locked and (followed := _followed_position(model, joint, at)) is not None:
            locked[joint.name] = followed
    return rebuilt(model, locked=locked)


def _locked_positions(model: Model, positions: Mapping[str, Any], q: Floats) -> dict[int, Floats]:
    """The positions of the named joints by index; where there is none, that of the joint they follow, or of `q`."""
    at: dict[int, Floats] = {}
    for name, value in positions.items():
        if name not in model.joint_names:
            raise UnknownName("movable joint", name, model.joint_names, "Only movable joints can be locked.")
        joint = model.joint(name)
        if value is not None:
            what = f"position to lock joint {name!r} at"
            at[model.joint_index(name)] = local_position(joint.kind.nq, value, what)
        elif joint.mimic is None:
            at[model.joint_index(name)] = np.asarray(joint.q_of(q))
    others = [model.joint(name) for name in positions if model.joint_index(name) not in at]
    for joint, followed in [(joint, _followed_position(model, joint, at)) for joint in others]:
        at[model.joint_index(joint.name)] = np.asarray(joint.q_of(q)) if followed is None else followed
    return at


def _followed_position(model: Model, joint: Joint, locked: Mapping[int, Floats]) -> Floats | None:
    """Where a mimic joint stands since one that it follows is locked, the nearest of several; None if none is."""
    ratio, offset = 1.0, 0.0
    while joint.mimic is not None:
        mimic = joint.mimic
        leader, factor, shift = mimic.leader or (mimic.source, mimic.multiplier, mimic.offset)
        ratio, offset = ratio * factor, ratio * shift + offset
        if leader in locked:
            return ratio * locked[leader] + offset
        joint = model.joints[leader]
    return None


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
