"""What all constraints between two places have: the places, gains against drift, a name."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import index, real
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, one_of, text, whole
from pinocchio._containers.enums import _Named
from pinocchio._containers.files import register
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError
from ulna.typing import Array, Floats

__all__ = ["BaumgarteCorrectorParameters", "ConstraintSelectionType", "ContactType"]


changes = array("q", [0])
"""How often an attribute of any constraint was set; placements and gains are read at every call."""
watched_changes: Array = np.frombuffer(changes, np.int64)
"""The same number (1,), for kernels that are bound to constraints as they are."""


class ContactType(_Named):
    """What a constraint holds: a point, or a frame."""

    CONTACT_3D = 0
    CONTACT_6D = 1
    CONTACT_UNDEFINED = 2


class ConstraintSelectionType(_Named):
    """Which rows of a constraint: those that are active now, or all that could be."""

    CURRENT = 0
    MAXIMAL = 1


@final
class BaumgarteCorrectorParameters:
    """Gains that pull a constraint together again: its error e follows e'' + Kd e' + Kp e = 0."""

    __slots__ = ("_v",)

    def __init__(self, Kp: float, Kd: float) -> None:
        self._v = np.array([real(Kp, "Kp"), real(Kd, "Kd")])

    @property
    def Kp(self) -> float:
        """The proportional gain [1/s^2]."""
        return float(self._v[0])

    @Kp.setter
    def Kp(self, value: float) -> None:
        self._v[0] = real(value, "Kp")

    @property
    def Kd(self) -> float:
        """The damping gain [1/s]."""
        return float(self._v[1])

    @Kd.setter
    def Kd(self, value: float) -> None:
        self._v[1] = real(value, "Kd")

    def _assign(self, other: Any) -> None:
        if not isinstance(other, BaumgarteCorrectorParameters):
            raise ArgumentError(f"The gains are {other!r}; expected BaumgarteCorrectorParameters(Kp, Kd).")
        self._v[:] = other._v

    @classmethod
    def _of(cls, gains: Any) -> BaumgarteCorrectorParameters:
        """Gains that an array holds."""
        return cls(*gains)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BaumgarteCorrectorParameters):
            return NotImplemented
        return (self.Kp, self.Kd) == (other.Kp, other.Kd)

    __hash__ = object.__hash__


register(BaumgarteCorrectorParameters)


class FramePair(CheckedAttributes):
    """Two placements that belong together: of a joint and of a second one, or of the world (joint 0)."""

    __slots__ = (
        "_gains",
        "_places",
        "joint1_id",
        "joint1_placement",
        "joint2_id",
        "joint2_placement",
        "name",
    )

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "name": text,
        **dict.fromkeys(("joint1_id", "joint2_id"), whole),
        **dict.fromkeys(("joint1_placement", "joint2_placement"), one_of(SE3)),
    }
    _binds_always: ClassVar[bool] = True
    """Whether two places of one joint, which bind nothing, are refused."""

    def _attach(self, model: Model, positional: Sequence[Any], named: dict[str, Any]) -> None:
        """Reads (joint, placement, joint, placement); placements may be left out, and the second joint."""
        self.name = ""
        joints: list[Any] = []
        placements: dict[int, Any] = {}
        for part in positional:
            if isinstance(part, SE3) and joints and len(joints) - 1 not in placements:
                placements[len(joints) - 1] = part
            elif isinstance(part, (int, np.integer)) and len(joints) < 2:
                joints.append(part)
            else:
                raise ArgumentError(
                    f"{type(self).__name__} was given {part!r} at the place of a joint or its placement; expected "
                    "an index of a joint and an SE3, and the same of a second joint."
                )
        for k, joint in enumerate(joints):
            named.setdefault(f"joint{k + 1}_id", joint)
        for k, placement in placements.items():
            named.setdefault(f"joint{k + 1}_placement", placement)
        if "joint1_id" not in named:
            raise ArgumentError(
                f"{type(self).__name__} was given no joint; model.getJointId(name) returns one."
            )
        fix = "model.getJointId(name) returns one."
        self.joint1_id = index(named.pop("joint1_id"), model.njoints, "joint", fix)
        self.joint2_id = index(named.pop("joint2_id", 0), model.njoints, "joint", fix)
        self._place(np.stack([SE3(named.pop(f"joint{k}_placement", 1))._m for k in (1, 2)]))
        self._gains = BaumgarteCorrectorParameters(0.0, 0.0)
        if named:
            raise InputError(f"{type(self).__name__} has no {', '.join(named)}.")
        if self._binds_always and self.joint1_id == self.joint2_id:
            raise InputError(
                f"{type(self).__name__} is between two places of joint {self.joint1_id}, so that it binds nothing; "
                "give two joints, of which one may be 0, the world."
            )

    def _place(self, places: Floats) -> None:
        """Takes over an array (2, 4, 4) of both placements."""
        self._keep(_places=places, joint1_placement=SE3._of(places[0]), joint2_placement=SE3._of(places[1]))

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        changes[0] += 1

    def _keep(self, **values: Any) -> None:
        super()._keep(**values)
        changes[0] += 1

    @property
    def baumgarte_corrector_parameters(self) -> BaumgarteCorrectorParameters:
        """The gains against drift, live."""
        return self._gains

    @baumgarte_corrector_parameters.setter
    def baumgarte_corrector_parameters(self, gains: BaumgarteCorrectorParameters) -> None:
        self._gains._assign(gains)

    m_baumgarte_parameters = baumgarte_corrector_parameters

    def setBaumgarteCorrectorParameters(
        self, bp: BaumgarteCorrectorParameters, sel: Any = ConstraintSelectionType.CURRENT
    ) -> None:
        """Sets the gains against drift.

        Args:
            sel: Accepted and ignored.
        """
        self.baumgarte_corrector_parameters = bp
