"""The parameters of a model, stored so that references to them stay live and changes are cheap to see.

Placements and inertias of joints, and placements of frames, lie in rows that never move from the moment a joint or
frame is added; a change of any is seen by comparing a few blocks of memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import is_
from typing import TYPE_CHECKING, Any, ClassVar, Self, final

import numpy as np

from pinocchio._containers.arrays import StdVec, numbers
from pinocchio._model.frame import JOINT_FRAMES, Frame
from pinocchio._model.joint_model import JointModel
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna.system import forks
from ulna.typing import Array, Floats

_BLOCK_ROWS = 64
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


@final
class RowStorage:
    """Stores the arrays of objects as rows of blocks; `slot` is the attribute in which an object holds its array."""

    __slots__ = ("_blocks", "_owners", "_slot", "count")

    def __init__(self, slot: str) -> None:
        self._slot = slot
        self._owners: list[Any] = []
        self._blocks: list[Floats] = []
        self.count = 0
        """How many rows are in use."""

    def adopt(self, owners: list[Any]) -> bool:
        """Moves the arrays of new objects into rows; returns whether there were any."""
        known = len(self._owners)
        made = known == self.count  # else these are not the objects of a copied storage
        same = made and len(owners) >= known and all(map(is_, owners, self._owners))
        if same and len(owners) == known:
            return False
        if not same:
            self._owners, self._blocks, self.count = [], [], 0
        for owner in owners[len(self._owners) :]:
            self._append(owner)
        return True

    def adopt_last(self, owner: Any, count: int) -> bool:
        """Moves the array of the last object into a row, where it alone is new.

        Args:
            owner: The last of the objects.
            count: How many there are.

        Returns:
            Whether it alone was new; else nothing has changed.
        """
        if count != self.count + 1:
            return False
        self._append(owner)
        return True

    def _append(self, owner: Any) -> None:
        values = getattr(owner, self._slot)
        at = self.count % _BLOCK_ROWS
        if at == 0:
            self._blocks.append(np.zeros((_BLOCK_ROWS, *values.shape)))
        row = self._blocks[-1][at]
        row[...] = values
        setattr(owner, self._slot, row)
        self._owners.append(owner)
        self.count += 1

    def copied(self) -> RowStorage:
        """A storage with copies of the rows, whose objects are not made yet; see `objects`."""
        out = object.__new__(RowStorage)
        out._slot, out._owners, out.count = self._slot, [], self.count
        out._blocks = [block.copy() for block in self._blocks]
        return out

    @classmethod
    def of_rows(cls, slot: str, rows: Floats) -> RowStorage:
        """A storage of rows whose objects are not made yet; see `objects`.

        Args:
            slot: The attribute in which an object holds its array.
            rows: The arrays (n, ...), one after the other; they are copied.

        Returns:
            The storage.
        """
        out = cls(slot)
        out.count = len(rows)
        for first in range(0, len(rows), _BLOCK_ROWS):
            block = np.zeros((_BLOCK_ROWS, *rows.shape[1:]))
            part = rows[first : first + _BLOCK_ROWS]
            block[: len(part)] = part
            out._blocks.append(block)
        return out

    def objects(self, make: Callable[[Floats], Any]) -> list[Any]:
        """The objects of a copy, each made of its row by `make`."""
        self._owners = [make(row) for block in self.blocks() for row in block]
        return [*self._owners]

    def blocks(self) -> list[Floats]:
        """The rows in use."""
        return [block[: self.count - k * _BLOCK_ROWS] for k, block in enumerate(self._blocks)]


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
        super().extend(frames)
        self.changes[0] += 1

    def append(self, frame: Frame) -> None:
        """Adds a frame at the end."""
        super().append(frame)
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
        """Adds frames at the end."""
        added = list(frames)
        super().extend(added)
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
        by_name: For each name the indices of its frames.
        of_joint: For each joint the index of the first frame of type JOINT or FIXED_JOINT on it.
    """

    __slots__ = ("by_name", "of_joint")

    def __init__(self, frames: Iterable[Frame]) -> None:
        self.by_name: dict[str, list[int]] = {}
        self.of_joint: dict[int, int] = {}
        for place, frame in enumerate(frames):
            self.add(frame, place)

    def add(self, frame: Frame, place: int) -> None:
        """Takes the next frame.

        Args:
            frame: The frame.
            place: Its index, above all others.
        """
        name, kind, joint, *_ = frame._facts
        self.by_name.setdefault(name, []).append(place)
        if kind in JOINT_FRAMES:
            self.of_joint.setdefault(joint, place)


