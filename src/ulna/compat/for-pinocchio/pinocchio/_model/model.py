"""Model: the mutable tree of joints, whose placements and inertias are live references."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from operator import is_
from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec, alike, fixed, is_float_array, vector
from pinocchio._containers.attributes import AttributeKind, computed, read_only, text
from pinocchio._containers.computed_lists import ComputedList
from pinocchio._containers.enums import FrameType
from pinocchio._containers.files import Saved, register
from pinocchio._containers.keywords import by_name
from pinocchio._containers.named_configurations import StdMap_String_VectorXd
from pinocchio._data.data import Data
from pinocchio._model.building import KinematicTree
from pinocchio._model.core_model import core_model
from pinocchio._model.frame import Frame
from pinocchio._model.joint_base import LAST_CHANGE
from pinocchio._model.joint_kinds import JointModel
from pinocchio._model.live_parameters import PER_Q, PER_V
from pinocchio._model.name_list import NameList
from pinocchio._model.row_storage import OwnerList
from pinocchio._model.skeleton import Skeleton
from pinocchio._model.supports import Supports, children_of, subtrees_of, supports_of
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna.errors import excerpt
from ulna.typing import Floats


def _per_joint(name: str, number: Callable[[Any], int], doc: str) -> Any:
    """A list of one number of each joint, which is made anew when a joint has changed."""

    def get(self: Model) -> StdVec[int]:
        joints, known = self.joints, self._lists_of_joints
        if (
            known[0] != LAST_CHANGE[0]
            or len(known[1]) != len(joints)
            or not all(map(is_, known[1], joints))
            or known[2]
        ):
            has_parts = any([joint._has_parts for joint in joints])  # which may change without being counted
            known = self.__dict__["_lists_of_joints"] = LAST_CHANGE[0], list(joints), has_parts, {}
        if name not in known[3]:
            known[3][name] = ComputedList(map(number, joints))
        return known[3][name]

    return property(get, doc=doc)


def _of_parents(name: str, make: Callable[[list[int]], list[list[int]]], doc: str) -> Any:
    """A list of joints for each joint, which is made anew when the tree has changed."""

    def get(self: Model) -> StdVec[StdVec[int]]:
        parents, known = self.parents, self._lists_of_parents
        if not list.__eq__(known[0], parents):
            known = self.__dict__["_lists_of_parents"] = list(parents), {}
        if name not in known[1]:
            known[1][name] = ComputedList(map(ComputedList, make(known[0])))
        return known[1][name]

    return property(get, doc=doc)


@final
class Model(Saved, Supports, KinematicTree):
    """A kinematic tree. Joint 0 is the universe; every other joint follows its parent."""

    if TYPE_CHECKING:  # made below, by their names
        lowerPositionLimit: Floats
        upperPositionLimit: Floats
        positionLimitMargin: Floats
        armature: Floats
        lowerVelocityLimit: Floats
        upperVelocityLimit: Floats
        lowerEffortLimit: Floats
        upperEffortLimit: Floats
        lowerDryFrictionLimit: Floats
        upperDryFrictionLimit: Floats
        damping: Floats
        rotorInertia: Floats
        rotorGearRatio: Floats
        velocityLimit: Floats
        effortLimit: Floats
        friction: Floats

    _lists_of_joints: tuple[Any, ...] = -1, [], False, {}
    """The last change of a joint, the joints then, whether some have parts, and lists of their numbers."""
    _lists_of_parents: tuple[list[int], dict[str, Any]] = [], {}
    """For each joint the joint before it, and lists that are made of these."""
    gravity981: ClassVar[Floats] = fixed(np.array([0.0, 0.0, -9.81]))
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "name": text,
        **dict.fromkeys(
            ("names", "parents", "joints", "inertias", "nq", "nv", "nvExtended", "nbodies"), read_only
        ),
        **dict.fromkeys(("supports", "subtrees", "span_indexes_vector"), computed),
        **dict.fromkeys(("sparsity_pattern_vector", "mimic_joint_supports"), computed),
        **dict.fromkeys(("mimicking_joints", "mimicked_joints"), computed),
        "gravity981": read_only,
    }

    @by_name("clone", "other")
    def __init__(self, other: Model | None = None) -> None:
        if other is not None:
            self._become_copy(other)
        else:
            self.__dict__.update(_empty(), _numbers=_empty()["_numbers"].copy())

    def _begin(self) -> None:
        """Makes a new object a model of the universe alone."""
        self._create_storage()
        self.name = ""
        """The name of the model."""
        self._keep(names=NameList(["universe"]), parents=StdVec([0]), joints=StdVec([JointModel()]))
        self._placements, self._inertias = OwnerList([SE3()]), OwnerList([Inertia()])
        self.frames = [Frame("universe", 0, 0, SE3(), FrameType.FIXED_JOINT)]
        self._configurations = StdMap_String_VectorXd()
        self._gravity = Motion._of(np.concatenate([self.gravity981, np.zeros(3)]))
        self._arrays = {key: np.zeros(0) for key in (*PER_Q, *PER_V)}
        self._keep(nq=0, nv=0, nvExtended=0, nbodies=1)
        self._changed()

    # sizes and the tree ---------------------------------------------------------------------------------

    nqs = _per_joint("nqs", lambda j: j.nq if j.kind else 0, "For each joint its entries of q.")
    nvs = _per_joint("nvs", lambda j: j.nv if j.kind else 0, "For each joint its entries of v.")
    idx_qs = _per_joint("idx_qs", lambda j: max(j.idx_q, 0), "For each joint where its q begins.")
    idx_vs = _per_joint("idx_vs", lambda j: max(j.idx_v, 0), "For each joint where its v begins.")
    nvExtendeds = _per_joint(
        "nvExtendeds", lambda j: j.nvExtended if j.kind else 0, "Like nvs, mimic joints counted."
    )
    idx_vExtendeds = _per_joint(
        "idx_vExtendeds", lambda j: max(j.idx_vExtended, 0), "Like idx_vs, mimic joints counted."
    )
    mimicking_joints = property(
        lambda self: ComputedList(i for i, j in enumerate(self.joints) if j.mimic),
        doc="Joints that follow others.",
    )
    mimicked_joints = property(
        lambda self: ComputedList(j.mimic[0] for j in self.joints if j.mimic),
        doc="The joints that those follow.",
    )
    supports = _of_parents("supports", supports_of, "For each joint, the joints from the universe to it.")
    subtrees = _of_parents(
        "subtrees",
        subtrees_of,
        "For each joint, the joints it moves, itself included; the universe is not counted.",
    )
    children = _of_parents("children", children_of, "For each joint, the joints that follow it at once.")

    def getChildJoints(self) -> StdVec[int]:
        """The joints that no other joint follows: the ends of the tree. Those after a joint are `children[i]`."""
        return StdVec(i for i, after in enumerate(self.children) if i and not after)

    # named configurations ---------------------------------------------------------------------------------------

    @property
    def referenceConfigurations(self) -> StdMap_String_VectorXd:
        """Named configurations; iterating yields entries with `key()` and `data()`."""
        return self._configurations

    @referenceConfigurations.setter
    def referenceConfigurations(self, values: Any) -> None:
        if not isinstance(values, Mapping):
            raise ArgumentError(
                f"`referenceConfigurations` is {excerpt(repr(values))}; expected a dictionary of named configurations."
            )
        self._configurations = StdMap_String_VectorXd(values)

    # data -----------------------------------------------------------------------------------------------

    def createData(self) -> Data:
        """What algorithms write their results into."""
        return Data(self)

    def check(self, data: Data) -> bool:
        """Whether a Data fits this model."""
        return data._layout == self._layout

    def hasConfigurationLimit(self) -> StdVec[bool]:
        """For each entry of q, whether a limit on it means something."""
        return StdVec(x for j in self.joints if not j.mimic for x in j.hasConfigurationLimit)

    def hasConfigurationLimitInTangent(self) -> StdVec[bool]:
        """For each entry of v, whether a limit on its position means something."""
        return StdVec(x for j in self.joints if not j.mimic for x in j.hasConfigurationLimitInTangent)

    # copies and files -----------------------------------------------------------------------------------

    def __getstate__(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "names": list(self.names),
            "parents": list(self.parents),
            "joints": [j.copy() for j in self.joints],
            "_placements": [M.copy() for M in self._placements],
            "_inertias": [i.copy() for i in self._inertias],
            "frames": [f.copy() for f in self.frames],
            "referenceConfigurations": {k: q.copy() for k, q in self.referenceConfigurations.items()},
            "_gravity": self._gravity.copy(),
            "_arrays": {key: a.copy() for key, a in self._arrays.items()},
            "sizes": (self.nq, self.nv, self.nvExtended, self.nbodies),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        values = dict(state)
        if "_rows" not in self.__dict__:
            self._create_storage()
        self._keep(**dict(zip(_SIZES, values.pop("sizes"), strict=True)))
        for key, value in values.items():
            kind = _KINDS_OF_LISTS.get(key, StdVec)
            self._keep(**{key: kind(value) if isinstance(value, list) else value})
        self._changed()

    def copy(self) -> Model:
        """A copy."""
        out = object.__new__(Model)
        out._become_copy(self)
        return out

    def _become_copy(self, other: Model) -> None:
        skeleton, numbers = other._state_now()
        own, its = self.__dict__, other.__dict__
        own.update(
            {name: its[name] for name in ("name", "_layout", *_SIZES)}, _skeleton=skeleton, _numbers=numbers
        )
        if its.get("_configurations"):
            own["_configurations"] = other._configurations._copied()

    @staticmethod
    def _made_of(skeleton: Skeleton, numbers: Floats, layout: tuple[Any, ...]) -> Model:
        """The model of these joints and frames, and of all its numbers (n,), which it takes."""
        out = object.__new__(Model)
        vars(out).update(_skeleton=skeleton, _numbers=numbers, _layout=layout, nq=skeleton.nq, nv=skeleton.nv)
        return out

    __copy__ = cast = copy

    def __reduce__(self) -> Any:  # as a copy has it, which takes half the time of what `__getstate__` says
        skeleton, numbers = self._state_now()
        rest = {name: self.__dict__[name] for name in ("name", "_layout", *_SIZES)}
        return _restored, (skeleton, numbers, rest, dict(self.referenceConfigurations))

    def __deepcopy__(self, memo: Any) -> Model:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        (skeleton, numbers), (its_skeleton, its_numbers) = self._state_now(), other._state_now()
        if skeleton == its_skeleton and self.name == other.name:
            return numbers.shape == its_numbers.shape and bool((numbers == its_numbers).all())
        same = all(np.array_equal(a, other._arrays[key]) for key, a in self._arrays.items())
        keys = ("name", "names", "parents", "joints", "_placements", "_inertias", "frames", "_gravity")
        return same and all(alike(getattr(self, key), getattr(other, key)) for key in keys)

    __hash__ = object.__hash__

    def __str__(self) -> str:
        joints = enumerate(zip(self.names, self.parents, strict=True))
        lines = [f"  Joint {i} {name}: parent={parent}\n" for i, (name, parent) in joints]
        return f"Nb joints = {self.njoints} (nq={self.nq},nv={self.nv})\n" + "".join(lines)

    __repr__ = __str__

    def ulna(self) -> Any:
        """Ulna's model of the present parameters, for `ulna.Robot(model.ulna())`.

        Raises:
            InputError: Gravity has an angular part.
        """
        self._check_gravity()
        return core_model(self)


@cache
def _empty() -> dict[str, Any]:
    """The attributes of a model of the universe alone, as copies have them."""
    first, copied = object.__new__(Model), object.__new__(Model)
    first._begin()
    copied._become_copy(first)
    return vars(copied)


_KINDS_OF_LISTS = {"names": NameList, "_placements": OwnerList, "_inertias": OwnerList}
_SIZES = ("nq", "nv", "nvExtended", "nbodies")


def _restored(
    skeleton: Skeleton, numbers: Floats, rest: dict[str, Any], configurations: dict[str, Floats]
) -> Model:
    """The model that `Model.__reduce__` tells of."""
    out = object.__new__(Model)
    vars(out).update(rest, _skeleton=skeleton, _numbers=numbers)
    if configurations:
        out._configurations = StdMap_String_VectorXd(configurations)
    return out


def _array(key: str, size: str) -> property:
    def get(self: Model) -> Floats:
        return self._arrays[key]

    def put(self: Model, value: Any) -> None:
        own = self._arrays[key]
        usual = is_float_array(value) and value.shape == own.shape
        own[:] = value if usual else vector(value, getattr(self, size), key)

    return property(get, put, doc=f"`{key}` of all joints, ({size},), live; assigning copies into it.")


for _key in PER_Q:
    setattr(Model, _key, _array(_key, "nq"))
for _key in PER_V:
    setattr(Model, _key, _array(_key, "nv"))
for _old, _new in (
    ("velocityLimit", "upperVelocityLimit"),
    ("effortLimit", "upperEffortLimit"),
    ("friction", "upperDryFrictionLimit"),
):
    setattr(Model, _old, _array(_new, "nv"))


register(Model)
Data._empty_model = Model
