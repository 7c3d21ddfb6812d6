"""The one way to make a model: tell a builder its links and joints, in any order, then `build()`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Self

import numpy as np

from ulna.errors import ModelError, UnknownName
from ulna.geometry import Geometry
from ulna.model import records
from ulna.model.assemble import assemble
from ulna.model.joints import JointKind
from ulna.model.model import Model
from ulna.model.parts import FrameKind
from ulna.model.records import FrameRecord, JointRecord, LinkRecord, ValueOrSequence, at
from ulna.spatial import SE3, Inertia
from ulna.typing import ArrayLike

Position = ArrayLike | Mapping[str, "float | Sequence[float] | np.ndarray"]


class ModelBuilder:
    """Collects what a model consists of.

    Each method checks what it is given on its own; `build` checks how it all fits together. Where a model comes from
    a file, `where` (such as ``"arm.urdf:12"``) leads the messages about that element.

    >>> builder = ModelBuilder("pendulum")
    >>> builder.add_link("base")
    >>> builder.add_link("rod", Inertia.from_point(1.0, (0.0, 0.0, -0.5)))
    >>> builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod", SE3.trans(0.0, 0.0, 1.0))
    >>> model = builder.build()

    Args:
        name: The model's name.
        source: The file it is read from, for messages and for finding meshes.
    """

    def __init__(self, name: str, source: str | None = None) -> None:
        self.name = records.name_of("model", name, "")
        self.source = source
        self.gravity: ArrayLike = (0.0, 0.0, -9.81)
        self._links: dict[str, LinkRecord] = {}
        self._joints: dict[str, JointRecord] = {}
        self._frames: dict[str, FrameRecord] = {}
        self._root_joint: JointRecord | None = None
        self._configurations: dict[str, Position] = {}
        self._tool: str | None = None
        self._disabled_pairs: dict[tuple[str, str], None] = {}
        self._groups: dict[str, tuple[str, ...]] = {}

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
            name: Its name, not given to another link.
            inertia: Its inertia in the link frame; None for a body without.
            visuals: What it looks like.
            collisions: What it collides with.
            where: Place in the file.

        Raises:
            ModelError: the name is taken, or the inertia cannot be one.
        """
        records.name_of("link", name, where)
        self._refuse_twice("link", name, self._links, where)
        self._links[name] = LinkRecord(
            name,
            records.inertia_of(name, inertia, where),
            records.geometries_of(f"visuals of link {name!r}", visuals, where),
            records.geometries_of(f"collisions of link {name!r}", collisions, where),
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
            name: Its name, not given to another joint.
            kind: What motion it allows; `Fixed()` for none.
            parent: Name of the link it is fixed to; may be added later.
            child: Name of the link it moves; may be added later.
            placement: T_parent_joint, its place on the parent link; None for the parent's frame.
            offset: T_joint_child, the child link's place in the moving frame; None for the moving frame itself.
            lower: Smallest position [rad, m]; None for no limit.
            upper: Largest position [rad, m]; None for no limit.
            velocity: Largest speed [rad/s, m/s]; None for no limit.
            effort: Largest force or torque [N, N m]; None for no limit.
            damping: Viscous friction [N s/m, N m s/rad].
            friction: Coulomb friction [N, N m].
            armature: Inertia of the drive seen at the joint [kg, kg m^2].
            mimic: (name of the joint to follow, multiplier, offset [rad, m]).
            where: Place in the file.

        Raises:
            ModelError: the name is taken, or a value cannot be used.
        """
        records.name_of("joint", name, where)
        self._refuse_twice("joint", name, self._joints, where)
        records.name_of(f"parent of joint {name!r}", parent, where)
        self._joints[name] = _joint_record(
            name, kind, parent, child, placement, offset, lower, upper, velocity, effort,
            damping, friction, armature, mimic, where,
        )  # fmt: skip
        return self

    def root_joint(
        self,
        kind: JointKind,
        name: str = "root_joint",
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
        where: str = "",
    ) -> Self:
        """Connects the root link to the world; replaces what was said before.

        Without it the root link stands still at the world's origin. `root_joint(Fixed(), placement=...)` puts it
        elsewhere. The arguments are those of `add_joint`.
        """
        records.name_of("joint", name, where)
        self._root_joint = _joint_record(
            name, kind, None, "", placement, offset, lower, upper, velocity, effort,
            damping, friction, armature, None, where,
        )  # fmt: skip
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
            name: Its name, not given to a link, a joint or another frame.
            link: Name of the link it moves with.
            placement: T_link_frame; None for the link's own frame.
            kind: ``"user"`` or ``"tool"``.
            where: Place in the file.

        Raises:
            ModelError: the name is taken, or a value cannot be used.
        """
        records.name_of("frame", name, where)
        self._refuse_twice("frame", name, self._frames, where)
        if kind not in ("user", "tool"):
            raise ModelError(
                at(where, f"Frame {name!r} is to be of kind {kind!r}; expected 'user' or 'tool'.")
            )
        pose = SE3.identity() if placement is None else placement
        self._frames[name] = FrameRecord(
            name, link, records.pose_of(f"frame {name!r}", pose, where), kind, where
        )
        return self

    def set_tool(self, name: str) -> Self:
        """Names the frame that is meant when none is named: a link, a joint or a frame."""
        self._tool = records.name_of("tool", name, "")
        return self

    def add_configuration(self, name: str, q: Position) -> Self:
        """Names a position.

        Args:
            name: Its name; a second position of that name replaces the first.
            q: The whole position (nq,), or a dictionary from joint names to positions, where the joints left out
                stand at neutral and mimic joints may be listed but follow their source.
        """
        self._configurations[records.name_of("configuration", name, "")] = q
        return self

    def disable_pair(self, link_a: str, link_b: str) -> Self:
        """Says that two links need no collision check."""
        pair = (link_a, link_b) if link_a <= link_b else (link_b, link_a)
        self._disabled_pairs[pair] = None
        return self

    def add_group(self, name: str, joints: Iterable[str]) -> Self:
        """Names a group of joints; joints that turn out fixed are left out of it."""
        if isinstance(joints, str):
            raise ModelError(
                f"The joints of group {name!r} are the string {joints!r}; expected a list of names."
            )
        self._groups[records.name_of("group", name, "")] = tuple(joints)
        return self

    def add_model(
        self,
        model: Model,
        link: str | None = None,
        placement: SE3 | None = None,
        *,
        prefix: str = "",
        joint: str | None = None,
        locked: Mapping[str, np.ndarray] | None = None,
    ) -> Self:
        """Adds all of a finished model: links, joints, frames, disabled pairs and groups.

        Its configurations, gravity and tool are not taken over, because they speak of the whole model.

        Args:
            model: The model.
            link: Name of the link its root is fixed to; None makes its root the root of this one.
            placement: T_link_root, where its world frame lies on that link.
            prefix: Put before every name.
            joint: Name of the new fixed joint; None makes one from the root's name. Where the model has a movable
                root joint, that one connects it instead.
            locked: For joints that shall not move any more, their position (kind.nq,).

        Raises:
            ModelError: a name is taken; another `prefix` mends that.
        """
        from ulna.model.merge import add_model

        add_model(self, model, link, placement, prefix, joint, locked or {})
        return self

    def build(self) -> Model:
        """The model.

        Fixed joints are merged: their links keep their own inertia and place, and move with the last movable joint
        before them. Rounding noise below 1e-15 in rotations and translations is cleaned off.

        Raises:
            ModelError: the parts contradict one another; the message says how to mend it.
            UnknownName: a name is used that nothing bears; offers the nearest one.
        """
        return assemble(
            self.name,
            self._links,
            self._joints,
            self._frames,
            self._root_joint,
            self._configurations,
            self._tool,
            np.asarray(self.gravity, dtype=float),
            tuple(self._disabled_pairs),
            self._groups,
            self.source,
        )

    def _refuse_twice(
        self, what: str, name: str, taken: Mapping[str, LinkRecord | JointRecord | FrameRecord], where: str
    ) -> None:
        if name in taken:
            first = f", first at {taken[name].where}" if taken[name].where else ""
            raise ModelError(at(where, f"There are two {what}s named {name!r}{first}. Rename one of them."))

    def link_names(self) -> tuple[str, ...]:
        """Names of the links told so far."""
        return tuple(self._links)

    def require_link(self, name: str, mend: str = "") -> None:
        """Raises UnknownName unless a link of that name was told."""
        if name not in self._links:
            raise UnknownName("link", name, self._links, mend)


def _joint_record(
    name: str,
    kind: JointKind,
    parent: str | None,
    child: str,
    placement: SE3 | None,
    offset: SE3 | None,
    lower: ValueOrSequence | None,
    upper: ValueOrSequence | None,
    velocity: ValueOrSequence | None,
    effort: ValueOrSequence | None,
    damping: ValueOrSequence,
    friction: ValueOrSequence,
    armature: ValueOrSequence,
    mimic: object,
    where: str,
) -> JointRecord:
    kind = records.kind_of(name, kind, where)
    if parent is not None and parent == child:
        raise ModelError(
            at(where, f"Joint {name!r} connects link {parent!r} with itself; expected two links.")
        )
    identity = SE3.identity()
    return JointRecord(
        name=name,
        kind=kind,
        parent=parent,
        child=child,
        placement=records.pose_of(f"joint {name!r}", identity if placement is None else placement, where),
        offset=records.pose_of(f"the child of joint {name!r}", identity if offset is None else offset, where),
        limits=records.limits_of(name, kind, lower, upper, velocity, effort, where),
        damping=records.numbers_of(name, "damping", damping, kind.nv, 0.0, where, 0.0),
        friction=records.numbers_of(name, "friction", friction, kind.nv, 0.0, where, 0.0),
        armature=records.numbers_of(name, "armature", armature, kind.nv, 0.0, where, 0.0),
        mimic=records.mimic_of(name, mimic, kind, where),
        where=where,
    )