class LiveParameters:
    """Joints, frames and inertias of a Model, and where their parameters are stored."""

    name: str
    names: StdVec[str]
    parents: StdVec[int]
    joints: StdVec[JointModel]
    nq: int
    nv: int
    _placements: StdVec[SE3]
    _inertias: StdVec[Inertia]
    _gravity: Motion
    _frames: FrameList
    _stored_arrays: dict[str, Floats]
    _array_blocks: list[Floats]
    """The arrays of `_arrays` as rows: those with entries for each q, and for each v."""
    _new_entries: list[Any]
    """What the arrays of joints are still without, for each new joint; see `_arrays`."""
    _frames_of_copy: list[Any]
    """What a copy knows of its frames, until these are made."""
    _joints_of_copy: list[tuple[type, dict[str, Any]]]
    """The class and the attributes of each joint of a copy, until these are made."""
    _counted_changes = _indexed_changes = _stored_changes = -1
    _frame_owners: tuple[Any, ...] = ()
    _frame_index: FrameIndex
    _frame_changes: Array
    _made_when_needed: ClassVar[dict[str, Callable[[Any], Any]]]
    """How attributes are made that a model does not have yet; those of a copy mostly are made of its rows."""

    def _create_storage(self) -> None:
        self._frames = FrameList((), self._frame_changes)
        self._rows = {
            "placements": RowStorage("_m"),
            "inertias": RowStorage("_p"),
            "frames": RowStorage("_m"),
        }

    def _take_rows(self, rows: dict[str, Floats], facts: list[Any]) -> None:
        """Takes placements, inertias and frames, whose objects are made when needed.

        Args:
            rows: The arrays (n, ...) of each, one after the other, by their names.
            facts: What is known of each frame; see `Frame._facts_now`.
        """
        slots = {"placements": "_m", "inertias": "_p", "frames": "_m"}
        self._rows = {name: RowStorage.of_rows(slots[name], rows[name]) for name in slots}
        self._frames_of_copy = facts

    def _store_all(self) -> None:
        """Moves the arrays of new joints and frames into rows, where their objects are made."""
        if {"_placements", "_inertias"} <= self.__dict__.keys():
            self._store_joints()
        if "_frames" in self.__dict__:
            self._store_frames()

    def _rows_of(self, name: str) -> Floats:
        """A copy of all placements, inertias or frames, one after the other."""
        with _MAKING:
            self._store_all()
            return np.concatenate(self._rows[name].blocks())

    def _facts_of_frames(self) -> list[Any]:
        """What is known of each frame; see `Frame._facts_now`."""
        frames: Any = self.__dict__.get("_frames")
        if frames is None:
            return self._frames_of_copy[:]
        return [frame._facts if frame._inertia is None else frame._facts_now() for frame in frames]

    def _copy_rows(self, other: LiveParameters) -> None:
        """Copies joints, frames and their parameters of another model; their objects are made when needed."""
        with _MAKING:
            other._store_all()
            self._rows = {name: rows.copied() for name, rows in other._rows.items()}
            self._frames_of_copy = other._facts_of_frames()
            joints = other.__dict__.get("joints")
            self._joints_of_copy = (
                other._joints_of_copy if joints is None else [(type(j), j.__dict__.copy()) for j in joints]
            )
            if other._new_entries:
                _ = other._arrays
            self._array_blocks, self._new_entries = [block.copy() for block in other._array_blocks], []

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
        out = FrameList((), self._frame_changes.copy())
        out.fill(
            [
                Frame._from_facts(facts, at, counters)
                for facts, at in zip(self._frames_of_copy, places, strict=True)
            ]
        )
        out.changes, self._frames_of_copy = self._frame_changes, []
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
        self._array_blocks = [np.stack([arrays[key] for key in keys]) for keys in (PER_Q, PER_V)]
        self._stored_arrays, self._new_entries = _rows_by_name(self), []

    @property
    def njoints(self) -> int:
        """How many joints there are, the universe included."""
        return len(self.names)

    @property
    def nframes(self) -> int:
        """How many frames there are."""
        frames: Any = self.__dict__.get("_frames")
        return self._rows["frames"].count if frames is None else len(frames)

    @property
    def frames(self) -> StdVec[Frame]:
        """The frames, live references."""
        return self._frames

    @frames.setter
    def frames(self, values: Any) -> None:
        self._frames = FrameList(values, self._frame_changes)

    @property
    def jointPlacements(self) -> StdVec[SE3]:
        """For each joint, where it is in the frame of the joint before it; live references."""
        return self._placements

    @jointPlacements.setter
    def jointPlacements(self, values: Any) -> None:
        self._placements[:] = values

    jointPosition = jointPlacements
    """The historic name of `jointPlacements`."""

    @property
    def inertias(self) -> StdVec[Inertia]:
        """For each joint, the inertia of all that is fixed to it, in its frame; live references."""
        return self._inertias

    @inertias.setter
    def inertias(self, values: Any) -> None:
        self._inertias[:] = values

    @property
    def gravity(self) -> Motion:
        """The acceleration of free fall, a live reference."""
        return self._gravity

    @gravity.setter
    def gravity(self, value: Any) -> None:
        array = numbers(value.vector if isinstance(value, Motion) else value, "value")
        self._gravity._assign(array if array.size == 6 else np.concatenate([array.reshape(3), np.zeros(3)]))

    def _parameter_blocks(self, name: str) -> list[Floats]:
        """The blocks in which the parameters of that name, one of `PARAMETERS` or "frames", are stored."""
        if name == "gravity":
            return [self._gravity._v]
        if name == "armature":
            return [self._arrays["armature"]]
        return self._rows[name].blocks()

    def _store_joints(self) -> None:
        self._rows["placements"].adopt(self._placements)
        self._rows["inertias"].adopt(self._inertias)

    def _store_last_joint(self) -> None:
        """A joint was added at the end."""
        for name, owners in (("placements", self._placements), ("inertias", self._inertias)):
            if not self._rows[name].adopt_last(owners[-1], len(owners)):
                self._rows[name].adopt(owners)

    def _store_frames(self) -> None:
        changes = self._frame_changes.item()
        if self._stored_changes != changes or self._rows["frames"].count != len(self._frames):
            self._rows["frames"].adopt([frame._placement for frame in self._frames])
            self._stored_changes = changes

    def _add_last_frame(self, frame: Frame) -> None:
        """Adds a frame at the end."""
        index = self._index_of_frames()
        self._frames.append(frame)
        index.add(frame, len(self._frames) - 1)
        self._indexed_changes = int(self._frame_changes[0])
        if not self._rows["frames"].adopt_last(self._frames[-1]._placement, len(self._frames)):
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
        changes = int(self._frame_changes[0])
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


def _made_joints(model: LiveParameters) -> StdVec[JointModel]:
    """The joints of a copy."""
    joints = []
    for kind, attributes in model._joints_of_copy:
        joints.append(object.__new__(kind))
        joints[-1].__dict__.update(attributes)
    model._joints_of_copy = []
    return StdVec(joints)


LiveParameters._made_when_needed = {
    "joints": _made_joints,
    "_placements": lambda model: StdVec(model._rows["placements"].objects(SE3._of)),
    "_inertias": lambda model: StdVec(model._rows["inertias"].objects(Inertia._of)),
    "_frames": LiveParameters._made_frames,
    "_stored_arrays": _rows_by_name,
    "_frame_changes": lambda _: np.zeros(1, np.int64),
}
_MAKING = forks.lock(forks.KERNEL)
