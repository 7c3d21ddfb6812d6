"""Copying a finished model into a builder, joint by joint, under other names and with joints locked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import ModelError
from ulna.model.joints import Fixed, JointKind
from ulna.model.model import Model
from ulna.model.parts import Joint, Link
from ulna.model.parts_builder import PartsBuilder
from ulna.spatial import SE3
from ulna.typing import Floats


def add_model(
    builder: PartsBuilder,
    model: Model,
    onto: str | None = None,
    placement: SE3 | None = None,
    *,
    prefix: str = "",
    mount: str | None = None,
    locked: Mapping[str, Floats] | None = None,
) -> None:
    """Adds all of a model to a builder; see `ModelBuilder.add_model`.

    Args:
        builder: What it is added to.
        model: The robot.
        onto: Name of the link its root is fixed to; None makes its root the root of this one.
        placement: T_link_root, where its world frame lies on that link [m]; None for the link's frame.
        prefix: Put before every name.
        mount: Name of the new fixed joint; None makes one from the root's name.
        locked: For joints that become fixed, their position, shape (kind.nq,) [rad, m].

    Raises:
        ModelError: a name is taken.
    """
    if onto is not None:
        builder.require_link(onto, "The model is to be fixed to it; add it first.")
    _reject_shared_names(builder, model, prefix)
    copy = _Copy(builder, model, prefix, locked or {})
    place = SE3.identity() if placement is None else placement
    for link in model.links:
        builder.add_link(prefix + link.name, link.inertia, link.visuals, link.collisions)
        joint = model.joint(link.parent_joint) if link.parent_joint in model.joint_names else None
        if link.parent is None:
            copy.root(link, joint, onto, place, mount)
        elif joint is None:
            name, parent = prefix + str(link.parent_joint), prefix + link.parent
            builder.add_joint(name, Fixed(), parent, prefix + link.name, link.origin, offset=link.offset)
        else:
            copy.joint(link, joint, prefix + link.parent, link.origin)
    for frame in model.frames:
        if frame.kind in ("user", "tool"):
            builder.add_frame(prefix + frame.name, prefix + frame.link, frame.origin, kind=frame.kind)
    for a, b in model.disabled_pairs:
        builder.disable_pair(prefix + a, prefix + b)
    for group, names in model.groups.items():
        builder.add_group(prefix + group, [prefix + name for name in names])


def _reject_shared_names(builder: PartsBuilder, model: Model, prefix: str) -> None:
    joints = [f.name for f in model.frames if f.kind in ("joint", "fixed_joint")]
    points = [f.name for f in model.frames if f.kind in ("user", "tool")]
    for what, names, taken in (
        ("link", model.link_names, builder.link_names),
        ("joint", joints, builder.joint_names),
        ("frame", points, builder.frame_names),
    ):
        shared = [prefix + name for name in names if prefix + name in taken]
        if shared:
            raise ModelError(
                f"{builder.name!r} has a {what} named {shared[0]!r} already"
                + (f" (and {len(shared) - 1} more that {model.name!r} has)" if len(shared) > 1 else "")
                + f". Give a prefix that distinguishes the parts, such as prefix={model.name + '_'!r}."
            )


@dataclass(frozen=True)
class _Copy:
    """The copying of one model into a builder."""

    builder: PartsBuilder
    model: Model
    prefix: str
    locked: Mapping[str, Floats]

    def joint(self, link: Link, joint: Joint, parent: str | None, origin: SE3) -> None:
        """Adds a movable joint, or a fixed one where it is locked; the parent None is the world."""
        name, child = self.prefix + joint.name, self.prefix + link.name
        kind: JointKind = joint.kind
        options: dict[str, Any] = {"offset": link.offset}
        if joint.name in self.locked:
            origin = origin @ kind.transform(np.asarray(self.locked[joint.name], dtype=float))
            kind = Fixed()
        else:
            options |= asdict(joint.limits)
            options |= {"damping": joint.damping, "friction": joint.friction, "armature": joint.armature}
            if joint.mimic is not None:
                mimic = joint.mimic
                leader, *relation = mimic.leader or (mimic.source, mimic.multiplier, mimic.offset)
                options["mimic"] = (self.prefix + self.model.joints[leader].name, *relation)
        if parent is None:
            self.builder.root_joint(kind, name, origin, **options)
        else:
            self.builder.add_joint(name, kind, parent, child, origin, **options)

    def root(self, root: Link, joint: Joint | None, onto: str | None, place: SE3, mount: str | None) -> None:
        """Puts the root link on the link `onto`, or on the world."""
        mount_name = root.parent_joint
        if joint is not None:
            self.joint(root, joint, onto, place @ root.origin)
        elif onto is not None:
            name = mount or self.prefix + (mount_name or f"{root.name}_mount")
            child = self.prefix + root.name
            self.builder.add_joint(name, Fixed(), onto, child, place @ root.origin, offset=root.offset)
        elif mount_name or place != SE3.identity():
            name = mount or self.prefix + (mount_name or "root_joint")
            self.builder.root_joint(Fixed(), name, place @ root.origin, offset=root.offset)


def copy_position(
    old: Model, old_q: Floats, new: Model, new_q: Floats, prefix: str = "", leave: str | None = None
) -> None:
    """Copies the positions of the joints that two models share.

    Args:
        old: The model that is copied from.
        old_q: Its position, shape (old.nq,) [rad, m].
        new: The model that is copied to.
        new_q: Its position, shape (new.nq,) [rad, m], which is written to.
        prefix: What the names in `new` begin with.
        leave: Name of a joint of `new` whose position stays.
    """
    for joint in old.joints:
        name = prefix + joint.name
        if joint.mimic is None and name != leave and name in new.joint_names:
            there = new.joint(name)
            new_q[there.idx_q : there.idx_q + there.nq] = old_q[joint.idx_q : joint.idx_q + joint.nq]
