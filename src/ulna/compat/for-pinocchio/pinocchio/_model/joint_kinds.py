"""The kinds of joints by their names, made of Ulna's kinds."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import fixed, real, vector
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name
from pinocchio._model.joint_model import JointModel
from pinocchio._model.repeated_joint_calls import repeated
from ulna.model import (
    Circle,
    Composite,
    Ellipsoid,
    FreeFlyer,
    Helical,
    JointKind,
    PlanarCircle,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
    Universal,
)
from ulna.model.joints.axes import Axis, unit_axis
from ulna.typing import Floats

__all__ = [
    "JointModel",
    "JointModelEllipsoid",
    "JointModelFreeFlyer",
    "JointModelHX",
    "JointModelHY",
    "JointModelHZ",
    "JointModelHelicalUnaligned",
    "JointModelPX",
    "JointModelPY",
    "JointModelPZ",
    "JointModelPlanar",
    "JointModelPrismaticUnaligned",
    "JointModelRUBX",
    "JointModelRUBY",
    "JointModelRUBZ",
    "JointModelRX",
    "JointModelRY",
    "JointModelRZ",
    "JointModelRevoluteUnaligned",
    "JointModelRevoluteUnboundedUnaligned",
    "JointModelSpherical",
    "JointModelSphericalZYX",
    "JointModelTranslation",
    "JointModelUniversal",
]

_AXES: dict[str, Axis] = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


def _fixed_kind(shortname: str, kind: JointKind, doc: str, axis: Axis | None = None) -> type[JointModel]:
    """A class of joints without parameters; those along a coordinate axis know it."""

    def __init__(self: JointModel) -> None:
        self._set_kind(shortname, kind)

    members: dict[str, Any] = {"__init__": __init__, "__doc__": doc, "__module__": __name__}
    if axis is not None:
        members["getMotionAxis"] = _motion_axis(axis)
    return type(shortname, (JointModel,), members)


def _motion_axis(axis: Axis) -> Any:
    def getMotionAxis(self: JointModel) -> Floats:
        return np.array(axis)

    getMotionAxis.__doc__ = "Its unit axis (3,)."
    return getMotionAxis


def _axis_of(name: str, doc: str) -> property:
    """The property of an axis of a joint's kind, its field of that name."""

    def read(self: JointModel) -> Floats:
        return fixed(np.array(getattr(self.kind, name)))

    def write(self: JointModel, value: Any) -> None:
        direction = vector(value, 3, name)
        if isinstance(self.kind, Prismatic):
            _check_length(direction)
        self._change_kind(**{name: unit_axis(direction)})

    return property(read, write, doc=doc)


def _check_length(axis: Floats) -> None:
    """Checks that a joint slides one metre a unit of q, to 1 %: in Pinocchio it slides as far as its axis is long.

    Raises:
        ArgumentError: The axis has another length.
    """
    length = float(np.linalg.norm(axis))
    if 0.0 < length < np.inf and abs(length - 1.0) > 0.01:
        raise ArgumentError(
            f"The axis of a prismatic joint is {axis.tolist()}, {length:.6g} long; expected length 1. Divide it by its "
            f"length, and multiply q and its limits by {length:.6g} for the same motion."
        )


def _length_of(name: str, doc: str) -> property:
    """The property of a length of a joint's kind, its field of that name."""

    def write(self: JointModel, value: float) -> None:
        self._change_kind(**{name: real(value, name)})

    return property(lambda self: getattr(self.kind, name), write, doc=doc)


class _Unaligned(JointModel):
    """A joint about or along any axis."""

    _make: Any

    @by_name("axis", "x y z")
    def __init__(self, *axis: Any) -> None:
        if len(axis) not in (0, 1, 3):
            raise ArgumentError(
                f"{type(self).__name__} was given {axis}; expected an axis (3,), or three numbers."
            )
        direction = vector(axis[0] if len(axis) == 1 else axis or _AXES["X"], 3, "axis")
        if self._make is Prismatic:
            _check_length(direction)
        self._set_kind(type(self).__name__, type(self)._make(unit_axis(direction)))

    axis = _axis_of("axis", "Its unit axis (3,).")


class JointModelRevoluteUnaligned(_Unaligned):
    """Turns about an axis between limits; nq = 1."""

    _make = Revolute


class JointModelPrismaticUnaligned(_Unaligned):
    """Slides along an axis; nq = 1."""

    _make = Prismatic


class JointModelRevoluteUnboundedUnaligned(_Unaligned):
    """Turns about an axis, three numbers, without end; q is (cos, sin), nv = 1."""

    _make = Circle

    @by_name("x y z")
    def __init__(self, *axis: Any) -> None:
        if len(axis) == 1:
            raise ArgumentError(
                f"JointModelRevoluteUnboundedUnaligned was given {axis[0]!r}; expected three numbers: pass *axis."
            )
        super().__init__(*axis)


class JointModelHelicalUnaligned(JointModel):
    """A screw about an axis with a pitch [m/rad]: `(axis, pitch)`, `(x, y, z, pitch)`."""

    @by_name("axis pitch", "x y z pitch")
    def __init__(self, *parts: Any) -> None:
        *axis, pitch = parts or (_AXES["X"], 0.0)
        if len(axis) not in (1, 3):
            raise ArgumentError(
                f"JointModelHelicalUnaligned was given {parts!r}; expected (axis, pitch) or (x, y, z, pitch)."
            )
        direction = unit_axis(vector(axis[0] if len(axis) == 1 else axis, 3, "axis"))
        self._set_kind("JointModelHelicalUnaligned", Helical(direction, real(pitch, "pitch")))

    axis = _axis_of("axis", "Its unit axis (3,).")
    pitch = _length_of("pitch", "Advance per angle [m/rad].")


