"""Data of a model's joints that show the state of the last algorithm whenever they are read."""

from __future__ import annotations

from typing import Any, final

from pinocchio._containers.arrays import StdVec
from pinocchio._data.articulated_bodies import check_articulated, is_articulated
from pinocchio._data.states import FieldStates
from pinocchio._model.joint_data import JointData, data_of
from ulna.typing import Floats


@final
class LiveJoint:
    """The state of one joint in a Data; see `LiveState`."""

    __slots__ = ("_data", "_joint", "_seen", "_target")

    def __init__(self, data: FieldStates, joint: Any, target: JointData) -> None:
        self._data, self._joint, self._target = data, joint, target
        self._seen = b""

    def update(self) -> None:
        """Writes the present state into the data of the joint, where it has changed."""
        known, arrays = self._data._known_states, self._data._arrays
        present = b""
        if "joints" in known:
            present = arrays["joints q"].tobytes()
        if "joint_velocities" in known:
            present += arrays["joint_velocities q"].tobytes() + arrays["joint_velocities v"].tobytes()
        if present == self._seen:
            return
        self._seen = present
        if "joint_velocities" in known:
            self._joint.calc(self._target, arrays["joint_velocities q"], arrays["joint_velocities v"])
        if "joints" in known:
            self._joint.calc(self._target, arrays["joints q"])

    @property
    def has_terms(self) -> bool:
        """Whether the terms of the articulated-body algorithm are defined."""
        return is_articulated(self._data._model)

    def terms(self, joint_data: JointData) -> tuple[Floats, Floats] | None:
        """U (6, nv) and Dinv (nv, nv) of the present state.

        Args:
            joint_data: The data of the joint, or of a part of it, which has none.

        Returns:
            The terms; None before the first algorithm.
        """
        data = self._data
        if joint_data is not self._target or data._q_of_joints is None:
            return None
        check_articulated(data._model)
        data._read("Yaba")
        rows = slice(self._joint.idx_v, self._joint.idx_v + self._joint.nv)
        return data._arrays["U of bodies"][:, rows].copy(), data._arrays["Dinv of bodies"][rows, rows].copy()


def live_joints(data: FieldStates) -> StdVec[JointData]:
    """The data of the joints of the model of a Data, the universe first.

    Returns:
        The data; each shows the state of the last algorithm whenever it is read.
    """
    joints = data._model.joints
    out = StdVec(data_of(joint, of_any_kind=True) for joint in joints)
    for joint, made in zip(list(joints)[1:], list(out)[1:], strict=True):
        made.follow(LiveJoint(data, joint, made))
    return out
