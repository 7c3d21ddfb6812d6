"""How a model is built, and how its joints and frames are found by their names."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError, check_text, is_index
from pinocchio._containers.arrays import index, numbers
from pinocchio._containers.enums import FrameType
from pinocchio._containers.keywords import by_name
from pinocchio._containers.unknown_ids import UnknownId, known
from pinocchio._model.frame import Frame
from pinocchio._model.joint_model import JointModel
from pinocchio._model.kernel_cache import KernelCache
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError, ModelError, ModelWarning
from ulna.typing import Floats

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

_JOINT = "parent_id joint_model joint_placement joint_name"
_BOUNDS = "min_effort max_effort min_velocity max_velocity min_config max_config"


class KinematicTree(KernelCache):
    """Joints and frames: adding them, and finding them by their names."""

    nvExtended: int
    nbodies: int

    # names ----------------------------------------------------------------------------------------------

    def getJointId(self, name: str) -> int:
        """The index of a joint.

        Args:
            name: Its name.

        Returns:
            Its index; where there is none, `njoints`, which remembers the name: its use as an index raises.
        """
        check_text(name, "name")
        if name in self.names:
            return self.names.index(name)
        fix = "Ask existJointName(name) first where it may be missing."
        return UnknownId.of(self.njoints, "joint", name, self.names, fix)

    def getFrameId(self, name: str, type: Any = None) -> int:
        """The index of a frame.

        Args:
            name: Its name.
            type: FrameType, where several frames have that name.

        Returns:
            The index.

        Raises:
            InputError: A body and a joint, or the like, share the name, and `type` does not say which is meant.
        """
        check_text(name, "name")
        types = self._frame_type(type)
        matches = self._frames_named(name, types)
        if len(matches) == 1:
            return matches[0]
        if matches:
            choice = ", ".join(f"FrameType.{self.frames[i].type.name}" for i in matches)
            raise InputError(
                f"{len(matches)} frames are named {name!r}; say which: getFrameId({name!r}, type) with one of {choice}."
            )
        fix = "Ask existFrame(name) first where it may be missing."
        return UnknownId.of(self.nframes, "frame", name, [f.name for f in self.frames if f.type & types], fix)

    def getBodyId(self, name: str) -> int:
        """The index of the frame of a body; see `getFrameId`."""
        return self.getFrameId(name, FrameType.BODY)

    def existJointName(self, name: str) -> bool:
        """Whether there is a joint of that name."""
        check_text(name, "name")
        return name in self.names

    def existFrame(self, name: str, type: Any = None) -> bool:
        """Whether there is a frame of that name (and type).

        Args:
            name: Its name.
            type: FrameType; None for any.

        Returns:
            Whether there is.
        """
        check_text(name, "name")
        types = self._frame_type(type)
        return bool(self._frames_named(name, types))

    def _frames_named(self, name: str, types: int) -> list[int]:
        """Indices of the frames of that name, and of one of these types."""
        frames = self._frames
        return [i for i, f in enumerate(frames) if f._facts[0] == name and f._facts[1] & types]

    def existBodyName(self, name: str) -> bool:
        """Whether there is a body of that name."""
        return self.existFrame(name, FrameType.BODY)

    @staticmethod
    def _frame_type(type: Any) -> int:
        if type is not None and not is_index(type):
            raise ArgumentError(f"`type` is {type!r}; expected one or several of FrameType, joined by |.")
        return 31 if type is None else int(type)

    # building -------------------------------------------------------------------------------------------

    @by_name(
        f"{_JOINT} max_effort max_velocity min_config max_config",
        f"{_JOINT} {_BOUNDS} config_limit_margin min_friction max_friction damping",
        f"{_JOINT} {_BOUNDS} min_friction max_friction damping",
    )
    def addJoint(
        self, parent_id: int, joint_model: JointModel, joint_placement: SE3, joint_name: str, *limits: Any
    ) -> int:
        """Adds a joint.

        Args:
            parent_id: The joint before it.
            joint_model: Its kind.
            joint_placement: Where it is in the frame of the joint before it.
            joint_name: Its name, not given to another joint.
            *limits: Nothing, or (max_effort, max_velocity, min_config, max_config), or these with their least
                values before them and (min_friction, max_friction, damping) behind; a margin of the
                configuration may stand before the friction.

        Returns:
            Its index.

        Raises:
            InputError: The universe cannot be added.
            ModelError: There is a joint of that name.
        """
        index(parent_id, self.njoints, "parent joint", "Parents are added before their children.")
        values = _limits(limits)
        if joint_name in self.names:
            raise ModelError(f"There is a joint named {joint_name!r} already. Give another name.")
        if joint_model.kind is None:
            raise InputError(
                "The universe cannot be added as a joint; expected a JointModel such as JointModelRZ()."
            )
        joint = joint_model.copy()
        follows = joint.mimic is not None
        place = (joint.idx_q, joint.idx_v) if follows else (self.nq, self.nv)
        joint.setIndexes(self.njoints, *place, self.nvExtended)
        self._arrays |= _extended(self._arrays, PER_Q, self.nq, joint.nq, values)
        self._arrays |= _extended(self._arrays, PER_V, self.nv, joint.nv, values)
        self.joints.append(joint)
        self.names.append(joint_name)
        self.parents.append(int(parent_id))
        self._placements.append(SE3(joint_placement))
        self._inertias.append(Inertia())
        self.nq, self.nv = self.nq + joint.nq, self.nv + joint.nv
        self.nvExtended += joint.nvExtended
        self._joint_added()
        return joint.id

    def make_mimic(self, followed: int, joint_id: int, scaling: float, offset: float) -> None:
        """Makes a joint follow another; it keeps its kind and loses its entries of q and v.

        Args:
            followed: Index of the joint that is followed.
            joint_id: Index of the joint that follows.
            scaling: Factor [-].
            offset: Offset [rad or m].

        Raises:
            ModelError: A joint has several coordinates.
        """
        source, joint = self.joints[followed], self.joints[joint_id]
        if source.mimic is not None:  # the end of the chain is what both follow
            followed, ratio, shift = source.mimic
            scaling, offset = scaling * ratio, scaling * shift + offset
            source = self.joints[followed]
        if 0 in (followed, joint_id) or (source.nq, source.nv) != (1, 1) or (joint.nq, joint.nv) != (1, 1):
            names = f"{self.names[joint_id]!r} is to follow {self.names[followed]!r}"
            raise ModelError(f"{names}; only joints with one coordinate can follow and be followed.")
        for key in self._arrays:
            self._arrays[key] = np.delete(self._arrays[key], joint.idx_q if key in PER_Q else joint.idx_v)
        joint.mimic, joint.nq, joint.nv, joint._shortname = (
            (followed, scaling, offset),
            0,
            0,
            "JointModelMimic",
        )
        self.nq = self.nv = 0
        for other in self.joints[1:]:
            if other.mimic is None:
                other.idx_q, other.idx_v = self.nq, self.nv
                self.nq, self.nv = self.nq + other.nq, self.nv + other.nv
        for other in self.joints[1:]:
            if other.mimic is not None:
                leader = self.joints[other.mimic[0]]
                other.idx_q, other.idx_v = leader.idx_q, leader.idx_v
        self._changed()

    def addJointFrame(self, joint_id: int, frame_id: int = 0) -> int:
        """Adds the frame of a joint.

        Args:
            frame_id: Index of the frame before it; -1 for that of the parent joint.

        Returns:
            Its index.
        """
        index(joint_id, self.njoints, "joint", "Add the joint with addJoint first.")
        if frame_id < 0:
            parent = self.parents[joint_id]
            kinds = (FrameType.JOINT, FrameType.FIXED_JOINT)
            matches = [
                i for i, f in enumerate(self._frames) if f._facts[2] == parent and f._facts[1] in kinds
            ]
            frame_id = matches[0] if matches else 0
        return self._add_new_frame(self.names[joint_id], joint_id, frame_id, SE3(), FrameType.JOINT)

    def addBodyFrame(
        self, body_name: str, parentJoint: int, body_placement: SE3, previous_frame: int = -1
    ) -> int:
        """Adds the frame of a body.

        Args:
            body_name: Its name.
            parentJoint: Index of the joint that carries the body.
            body_placement: Pose of the frame in the frame of the joint.
            previous_frame: Index of the frame before it; -1 for that of the joint.

        Returns:
            Its index.
        """
        if previous_frame < 0:
            joints = int(FrameType.JOINT) | int(FrameType.FIXED_JOINT)
            previous_frame = known(self.getFrameId(self.names[parentJoint], joints))
        return self._add_new_frame(body_name, parentJoint, previous_frame, body_placement, FrameType.BODY)

    def _add_new_frame(self, name: str, joint: int, frame: int, placement: SE3, type: FrameType) -> int:
        """Adds a frame without inertia; see `addFrame`."""
        made = Frame(name, joint, frame, placement, type)
        valid = made.parentJoint < self.njoints and made.parentFrame < self.nframes
        if valid and not self._frames_named(name, type):
            return self._append_frame(made)
        return self.addFrame(made)

    def _append_frame(self, frame: Frame) -> int:
        self._frames.append(frame)
        self._store_last_frame()
        return self.nframes - 1

    def addFrame(self, frame: Frame, append_inertia: bool = True) -> int:
        """Adds a frame, and its inertia to the body of the joint.

        Args:
            frame: The frame.
            append_inertia: Whether to add its inertia.

        Returns:
            Its index; that of the frame of the same name and type where there is one, which stays as it is.
        """
        index(frame.parentJoint, self.njoints, "joint", f"It is the parent joint of frame {frame.name!r}.")
        index(frame.parentFrame, self.nframes, "frame", f"It is the parent frame of frame {frame.name!r}.")
        if self.existFrame(frame.name, frame.type):
            present = int(self.getFrameId(frame.name, frame.type))
            if frame != self.frames[present]:
                warnings.warn(
                    f"There is a {frame.type.name} frame named {frame.name!r} already, which is another one; it stays. "
                    "Give another name.", ModelWarning, stacklevel=2,
                )  # fmt: skip
            return present
        if append_inertia and not frame.inertia.isZero():
            self._inertias[frame.parentJoint] += frame.inertia.se3Action(frame.placement)
        return self._append_frame(frame.copy())

    def appendBodyToJoint(
        self, joint_id: int, body_inertia: Inertia, body_placement: SE3 | None = None
    ) -> None:
        """Adds the inertia of a body to a joint.

        Args:
            body_inertia: The inertia.
            body_placement: Pose of the body in the frame of the joint; the identity by default.
        """
        index(joint_id, self.njoints, "joint", "Add the joint with addJoint first.")
        M = SE3() if body_placement is None else body_placement
        self._inertias[joint_id] += body_inertia.se3Action(M)
        self.nbodies += 1


def _extended(
    arrays: dict[str, Floats], defaults: dict[str, float], before: int, more: int, values: dict[str, Any]
) -> dict[str, Floats]:
    """The arrays of those names with entries for one more joint, as rows of one block.

    Args:
        arrays: The arrays of the model, of `before` entries each.
        defaults: What new entries are where `values` says nothing, by the names of the arrays.
        before: How many entries there are.
        more: How many are added.
        values: The new entries (more,) or (1,) by the names of their arrays.

    Returns:
        The new arrays by their names.
    """
    block = np.empty((len(defaults), before + more))
    out: dict[str, Floats] = {}
    for row, (key, default) in zip(block, defaults.items(), strict=True):
        row[:before] = arrays[key]
        row[before:] = values.get(key, default)
        out[key] = row
    return out


def _limits(limits: tuple[Any, ...]) -> dict[str, Any]:
    """The limits given to addJoint, by the names of the model's arrays.

    Raises:
        ArgumentError: They are not vectors of numbers, or not as many as there are limits.
    """
    if not limits:
        return {}
    if len(limits) == 4:
        effort, speed, low, high = limits
        limits = (-numbers(effort, "max_effort"), effort, -numbers(speed, "max_velocity"), speed, low, high)
    names = ["lowerEffortLimit", "upperEffortLimit", "lowerVelocityLimit", "upperVelocityLimit"]
    names += ["lowerPositionLimit", "upperPositionLimit"]
    rest = ["lowerDryFrictionLimit", "upperDryFrictionLimit", "damping"]
    by_count = {6: [], 9: rest, 10: ["positionLimitMargin", *rest]}
    if len(limits) not in by_count:
        raise ArgumentError(f"addJoint was given {len(limits)} limits; expected 4, 9 or 10 after the name.")
    values = dict(zip(names + by_count[len(limits)], limits, strict=True))
    arrays = {key: np.atleast_1d(numbers(value, key)) for key, value in values.items()}
    for key, array in arrays.items():
        if array.ndim > 1:
            raise ArgumentError(f"addJoint: `{key}` has shape {array.shape}; expected (n,).")
    return arrays
