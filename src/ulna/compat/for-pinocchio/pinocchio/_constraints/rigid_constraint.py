"""Constraints between two joints, or of a joint to the world, and what is known of them at a state."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Self, final

import numpy as np

from pinocchio._constraints.frame_pair import (
    BaumgarteCorrectorParameters,
    ConstraintSelectionType,
    ContactType,
    FramePair,
)
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec, alike
from pinocchio._containers.attributes import AttributeKind, one_of, read_only, refused
from pinocchio._containers.enums import ReferenceFrame
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Force, Motion
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError, excerpt, nearest
from ulna.typing import Floats

__all__ = ["RigidConstraintData"]


def _member(*members: Any) -> AttributeKind:
    """The kind of attributes that are one of some members of an enumeration."""
    expected = f"{' or '.join(one.name for one in members)} of {type(members[0]).__name__}"

    def kind(_: Any, name: str, value: Any) -> Any:
        if type(value) is not type(members[0]) or value not in members:
            raise refused(name, value, expected)
        return value

    return kind


class RigidConstraint(FramePair):
    """`RigidConstraintModel(type, model, joint1[, placement1[, joint2, placement2]][, reference_frame])`.

    A point (CONTACT_3D) or a frame (CONTACT_6D) of one joint goes with one of another, or with one of the world, at
    `joint2_placement`. Forces are written along the first frame (LOCAL) or the world's axes (LOCAL_WORLD_ALIGNED).
    """

    __slots__ = (
        "_depths",
        "desired_contact_acceleration",
        "desired_contact_placement",
        "desired_contact_velocity",
        "reference_frame",
        "type",
    )
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "desired_contact_placement": one_of(SE3),
        **dict.fromkeys(("desired_contact_velocity", "desired_contact_acceleration"), one_of(Motion)),
        "reference_frame": _member(ReferenceFrame.LOCAL, ReferenceFrame.LOCAL_WORLD_ALIGNED),
        "type": _member(ContactType.CONTACT_3D, ContactType.CONTACT_6D),
    }

    @by_name(
        "contact_type model joint1_id reference_frame",
        "contact_type model joint1_id joint1_placement reference_frame",
        "contact_type model joint1_id joint1_placement joint2_id joint2_placement reference_frame",
        "contact_type model joint1_id joint2_id reference_frame",
        "clone",
    )
    def __init__(self, *args: Any) -> None:
        if len(args) == 1 and isinstance(args[0], RigidConstraint):
            self._copy(args[0])
            return
        parts = list(args)
        kind = parts.pop(0) if parts else None
        model: Any = parts.pop(0) if parts else None
        rf = parts.pop() if parts and isinstance(parts[-1], ReferenceFrame) else ReferenceFrame.LOCAL
        self._check(kind, model)
        self.type = kind
        self.reference_frame = rf
        self._attach(model, parts, {})
        self._depths = tuple(len(model.supports[joint]) for joint in (self.joint1_id, self.joint2_id))
        self.desired_contact_placement = SE3()
        self.desired_contact_velocity, self.desired_contact_acceleration = Motion(), Motion()

    @staticmethod
    def _check(kind: Any, model: Any) -> None:
        if not isinstance(kind, ContactType) or kind == ContactType.CONTACT_UNDEFINED:
            raise ArgumentError(
                f"The type of contact is {kind!r}; expected ContactType.CONTACT_3D or ContactType.CONTACT_6D."
            )
        if not isinstance(model, Model):
            raise ArgumentError(f"The model is {model!r}; expected a pinocchio.Model.")

    def _copy(self, other: RigidConstraint) -> None:
        self._place(other._places.copy())
        self._gains = BaumgarteCorrectorParameters(other._gains.Kp, other._gains.Kd)
        for name in ("name", "joint1_id", "joint2_id", "type", "reference_frame", "_depths"):
            setattr(self, name, getattr(other, name))
        for name in ("placement", "velocity", "acceleration"):
            setattr(self, f"desired_contact_{name}", getattr(other, f"desired_contact_{name}").copy())

    def copy(self) -> Self:
        """A copy."""
        return type(self)(self)

    cast = __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RigidConstraint):
            return NotImplemented
        return (
            self._shape() == other._shape()
            and np.array_equal(self._places, other._places)
            and self._gains == other._gains
        )

    __hash__ = object.__hash__

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows it has: 3 or 6."""
        return 6 if self.type == ContactType.CONTACT_6D else 3

    size = residualSize

    def retrieveCompliance(self, sel: Any = ConstraintSelectionType.CURRENT) -> Floats:
        """The compliance of its rows: none, zeros."""
        return np.zeros(self.residualSize())

    def _shape(self) -> tuple[int, bool, int, int]:
        """What a kernel depends on: rows, whether they are written in local axes, the joints."""
        local = self.reference_frame == ReferenceFrame.LOCAL
        return self.residualSize(), local, self.joint1_id, self.joint2_id

    def createData(self) -> RigidConstraintData:
        """What is known of it at a state; filled by algorithms."""
        return RigidConstraintData(self)


