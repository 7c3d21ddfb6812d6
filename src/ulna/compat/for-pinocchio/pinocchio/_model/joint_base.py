"""A kind of joint with its indices in q and v: what all joints have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

from pinocchio._containers.arrays import StdVec
from ulna.model import JointKind

NOWHERE = 2**64 - 1
"""The index of a joint that is in no model."""
_FORMER_NAMES = {
    "_word": "_shortname",
    "_within": "_wrapped",
    "_kind_word": "_mimic_shortname",
    "_columns": "_subspace",
}


def present_names(state: dict[str, Any]) -> dict[str, Any]:
    """The attributes of a pickled joint, or its data, by their present names."""
    return {_FORMER_NAMES.get(name, name): value for name, value in state.items()}


class JointBase:
    """A kind of joint and, once in a model, its index and its places in q and v."""

    _limit_entries = 1
    """How many entries of `hasConfigurationLimit` there are for each of q."""

    def __init__(self, other: JointBase | None = None) -> None:
        self.id = NOWHERE
        """The index in its model."""
        self.idx_q = self.idx_v = self.idx_vExtended = -1
        """Where its entries of q, of v, and of v with mimic joints counted begin."""
        self.kind: JointKind | None = None if other is None else other.kind
        """Ulna's kind of joint; None for the universe."""
        self.nq = 1 if self.kind is None else self.kind.nq
        """How many entries of q it has; 1 for the universe, as in Pinocchio, which has none."""
        self.nv = 1 if self.kind is None else self.kind.nv
        """How many entries of v it has; 1 for the universe, as in Pinocchio, which has none."""
        self._shortname = "JointModelRX" if other is None else other.shortname()
        self._wrapped = other
        self._mimic_shortname = ""
        self.mimic: tuple[int, float, float] | None = None if other is None else other.mimic
        """Of a mimic joint: the index of the joint it follows, the ratio, and the offset."""

    def _set_kind(self, shortname: str, kind: JointKind) -> None:
        JointBase.__init__(self)
        self._shortname, self.kind, self.nq, self.nv = shortname, kind, kind.nq, kind.nv

    @property
    def nvExtended(self) -> int:
        """How many velocities the joint has, also where it mimics."""
        return 1 if self.kind is None else self.kind.nv

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
        return self._shortname

    def extract(self) -> JointBase:
        """The joint itself, of the class of its kind."""
        return self.copy() if self._wrapped is None else self._wrapped.copy()

    @property
    def parts(self) -> Sequence[Any]:
        """The joints that it is made of; none, unless it is a JointModelComposite."""
        return ()

    @classmethod
    def classname(cls) -> str:
        """The name of its class."""
        return cls.__name__

    def setIndexes(self, joint_id: int, idx_q: int, idx_v: int, idx_vExtended: int | None = None) -> None:
        """Sets the indices of the joint in a model.

        Args:
            idx_q: Its first entry in q.
            idx_v: Its first entry in v.
            idx_vExtended: Its first entry in a v with those of following joints; `idx_v` by default.
        """
        self.id, self.idx_q, self.idx_v = joint_id, idx_q, idx_v
        self.idx_vExtended = idx_v if idx_vExtended is None else idx_vExtended

    def hasSameIndexes(self, other: JointBase) -> bool:
        """Whether another joint stands at the same place."""
        return (self.id, self.idx_q, self.idx_v) == (other.id, other.idx_q, other.idx_v)

    @property
    def hasConfigurationLimit(self) -> StdVec[bool]:
        """For each entry of its q, whether a limit on it means something; twice for a screw about a main axis."""
        if self.kind is None:
            return StdVec()
        return StdVec(c.unit in ("rad", "m") for c in self.kind.coordinates * self._limit_entries)

    @property
    def hasConfigurationLimitInTangent(self) -> StdVec[bool]:
        """For each entry of its v, whether a limit on its position means something."""
        if self.kind is None:
            return StdVec()
        plain = self.kind.nq == self.kind.nv
        return StdVec(plain or c.unit == "m" for c in self.kind.rates * self._limit_entries)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(present_names(state))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, JointBase):
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
        lines = (
            f"{self.shortname()}\n  index: {self.id}\n  index q: {self.idx_q}\n  index v: {self.idx_v}\n"
            f"  index vExtended: {self.idx_vExtended}\n  nq: {self.nq}\n  nv: {self.nv}\n"
            f"  nvExtended: {self.nvExtended}\n"
        )
        if self.mimic is None:
            return lines
        followed, scaling, offset = self.mimic
        kind = self._mimic_shortname or type(self).__name__
        return (
            f"{lines}  Mimicking joint type: {kind}\n  Mimicked joint id: {followed}\n"
            f"  Mimic scaling: {scaling:.6g}\n  Mimic offset: {offset:.6g}\n"
        )

    __repr__ = __str__

    def copy(self) -> Self:
        """A copy, with the same indices."""
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        return out

    __copy__ = copy