class JointModelUniversal(JointModel):
    """Turns about a first axis, then about a second one: six numbers, or two axes; nq = nv = 2."""

    @by_name("axis1 axis2", "x1 y1 z1 x2 y2 z2")
    def __init__(self, *parts: Any) -> None:
        if len(parts) not in (0, 2, 6):
            raise ArgumentError(
                f"JointModelUniversal was given {parts!r}; expected two axes, or six numbers."
            )
        first, second = (
            parts if len(parts) == 2 else (parts[:3], parts[3:]) if parts else (_AXES["X"], _AXES["Y"])
        )
        axes = (unit_axis(vector(a, 3, "axis")) for a in (first, second))
        self._set_kind("JointModelUniversal", Universal(*axes))

    axis1 = _axis_of("axis1", "The first unit axis (3,), in the fixed frame.")
    axis2 = _axis_of("axis2", "The second unit axis (3,), in the moving frame.")


class JointModelEllipsoid(JointModel):
    """Rolls and spins on an ellipsoid, `(radius_x, radius_y, radius_z)` [m]; q is three angles, x then y then z [rad].

    The moving frame has the rotation Rx Ry Rz; its place is the radii times the third column of that.
    """

    @by_name("radius_x radius_y radius_z")
    def __init__(self, *radii: float) -> None:
        if len(radii) not in (0, 3):
            raise ArgumentError(f"JointModelEllipsoid was given {radii}; expected three radii [m], or none.")
        values = radii or (0.0, 0.0, 0.0)
        sizes = (real(r, f"radius_{axis}") for axis, r in zip("xyz", values, strict=True))
        self._set_kind("JointModelEllipsoid", Ellipsoid(*sizes))

    radius_x, radius_y, radius_z = (_length_of(f"radius_{x}", f"Radius along {x} [m].") for x in "xyz")


JointModelFreeFlyer = _fixed_kind(
    "JointModelFreeFlyer", FreeFlyer(), "Moves freely; q is position and quaternion xyzw, v the body twist."
)
JointModelSpherical = _fixed_kind("JointModelSpherical", Spherical(), "A ball joint; q is a quaternion xyzw.")
JointModelTranslation = _fixed_kind("JointModelTranslation", Translation(), "Slides freely in space.")
JointModelPlanar = _fixed_kind(
    "JointModelPlanar", PlanarCircle(), "Moves in the plane; q is (x, y, cos, sin)."
)
JointModelSphericalZYX = _fixed_kind(
    "JointModelSphericalZYX",
    Composite((Revolute(_AXES["Z"]), Revolute(_AXES["Y"]), Revolute(_AXES["X"]))),
    "A ball joint with the angles yaw, pitch, roll.",
)


def _along(letter: str, make: Any, family: str, doc: str) -> type[JointModel]:
    axis = _AXES[letter]
    return _fixed_kind(f"JointModel{family}{letter}", make(axis), doc.format(letter.lower()), axis)


JointModelRX, JointModelRY, JointModelRZ = (_along(c, Revolute, "R", "Turns about {}.") for c in "XYZ")
JointModelPX, JointModelPY, JointModelPZ = (_along(c, Prismatic, "P", "Slides along {}.") for c in "XYZ")
JointModelRUBX, JointModelRUBY, JointModelRUBZ = (
    _along(c, Circle, "RUB", "Turns about {} without end; q is (cos, sin).") for c in "XYZ"
)


def _screw(letter: str) -> type[JointModel]:
    shortname = f"JointModelH{letter}"

    def __init__(self: Any, pitch: float = 0.0) -> None:
        self._set_kind(shortname, Helical(_AXES[letter], real(pitch, "pitch")))

    doc = f"A screw about {letter.lower()} with a pitch [m/rad]."
    members = {
        "__init__": __init__,
        "__doc__": doc,
        "__module__": __name__,
        "getMotionAxis": _motion_axis(_AXES[letter]),
        "_limit_entries": 2,
        "pitch": _length_of("pitch", "Advance per angle [m/rad]."),
    }
    return type(shortname, (JointModel,), members)


JointModelHX, JointModelHY, JointModelHZ = (_screw(c) for c in "XYZ")


def along(axis: Any, aligned: tuple[Any, Any, Any], unaligned: Any) -> JointModel:
    """The joint about or along an axis: the aligned one where that is exactly a coordinate axis.

    Args:
        axis: The axis, (3,).
        aligned: Classes for x, y, z.
        unaligned: Class for other axes.

    Returns:
        The joint.
    """
    unit = unit_axis(axis)
    for letter, make in zip("XYZ", aligned, strict=True):
        if unit == _AXES[letter]:
            return make()
    return unaligned(*unit)


def revolute(axis: Any) -> JointModel:
    """A revolute joint about an axis."""
    return along(axis, (JointModelRX, JointModelRY, JointModelRZ), JointModelRevoluteUnaligned)


def continuous(axis: Any) -> JointModel:
    """A joint without end about an axis."""
    return along(axis, (JointModelRUBX, JointModelRUBY, JointModelRUBZ), JointModelRevoluteUnboundedUnaligned)


def prismatic(axis: Any) -> JointModel:
    """A prismatic joint along an axis."""
    return along(axis, (JointModelPX, JointModelPY, JointModelPZ), JointModelPrismaticUnaligned)


register(*(repeated(globals()[_name]) for _name in __all__))
