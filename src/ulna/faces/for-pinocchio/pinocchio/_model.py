"""Model: the mutable tree of joints, whose placements and inertias are live references into one array of numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np

from pinocchio._arrays import StdVec, index, vector
from pinocchio._engine import tower_model
from pinocchio._enums import FrameType
from pinocchio._frame import Frame
from pinocchio._inertia import Inertia
from pinocchio._joints import JointModel
from pinocchio._numbers import Numbers
from pinocchio._saved import Saved
from pinocchio._se3 import SE3
from pinocchio._supports import Supports
from pinocchio._vectors import Motion
from ulna.errors import InputError, ModelError, UnknownName
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data import Data

FREE = float(np.finfo(float).max)
"""What limits are where there is none."""
_PER_Q = {"lowerPositionLimit": -FREE, "upperPositionLimit": FREE, "positionLimitMargin": 0.0}
_PER_V = {
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


@final
class Model(Saved, Supports, Numbers):
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

    gravity981: ClassVar[Floats] = np.array([0.0, 0.0, -9.81])

    def __init__(self, other: Model | None = None) -> None:
        self._begin()
        self.name = ""
        """The name of the model."""
        self.names: StdVec[str] = StdVec(["universe"])
        """Names of the joints."""
        self.parents: StdVec[int] = StdVec([0])
        """For each joint, the joint before it."""
        self.joints: StdVec[JointModel] = StdVec([JointModel()])
        """The joints."""
        self._placements: StdVec[SE3] = StdVec([SE3()])
        self._inertias: StdVec[Inertia] = StdVec([Inertia()])
        self.frames = [Frame("universe", 0, 0, SE3(), FrameType.FIXED_JOINT)]
        self.referenceConfigurations: dict[str, Floats] = {}
        """Named configurations."""
        self._gravity = Motion(self.gravity981, np.zeros(3))
        self._arrays = {key: np.zeros(0) for key in (*_PER_Q, *_PER_V)}
        self.nq = self.nv = self.nvExtended = 0
        self.nbodies = 1
        self._changed()
        if other is not None:
            self.__setstate__(other.__getstate__())

    # sizes and the tree ---------------------------------------------------------------------------------

    @property
    def njoints(self) -> int:
        """How many joints there are, the universe included."""
        return len(self.names)

    @property
    def nframes(self) -> int:
        """How many frames there are."""
        return len(self.frames)

    nqs = property(lambda self: StdVec(j.nq for j in self.joints), doc="For each joint its entries of q.")
    nvs = property(lambda self: StdVec(j.nv for j in self.joints), doc="For each joint its entries of v.")
    idx_qs = property(
        lambda self: StdVec(max(j.idx_q, 0) for j in self.joints), doc="For each joint where its q begins."
    )
    idx_vs = property(
        lambda self: StdVec(max(j.idx_v, 0) for j in self.joints), doc="For each joint where its v begins."
    )
    nvExtendeds = property(
        lambda self: StdVec(j.nvExtended for j in self.joints), doc="Like nvs, mimic joints counted."
    )
    idx_vExtendeds = property(
        lambda self: StdVec(max(j.idx_vExtended, 0) for j in self.joints),
        doc="Like idx_vs, mimic joints counted.",
    )
    mimicking_joints = property(
        lambda self: StdVec(i for i, j in enumerate(self.joints) if j.mimic), doc="Joints that follow others."
    )
    mimicked_joints = property(
        lambda self: StdVec(j.mimic[0] for j in self.joints if j.mimic), doc="The joints that those follow."
    )

    @property
    def supports(self) -> StdVec[StdVec[int]]:
        """For each joint, the joints from the universe to it."""
        found: StdVec[StdVec[int]] = StdVec([StdVec([0])])
        for i in range(1, self.njoints):
            found.append(StdVec([*found[self.parents[i]], i]))
        return found

    @property
    def subtrees(self) -> StdVec[StdVec[int]]:
        """For each joint, the joints it moves, itself included; the universe is not counted."""
        found: StdVec[StdVec[int]] = StdVec(StdVec() for _ in self.names)
        for i, support in enumerate(self.supports):
            for j in support if i else ():
                found[j].append(i)
        return found

    @property
    def children(self) -> StdVec[StdVec[int]]:
        """For each joint, the joints that follow it at once."""
        return StdVec(StdVec(self.getChildJoints(i)) for i in range(self.njoints))

    def getChildJoints(self, joint_id: int) -> list[int]:
        """The joints that follow a joint at once."""
        return [i for i in range(1, self.njoints) if self.parents[i] == joint_id]

    # live numbers ---------------------------------------------------------------------------------------

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
        """For each joint, all that it carries rigidly, in its frame; live references."""
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
        given = np.asarray(value.vector if isinstance(value, Motion) else value, dtype=float)
        self._gravity._assign(given if given.size == 6 else np.concatenate([given.reshape(3), np.zeros(3)]))

    # names ----------------------------------------------------------------------------------------------

    def getJointId(self, name: str) -> int:
        """The index of the joint of that name. Raises UnknownName with the nearest one."""
        if name not in self.names:
            raise UnknownName(
                "joint", name, self.names, "Ask existJointName(name) first where it may be missing."
            )
        return self.names.index(name)

    def getFrameId(self, name: str, type: Any = None) -> int:
        """The index of the frame of that name (and type). Raises UnknownName with the nearest one."""
        wanted = self._frame_type(type)
        for i, frame in enumerate(self.frames):
            if frame._name == name and frame._type & wanted:
                return i
        mend = "Ask existFrame(name) first where it may be missing."
        raise UnknownName("frame", name, [f.name for f in self.frames if f.type & wanted], mend)

    def getBodyId(self, name: str) -> int:
        """The index of the frame of the body of that name. Raises UnknownName with the nearest one."""
        return self.getFrameId(name, FrameType.BODY)

    def existJointName(self, name: str) -> bool:
        """Whether there is a joint of that name."""
        return name in self.names

    def existFrame(self, name: str, type: Any = None) -> bool:
        """Whether there is a frame of that name (and type)."""
        wanted = self._frame_type(type)
        return any(f.name == name and f.type & wanted for f in self.frames)

    def existBodyName(self, name: str) -> bool:
        """Whether there is a body of that name."""
        return self.existFrame(name, FrameType.BODY)

    @staticmethod
    def _frame_type(type: Any) -> int:
        return 31 if type is None else int(type)

    # building -------------------------------------------------------------------------------------------

    def addJoint(
        self, parent_id: int, joint_model: JointModel, joint_placement: SE3, joint_name: str, *limits: Any
    ) -> int:
        """Adds a joint; returns its index.

        Args:
            parent_id: The joint before it.
            joint_model: Its kind.
            joint_placement: Where it is in the frame of the joint before it.
            joint_name: Its name, not given to another joint.
            limits: Nothing, or (max_effort, max_velocity, min_config, max_config), or these with their least
                values before them and (min_friction, max_friction, damping) behind; a margin of the
                configuration may stand before the friction.
        """
        index(parent_id, self.njoints, "parent joint", "Parents are added before their children.")
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
        told = _limits(limits)
        for key, default in (*_PER_Q.items(), *_PER_V.items()):
            size = joint.nq if key in _PER_Q else joint.nv
            own = np.full(size, default) if key not in told else np.broadcast_to(told[key], size)
            self._arrays[key] = np.concatenate([self._arrays[key], np.asarray(own, dtype=float)])
        self.joints.append(joint)
        self.names.append(joint_name)
        self.parents.append(int(parent_id))
        self._placements.append(SE3(joint_placement))
        self._inertias.append(Inertia())
        self.nq, self.nv = self.nq + joint.nq, self.nv + joint.nv
        self.nvExtended += joint.nvExtended
        self._changed()
        return joint.id

    def make_mimic(self, followed: int, joint_id: int, scaling: float, offset: float) -> None:
        """Makes a joint follow another; it keeps its kind and gives up its entries of q and v."""
        source, joint = self.joints[followed], self.joints[joint_id]
        if source.mimic is not None:  # the end of the chain is what both follow
            followed, ratio, shift = source.mimic
            scaling, offset = scaling * ratio, scaling * shift + offset
            source = self.joints[followed]
        if (source.nq, source.nv) != (1, 1) or (joint.nq, joint.nv) != (1, 1):
            names = f"{self.names[joint_id]!r} is to follow {self.names[followed]!r}"
            raise ModelError(f"{names}; only joints with one coordinate can follow and be followed.")
        for key in self._arrays:
            self._arrays[key] = np.delete(self._arrays[key], joint.idx_q if key in _PER_Q else joint.idx_v)
        joint.mimic, joint.nq, joint.nv, joint._word = (followed, scaling, offset), 0, 0, "JointModelMimic"
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

    def addJointFrame(self, joint_id: int, previous_frame: int = -1) -> int:
        """Adds the frame of a joint; returns its index."""
        index(joint_id, self.njoints, "joint", "Add the joint with addJoint first.")
        if previous_frame < 0:
            parent = self.parents[joint_id]
            kinds = (FrameType.JOINT, FrameType.FIXED_JOINT)
            previous_frame = next(
                (i for i, f in enumerate(self.frames) if f.parentJoint == parent and f.type in kinds), 0
            )
        return self.addFrame(Frame(self.names[joint_id], joint_id, previous_frame, SE3(), FrameType.JOINT))

    def addBodyFrame(
        self, body_name: str, parentJoint: int, body_placement: SE3, parentFrame: int = -1
    ) -> int:
        """Adds the frame of a body; returns its index."""
        if parentFrame < 0:
            parentFrame = self.getFrameId(self.names[parentJoint])
        return self.addFrame(Frame(body_name, parentJoint, parentFrame, body_placement, FrameType.BODY))

    def addFrame(self, frame: Frame, append_inertia: bool = True) -> int:
        """Adds a frame, and its inertia to the joint's body; returns its index.

        A frame of the same name and type raises ModelError.
        """
        index(frame.parentJoint, self.njoints, "joint", f"It is the parent joint of frame {frame.name!r}.")
        index(frame.parentFrame, self.nframes, "frame", f"It is the parent frame of frame {frame.name!r}.")
        if self.existFrame(frame.name, frame.type):
            raise ModelError(
                f"There is a {frame.type.name} frame named {frame.name!r} already. Give another name."
            )
        self.frames.append(frame.copy())
        if append_inertia and not frame.inertia.isZero():
            self._inertias[frame.parentJoint] += frame.inertia.se3Action(frame.placement)
        self._frames_changed()
        return self.nframes - 1

    def appendBodyToJoint(
        self, joint_id: int, body_inertia: Inertia, body_placement: SE3 | None = None
    ) -> None:
        """Adds a body to what a joint carries, placed in the joint's frame."""
        index(joint_id, self.njoints, "joint", "Add the joint with addJoint first.")
        M = SE3() if body_placement is None else body_placement
        self._inertias[joint_id] += body_inertia.se3Action(M)
        self.nbodies += 1

    def createData(self) -> Data:
        """What algorithms write their results into."""
        from pinocchio._data import Data

        return Data(self)

    def check(self, data: Data | None = None) -> bool:
        """Whether a Data fits this model."""
        return data is None or data._layout == self._layout

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
        told = dict(state)
        if "_version" not in self.__dict__:
            self._begin()
        self.nq, self.nv, self.nvExtended, self.nbodies = told.pop("sizes")
        for key, value in told.items():
            setattr(self, key, StdVec(value) if isinstance(value, list) else value)
        self._changed()

    def copy(self) -> Model:
        """One of its own."""
        return Model(self)

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> Model:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        same = all(np.array_equal(a, other._arrays[key]) for key, a in self._arrays.items())
        keys = ("name", "names", "parents", "joints", "_placements", "_inertias", "frames", "_gravity")
        return same and all(getattr(self, key) == getattr(other, key) for key in keys)

    __hash__ = object.__hash__

    def __str__(self) -> str:
        lines = [f"Nb joints = {self.njoints} (nq={self.nq},nv={self.nv})"]
        lines += [f"  Joint {i} {name}: parent={self.parents[i]}" for i, name in enumerate(self.names)]
        return "\n".join(lines) + "\n"

    __repr__ = __str__

    def ulna(self) -> Any:
        """The tower's model of the present numbers: `ulna.Robot(model.ulna())` has all that Ulna has."""
        return tower_model(self)


