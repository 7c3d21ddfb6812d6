"""A model with some of its joints locked: what of its structure remains, then its numbers at a configuration."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import vector
from pinocchio._containers.enums import FrameType
from pinocchio._containers.named_configurations import StdMap_String_VectorXd
from pinocchio._model.model import Model
from pinocchio._model.skeleton import Skeleton, gathered, remembered, renumbered
from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from ulna import spatial
from ulna.errors import InputError
from ulna.model import Prismatic, Revolute
from ulna.typing import Array, Floats

Moved = list[tuple[int, SE3 | None]]
"""For each joint of a model, the joint of the reduced one that carries it, and its frame there; None for the same."""


def reduced_model(model: Model, locked: list[int], reference: Any) -> tuple[Model, Moved]:
    """The model with some joints locked, and where each of its joints is in it.

    Args:
        locked: Indices of the joints that are locked.
        reference: The configuration (nq,) at which they are.

    Returns:
        The reduced model, and where the joints are.

    Raises:
        InputError: The universe is to be locked, a joint twice, or a joint without the one that follows it.
    """
    q = vector(reference, model.nq, "reference_configuration")
    skeleton, numbers = model._state_now()
    structure = _structure_of(skeleton, locked)
    placed = structure.lock(numbers, q)
    out = Model._made_of(structure.skeleton_with(numbers), numbers.take(structure.index), structure.layout)
    out._keep(name=model.name, nbodies=len(structure.kept), nvExtended=structure.nvExtended)
    if model.referenceConfigurations:
        references = {name: x[structure.of_q] for name, x in model.referenceConfigurations.items()}
        out._configurations = StdMap_String_VectorXd(references)
    return out, [(carrier, placed.get(i)) for i, carrier in enumerate(structure.carriers)]


_KNOWN: dict[Any, _Structure] = {}


def _structure_of(skeleton: Skeleton, locked: list[int]) -> _Structure:
    key = tuple(locked), skeleton.names, skeleton.parents
    known = _KNOWN.get(key)
    if (
        known is not None
        and known.source.joints is skeleton.joints
        and known.source.frames is skeleton.frames
    ):
        return known
    _check(skeleton, locked)
    return remembered(_KNOWN, key, _Structure(skeleton, set(locked)))


@final
class _Structure:
    """What remains of a model without some joints, whatever its numbers.

    Attributes:
        source: The joints and frames of the model.
        kept: The joints that are kept.
        carriers: For each joint of the model, the new index of the joint that carries it.
        of_q: Which entries of q are kept.
        index: Which of the model's numbers, once changed by `lock`, are those of the reduced one (n,).
        layout: See `KernelCache._layout`.
    """

    def __init__(self, source: Skeleton, locked: set[int]) -> None:
        self.source, self.kept, self.carriers = source, list[int](), list[int]()
        for i, parent in enumerate(source.parents):
            self.carriers.append(self.carriers[parent] if i in locked else len(self.kept))
            if i not in locked:
                self.kept.append(i)
        self._steps = [
            (i, parent in locked, i in locked)
            for i, parent in enumerate(source.parents)
            if i in locked or parent in locked
        ]
        self._axes = {
            i: (_ALONG[type(kind).transform], np.array(kind.axis))
            for i, kind in ((i, source.joints[i][1]["kind"]) for i in locked)
            if type(kind).transform in _ALONG
        }
        self.of_q, self._of_v = _entries(source, locked)
        self.index = self._index()
        joints, self.layout, self.nvExtended = renumbered(
            (source.joints[i], self.carriers) for i in self.kept
        )
        moved = [(k, facts[2]) for k, facts in enumerate(source.frames) if facts[2] in locked]
        self._bodies = [(k, joint) for k, joint in moved if source.frames[k][1] == FrameType.JOINT]
        self._moved_frames = _ranges(moved)
        frames = tuple([(*facts[:2], self.carriers[facts[2]], *facts[3:]) for facts in source.frames])
        self._skeleton = Skeleton(
            tuple([source.names[i] for i in self.kept]),
            tuple([self.carriers[source.parents[i]] for i in self.kept]),
            joints,
            frames,
            len(self.of_q),
            len(self._of_v),
        )

    def _index(self) -> Array:
        joints, frames, source = len(self.source.joints), len(self.source.frames), self.source
        places: Any = np.arange(29 * joints + 16 * frames + 3 * source.nq + 10 * source.nv + 6)
        placements, inertias, of_frames = source.row_blocks(places)
        per_q, per_v = source.array_blocks(places)
        rows = placements[self.kept], inertias[self.kept], of_frames
        return gathered(rows, (per_q[:, self.of_q], per_v[:, self._of_v]), places[-6:])

    def lock(self, numbers: Floats, q: Floats) -> dict[int, SE3]:
        """Changes the numbers (n,) of the model to those at which `index` finds the reduced one's.

        Args:
            numbers: See `skeleton.gathered` [any].
            q: The configuration (nq,) at which joints are locked.

        Returns:
            Where the locked joints are in the frames of the joints that carry them.
        """
        placements, inertias, frames = self.source.row_blocks(numbers)
        placed: dict[int, SE3] = {}
        for i, is_moved, is_locked in self._steps:
            if is_moved:
                placements[i] = (placed[self.source.parents[i]] * SE3._of(placements[i]))._m
            if is_locked:
                M = placed[i] = self._locked_at(i, placements[i], q)
                whole = inertias[self.kept[self.carriers[i]]]
                whole[...] = (Inertia._of(whole) + Inertia._of(inertias[i]).se3Action(M))._p
        for joint, first, end in self._moved_frames:
            part = frames[first:end]
            part[...] = placed[joint]._m @ part
        return placed

    def _locked_at(self, i: int, placement: Floats, q: Floats) -> SE3:
        """The frame of a joint whose placement is (4, 4), at a configuration (nq,) of the model."""
        joint = self.source.joints[i][1]
        if i in self._axes:
            name, axis = self._axes[i]
            return _MOVED[name](placement, axis, _position(joint, q).item())
        return SE3._of(placement) * SE3._of(_pose_at(joint, q))

    def skeleton_with(self, numbers: Floats) -> Skeleton:
        """The joints and frames; the frame of a locked joint has its inertia among these numbers (n,), as a body."""
        inertias, facts = self.source.row_blocks(numbers)[1], list(self._skeleton.frames)
        for k, joint in self._bodies:
            body = Inertia._of(inertias[joint].copy())
            facts[k] = (facts[k][0], FrameType.FIXED_JOINT, facts[k][2], k, body)
        names, parents, joints, _, nq, nv = self._skeleton
        return Skeleton(names, parents, joints, tuple(facts), nq, nv)


def _ranges(frames: list[tuple[int, int]]) -> list[tuple[int, int, int]]:
    """Frames in a row on the same joint: the joint, the first frame, and that after the last one."""
    out: list[tuple[int, int, int]] = []
    for k, joint in frames:
        if out and out[-1][0] == joint and out[-1][2] == k:
            out[-1] = joint, out[-1][1], k + 1
        else:
            out.append((joint, k, k + 1))
    return out


def _check(skeleton: Skeleton, locked: list[int]) -> None:
    repeated = next((joint for joint in locked if locked.count(joint) > 1), None)
    if repeated is not None:
        raise InputError(f"The list of joints to lock has {repeated} more than once; name each joint once.")
    if 0 in locked:
        raise InputError(
            "Joint 0 is the universe, which does not move; take it off the list of joints to lock."
        )
    for i, (_, joint) in enumerate(skeleton.joints):
        followed = joint["mimic"]
        if followed is not None and i not in locked and followed[0] in locked:
            raise InputError(
                f"Joint {skeleton.names[i]!r} follows a joint that is to be locked. Lock it, too."
            )


def _entries(skeleton: Skeleton, locked: set[int]) -> tuple[list[int], list[int]]:
    """Which entries of q and of v are kept: joints have theirs in their own order."""
    of_q, of_v = list(range(skeleton.nq)), list(range(skeleton.nv))
    for i in sorted(locked, reverse=True):
        joint = skeleton.joints[i][1]
        if joint["mimic"] is None:
            del of_q[joint["idx_q"] : joint["idx_q"] + joint["nq"]]
            del of_v[joint["idx_v"] : joint["idx_v"] + joint["nv"]]
    return of_q, of_v


def _pose_at(joint: dict[str, Any], q: Floats) -> Floats:
    """What a joint of these attributes does at a configuration of its model, (4, 4)."""
    return np.asarray(joint["kind"].transform(_position(joint, q)).matrix(), dtype=float)


def _position(joint: dict[str, Any], q: Floats) -> Floats:
    """Its own configuration, also where it follows another joint."""
    start = joint["idx_q"]
    at = q[start : start + joint["kind"].nq]
    if joint["mimic"] is None:
        return at
    _, scaling, offset = joint["mimic"]
    return scaling * at + offset


_ALONG = {Revolute.transform: "turned", Prismatic.transform: "shifted"}
"""The functions below by what kinds of joints do."""
_MOVED = BoundFunctions(
    {
        "turned": (
            lambda m, axis, angle: (
                pose(m) @ spatial.SE3(spatial.angle_axis_to_matrix(angle, axis), np.zeros(3))
            ).matrix(),
            *((4, 4), (3,), ()),
        ),
        "shifted": (
            lambda m, axis, way: (pose(m) @ spatial.SE3(np.eye(3), way * axis)).matrix(),
            *((4, 4), (3,), ()),
        ),
    },
    holder=SE3,
)
