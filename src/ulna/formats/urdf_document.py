"""What a URDF file says, as frozen data: the elements with their numbers checked and nothing interpreted."""

from __future__ import annotations

from dataclasses import dataclass, field

Vector = tuple[float, ...]


@dataclass(frozen=True)
class UrdfOrigin:
    """A pose: translation [m], fixed-axis angles roll, pitch, yaw [rad], R = Rz(yaw) Ry(pitch) Rx(roll)."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class UrdfMaterial:
    """A colour (red, green, blue, opacity in 0..1) and the URI of a texture, where given."""

    name: str
    rgba: Vector | None = None
    texture: str | None = None


@dataclass(frozen=True)
class UrdfShape:
    """A geometry: `kind` is box, cylinder, sphere, capsule or mesh.

    Attributes:
        kind: the name of the element.
        size: box: three edges; cylinder and capsule: radius, length; sphere: radius [m]; empty for a mesh.
        uri: the file of a mesh, as written.
        scale: of a mesh.
        line: of the element in the file.
    """

    kind: str
    size: Vector = ()
    uri: str = ""
    scale: Vector = (1.0, 1.0, 1.0)
    line: int | None = field(default=None, compare=False)


@dataclass(frozen=True)
class UrdfBody:
    """A visual or a collision element of a link."""

    name: str | None
    origin: UrdfOrigin
    shape: UrdfShape
    material: UrdfMaterial | None = None


@dataclass(frozen=True)
class UrdfInertial:
    """Mass [kg], pose of the centre-of-mass frame in the link, inertia [kg m^2] about it, in its axes.

    `inertia` is in the order ixx, ixy, ixz, iyy, iyz, izz.
    """

    mass: float
    origin: UrdfOrigin
    inertia: Vector


@dataclass(frozen=True)
class UrdfLink:
    """A link."""

    name: str
    inertial: UrdfInertial | None = None
    visuals: tuple[UrdfBody, ...] = ()
    collisions: tuple[UrdfBody, ...] = ()
    line: int | None = field(default=None, compare=False)


@dataclass(frozen=True)
class UrdfLimit:
    """Limits of a joint [rad or m, rad/s or m/s, N m or N]; infinite where the file gives none."""

    lower: float
    upper: float
    velocity: float
    effort: float


@dataclass(frozen=True)
class UrdfMimic:
    """The joint follows `joint`: q = multiplier * q_joint + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class UrdfJoint:
    """A joint; `kind` is revolute, continuous, prismatic, fixed, floating, planar or spherical."""

    name: str
    kind: str
    parent: str
    child: str
    origin: UrdfOrigin = UrdfOrigin()
    axis: Vector = (1.0, 0.0, 0.0)
    limit: UrdfLimit | None = None
    damping: float = 0.0
    friction: float = 0.0
    mimic: UrdfMimic | None = None
    line: int | None = field(default=None, compare=False)


@dataclass(frozen=True)
class UrdfDocument:
    """A URDF file: a tree of links and joints, both in file order.

    Attributes:
        name: of the robot.
        links: all of them; exactly one, `root`, is nobody's child.
        joints: all of them.
        materials: the named ones, by name.
        root: the name of the link that everything hangs from.
        file: where it was read from; None for text.
    """

    name: str
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]
    materials: dict[str, UrdfMaterial]
    root: str
    file: str | None = None