_PLACES = ("oMc1", "oMc2", "c1Mc2")
_MOTIONS = (
    "contact1_velocity",
    "contact2_velocity",
    "contact_placement_error",
    "contact_velocity_error",
    "contact_acceleration_error",
)


@final
class RigidConstraintData:
    """What is known of a constraint at a state: placements, velocities, errors, its force."""

    __slots__ = (
        "_blocks",
        "_deferred",
        "_left",
        "_size",
        "_views",
    )

    def __init__(self, contact_model: RigidConstraint) -> None:
        if not isinstance(contact_model, RigidConstraint):
            raise ArgumentError(f"The constraint is {contact_model!r}; expected a RigidConstraintModel.")
        self._size = contact_model.residualSize()
        self._deferred: Any = None
        self._left: dict[str, str] = {}
        self._blocks = {n: np.eye(4) for n in _PLACES} | {n: np.zeros(6) for n in _MOTIONS}
        self._views: dict[str, Any] = {n: SE3._of(self._blocks[n]) for n in _PLACES}
        self._views |= {n: Motion._of(self._blocks[n]) for n in _MOTIONS}
        self._views |= {"contact_force": Force(), "contact_acceleration_desired": Motion()}
        self._views |= {n: Motion() for n in _DRIFTS}
        depths = contact_model._depths[0], *contact_model._depths
        self._views |= {n: StdVec(np.zeros((k, 6, 6))) for n, k in zip(_PER_SUPPORT, depths, strict=True)}

    def copy(self) -> RigidConstraintData:
        """A copy."""
        if self._deferred is not None:
            self._deferred.fill()
        out = object.__new__(RigidConstraintData)
        out._size, out._deferred, out._left = self._size, None, dict(self._left)
        out._blocks = {name: block.copy() for name, block in self._blocks.items()}
        out._views = {
            name: type(view)._of(out._blocks[name]) if name in out._blocks else copy.copy(view)
            for name, view in self._views.items()
        }
        return out

    __copy__ = copy

    def _leave(self, function: str, fields: Sequence[str]) -> None:
        """Notes that a function left intermediate results in fields, in Pinocchio, and nothing here."""
        self._left |= dict.fromkeys(fields, function)

    def _place(self, model: RigidConstraint, data: Data) -> None:
        oMi, blocks = data._arrays["oMi"], self._blocks
        self._deferred = None
        for name, joint, place in zip(
            _PLACES, (model.joint1_id, model.joint2_id), model._places, strict=False
        ):
            np.matmul(oMi[joint], place, out=blocks[name])
        blocks["c1Mc2"][:] = self._views["oMc1"].actInv(self._views["oMc2"])._m

    def __getattr__(self, name: str) -> Any:
        near = nearest(name, _FIELDS, 1, 0.6)
        raise AttributeError(
            f"RigidConstraintData has no field {name!r}." + (f" Did you mean {near[0]!r}?" if near else "")
        )

    def __repr__(self) -> str:
        force = self._views["contact_force"].vector.round(6).tolist()
        return f"<RigidConstraintData of {self._size} rows, force {force}>"


