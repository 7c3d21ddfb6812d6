"""JointModel: a kind of joint with its places in q and v; what all kinds have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._containers.arrays import StdVec
from ulna.model import JointKind

if TYPE_CHECKING:
    from pinocchio._model.joint_data import JointData

NOWHERE = 2**64 - 1
"""The index of a joint that is in no model."""


class JointModel:
    """A kind of joint and, once in a model, its index and its places in q and v."""

    def __init__(self, other: JointModel | None = None) -> None:
        self.id = NOWHERE
        """The index in its model."""
        self.idx_q = self.idx_v = self.idx_vExtended = -1
        """Where its entries of q, of v, and of v with mimic joints counted begin."""
        self.kind: JointKind | None = None if other is None else other.kind
        """The tower's kind; None for the universe."""
        self.nq = 0 if self.kind is None else self.kind.nq
        """How many entries of q it has."""
        self.nv = 0 if self.kind is None else self.kind.nv
        """How many entries of v it has."""
        self._word = "JointModelRX" if other is None else other.shortname()
        self._within = other
        self._kind_word = ""
        self.mimic: tuple[int, float, float] | None = None if other is None else other.mimic
        """Of a mimic joint: the index of the joint it follows, the ratio, and the offset."""

    def _be(self, word: str, kind: JointKind) -> None:
        JointModel.__init__(self)
        self._word, self.kind, self.nq, self.nv = word, kind, kind.nq, kind.nv

    @property
    def nvExtended(self) -> int:
        """How many velocities it has of its own, also where it mimics."""
        return 0 if self.kind is None else self.kind.nv

    @property
    def scaling(self) -> float:
        """Of a mimic joint: the ratio."""
        return self._followed()[1]

    @property
    def offset(self) -> float:
        """Of a mimic joint: the offset [rad, m]."""
        return self._followed()[2]

    def _followed(self) -> tuple[int, float, float]:
        if self.mimic is None:
            raise AttributeError(
                f"{self.shortname()} follows no joint; only a JointModelMimic has a ratio and an offset."
            )
        return self.mimic

    def shortname(self) -> str:
        """The name of its kind."""
        return self._word

    def extract(self) -> JointModel:
        """The joint itself, of the class of its kind."""
        return self.copy() if self._within is None else self._within.copy()

    def createData(self) -> JointData:
        """What `calc` writes into."""
        from pinocchio._model.joint_data import data_of

        return data_of(self)

    def calc(self, jdata: JointData, q: Any, v: Any = None) -> None:
        """Fills a JointData at configuration `q` (of the model, or its own entries) and velocity `v`."""
        if self.kind is not None:
            own_v = None if v is None else _own(v, self.idx_v, self.kind.nv)
            jdata.place(self, _own(q, self.idx_q, self.kind.nq), own_v)

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

    @property
    def hasConfigurationLimit(self) -> StdVec[bool]:
        """For each entry of its q, whether a limit on it means something."""
        return (
            StdVec() if self.kind is None else StdVec(c.unit in ("rad", "m") for c in self.kind.coordinates)
        )

    @property
    def hasConfigurationLimitInTangent(self) -> StdVec[bool]:
        """For each entry of its v, whether a limit on its position means something."""
        if self.kind is None:
            return StdVec()
        plain = self.kind.nq == self.kind.nv
        return StdVec(plain or c.unit == "m" for c in self.kind.rates)

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
        told = (
            f"{self.shortname()}\n  index: {self.id}\n  index q: {self.idx_q}\n  index v: {self.idx_v}\n"
            f"  index vExtended: {self.idx_vExtended}\n  nq: {self.nq}\n  nv: {self.nv}\n"
            f"  nvExtended: {self.nvExtended}\n"
        )
        if self.mimic is None:
            return told
        followed, scaling, offset = self.mimic
        return (
            f"{told}  Mimicking joint type: {self._kind_word or type(self).__name__}\n  Mimicked joint id: {followed}\n"
            f"  Mimic scaling: {scaling:.6g}\n  Mimic offset: {offset:.6g}\n"
        )

    __repr__ = __str__

    def copy(self) -> JointModel:
        """One of its own, at the same place."""
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        return out

    __copy__ = copy


def _own(values: Any, start: int, size: int) -> Any:
    """The `size` entries of a joint among those of its model."""
    first = max(start, 0)
    return np.asarray(values, dtype=float).reshape(-1)[first : first + size]
