"""How a model is built, and how its joints and frames are found by their names."""

from __future__ import annotations

import builtins
import warnings
from typing import Any

import numpy as np

from pinocchio._containers.arguments import OMITTED, ArgumentError, WrongShape, check_text, checks_itself
from pinocchio._containers.arrays import index, numbers
from pinocchio._containers.enums import FrameType
from pinocchio._containers.keywords import by_name
from pinocchio._containers.unknown_ids import UnknownId
from pinocchio._model.frame import Frame
from pinocchio._model.joint_model import JointModel
from pinocchio._model.kernel_cache import KernelCache
from pinocchio._model.live_parameters import PER_Q
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError, ModelError, ModelWarning

_NOTHING = Inertia()
_HERE = SE3()
"""What is copied, or shared where nobody writes to it."""
_JOINT = "parent_id joint_model joint_placement joint_name"
_BOUNDS = "min_effort max_effort min_velocity max_velocity min_config max_config"


class KinematicTree(KernelCache):
    """Joints and frames: adding them, and finding them by their names."""

    nvExtended: int
    nbodies: int

    # names ----------------------------------------------------------------------------------------------

    @checks_itself
    def getJointId(self, name: str) -> int:
        """The index of a joint.

        Args:
            name: Its name.

        Returns:
            Its index; where there is none, `njoints`, which remembers the name: its use as an index raises.
        """
        try:
            return self.names._places[name]
        except (KeyError, TypeError):  # unknown, or no text
            check_text(name, "name")
        fix = "Ask existJointName(name) first where it may be missing."
        return UnknownId.of(self.njoints, "joint", name, self.names, fix)

    @checks_itself
    def getFrameId(self, name: str, type: Any = OMITTED) -> int:
        """The index of a frame.

        Args:
            name: Its name.
            type: FrameType, where several frames have that name.

        Returns:
            The index.

        Raises:
            InputError: A body and a joint, or the like, share the name, and `type` does not say which is meant.
        """
        if type is OMITTED and self._frame_changes.item() == self._indexed_changes:
            try:
                return self._frame_index.places[name]
            except (KeyError, TypeError):  # unknown, shared by several frames, or no text
                pass
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

    @checks_itself
    def getBodyId(self, name: str) -> int:
        """The index of the frame of a body; see `getFrameId`."""
        known = self._index_of_frames().bodies.get(name, -1) if isinstance(name, str) else -1
        if known >= 0:
            return known
        return self.getFrameId(name, FrameType.BODY)

    @checks_itself
    def existJointName(self, name: str) -> bool:
        """Whether there is a joint of that name."""
        check_text(name, "name")
        return name in self.names._places

    @checks_itself
    def existFrame(self, name: str, type: Any = OMITTED) -> bool:
        """Whether there is a frame of that name (and type).

        Args:
            name: Its name.
            type: FrameType; any where it is left out.

        Returns:
            Whether there is.
        """
        check_text(name, "name")
        if type is OMITTED:
            return name in self._index_of_frames().by_name
        types = self._frame_type(type)
        return bool(self._frames_named(name, types))

    def _frames_named(self, name: str, types: int) -> list[int]:
        """Indices of the frames of that name, and of one of these types."""
        indices, frames = self._index_of_frames().by_name.get(name, ()), self._frames
        return [i for i in indices if frames[i]._facts[1] & types]

    @checks_itself
    def existBodyName(self, name: str) -> bool:
        """Whether there is a body of that name."""
        check_text(name, "name")
        return name in self._index_of_frames().bodies

    @staticmethod
    def _frame_type(type: Any) -> int:
        if type is OMITTED:
            return 31
        if not isinstance(type, FrameType):
            raise ArgumentError(f"`type` is {type!r}; expected a FrameType, such as FrameType.BODY.")
        return int(type)

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
        if joint_name in self.names._places:
            raise ModelError(f"There is a joint named {joint_name!r} already. Give another name.")
        if joint_model.kind is None:
            raise InputError(
                "The universe cannot be added as a joint; expected a JointModel such as JointModelRZ()."
            )
        joint = joint_model.held()
        follows = joint.mimic is not None
        place = (joint.idx_q, joint.idx_v) if follows else (self.nq, self.nv)
        joint.setIndexes(self.njoints, *place, self.nvExtended)
        _check_sizes(values, joint.nq, joint.nv)
        self._new_entries.append((joint.nq, joint.nv, values))
        list.append(self.joints, joint)  # a copy already
        self.names.append(joint_name)
        self.parents.append(int(parent_id))
        self._placements.append(joint_placement.copy())
        self._inertias.append(_NOTHING.copy())
        extended = self.nvExtended + joint.nvExtended
        self._keep(nq=self.nq + joint.nq, nv=self.nv + joint.nv, nvExtended=extended)
        self._joint_added()
        return joint.id

    def _make_mimic(self, followed: int, joint_id: int, scaling: float, offset: float) -> None:
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
        self._arrays = {
            key: np.delete(values, joint.idx_q if key in PER_Q else joint.idx_v)
            for key, values in self._arrays.items()
        }
        joint._keep(mimic=(followed, scaling, offset), nq=0, nv=0, _shortname="JointModelMimic")
        nq = nv = 0
        for other in list(self.joints)[1:]:
            if other.mimic is None:
                other._keep(idx_q=nq, idx_v=nv)
                nq, nv = nq + other.nq, nv + other.nv
        self._keep(nq=nq, nv=nv)
        for other in list(self.joints)[1:]:
            if other.mimic is not None:
                leader = self.joints[other.mimic[0]]
                other._keep(idx_q=leader.idx_q, idx_v=leader.idx_v)
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
            frame_id = self._index_of_frames().of_joint.get(self.parents[joint_id], 0)
        return self._add_new_frame(self.names[joint_id], joint_id, frame_id, _HERE, FrameType.JOINT)

    def addBodyFrame(self, body_name: str, parentJoint: int, body_placement: SE3, previous_frame: int) -> int:
        """Adds the frame of a body.

        Args:
            body_name: Its name.
            parentJoint: Index of the joint that carries the body.
            body_placement: Pose of the frame in the frame of the joint.
            previous_frame: Index of the frame before it; -1 for that of the joint.

        Returns:
            Its index.

        Raises:
            ModelError: The frame before it is to be that of the joint, which has none.
        """
        if previous_frame < 0:
            index(parentJoint, self.njoints, "joint", "model.getJointId(name) returns one.")
            joints = int(FrameType.JOINT) | int(FrameType.FIXED_JOINT)
            found = self._frames_named(self.names[parentJoint], joints)
            if not found:
                raise ModelError(
                    f"Joint {self.names[parentJoint]!r} has no frame that {body_name!r} could follow. Add it with "
                    "addJointFrame(joint_id) first, or give the index of another frame."
                )
            previous_frame = found[0]
        return self._add_new_frame(body_name, parentJoint, previous_frame, body_placement, FrameType.BODY)

    def _add_new_frame(self, name: str, joint: int, frame: int, placement: SE3, type: FrameType) -> int:
        """Adds a frame without inertia; see `addFrame`."""
        if builtins.type(name) is not str:
            check_text(name, "name")
        facts = name, type, int(joint), int(frame), _NOTHING
        made = Frame._from_facts(facts, placement.copy())
        valid = 0 <= facts[2] < self.njoints and 0 <= facts[3] < len(self._frames)
        if valid and not self._frames_named(name, type):
            return self._append_frame(made)
        return self.addFrame(made)

    def _append_frame(self, frame: Frame) -> int:
        self._add_last_frame(frame)
        return len(self._frames) - 1

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

    def appendBodyToJoint(self, joint_id: int, body_inertia: Inertia, body_placement: SE3) -> None:
        """Adds the inertia of a body to a joint.

        Args:
            body_inertia: The inertia.
            body_placement: Pose of the body in the frame of the joint.
        """
        index(joint_id, self.njoints, "joint", "Add the joint with addJoint first.")
        inertia = self._inertias[joint_id]
        inertia += body_inertia._moved(body_placement)
        self._keep(nbodies=self.nbodies + 1)


def _limits(limits: tuple[Any, ...]) -> dict[str, list[float]]:
    """The limits given to addJoint, by the names of the model's arrays; one for all entries, or one for each.

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
    return {key: _entries(key, value) for key, value in values.items()}


def _entries(key: str, value: Any) -> list[float]:
    if type(value) is float:
        return [value]
    if type(value) is np.ndarray and value.ndim == 1 and value.dtype == float:
        return value.tolist()
    array = numbers(value, key)
    if array.ndim > 1:
        raise ArgumentError(f"addJoint: `{key}` has shape {array.shape}; expected (n,).")
    return array.reshape(-1).tolist()


def _check_sizes(values: dict[str, list[float]], nq: int, nv: int) -> None:
    """Checks that there is one entry for all, or one for each.

    Raises:
        WrongShape: There are others.
    """
    for key, entries in values.items():
        size = nq if key in PER_Q else nv
        if len(entries) not in (1, size):
            raise WrongShape(key, (len(entries),), f"({size},)")