_FIELDS = (*_PLACES, *_MOTIONS, "contact_force", "contact_acceleration_desired")
_DRIFTS = (
    "contact1_acceleration_drift",
    "contact2_acceleration_drift",
    "contact_acceleration",
    "contact_acceleration_deviation",
)
_PER_SUPPORT = ("lambdas_joint1", "extended_motion_propagators_joint1", "extended_motion_propagators_joint2")
DYNAMICS_LEAVE = _DRIFTS[:3]
"""Fields in which constraintDynamics leaves intermediate results in Pinocchio."""
DELASSUS_LEAVES = _PER_SUPPORT[1:]
"""Fields in which computeDampedDelassusMatrixInverse does."""


def _field(name: str) -> property:
    def get(self: RigidConstraintData) -> Any:
        if self._deferred is not None and name in _DEFERRED:
            self._deferred.fill()
        return self._views[name]

    kind = one_of(SE3 if name in _PLACES else Force if name == "contact_force" else Motion)

    def put(self: RigidConstraintData, value: Any) -> None:
        kind(self, name, value)

    return property(get, put, doc=f"`{name}` as the last algorithm left it, live.")


def _workspace(name: str) -> property:
    def get(self: RigidConstraintData) -> Any:
        if name in self._left:
            raise InputError(
                f"`{name}` was invalidated by {self._left[name]}, which leaves an intermediate result there in "
                "Pinocchio, and nothing here. Read contact_acceleration_error, contact_velocity_error, "
                "contact1_velocity or contact2_velocity."
            )
        return self._views[name]

    kind = one_of(Motion)

    def put(self: RigidConstraintData, value: Any) -> None:
        if name in _DRIFTS:
            self._views[name]._assign(kind(None, name, value))
            self._left.pop(name, None)
        elif not alike(self._views[name], value):
            read_only(self, name, value)

    return property(get, put, doc=f"`{name}`: zero until an algorithm of Pinocchio would use it.")


_DEFERRED = frozenset((*_PLACES, *_MOTIONS))
for _name in _FIELDS:
    setattr(RigidConstraintData, _name, _field(_name))
for _name in (*_DRIFTS, *_PER_SUPPORT):
    setattr(RigidConstraintData, _name, _workspace(_name))


def checked_constraints(model: Model, models: Any, datas: Any) -> list[RigidConstraint]:
    """The constraints, checked against their data and the model.

    Returns:
        The constraints as a list.

    Raises:
        ArgumentError: Something is no constraint, or no data of one.
        InputError: The data is of another constraint, or a joint is not one of the model.
    """
    if not (isinstance(models, (list, tuple)) and isinstance(datas, (list, tuple))):
        wrong = datas if isinstance(models, (list, tuple)) else models
        raise ArgumentError(f"Constraints, or their data, are {excerpt(repr(wrong))}; expected a list.")
    if len(models) != len(datas):
        raise InputError(
            f"There are {len(models)} constraints and {len(datas)} data of constraints; expected as many."
        )
    for one, data in zip(models, datas, strict=True):
        if not isinstance(one, RigidConstraint) or not isinstance(data, RigidConstraintData):
            raise ArgumentError(
                f"The constraint is {one!r} and its data {data!r}; expected a RigidConstraintModel and what its "
                "createData() returns."
            )
        if data._size != one.residualSize():
            raise InputError(
                f"The data of a constraint has {data._size} rows, the constraint {one.residualSize()}; make it anew: "
                "constraint.createData()."
            )
        if not 0 <= min(one.joint1_id, one.joint2_id) < max(one.joint1_id, one.joint2_id) < model.njoints:
            raise InputError(
                f"A constraint is between the joints {one.joint1_id} and {one.joint2_id}; the model has "
                f"{model.njoints}. It was made for another model."
            )
    return list(models)


def structures_of(models: Sequence[RigidConstraint]) -> tuple[tuple[int, bool, int, int], ...]:
    """What kernels depend on, for each: rows, whether they are written in local axes, the joints."""
    return tuple(one._shape() for one in models)
