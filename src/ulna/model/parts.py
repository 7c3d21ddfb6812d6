"""The parts of a model: joints, links, frames, limits and mimic relations, as frozen values."""

from __future__ import annotations

from typing import Literal

from ulna.data_classes import dataclass
from ulna.geometry import Geometry
from ulna.model.joints import JointKind
from ulna.spatial import SE3, Inertia
from ulna.typing import Array

FrameKind = Literal["link", "joint", "fixed_joint", "tool", "user"]


@dataclass(frozen=True)
class Limits:
    """The limits of one joint; infinite where there is none.

    Attributes:
        lower: Smallest position, one number per entry of q [rad, m].
        upper: Largest position, one number per entry of q [rad, m].
        velocity: Largest speed, one number per entry of v [rad/s, m/s].
        effort: Largest force or torque, one number per entry of v [N, N m].
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]
    effort: tuple[float, ...]


@dataclass(frozen=True)
class Mimic:
    """A joint without an independent position: q = multiplier * q_source + offset.

    A continuous joint that is followed by a slide, or not in a whole ratio, comes out of the builder as a
    revolute one without limits: a turn more or less is another place for its follower.

    Attributes:
        source: Index of the joint it follows; never itself a mimic joint.
        multiplier: Ratio of the positions, and of the velocities.
        offset: Its position while the source stands at 0 [rad, m].
        leader: Index, ratio and offset [rad, m] of the joint that it was declared to follow where that is a mimic
            joint, too; None where it is the source. Once the leader is locked, the joint stays where that puts it.
    """

    source: int
    multiplier: float
    offset: float
    leader: tuple[int, float, float] | None = None


@dataclass(frozen=True)
class Joint:
    """A joint that moves.

    Attributes:
        name: Its name.
        kind: What motion it allows, with its constants.
        parent: Index of the joint before it; -1 for the world.
        placement: T_parent_joint, the pose of the joint's fixed frame in the parent's moving frame.
        idx_q: Where its part of q begins; for a mimic joint, its source's part.
        idx_v: Where its part of v begins; for a mimic joint, its source's part.
        limits: Its limits; those of a mimic joint are kept but do not bind its source.
        damping: Viscous friction, per entry of its velocity [N s/m, N m s/rad].
        friction: Coulomb friction, likewise [N, N m].
        armature: Inertia of the drive seen at the joint, likewise [kg, kg m^2].
        mimic: Which joint it follows, if it follows one.
        parent_link: Name of the link it is fixed to; None for the world.
        child_link: Name of the link it moves.
    """

    name: str
    kind: JointKind
    parent: int
    placement: SE3
    idx_q: int
    idx_v: int
    limits: Limits
    damping: tuple[float, ...]
    friction: tuple[float, ...]
    armature: tuple[float, ...]
    mimic: Mimic | None
    parent_link: str | None
    child_link: str

    @property
    def nq(self) -> int:
        """Number of entries it adds to q; 0 for a mimic joint."""
        return 0 if self.mimic else self.kind.nq

    @property
    def nv(self) -> int:
        """Number of entries it adds to v; 0 for a mimic joint."""
        return 0 if self.mimic else self.kind.nv

    def q_of(self, q: Array) -> Array:
        """Its own position, shape (..., kind.nq), out of the model's q (..., nq)."""
        part = q[..., self.idx_q : self.idx_q + self.kind.nq]
        return part if self.mimic is None else self.mimic.multiplier * part + self.mimic.offset

    def v_of(self, v: Array) -> Array:
        """Its own velocity (..., kind.nv) out of the model's v (..., nv); serves accelerations, too."""
        part = v[..., self.idx_v : self.idx_v + self.kind.nv]
        return part if self.mimic is None else self.mimic.multiplier * part


@dataclass(frozen=True)
class Link:
    """A rigid body.

    Attributes:
        name: Its name.
        joint: Index of the last movable joint before it, which carries it; -1 for the world.
        placement: T_joint_link, its pose in that joint's moving frame (in the world frame for -1).
        inertia: Its own inertia, in the link frame; zero mass where the model names none.
        visuals: What it looks like.
        collisions: What it collides with.
        parent: Name of the link before it; None for the root.
        parent_joint: Name of the joint that connects it to its parent, movable or fixed; None for a bare
            root.
        origin: T_parent_joint, the pose of that joint's fixed frame in the parent link's frame.
        offset: T_joint_link, its pose in that joint's moving frame; the identity in URDF models.
    """

    name: str
    joint: int
    placement: SE3
    inertia: Inertia
    visuals: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]
    parent: str | None
    parent_joint: str | None
    origin: SE3
    offset: SE3


@dataclass(frozen=True)
class Frame:
    """A named frame that moves with a link.

    Attributes:
        name: Its name. A link and a joint may share one.
        joint: Index of the joint that carries it; -1 for the world.
        placement: T_joint_frame, its pose in that joint's moving frame (in the world frame for -1).
        kind: What it belongs to.
        link: Name of the link it is fixed to.
        origin: T_link_frame, its pose in that link's frame.
    """

    name: str
    joint: int
    placement: SE3
    kind: FrameKind
    link: str
    origin: SE3
