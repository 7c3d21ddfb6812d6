"""The parameters of a model, stored so that references to them stay live and changes are cheap to see.

Placements and inertias of joints, and placements of frames, lie in rows that never move from the moment a joint or
frame is added; a change of any is seen by comparing a few blocks of memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import is_
from typing import TYPE_CHECKING, Any, ClassVar, Self, final

import numpy as np

from pinocchio._containers.arguments import WrongShape
from pinocchio._containers.arrays import StdVec, entries_of, numbers
from pinocchio._containers.attributes import CheckedAttributes, checked_list
from pinocchio._containers.enums import FrameType
from pinocchio._containers.named_configurations import StdMap_String_VectorXd
from pinocchio._model.frame import JOINT_FRAMES, Facts, Frame
from pinocchio._model.joint_base import LAST_CHANGE
from pinocchio._model.joint_model import JointModel
from pinocchio._model.name_list import NameList
from pinocchio._model.row_storage import OwnerList, RowStorage
from pinocchio._model.skeleton import SLOTS, Attributes, Skeleton, gathered, gravity_of, joints_with
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError
from ulna.system import forks
from ulna.typing import Array, Floats

FREE = float(np.finfo(float).max)
"""What limits are where there is none."""
PER_Q = {"lowerPositionLimit": -FREE, "upperPositionLimit": FREE, "positionLimitMargin": 0.0}
PER_V = {
    "armature": 0.0,
    "lowerVelocityLimit": -FREE,
    "upperVelocityLimit": FREE,
    "lowerEffortLimit": -FREE,
    "upperEffortLimit": FREE,
    "lowerDryFrictionLimit": -0.0,
    "upperDryFrictionLimit": 0.0,
    "damping": 0.0,
    "rotorInertia": 0.0,
    "rotorGearRatio": 1.0,
}
USUAL = {key: [value] for key, value in (PER_Q | PER_V).items()}
"""The entries of a new joint, by the names of the arrays."""


class FrameList(StdVec[Frame]):
    """The frames of a model; `changes` counts how often one was added, removed or changed."""

    def __init__(self, frames: Iterable[Frame] = (), changes: Array | None = None) -> None:
        super().__init__(frames)
        self.changes = np.zeros(1, np.int64) if changes is None else changes
        self._count_added(self)

    def _count_added(self, frames: Iterable[Frame]) -> None:
        self.changes[0] += 1
        for frame in frames:
            frame._add_counter(self.changes)

    def fill(self, frames: list[Frame]) -> None:
        """Adds frames that count their changes in `changes` already."""
        list.extend(self, frames)
        self.changes[0] += 1

    def append(self, frame: Frame) -> None:
        """Adds a copy of a frame at the end."""
        self.take(self._checked(frame))

    def take(self, frame: Frame) -> None:
        """Adds a frame at the end, and no copy of it."""
        list.append(self, frame)
        self._count_added([frame])

    def insert(self, place: Any, frame: Frame) -> None:
        """Adds a frame.

        Args:
            place: Index of the frame that it stands before.
            frame: The frame.
        """
        super().insert(place, frame)
        self._count_added([frame])

    def extend(self, frames: Iterable[Frame]) -> None:
        """Adds copies of frames at the end."""
        added = [self._checked(frame) for frame in entries_of(frames, "A list of frames")]
        list.extend(self, added)
        self._count_added(added)

    def __iadd__(self, frames: Iterable[Frame]) -> Self:
        self.extend(frames)
        return self

    def __reduce__(self) -> Any:
        return FrameList, (list(self),)


FrameList.__name__ = "StdVec_Frame"  # as scripts see it


def _counted(name: str) -> Any:
    change = getattr(list, name)

    def method(self: FrameList, *args: Any, **options: Any) -> Any:
        result = change(self, *args, **options)
        self.changes[0] += 1
        return result

    method.__name__, method.__doc__ = name, change.__doc__
    return method


for _name in ("pop", "remove", "clear", "reverse", "sort", "__delitem__"):
    setattr(FrameList, _name, _counted(_name))


@final
class FrameIndex:
    """Where frames are in a list, by their names, and which is the first of each joint.

    Attributes:
        places: For each name that one frame alone has, its index.
        by_name: For each name the indices of its frames.
        bodies: For each name that frames of bodies have, the index of the one; -1 where several have it.
        of_joint: For each joint the index of the first frame of type JOINT or FIXED_JOINT on it.
    """

    __slots__ = ("bodies", "by_name", "of_joint", "places")

    def __init__(self, frames: Iterable[Frame]) -> None:
        self.by_name: dict[str, list[int]] = {}
        self.bodies: dict[str, int] = {}
        self.of_joint: dict[int, int] = {}
        self.places: dict[str, int] = {}
        for place, frame in enumerate(frames):
            self.add(frame, place)

    def add(self, frame: Frame, place: int) -> None:
        """Takes the next frame.

        Args:
            frame: The frame.
            place: Its index, above all others.
        """
        name, kind, joint, *_ = frame._facts
        places = self.by_name.setdefault(name, [])
        places.append(place)
        if len(places) == 1:
            self.places[name] = place
        else:
            self.places.pop(name, None)
        if kind is FrameType.BODY:
            self.bodies[name] = -1 if name in self.bodies else place
        if kind in JOINT_FRAMES:
            self.of_joint.setdefault(joint, place)


class LiveParameters(CheckedAttributes):
    """Joints, frames and inertias of a Model, and where their parameters are stored."""

    name: str
    names: NameList
    """Names of the joints."""
    parents: StdVec[int]
    """For each joint, the joint before it."""
    joints: StdVec[JointModel]
    """The joints."""
    nq: int
    nv: int
    _layout: tuple[Any, ...]
    """For each joint its name and where its entries begin."""
    _placements: OwnerList
    _inertias: OwnerList
    _gravity: Motion
    _configurations: StdMap_String_VectorXd
    _frames: FrameList
    _stored_arrays: dict[str, Floats]
    _array_blocks: list[Floats]
    """The arrays of `_arrays` as rows: those with entries for each q, and for each v."""
    _new_entries: list[Any]
    """What the arrays of joints are still without, for each new joint; see `_arrays`."""
    _skeleton: Skeleton
    """Of a copy: what lists of joints and frames are made of, when they are first asked for."""
    _numbers: Floats
    """Of a copy: all numbers (n,), of which rows and arrays are views; see `skeleton.gathered`."""
    _rows: dict[str, RowStorage]
    _known_facts: tuple[int, int, tuple[Facts, ...], list[int]] | None = None
    """The count of changes and the number of frames, what was known of each then, and those with inertias that others
    may change without being counted.
    """
    _known_joints: tuple[int, tuple[JointModel, ...], tuple[Attributes, ...]] | None = None
    """The last change of a joint, the joints, and what their attributes were then."""
    _counted_changes = _indexed_changes = _stored_changes = -1
    _frame_owners: tuple[Any, ...] = ()
    _frame_index: FrameIndex
    _frame_changes: Array
    _made_when_needed: ClassVar[dict[str, Callable[[Any], Any]]]
    """How attributes are made that a model does not have yet; those of a copy mostly are made of its rows."""

    def _create_storage(self) -> None:
        self._frames = FrameList((), self._frame_changes)
        self._rows = {name: RowStorage(slot) for name, slot in SLOTS.items()}

    def _store_all(self) -> None:
        """Moves the arrays of new joints and frames into rows, where their objects are made."""
        made = self.__dict__
        if (
            "_placements" in made
            and "_inertias" in made
            and (self._placements.is_new or self._inertias.is_new)
        ):
            self._store_joints()
        if "_frames" in made:
            self._store_frames()

    def _facts_of_frames(self) -> tuple[Facts, ...]:
        """What is known of each frame; see `Frame._facts_now`."""
        frames: Any = self.__dict__.get("_frames")
        if frames is None:
            return self._skeleton.frames
        changes, known = self._frame_changes.item(), self._known_facts
        if known is not None and known[0] == changes and known[1] == len(frames):
            if not known[3]:
                return known[2]
            now = list(known[2])
            for k in known[3]:
                now[k] = frames[k]._facts_now()
            return tuple(now)
        facts = tuple([frame._facts_now() for frame in frames])
        read = [k for k, frame in enumerate(frames) if frame._inertia is not None]
        self._known_facts = changes, len(frames), facts, read
        return facts

    def _attributes_of_joints(self) -> tuple[Attributes, ...]:
        """The class and the attributes of each joint."""
        joints: Any = self.__dict__.get("joints")
        if joints is None:
            return self._skeleton.joints
        change, known = LAST_CHANGE[0], self._known_joints
        same = known is not None and known[0] == change and len(known[1]) == len(joints)
        if known is not None and same and all(map(is_, known[1], joints)):
            return known[2]
        if any([joint._has_parts for joint in joints]):  # which may change without being counted
            return tuple([(type(joint), joint.copy().__dict__) for joint in joints])
        attributes = tuple([(type(joint), joint.__dict__.copy()) for joint in joints])
        self._known_joints = change, tuple(joints), attributes
        return attributes

    def _skeleton_now(self) -> Skeleton:
        """Its joints and frames as they are now, without their numbers."""
        made = self.__dict__
        known = made.get("_skeleton")
        if known is not None and made.keys().isdisjoint(_OF_SKELETON):
            return known
        if known is not None and "_numbers" in made:
            nq, nv = known.nq, known.nv
        else:
            nq, nv = (block.shape[1] for block in self._array_blocks)
        parts = (
            tuple(self.names) if known is None or "names" in made else known.names,
            tuple(self.parents) if known is None or "parents" in made else known.parents,
            self._attributes_of_joints(),
            self._facts_of_frames(),
            nq,
            nv,
        )
        return _new_tuple(Skeleton, parts)  # a third of the time

    def _numbers_now(self) -> Floats:
        """All its numbers in a new array."""
        numbers = self.__dict__.get("_numbers")
        if numbers is not None:
            return numbers.copy()
        blocks = [block for part in self._rows.values() for block in part.blocks()]
        return gathered(blocks, self._array_blocks, self._gravity._v)

    def _leave_numbers(self) -> None:
        """Some numbers of a copy no longer lie in the array of all of them."""
        if "_numbers" in self.__dict__:
            _ = self._rows, self._array_blocks, self._gravity  # views of it
            del self._numbers

    def _state_now(self) -> tuple[Skeleton, Floats]:
        """Its joints and frames without their numbers, and all numbers in a new array (n,)."""
        with _MAKING:
            self._store_all()
            if self.__dict__.get("_new_entries"):
                _ = self._arrays
            return self._skeleton_now(), self._numbers_now()

    if not TYPE_CHECKING:  # for type checkers the attributes are there

        def __getattr__(self, name: str) -> Any:
            """What is made when it is first asked for: joints and frames of a copy, counters."""
            make = self._made_when_needed.get(name)
            if make is None:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            with _MAKING:
                if name not in self.__dict__:  # another thread may have made it meanwhile
                    self.__dict__[name] = make(self)
            return self.__dict__[name]

    def _made_frames(self) -> FrameList:
        """The frames of a copy."""
        places, counters = self._rows["frames"].objects(SE3._of), (self._frame_changes,)
        known = self._skeleton.frames
        out = FrameList((), self._frame_changes.copy())
        out.fill([Frame._from_facts(facts, at, counters) for facts, at in zip(known, places, strict=True)])
        out.changes = self._frame_changes
        self._known_facts = out.changes.item(), len(known), known, []
        return out

    @property
    def _arrays(self) -> dict[str, Floats]:
        """The arrays with entries for each q or v, by their names; those of new joints are added when they are read."""
        if self._new_entries:
            with _MAKING:
                if self._new_entries:  # another thread may have added them meanwhile
                    self._arrays = extended(self._stored_arrays, self._new_entries)
        return self._stored_arrays

    @_arrays.setter
    def _arrays(self, arrays: dict[str, Floats]) -> None:
        self._leave_numbers()
        self._array_blocks = [np.stack([arrays[key] for key in keys]) for keys in (PER_Q, PER_V)]
        self._stored_arrays, self._new_entries = _rows_by_name(self), []

    @property
    def njoints(self) -> int:
        """How many joints there are, the universe included."""
        return len(self._layout)

    @property
    def nframes(self) -> int:
        """How many frames there are."""
        frames: Any = self.__dict__.get("_frames")
        return len(self._skeleton.frames) if frames is None else len(frames)

    @property
    def frames(self) -> StdVec[Frame]:
        """The frames, live references."""
        return self._frames

    @frames.setter
    def frames(self, values: Any) -> None:
        self._frames = FrameList(
            checked_list("frames", values, Frame, "a list of Frame"), self._frame_changes
        )

    @property
    def jointPlacements(self) -> StdVec[SE3]:
        """For each joint, where it is in the frame of the joint before it; live references."""
        return self._placements

    @jointPlacements.setter
    def jointPlacements(self, values: Any) -> None:
        self._placements[:] = checked_list(
            "jointPlacements", values, SE3, "a list of SE3, one for each joint"
        )

    jointPosition = jointPlacements
    """The historic name of `jointPlacements`."""

    @property
    def inertias(self) -> StdVec[Inertia]:
        """For each joint, the inertia of all that is fixed to it, in its frame; live references."""
        return self._inertias

    @property
    def gravity(self) -> Motion:
        """The acceleration of free fall, a live reference."""
        return self._gravity

    @gravity.setter
    def gravity(self, value: Any) -> None:
        if type(value) is Motion:
            self._gravity._assign(value)
            return
        array = numbers(value.vector if isinstance(value, Motion) else value, "gravity")
        if array.size not in (3, 6):
            raise WrongShape("gravity", array.shape, "a Motion, or 3 or 6 numbers")
        self._gravity._assign(np.concatenate([array.reshape(-1), np.zeros(6 - array.size)]))

    def _parameter_blocks(self, name: str) -> list[Floats]:
        """The blocks in which the parameters of that name, one of `PARAMETERS` or "frames", are stored.

        Of gravity that is the linear part; what depends on it calls `_check_gravity` first.
        """
        if name == "gravity":
            return [self._gravity._v[:3]]
        if name == "armature":
            return [self._arrays["armature"]]
        return self._rows[name].blocks()

    def _check_gravity(self, on: str = "parameters") -> None:
        """Checks that gravity has no angular part, where it counts.

        Args:
            on: What a function depends on; see `KernelCache._watched`.

        Raises:
            InputError: It has one, and the function reads gravity.
        """
        angular = self._gravity._v[3:]
        if on == "parameters" and angular.any():
            raise InputError(
                f"The angular part of model.gravity is {angular.tolist()}; expected zeros: gravity is a linear "
                "acceleration (3,) [m/s^2] here. Set model.gravity.angular = np.zeros(3), and add accelerations of the "
                "base as those of a joint."
            )

    def _store_joints(self) -> None:
        for name, owners in (("placements", self._placements), ("inertias", self._inertias)):
            if self._rows[name].adopt(owners):
                self._leave_numbers()
            owners.is_new = False

    def _store_last_joint(self) -> None:
        """A joint was added at the end."""
        for name, owners in (("placements", self._placements), ("inertias", self._inertias)):
            if not self._rows[name].adopt_last(owners[-1], len(owners)):
                self._rows[name].adopt(owners)
            owners.is_new = False
        self._leave_numbers()

    def _store_frames(self) -> None:
        changes = self._frame_changes.item()
        if self._stored_changes != changes or self._rows["frames"].count != len(self._frames):
            if self._rows["frames"].adopt([frame._placement for frame in self._frames]):
                self._leave_numbers()
            self._stored_changes = changes

    def _add_last_frame(self, frame: Frame) -> None:
        """Adds a frame at the end."""
        index = self._index_of_frames()
        self._frames.take(frame)
        index.add(frame, len(self._frames) - 1)
        self._indexed_changes = int(self._frame_changes[0])
        if self._rows["frames"].adopt_last(self._frames[-1]._placement, len(self._frames)):
            self._leave_numbers()
        else:
            self._store_frames()

    def _count_joint(self) -> None:
        """A joint was added, which changes no frame."""
        self._frame_changes[0] += 1
        self._indexed_changes += 1

    def _frames_changed(self) -> None:
        """Frames or joints were added."""
        self._frame_changes[0] += 1
        self._store_frames()

    def _watched_frames(self) -> list[tuple[Array, Array]]:
        """The count of changes of joints and frames, and a copy of it, (1,) each."""
        return [(self._frame_changes, self._frame_changes.copy())]

    def _index_of_frames(self) -> FrameIndex:
        """Where the frames are by their names; made anew when one was changed."""
        changes = self._frame_changes.item()
        if changes != self._indexed_changes:
            self._indexed_changes, self._frame_index = changes, FrameIndex(self._frames)
        return self._frame_index

    def _frame_state(self) -> tuple[Any, bytes]:
        """A key that changes when a frame of this model does."""
        count = int(self._frame_changes[0])
        if count != self._counted_changes:
            self._counted_changes = count
            self._frame_owners = tuple((f.name, f.parentJoint) for f in self._frames)
            self._store_frames()
        return self._frame_owners, b"".join(part.tobytes() for part in self._rows["frames"].blocks())


def extended(
    arrays: dict[str, Floats], joints: Iterable[tuple[int, int, dict[str, list[float]]]]
) -> dict[str, Floats]:
    """The arrays of joints, (nq,) or (nv,) each, with entries for more joints.

    Args:
        arrays: The arrays (n,) by their names.
        joints: For each new joint its nq and nv, and the entries that are not the usual ones, by the names of arrays:
            one for all, or one for each.

    Returns:
        New arrays (n,) by their names.
    """
    out = {}
    for key, array in arrays.items():
        per_q, default = key in PER_Q, USUAL[key]
        entries = array.tolist()
        for nq, nv, values in joints:
            more = values.get(key, default)
            entries += more if len(more) > 1 else more * (nq if per_q else nv)
        out[key] = np.array(entries, dtype=float)
    return out


def _rows_by_name(model: LiveParameters) -> dict[str, Floats]:
    per_q, per_v = model._array_blocks
    return dict(zip(PER_Q, per_q, strict=True)) | dict(zip(PER_V, per_v, strict=True))


LiveParameters._made_when_needed = {
    "names": lambda model: NameList(model._skeleton.names),
    "parents": lambda model: StdVec(model._skeleton.parents),
    "joints": lambda model: joints_with(model._skeleton.joints),
    "_rows": lambda model: model._skeleton.rows(model._numbers),
    "_placements": lambda model: OwnerList(model._rows["placements"].objects(SE3._of)),
    "_inertias": lambda model: OwnerList(model._rows["inertias"].objects(Inertia._of)),
    "_frames": LiveParameters._made_frames,
    "_gravity": lambda model: Motion._of(gravity_of(model._numbers)),
    "_array_blocks": lambda model: model._skeleton.array_blocks(model._numbers),
    "_stored_arrays": _rows_by_name,
    "_new_entries": lambda _: [],
    "_frame_changes": lambda _: np.zeros(1, np.int64),
    "_configurations": lambda _: StdMap_String_VectorXd(),
}
_new_tuple = tuple.__new__
_OF_SKELETON = frozenset(("names", "parents", "joints", "_frames"))
"""The attributes that a skeleton tells of."""
_MAKING = forks.lock(forks.KERNEL)
