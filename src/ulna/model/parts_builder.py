"""The parts of a model that is being built: links, joints, frames, configurations, each checked when added."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Self

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.errors import ModelError, UnknownName
from ulna.geometry import Geometry
from ulna.model.check import (
    ValueOrSequence,
    checked_geometries,
    checked_gravity,
    checked_inertia,
    checked_kind,
    checked_limits,
    checked_mimic,
    checked_name,
    checked_numbers,
    checked_pose,
)
from ulna.model.joints import JointKind
from ulna.model.parts import FrameKind
from ulna.model.records import BuilderState, FrameRecord, JointRecord, LinkRecord, model_error
from ulna.spatial import SE3, Inertia
from ulna.typing import ArrayLike, Floats

Position = ArrayLike | Mapping[str, ValueOrSequence]


class PartsBuilder(FixedAttributes):
    """Collects links, joints, frames, configurations and groups, and checks each one.

    Args:
        name: The model's name.
        source: The file it is read from.
    """

    def __init__(self, name: str, source: str | None = None) -> None:
        self._state = BuilderState(checked_name("model", name), source)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: {len(self.link_names)} links, {len(self.joint_names)} joints>"

    @property
    def name(self) -> str:
        """The model's name."""
        return self._state.name

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links added so far."""
        return tuple(self._state.links)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints added so far, fixed ones included."""
        return tuple(self._state.joints)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of the frames added so far, not counting those of links and joints."""
        return tuple(self._state.frames)

    @property
    def gravity(self) -> Floats:
        """Acceleration of free fall in the world frame, shape (3,) [m/s^2]; (0, 0, -9.81) unless set."""
        return np.asarray(self._state.gravity, dtype=float)

    @gravity.setter
    def gravity(self, gravity: ArrayLike) -> None:
        self._state.gravity = checked_gravity(gravity)

    def add_link(
        self,
        name: str,
        inertia: Inertia | None = None,
        visuals: Sequence[Geometry] = (),
        collisions: Sequence[Geometry] = (),
        *,
        where: str = "",
    ) -> Self:
        """Adds a body.

        Args:
            name: Its name, which no other link has.
            inertia: Its inertia in the link frame [kg, m, kg m^2]; None for a body without.
            visuals: What it looks like.
            collisions: What it collides with.
            where: The place in the file, for messages.

        Returns:
            The builder.

        Raises:
            ModelError: the name is taken, or the inertia cannot be one.

        Example:
            >>> from ulna.geometry import Box, Geometry
            >>> inertia = ulna.Inertia.from_box(2.0, (0.1, 0.1, 0.4))
            >>> shapes = [Geometry("body", Box((0.1, 0.1, 0.4)))]
            >>> builder = ulna.ModelBuilder("part").add_link("body", inertia, visuals=shapes, collisions=shapes)
            >>> builder.build().mass
            2.0
        """
        links = self._state.links
        _reject_duplicate_name("link", checked_name("link", name, where), links, where)
        links[name] = LinkRecord(
            name,
            checked_inertia(name, inertia, where),
            checked_geometries(f"visuals of link {name!r}", visuals, where),
            checked_geometries(f"collisions of link {name!r}", collisions, where),
            where,
        )
        return self

    def add_joint(
        self,
        name: str,
        kind: JointKind,
        parent: str,
        child: str,
        placement: SE3 | None = None,
        *,
        offset: SE3 | None = None,
        lower: ValueOrSequence | None = None,
        upper: ValueOrSequence | None = None,
        velocity: ValueOrSequence | None = None,
        effort: ValueOrSequence | None = None,
        damping: ValueOrSequence = 0.0,
        friction: ValueOrSequence = 0.0,
        armature: ValueOrSequence = 0.0,
        mimic: tuple[str, float, float] | str | None = None,
        where: str = "",
    ) -> Self:
        """Connects two links. Limits and the like are one number, or one for each entry of q or v.

        Args:
            name: Its name, which no other joint has.
            kind: What motion it allows; `Fixed()` for none.
            parent: Name of the link it is fixed to; may be added later.
            child: Name of the link it moves; may be added later.
            placement: T_parent_joint, its place on the parent link [m]; None for the parent's frame.
            offset: T_joint_child, the child link's place in the moving frame [m]; None for the moving frame itself.
            lower: Smallest position [rad, m]; None for no limit.
            upper: Largest position [rad, m]; None for no limit.
            velocity: Largest speed [rad/s, m/s]; None for no limit.
            effort: Largest force or torque [N, N m]; None for no limit.
            damping: Viscous friction [N s/m, N m s/rad].
            friction: Coulomb friction [N, N m].
            armature: Inertia of the drive as it acts at the joint [kg, kg m^2].
            mimic: (name of the joint to follow, multiplier, offset [rad, m]).
            where: The place in the file, for messages.

        Returns:
            The builder.

        Raises:
            ModelError: the name is taken, or a value cannot be used.

        Example:
            >>> from ulna.model import Prismatic
            >>> builder = ulna.ModelBuilder("lift").add_link("base").add_link("platform")
            >>> builder = builder.add_joint("slide", Prismatic((0, 0, 1)), "base", "platform", lower=0.0, upper=1.2)
            >>> ulna.Robot(builder.build()).fk([0.7])[:3, 3]
            array([0. , 0. , 0.7])
        """
        _reject_duplicate_name("joint", checked_name("joint", name, where), self._state.joints, where)
        kind = checked_kind(name, kind, where)
        _reject_equal_links(name, checked_name(f"parent of joint {name!r}", parent, where), child, where)
        self._state.joints[name] = JointRecord(
            name=name,
            kind=kind,
            parent=parent,
            child=checked_name(f"child of joint {name!r}", child, where),
            placement=checked_pose(f"joint {name!r}", _pose(placement), where),
            offset=checked_pose(f"the child of joint {name!r}", _pose(offset), where),
            limits=checked_limits(
                name, kind, {"lower": lower, "upper": upper, "velocity": velocity, "effort": effort}, where
            ),
            damping=_of_drive("damping", damping, name, kind, where),
            friction=_of_drive("friction", friction, name, kind, where),
            armature=_of_drive("armature", armature, name, kind, where),
            mimic=checked_mimic(name, mimic, kind, where),
            where=where,
        )
        return self

    def root_joint(
        self,
        kind: JointKind,
        name: str = "root_joint",
        placement: SE3 | None = None,
        **rest: Any,
    ) -> Self:
        """Connects the root link to the world; replaces an earlier root joint.

        Without it the root link stands still at the world's origin. `root_joint(Fixed(), placement=...)` puts it
        elsewhere.

        Args:
            kind: What motion it allows, such as `FreeFlyer()`.
            name: Its name, which no other joint has.
            placement: T_world_joint [m]; None for the world's origin.
            **rest: As for `add_joint`: `offset`, limits and the like, `where`. It cannot mimic.

        Returns:
            The builder.

        Raises:
            ModelError: a value cannot be used.
        """
        if rest.get("mimic") is not None:
            raise model_error(
                rest.get("where", ""), f"The root joint {name!r} is to mimic a joint; it cannot."
            )
        alone = PartsBuilder(self.name).add_joint(name, kind, "world", "root", placement, **rest)
        self._state.root_joint = replace(alone._state.joints[name], parent=None, child="")
        return self

    def add_frame(
        self,
        name: str,
        link: str,
        placement: SE3 | None = None,
        *,
        kind: FrameKind = "user",
        where: str = "",
    ) -> Self:
        """Adds a named frame to a link.

        Args:
            name: Its name, which no link, joint or other frame has.
            link: Name of the link it moves with.
            placement: T_link_frame [m]; None for the link's own frame.
            kind: ``"user"`` or ``"tool"``.
            where: The place in the file, for messages.

        Returns:
            The builder.

        Raises:
            ModelError: the name is taken, or a value cannot be used.
        """
        frames = self._state.frames
        _reject_duplicate_name("frame", checked_name("frame", name, where), frames, where)
        if kind not in ("user", "tool"):
            raise model_error(where, f"Frame {name!r} is to be of kind {kind!r}; expected 'user' or 'tool'.")
        link = checked_name(f"link of frame {name!r}", link, where)
        frames[name] = FrameRecord(
            name, link, checked_pose(f"frame {name!r}", _pose(placement), where), kind, where
        )
        return self

    def set_tool(self, name: str) -> Self:
        """Names the frame that is meant when none is named: a link, a joint or a frame.

        Without it, it is the leaf link with the most joints before it (mimic joints do not count), the first
        of those.
        """
        self._state.tool = checked_name("tool", name)
        return self

    def add_configuration(self, name: str, q: Position) -> Self:
        """Names a position.

        Args:
            name: Its name; a second position of that name replaces the first.
            q: The whole position, shape (nq,) [rad, m], or a dictionary from joint names to positions, where the
                joints left out stand at neutral and mimic joints may be listed but follow their source.

        Returns:
            The builder.
        """
        self._state.configurations[checked_name("configuration", name)] = q
        return self

    def disable_pair(self, link_a: str, link_b: str) -> Self:
        """Declares that two links need no collision check.

        Args:
            link_a, link_b: Names of the links; may be added later.

        Returns:
            The builder.

        Raises:
            ModelError: what should be a name is not a string, or is empty.
        """
        first, second = sorted((checked_name("link", link_a), checked_name("link", link_b)))
        self._state.disabled_pairs.add((first, second))
        return self

    def add_group(self, name: str, joints: Iterable[str]) -> Self:
        """Names a group of joints, or adds joints to it; those that turn out fixed are left out.

        Args:
            name: Name of the group.
            joints: Names of the joints; may be added later.

        Returns:
            The builder.

        Raises:
            ModelError: `joints` is a string.
        """
        if isinstance(joints, str):
            raise ModelError(
                f"The joints of group {name!r} are the string {joints!r}; expected a list of names."
            )
        before = self._state.groups.get(checked_name("group", name), ())
        self._state.groups[name] = tuple(dict.fromkeys([*before, *joints]))
        return self

    def require_link(self, name: str, fix: str = "") -> None:
        """Checks that a link was added.

        Args:
            name: Its name.
            fix: How to correct it, for the message.

        Raises:
            UnknownName: there is no link of that name.
        """
        if name not in self._state.links:
            raise UnknownName("link", name, self._state.links, fix)


def _pose(pose: SE3 | None) -> SE3:
    return SE3.identity() if pose is None else pose


def _reject_equal_links(joint: str, parent: str, child: str, where: str) -> None:
    if parent == child:
        text = f"Joint {joint!r} connects link {parent!r} with itself; expected two links."
        raise model_error(where, text)


def _reject_duplicate_name(
    what: str, name: str, taken: Mapping[str, LinkRecord | JointRecord | FrameRecord], where: str
) -> None:
    if name in taken:
        first = f", the first one at {taken[name].where}" if taken[name].where else ""
        raise model_error(where, f"There are two {what}s named {name!r}{first}. Rename one of them.")


def _of_drive(
    what: str, value: ValueOrSequence, joint: str, kind: JointKind, where: str
) -> tuple[float, ...]:
    """Numbers of the drive of a joint, one for each velocity."""
    return checked_numbers(f"`{what}` of joint {joint!r}", value, kind.nv, finite=True, where=where)
