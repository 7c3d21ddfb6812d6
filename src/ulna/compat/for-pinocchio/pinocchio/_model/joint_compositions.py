"""Joints made of others: several in a row, and a joint that follows another one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pinocchio._containers.arguments import ArgumentError, check_size, is_index
from pinocchio._containers.arrays import StdVec, real
from pinocchio._containers.attributes import AttributeKind, read_only
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name
from pinocchio._model.joint_base import NOWHERE
from pinocchio._model.joint_model import JointModel
from pinocchio._model.repeated_joint_calls import repeated
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError, UnknownName
from ulna.model import (
    Composite,
    JointKind,
)
from ulna.spatial import SE3 as Pose

__all__ = ["JointModelComposite", "JointModelMimic"]


def _chain(kind: JointKind, place: Pose) -> tuple[tuple[JointKind, ...], tuple[Pose, ...]]:
    """A kind as a chain of plain ones, with their placements."""
    if not isinstance(kind, Composite):
        return (kind,), (place,)
    assert kind.placements is not None  # a Composite fills them in
    first, *others = kind.placements
    return kind.kinds, (place @ first, *others)


class JointModelComposite(JointModel):
    """Several joints in a row: `()`, `(joint)`, `(joint, placement, name)`; then `addJoint(joint, placement)`."""

    _has_parts = True
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"joints": read_only, "jointPlacements": read_only}
    joints: StdVec[JointModel]
    """The joints it is made of."""
    jointPlacements: StdVec[SE3]
    """Where each is in the moving frame of the one before."""

    @by_name("joint_model joint_placement name", "size")
    def __init__(self, *parts: Any) -> None:
        JointModel.__init__(self)
        self._shortname = "JointModelComposite"
        self.kind: Composite | None = None
        self._keep(joints=StdVec(), jointPlacements=StdVec())
        self._names: list[str] = []
        if len(parts) == 1 and is_index(parts[0]):
            check_size(parts[0], "size")
        elif parts:
            self.addJoint(*parts)

    @classmethod
    def _of_attributes(cls, attributes: dict[str, Any]) -> Self:
        out = super()._of_attributes(attributes)
        out.__dict__.update({key: attributes[key].copy() for key in ("joints", "jointPlacements")})
        return out

    @property
    def parts(self) -> StdVec[JointModel]:
        """The joints it is made of."""
        return self.joints

    @property
    def njoints(self) -> int:
        """How many joints it is made of."""
        return len(self.joints)

    @by_name("joint_model joint_placement name")
    def addJoint(self, joint: JointModel, placement: SE3 | None = None, name: str = "") -> Self:
        """Adds a joint after the last one.

        Args:
            joint: The joint.
            placement: Its pose in the moving frame of the joint before; the identity by default.
            name: Its name.

        Returns:
            This joint.

        Raises:
            ArgumentError: It is the universe, or composite.
        """
        if joint.kind is None or isinstance(joint, JointModelComposite):
            raise ArgumentError(
                f"JointModelComposite.addJoint was given {joint.shortname()}; expected a plain joint."
            )
        place = SE3() if placement is None else placement.copy()
        joints, placements = [*self.joints, joint.copy()], [*self.jointPlacements, place]
        self._keep(joints=StdVec(joints), jointPlacements=StdVec(placements))
        self._names = [*self._names, name]
        before = ((), ()) if self.kind is None else (self.kind.kinds, self.kind.placements or ())
        kinds, places = _chain(joint.kind, place._pose())
        self.kind = Composite((*before[0], *kinds), (*before[1], *places))
        self._keep(nq=self.kind.nq, nv=self.kind.nv)
        return self

    def getJointId(self, joint_name: str) -> int:
        """The place of the joint that was added under a name. Raises UnknownPart with the nearest one."""
        if not joint_name or joint_name not in self._names:
            raise UnknownPart("part of this joint", joint_name, [n for n in self._names if n])
        return self._names.index(joint_name)

    def __str__(self) -> str:
        parts = "".join(f"  {joint.shortname()}\n" for joint in self.joints)
        return f"JointModelComposite containing following models:\n{parts}"

    __repr__ = __str__


class UnknownPart(UnknownName, ValueError):
    """A composite joint has no part of that name; Pinocchio raises a ValueError."""


class JointModelMimic(JointModel):
    """A joint that follows another one: q = scaling * q_followed + offset.

    `JointModelMimic(followed, scaling, offset)` is of the kind of what it follows; `JointModelMimic(joint, followed,
    scaling, offset)`.
    """

    @by_name("joint_model scaling offset")
    def __init__(self, joint: JointModel, *rest: Any) -> None:
        if len(rest) != (3 if rest and isinstance(rest[0], JointModel) else 2):
            raise ArgumentError(
                f"JointModelMimic was given {(joint, *rest)}; expected the joint (if it is of another kind), the joint "
                "that is followed, scaling and offset."
            )
        followed, scaling, offset = rest if rest and isinstance(rest[0], JointModel) else (joint, *rest)
        if joint.kind is None or followed.id == NOWHERE or (followed.nq, followed.nv) != (1, 1):
            raise InputError(
                "JointModelMimic needs a joint, and a joint with one coordinate that is in the model already, "
                "such as model.joints[1]."
            )
        self._set_kind("JointModelMimic", joint.kind)
        self._mimic_shortname = joint.shortname()
        self.mimic = (int(followed.id), real(scaling, "scaling"), real(offset, "offset"))
        self._keep(nq=0, nv=0, idx_q=followed.idx_q, idx_v=followed.idx_v)


register(JointModelComposite, repeated(JointModelMimic))
