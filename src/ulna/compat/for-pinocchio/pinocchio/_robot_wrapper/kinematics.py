"""Where the joints and frames of a RobotWrapper are, how they move, and their Jacobians."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pinocchio._algorithms import frame_motions, jacobians, kinematics
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import index as checked_index
from pinocchio._containers.documentation import describe_arguments
from pinocchio._containers.enums import ReferenceFrame
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna.typing import Floats

_LOCAL = ReferenceFrame.LOCAL
_JOINT = "robot.index(name) returns one."
_FRAME = "robot.model.getFrameId(name) returns one."


def _of_velocity(ask: Callable[..., Motion], of: str, doc: str) -> Callable[..., Motion]:
    """A method that asks for a motion of a joint or a frame at q and v."""

    def method(
        self: Kinematic,
        q: Any,
        v: Any,
        index: int,
        update_kinematics: bool = True,
        reference_frame: Any = _LOCAL,
    ) -> Motion:
        place = getattr(self, of)(index)
        if update_kinematics:
            self._moving(q, v)
        return ask(self.model, self.data, place, reference_frame)

    method.__doc__ = doc
    return method


def _of_acceleration(ask: Callable[..., Motion], of: str, doc: str) -> Callable[..., Motion]:
    """A method that asks for a motion of a joint or a frame at q, v and a."""

    def method(
        self: Kinematic,
        q: Any,
        v: Any,
        a: Any,
        index: int,
        update_kinematics: bool = True,
        reference_frame: Any = _LOCAL,
    ) -> Motion:
        place = getattr(self, of)(index)
        if update_kinematics:
            self._moving(q, v, a)
        return ask(self.model, self.data, place, reference_frame)

    method.__doc__ = doc
    return method


@describe_arguments
class Kinematic:
    """The calls of a RobotWrapper about places and motions."""

    model: Model
    data: Any

    def _joint(self, joint: Any) -> int:
        return checked_index(joint, self.model.njoints, "joint", _JOINT)

    def _frame(self, frame: Any) -> int:
        return checked_index(frame, self.model.nframes, "frame", _FRAME)

    def forwardKinematics(self, q: Any, v: Any = None, a: Any = None) -> None:
        """Fills `data.oMi`; with v also `data.v`, with v and a also `data.a`.

        Args:
            v: Velocities (nv,); None for positions alone.
            a: Accelerations (nv,), with v.

        Raises:
            ArgumentError: There is an acceleration and no velocity.
        """
        if a is not None and v is None:
            raise ArgumentError(
                "`a` was passed without `v`; expected both: numpy.zeros(model.nv) for a robot at rest."
            )
        kinematics.forwardKinematics(self.model, self.data, *(x for x in (q, v, a) if x is not None))

    def _moving(self, *state: Any) -> None:
        """Forward kinematics of q, v, and perhaps a, none of which may be missing."""
        for name, value in zip("qva", state, strict=False):
            if value is None:
                raise ArgumentError(f"`{name}` is None; expected an array, or update_kinematics=False.")
        kinematics.forwardKinematics(self.model, self.data, *state)

    def framesForwardKinematics(self, q: Any) -> None:
        """Fills `data.oMi` and `data.oMf`."""
        kinematics.framesForwardKinematics(self.model, self.data, q)

    def placement(self, q: Any, index: int, update_kinematics: bool = True) -> SE3:
        """Where a joint is in the world: a live reference into `data.oMi`.

        Args:
            index: Index of the joint.
            update_kinematics: Whether to compute it; else `data` has it.

        Returns:
            The placement of the joint in the world.
        """
        joint = self._joint(index)
        if update_kinematics:
            self.forwardKinematics(q)
        return self.data.oMi[joint]

    position = placement
    """The historic name of `placement`."""

    def framePlacement(self, q: Any, index: int, update_kinematics: bool = True) -> SE3:
        """Where a frame is in the world; `data.oMf` has it, too.

        Args:
            index: Index of the frame.
            update_kinematics: Whether to compute it; else `data` has it.

        Returns:
            The placement of the frame in the world.
        """
        frame = self._frame(index)
        if update_kinematics:
            self.forwardKinematics(q)
        return kinematics.updateFramePlacement(self.model, self.data, frame).copy()

    framePosition = framePlacement
    """The historic name of `framePlacement`."""

    velocity = _of_velocity(frame_motions.getVelocity, "_joint", "The velocity of a joint.")
    acceleration = _of_acceleration(
        frame_motions.getAcceleration, "_joint", "The spatial acceleration of a joint."
    )
    classicalAcceleration = classicAcceleration = _of_acceleration(
        frame_motions.getClassicalAcceleration, "_joint", "The acceleration of the point at a joint's origin."
    )
    frameVelocity = _of_velocity(frame_motions.getFrameVelocity, "_frame", "The velocity of a frame.")
    frameAcceleration = _of_acceleration(
        frame_motions.getFrameAcceleration, "_frame", "The spatial acceleration of a frame."
    )
    frameClassicalAcceleration = frameClassicAcceleration = _of_acceleration(
        frame_motions.getFrameClassicalAcceleration,
        "_frame",
        "The acceleration of the point at a frame's origin.",
    )

    def computeJointJacobians(self, q: Any) -> Floats:
        """Fills `data.J` (6, nv), all columns in WORLD, and `data.oMi`."""
        return jacobians.computeJointJacobians(self.model, self.data, q)

    def computeJointJacobian(self, q: Any, index: int) -> Floats:
        """The Jacobian (6, nv) of a joint, in LOCAL.

        Args:
            index: Index of the joint.

        Returns:
            Jacobian (6, nv), linear rows first.
        """
        return jacobians.computeJointJacobian(self.model, self.data, q, self._joint(index))

    jointJacobian = computeJointJacobian
    """The historic name of `computeJointJacobian`."""

    def getJointJacobian(self, index: int, rf_frame: Any = _LOCAL) -> Floats:
        """The Jacobian (6, nv) of a joint, after `computeJointJacobians`.

        Args:
            index: Index of the joint.
            rf_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Returns:
            Jacobian (6, nv), linear rows first.
        """
        return jacobians.getJointJacobian(self.model, self.data, self._joint(index), rf_frame)

    def computeFrameJacobian(self, q: Any, frame_id: int) -> Floats:
        """The Jacobian (6, nv) of a frame, in LOCAL.

        Returns:
            Jacobian (6, nv), linear rows first.
        """
        return jacobians.computeFrameJacobian(self.model, self.data, q, self._frame(frame_id))

    frameJacobian = computeFrameJacobian
    """The historic name of `computeFrameJacobian`."""

    def getFrameJacobian(self, frame_id: int, rf_frame: Any = _LOCAL) -> Floats:
        """The Jacobian (6, nv) of a frame, after `computeJointJacobians`.

        Args:
            rf_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Returns:
            Jacobian (6, nv), linear rows first.
        """
        return jacobians.getFrameJacobian(self.model, self.data, self._frame(frame_id), rf_frame)
