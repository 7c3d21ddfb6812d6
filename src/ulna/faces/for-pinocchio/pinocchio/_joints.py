"""Joint models: Pinocchio's names for the tower's kinds of joints, with their places in q and v."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from pinocchio._arrays import StdVec, vector
from pinocchio._se3 import SE3
from ulna.errors import InputError
from ulna.model import (
    Circle,
    Composite,
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
    "JointModelComposite",
    "JointModelFreeFlyer",
    "JointModelHX",
    "JointModelHY",
    "JointModelHZ",
    "JointModelHelicalUnaligned",
    "JointModelMimic",
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
NOWHERE = 2**64 - 1
"""The index of a joint that is in no model."""


class JointModel:
    """A kind of joint and, once in a model, its index and its places in q and v."""

    def __init__(self, joint: JointModel | None = None) -> None:
        self.id = NOWHERE
        self.idx_q = self.idx_v = self.idx_vExtended = -1
        self.kind: JointKind | None = None if joint is None else joint.kind
        self.nq = 0 if self.kind is None else self.kind.nq
        self.nv = 0 if self.kind is None else self.kind.nv
        self._word = "JointModelRX" if joint is None else joint.shortname()
        self.mimic: tuple[int, float, float] | None = None
        """Of a mimic joint: the index of the joint it follows, the ratio, and the offset."""

    def _be(self, word: str, kind: JointKind) -> None:
        JointModel.__init__(self)
        self._word, self.kind, self.nq, self.nv = word, kind, kind.nq, kind.nv

    @property
    def nvExtended(self) -> int:
        """How many velocities it has of its own, also where it mimics."""
        return 0 if self.kind is None else self.kind.nv

    def shortname(self) -> str:
        """The name of its kind."""
        return self._word

    def lieGroup(self) -> Any:
        """The Lie group of its configurations."""
        from pinocchio.liegroups import of_joint

        return of_joint(self)

    @classmethod
    def classname(cls) -> str:
        """The name of its class."""
        return cls.__name__

    def setIndexes(self, joint_id: int, idx_q: int, idx_v: int, idx_vExtended: int | None = None) -> None:
        """Says where it stands in a model."""
        self.id, self.idx_q, self.idx_v = joint_id, idx_q, idx_v
        self.idx_vExtended = idx_v if idx_vExtended is None else idx_vExtended

    def hasSameIndexes(self, other: JointModel) -> bool:
        """Whether another joint stands at the same place."""
        return (self.id, self.idx_q, self.idx_v) == (other.id, other.idx_q, other.idx_v)

    def hasConfigurationLimit(self) -> list[bool]:
        """For each entry of its q, whether a limit on it means something."""
        kind = self.kind
        return [] if kind is None else [c.unit in ("rad", "m") for c in kind.coordinates]

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        """For each entry of its v, whether a limit on its position means something."""
        if self.kind is None:
            return []
        plain = self.kind.nq == self.kind.nv
        return [plain or c.unit == "m" for c in self.kind.rates]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, JointModel):
            return NotImplemented
        return (self.kind, self.id, self.idx_q, self.idx_v, self.mimic) == (
            other.kind,
            other.id,
            other.idx_q,
            other.idx_v,
            other.mimic,
        )

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return (
            f"{self.shortname()}\n  index: {self.id}\n  index q: {self.idx_q}\n  index v: {self.idx_v}\n"
            f"  index vExtended: {self.idx_vExtended}\n  nq: {self.nq}\n  nv: {self.nv}\n"
            f"  nvExtended: {self.nvExtended}\n"
        )

    __repr__ = __str__

    def copy(self) -> JointModel:
        """One of its own, at the same place."""
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        return out

    __copy__ = copy


def _fixed_kind(word: str, kind: JointKind, doc: str) -> type[JointModel]:
    """A class of joints without parameters."""

    def __init__(self: JointModel) -> None:
        self._be(word, kind)

    return type(word, (JointModel,), {"__init__": __init__, "__doc__": doc, "__module__": __name__})


class _Unaligned(JointModel):
    """A joint about or along any axis."""

    _make: Any

    def __init__(self, *axis: Any) -> None:
        given = axis[0] if len(axis) == 1 else axis or _AXES["X"]
        self._axis: Axis = unit_axis(vector(given, 3, "axis"))
        self._be(type(self).__name__, type(self)._make(self._axis))

    @property
    def axis(self) -> Floats:
        """Its unit axis (3,)."""
        return np.array(self._axis)


class JointModelRevoluteUnaligned(_Unaligned):
    """Turns about an axis between limits; nq = 1."""

    _make = Revolute


class JointModelPrismaticUnaligned(_Unaligned):
    """Slides along an axis; nq = 1."""

    _make = Prismatic


class JointModelRevoluteUnboundedUnaligned(_Unaligned):
    """Turns about an axis without end; q is (cos, sin), nv = 1."""

    _make = Circle


class JointModelHelicalUnaligned(JointModel):
    """A screw about an axis with a pitch [m/rad]."""

    def __init__(self, *parts: Any) -> None:
        *axis, pitch = parts
        self._axis: Axis = unit_axis(vector(axis[0] if len(axis) == 1 else axis, 3, "axis"))
        self.pitch = float(pitch)
        self._be("JointModelHelicalUnaligned", Helical(self._axis, self.pitch))

    @property
    def axis(self) -> Floats:
        """Its unit axis (3,)."""
        return np.array(self._axis)


class JointModelUniversal(JointModel):
    """Turns about a first axis, then about a second one: six numbers, or two axes; nq = nv = 2."""

    def __init__(self, *parts: Any) -> None:
        first, second = parts if len(parts) == 2 else (parts[:3], parts[3:])
        one, two = (unit_axis(vector(a, 3, "axis")) for a in (first, second))
        self._be("JointModelUniversal", Universal(one, two))


class JointModelComposite(JointModel):
    """Several joints in a row: `JointModelComposite()`, then `addJoint(joint, placement)`."""

    def __init__(self, *parts: Any) -> None:
        JointModel.__init__(self)
        self._word = "JointModelComposite"
        self.joints: StdVec[JointModel] = StdVec()
        self.jointPlacements: StdVec[SE3] = StdVec()
        if parts and isinstance(parts[0], JointModel):
            self.addJoint(*parts)

    @property
    def njoints(self) -> int:
        """How many joints it is made of."""
        return len(self.joints)

    def addJoint(self, joint: JointModel, placement: SE3 | None = None) -> Self:
        """Adds a joint, placed in the moving frame of the one before."""
        if joint.kind is None or isinstance(joint.kind, Composite):
            raise InputError(
                f"JointModelComposite.addJoint was given {joint.shortname()}; expected a plain joint."
            )
        self.joints.append(joint)
        self.jointPlacements.append(SE3() if placement is None else placement.copy())
        kinds = tuple(j.kind for j in self.joints if j.kind is not None)
        self.kind = Composite(kinds, tuple(M._pose() for M in self.jointPlacements))
        self.nq, self.nv = self.kind.nq, self.kind.nv
        return self


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


def _along(letter: str, make: Any, words: str, doc: str) -> type[JointModel]:
    return _fixed_kind(f"JointModel{words}{letter}", make(_AXES[letter]), doc.format(letter.lower()))


JointModelRX, JointModelRY, JointModelRZ = (_along(c, Revolute, "R", "Turns about {}.") for c in "XYZ")
JointModelPX, JointModelPY, JointModelPZ = (_along(c, Prismatic, "P", "Slides along {}.") for c in "XYZ")
JointModelRUBX, JointModelRUBY, JointModelRUBZ = (
    _along(c, Circle, "RUB", "Turns about {} without end; q is (cos, sin).") for c in "XYZ"
)


def _screw(letter: str) -> type[JointModel]:
    word = f"JointModelH{letter}"

    def __init__(self: Any, pitch: float = 0.0) -> None:
        self.pitch = float(pitch)
        self._be(word, Helical(_AXES[letter], self.pitch))

    doc = f"A screw about {letter.lower()} with a pitch [m/rad]."
    return type(word, (JointModel,), {"__init__": __init__, "__doc__": doc, "__module__": __name__})


JointModelHX, JointModelHY, JointModelHZ = (_screw(c) for c in "XYZ")


def along(axis: Any, aligned: tuple[Any, Any, Any], unaligned: Any) -> JointModel:
    """The joint of an axis: that of a coordinate axis where it is exactly one."""
    unit = unit_axis(axis)
    for letter, make in zip("XYZ", aligned, strict=True):
        if unit == _AXES[letter]:
            return make()
    return unaligned(unit)


def revolute(axis: Any) -> JointModel:
    """A revolute joint about an axis."""
    return along(axis, (JointModelRX, JointModelRY, JointModelRZ), JointModelRevoluteUnaligned)


def continuous(axis: Any) -> JointModel:
    """A joint without end about an axis."""
    return along(axis, (JointModelRUBX, JointModelRUBY, JointModelRUBZ), JointModelRevoluteUnboundedUnaligned)


def prismatic(axis: Any) -> JointModel:
    """A prismatic joint along an axis."""
    return along(axis, (JointModelPX, JointModelPY, JointModelPZ), JointModelPrismaticUnaligned)


class JointModelMimic(JointModel):
    """A joint that follows another one: `JointModelMimic(joint, joint followed, scaling, offset)`."""

    def __init__(self, joint: JointModel, followed: JointModel, scaling: float, offset: float = 0.0) -> None:
        if joint.kind is None or followed.id == NOWHERE or (followed.nq, followed.nv) != (1, 1):
            raise InputError(
                "JointModelMimic needs a joint, and a joint with one coordinate that is in the model already, "
                "such as model.joints[1]."
            )
        self._be("JointModelMimic", joint.kind)
        self.nq = self.nv = 0
        self.mimic = (int(followed.id), float(scaling), float(offset))
        self.idx_q, self.idx_v = followed.idx_q, followed.idx_v

    @property
    def scaling(self) -> float:
        """The ratio."""
        assert self.mimic is not None
        return self.mimic[1]

    @property
    def offset(self) -> float:
        """The offset [rad, m]."""
        assert self.mimic is not None
        return self.mimic[2]
