"""The joints of a graph: what they are in a model, and which joint leads the other way.

A joint has a pose of its second body in its first one, T(q). The reversed joint has T'(q') = T(q)^-1: `reverse_q` maps
q to q', and `reverse_v` v to v', since the twist of the first body seen from the second is minus that of the second
seen from the first: S' v' = -Ad_T S v.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec, real, vector
from pinocchio._model import joint_kinds as kinds
from pinocchio._model.joint_compositions import JointModelComposite
from pinocchio._model.joint_model import JointModel
from pinocchio._spatial.se3 import SE3
from pinocchio.rpy import matrixToRpy
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = [
    "JointComposite",
    "JointEllipsoid",
    "JointFixed",
    "JointFreeFlyer",
    "JointHelical",
    "JointMimic",
    "JointPlanar",
    "JointPrismatic",
    "JointRevolute",
    "JointRevoluteUnbounded",
    "JointSpherical",
    "JointSphericalZYX",
    "JointTranslation",
    "JointUniversal",
]


class GraphJoint:
    """A joint between two bodies of a graph."""

    def model(self) -> JointModel:
        """The joint of a model that it becomes."""
        raise NotImplementedError

    @property
    def nq(self) -> int:
        """How many entries of q it has."""
        return self.model().nq

    @property
    def nv(self) -> int:
        """How many entries of v it has."""
        return self.model().nv

    def reversed(self) -> GraphJoint:
        """The joint that leads from its second body to the first one."""
        return self

    @property
    def leading(self) -> SE3:
        """The placement before its first moving part, which the reversed joint leaves to whoever places it."""
        return SE3()

    def reverse_q(self, q: Floats) -> Floats:
        """The configuration of the reversed joint at which the bodies are in the same places."""
        return -q

    def reverse_v(self, q: Floats, v: Floats) -> Floats:
        """The velocity of the reversed joint with which the bodies move alike.

        Args:
            q: Configuration of this joint, (nq,) [rad, m].
            v: Its velocity, (nv,) [rad/s, m/s].

        Returns:
            The velocity, (nv,) [rad/s, m/s].

        Raises:
            ValueError: If the reversed joint is singular there and cannot move so.
        """
        here, back = self.model().kind, self.reversed().model().kind
        assert here is not None and back is not None  # a model's joint has a kind
        columns = [here.transform(q).act(s).vector() for s in here.motion_subspace(q)]
        others = [s.vector() for s in back.motion_subspace(self.reverse_q(q))]
        twist = -np.stack(columns, axis=1) @ v
        subspace = np.stack(others, axis=1)
        velocity = np.asarray(np.linalg.lstsq(subspace, twist, rcond=None)[0], float)
        if np.abs(subspace @ velocity - twist).max(initial=0.0) > 1e-6 * max(
            1.0, np.abs(twist).max(initial=0.0)
        ):
            raise ValueError(
                f"The reversed {type(self).__name__} is singular at q = {np.asarray(q).tolist()}: none of its "
                "velocities moves the bodies as v does. Take another configuration, or keep the joint's direction."
            )
        return velocity

    def reverse_limits(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """The limits of the reversed joint's configuration.

        Args:
            low: Lower limits of this joint, (nq,) [rad, m].
            high: Upper limits, (nq,) [rad, m].

        Returns:
            Lower and upper limits of the reversed joint, (nq,) each [rad, m].

        Raises:
            InputError: There are limits, and those of the reversed joint depend on the configuration.
        """
        if np.isfinite([low, high]).any():
            raise InputError(
                f"{type(self).__name__} with limits cannot be reversed: limits of its inverse are no intervals. Take "
                "the root on the other side of this joint, or leave its limits out."
            )
        return low, high

    def reverse_rates(self, values: Floats) -> Floats:
        """Values for each entry of v, such as damping, in the order of the reversed joint."""
        return values

    def pose(self, q: Any) -> SE3:
        """The pose of its second body in the first one.

        Args:
            q: Configuration, (nq,).

        Raises:
            WrongShape: `q` has another size.
        """
        kind = self.model().kind
        assert kind is not None
        return SE3(kind.transform(vector(q, kind.nq, "q_ref")).matrix())

    def __repr__(self) -> str:
        return f"pinocchio.graph.{type(self).__name__}"


class _Scalar(GraphJoint):
    """A joint whose inverse has the opposite coordinates."""

    def reverse_limits(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        return -high, -low


class _WithAxis(_Scalar):
    """A joint about or along an axis: `(axis)`."""

    _make: Any

    def __init__(self, axis: Any) -> None:
        self.axis = vector(axis, 3, "axis").copy()
        """The axis (3,)."""

    def model(self) -> JointModel:
        return type(self)._make(self.axis)


class JointRevolute(_WithAxis):
    """Turns about an axis between limits."""

    _make = staticmethod(kinds.revolute)


class JointPrismatic(_WithAxis):
    """Slides along an axis."""

    _make = staticmethod(kinds.prismatic)


class JointRevoluteUnbounded(_WithAxis):
    """Turns about an axis without end; q is (cos, sin)."""

    _make = staticmethod(kinds.continuous)

    def reverse_q(self, q: Floats) -> Floats:
        return q * (1.0, -1.0)

    def reverse_limits(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        return np.array([low[0], -high[1]]), np.array([high[0], -low[1]])


class JointHelical(_Scalar):
    """A screw about an axis with a pitch [m/rad]."""

    def __init__(self, axis: Any, pitch: float) -> None:
        self.axis = vector(axis, 3, "axis").copy()
        """The axis (3,)."""
        self.pitch = real(pitch, "pitch")
        """Advance per angle [m/rad]."""

    def model(self) -> JointModel:
        for letter, unit in zip("XYZ", np.eye(3), strict=True):
            if np.array_equal(self.axis, unit):
                return getattr(kinds, f"JointModelH{letter}")(self.pitch)
        return kinds.JointModelHelicalUnaligned(self.axis, self.pitch)


class JointTranslation(_Scalar):
    """Slides freely in space."""

    def model(self) -> JointModel:
        return kinds.JointModelTranslation()


class JointUniversal(GraphJoint):
    """Turns about a first axis, then about a second one."""

    def __init__(self, axis1: Any, axis2: Any) -> None:
        self.axis1, self.axis2 = (vector(a, 3, n).copy() for a, n in ((axis1, "axis1"), (axis2, "axis2")))

    def model(self) -> JointModel:
        return kinds.JointModelUniversal(self.axis1, self.axis2)

    def reversed(self) -> GraphJoint:
        return JointUniversal(-self.axis2, -self.axis1)

    def reverse_q(self, q: Floats) -> Floats:
        return q[::-1]

    def reverse_limits(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        return low[::-1], high[::-1]

    def reverse_rates(self, values: Floats) -> Floats:
        return values[::-1]


class JointSpherical(GraphJoint):
    """A ball joint; q is a quaternion xyzw."""

    def model(self) -> JointModel:
        return kinds.JointModelSpherical()

    def reverse_q(self, q: Floats) -> Floats:
        return q * (-1.0, -1.0, -1.0, 1.0)


class JointSphericalZYX(GraphJoint):
    """A ball joint with the angles yaw, pitch, roll."""

    def model(self) -> JointModel:
        return kinds.JointModelSphericalZYX()

    def reverse_q(self, q: Floats) -> Floats:
        return matrixToRpy(self.pose(q).rotation.T)[::-1].copy()


class JointFreeFlyer(GraphJoint):
    """Moves freely; q is position and quaternion xyzw."""

    def model(self) -> JointModel:
        return kinds.JointModelFreeFlyer()

    def reverse_q(self, q: Floats) -> Floats:
        R = self.pose(q).rotation
        return np.concatenate([-R.T @ q[:3], q[3:] * (-1.0, -1.0, -1.0, 1.0)])


class JointPlanar(GraphJoint):
    """Moves in the plane; q is (x, y, cos, sin)."""

    def model(self) -> JointModel:
        return kinds.JointModelPlanar()

    def reverse_q(self, q: Floats) -> Floats:
        x, y, c, s = q
        return np.array([-c * x - s * y, s * x - c * y, c, -s])


class _NotInvertible(GraphJoint):
    """A joint whose inverse is no joint that models have."""

    def reversed(self) -> GraphJoint:
        raise InputError(
            f"{type(self).__name__} cannot be reversed; take a root from which it is reached at its source body."
        )


class JointEllipsoid(_NotInvertible):
    """Rolls and spins on an ellipsoid: `(radius_x, radius_y, radius_z)` [m]."""

    def __init__(self, radius_x: float = 0.01, radius_y: float = 0.01, radius_z: float = 0.01) -> None:
        self.radius_x, self.radius_y, self.radius_z = radius_x, radius_y, radius_z

    def model(self) -> JointModel:
        return kinds.JointModelEllipsoid(self.radius_x, self.radius_y, self.radius_z)


class _WithoutCoordinates(GraphJoint):
    """A joint without entries of q and v."""

    @property
    def nq(self) -> int:
        """It has no entries of q: 0."""
        return 0

    @property
    def nv(self) -> int:
        """It has no entries of v: 0."""
        return 0


class JointMimic(_WithoutCoordinates, _NotInvertible):
    """Follows another joint of the graph: q = scaling * q_primary + offset."""

    def __init__(
        self, secondary_joint_model: GraphJoint, primary_name: str, scaling: float, offset: float
    ) -> None:
        self.secondary_joint = secondary_joint_model
        """What kind of joint it is."""
        self.primary_name = primary_name
        """Name of the joint that it follows."""
        self.scaling, self.offset = real(scaling, "scaling"), real(offset, "offset")

    def model(self) -> JointModel:
        return self.secondary_joint.model()


class JointFixed(_WithoutCoordinates):
    """Does not move: `(joint_offset)`, a pose, the identity by default."""

    def __init__(self, pose: SE3 | None = None) -> None:
        self.joint_offset = SE3() if pose is None else SE3(pose)
        """Pose of its second frame in the first one."""

    def reversed(self) -> GraphJoint:
        return JointFixed(self.joint_offset.inverse())

    def pose(self, q: Any) -> SE3:
        vector(q, 0, "q_ref")
        return self.joint_offset


class JointComposite(GraphJoint):
    """Several joints in a row: `(joint, placement)`, or lists of both; then `addJoint(joint, placement)`."""

    def __init__(self, joints: Any = (), placements: Any = ()) -> None:
        self.joints: StdVec[GraphJoint] = StdVec()
        """The joints."""
        self.jointsPlacements: StdVec[SE3] = StdVec()
        """Where each is in the moving frame of the one before."""
        single = isinstance(joints, GraphJoint)
        pairs: Sequence[Any] = [(joints, placements)] if single else zip(joints, placements, strict=True)  # type: ignore[assignment]
        for joint, place in pairs:
            self.addJoint(joint, place)

    def addJoint(self, joint_model: GraphJoint, pose: SE3 | None = None) -> None:
        """Adds a joint after the last one.

        Args:
            joint_model: The joint.
            pose: Its placement in the moving frame of the joint before; the identity by default.

        Raises:
            ArgumentError: It is fixed, composite, a mimic joint, or none of this module.
        """
        if not isinstance(joint_model, GraphJoint) or isinstance(
            joint_model, (JointComposite, JointFixed, JointMimic)
        ):
            raise ArgumentError(f"JointComposite.addJoint was given {joint_model!r}; expected a plain joint.")
        self.joints.append(joint_model)
        self.jointsPlacements.append(SE3() if pose is None else SE3(pose))

    def model(self) -> JointModel:
        out = JointModelComposite()
        for joint, place in zip(self.joints, self.jointsPlacements, strict=True):
            out.addJoint(joint.model(), place)
        return out

    def reversed(self) -> GraphJoint:
        joints = [joint.reversed() for joint in self.joints][::-1]
        places = [SE3(), *(place.inverse() for place in self.jointsPlacements[:0:-1])]
        return JointComposite(joints, places)

    @property
    def leading(self) -> SE3:
        """The placement of its first joint."""
        return self.jointsPlacements[0] if len(self.joints) else SE3()

    def _parts(self, values: Floats, size: str) -> list[Floats]:
        ends = np.cumsum([getattr(joint, size) for joint in self.joints])[:-1]
        return np.split(values, ends)

    def reverse_q(self, q: Floats) -> Floats:
        parts = zip(self.joints, self._parts(q, "nq"), strict=True)
        return np.concatenate([joint.reverse_q(part) for joint, part in parts][::-1])

    def reverse_v(self, q: Floats, v: Floats) -> Floats:
        parts = zip(self.joints, self._parts(q, "nq"), self._parts(v, "nv"), strict=True)
        return np.concatenate([joint.reverse_v(a, b) for joint, a, b in parts][::-1])

    def reverse_limits(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        parts = zip(self.joints, self._parts(low, "nq"), self._parts(high, "nq"), strict=True)
        both = [joint.reverse_limits(a, b) for joint, a, b in parts][::-1]
        return np.concatenate([a for a, _ in both]), np.concatenate([b for _, b in both])

    def reverse_rates(self, values: Floats) -> Floats:
        parts = zip(self.joints, self._parts(values, "nv"), strict=True)
        return np.concatenate([joint.reverse_rates(part) for joint, part in parts][::-1])