def _limits(limits: tuple[Any, ...]) -> dict[str, Any]:
    """The limits that addJoint was told, by the names of the model's arrays."""
    if not limits:
        return {}
    if len(limits) == 4:
        effort, speed, low, high = limits
        limits = (-np.asarray(effort), effort, -np.asarray(speed), speed, low, high)
    names = ["lowerEffortLimit", "upperEffortLimit", "lowerVelocityLimit", "upperVelocityLimit"]
    names += ["lowerPositionLimit", "upperPositionLimit"]
    rest = ["lowerDryFrictionLimit", "upperDryFrictionLimit", "damping"]
    by_count = {6: [], 9: rest, 10: ["positionLimitMargin", *rest]}
    if len(limits) not in by_count:
        raise InputError(f"addJoint was given {len(limits)} limits; expected 4, 9 or 10 after the name.")
    return {key: np.atleast_1d(v) for key, v in zip(names + by_count[len(limits)], limits, strict=True)}


def _array(key: str, size: str) -> property:
    def get(self: Model) -> Floats:
        return self._arrays[key]

    def put(self: Model, value: Any) -> None:
        self._arrays[key][:] = vector(value, getattr(self, size), key)

    return property(get, put, doc=f"`{key}` of all joints, ({size},), live; assigning copies into it.")


for _key in _PER_Q:
    setattr(Model, _key, _array(_key, "nq"))
for _key in _PER_V:
    setattr(Model, _key, _array(_key, "nv"))
for _old, _new in (
    ("velocityLimit", "upperVelocityLimit"),
    ("effortLimit", "upperEffortLimit"),
    ("friction", "upperDryFrictionLimit"),
):
    setattr(Model, _old, _array(_new, "nv"))
