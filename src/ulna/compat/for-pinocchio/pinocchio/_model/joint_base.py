"""A kind of joint with its indices in q and v: what all joints have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, ClassVar, Self

from pinocchio._containers.arrays import StdVec
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, ReadOnlyAttribute, read_only
from ulna.model import JointKind

LAST_CHANGE = [0]
"""The number of the last change of an attribute of any joint."""
_numbers_of_changes = count(1)
NOWHERE = 2**64 - 1
"""The index of a joint that is in no model."""
_UNIVERSE = {
    "id": NOWHERE,
    "idx_q": -1,
    "idx_v": -1,
    "idx_vExtended": -1,
    "kind": None,
    "nq": 1,
    "nv": 1,
    "mimic": None,
    "_shortname": "JointModelRX",
    "_wrapped": None,
    "_mimic_shortname": "",
}
"""The attributes of a joint without a kind, in no model."""
_FORMER_NAMES = {
    "_word": "_shortname",
    "_within": "_wrapped",
    "_kind_word": "_mimic_shortname",
    "_columns": "_subspace",
}


def present_names(state: dict[str, Any]) -> dict[str, Any]:
    """The attributes of a pickled joint, or its data, by their present names."""
    return {_FORMER_NAMES.get(name, name): value for name, value in state.items()}


class JointBase(CheckedAttributes):
    """A kind of joint and, once in a model, its index and its places in q and v.

    Its slots hold what is known until an attribute changes, which copies begin without: how `calc` runs without Python,
    and the data that `createData` copies.
    """

    __slots__ = ("__dict__", "__weakref__", "_calls", "_neutral", "_tables")
    _calls: Any
    _neutral: Any
    _tables: Any
    _kinds: ClassVar[Mapping[str, AttributeKind]] = dict.fromkeys(
        ("id", "idx_q", "idx_v", "idx_vExtended", "nq", "nv"), read_only
    )

    _limit_entries = 1
    """How many entries of `hasConfigurationLimit` there are for each of q."""
    _has_parts = False
    """Whether its attributes hold objects that change."""

    id: int
    """The index in its model."""
    idx_q: int
    """Where its entries of q begin."""
    idx_v: int
    """Where its entries of v begin."""
    idx_vExtended: int
    """Where its entries of v begin, with mimic joints counted."""
    kind: JointKind | None
    """Ulna's kind of joint; None for the universe."""
    nq: int
    """How many entries of q it has; 1 for the universe, as in Pinocchio, which has none."""
    nv: int
    """How many entries of v it has; 1 for the universe, as in Pinocchio, which has none."""
    mimic: tuple[int, float, float] | None
    """Of a mimic joint: the index of the joint it follows, the ratio, and the offset."""
    _shortname: str
    _wrapped: JointBase | None
    _mimic_shortname: str
    _held = False
    """Whether a model holds it: there it is a JointModel, whatever its kind, and its data are a JointData."""

    def __init__(self, other: JointBase | None = None) -> None:
        if other is None:
            self.__dict__.update(_UNIVERSE)
            return
        kind = other.kind
        sizes = (1, 1) if kind is None else (kind.nq, kind.nv)
        self.__dict__.update(
            _UNIVERSE,
            kind=kind,
            nq=sizes[0],
            nv=sizes[1],
            _shortname=other.shortname(),
            _wrapped=other,
            mimic=other.mimic,
        )

    def _set_kind(self, shortname: str, kind: JointKind) -> None:
        """Makes a new joint one of a kind."""
        self.__dict__.update(_UNIVERSE, _shortname=shortname, kind=kind, nq=kind.nq, nv=kind.nv)

    def _change_kind(self, **values: Any) -> None:
        """Changes axes or lengths of its kind, before a model has it.

        Raises:
            ReadOnlyAttribute: It is in a model, whose code was compiled for them.
        """
        if self.id != NOWHERE:
            raise ReadOnlyAttribute(
                f"{' and '.join(values)} of joint {self.id} cannot be changed any more; make a new joint, and add it."
            )
        self.kind = replace(self.kind, **values)  # type: ignore[type-var]

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
        out = self.copy() if self._wrapped is None else self._wrapped.copy()
        out.__dict__.pop("_held", None)
        return out

    def held(self) -> Self:
        """A copy for a model."""
        out = self.copy()
        out.__dict__["_held"] = True
        return out

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
        extended = idx_v if idx_vExtended is None else idx_vExtended
        self.__dict__.update(id=joint_id, idx_q=idx_q, idx_v=idx_v, idx_vExtended=extended)
        self._count_change()

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

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        self._count_change()

    def _keep(self, **values: Any) -> None:
        super()._keep(**values)
        self._count_change()

    def _count_change(self) -> None:
        """Counts a change of an attribute, and forgets what was known."""
        LAST_CHANGE[0] = next(_numbers_of_changes)
        self._know(_calls=None, _tables=None, _neutral=None)

    def _know(self, **values: Any) -> None:
        """Fills slots."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(present_names(state))
        self._count_change()

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
        return self._of_attributes(self.__dict__)

    @classmethod
    def _of_attributes(cls, attributes: dict[str, Any]) -> Self:
        """A joint of this class with a copy of the attributes of another."""
        out = object.__new__(cls)
        out.__dict__.update(attributes)
        return out

    __copy__ = copy
