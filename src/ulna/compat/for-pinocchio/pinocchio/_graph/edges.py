"""Bodies and frames of a graph, and what a joint between two of them is made of."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError, check_text
from pinocchio._containers.arrays import numbers, real
from pinocchio._containers.enums import FrameType
from pinocchio._graph.joints import GraphJoint, JointFixed
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import ModelError
from ulna.typing import Floats

__all__ = ["BodyFrame", "EdgeParameters", "JointLimits", "OpFrame", "SensorFrame"]


class GraphFrame:
    """A body, a frame or a sensor of a graph."""

    f_type: FrameType


class BodyFrame(GraphFrame):
    """A body with its inertia."""

    f_type = FrameType.BODY

    def __init__(self, inertia: Inertia | None = None) -> None:
        self.inertia = Inertia() if inertia is None else Inertia(inertia)
        """Its inertia, in its own frame."""


class OpFrame(GraphFrame):
    """A frame without mass, held by a fixed joint."""

    f_type = FrameType.OP_FRAME


class SensorFrame(GraphFrame):
    """A sensor, held by a fixed joint."""

    f_type = FrameType.SENSOR


class JointLimits:
    """Limits and losses of a joint; those that are empty are infinite, or zero for losses.

    Attributes:
        minConfig: Lower limits of q, (nq,).
        maxConfig: Upper limits of q, (nq,).
        maxVel: Largest velocities, (nv,).
        maxEffort: Largest torques or forces, (nv,).
        friction: Coulomb friction, (nv,).
        damping: Viscous friction, (nv,).
        armature: Inertia of the drives, (nv,).
        frictionLoss: Kept; it plays no part, as in Pinocchio.
    """

    PER_Q = ("minConfig", "maxConfig")
    PER_V = ("maxVel", "maxEffort", "friction", "damping", "armature")

    def __init__(self) -> None:
        for name in (*self.PER_Q, *self.PER_V):
            setattr(self, name, np.zeros(0))
        self.frictionLoss = 0.0

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "frictionLoss" and name not in (*self.PER_Q, *self.PER_V):
            raise AttributeError(
                f"JointLimits has no {name!r}; it has {', '.join((*self.PER_Q, *self.PER_V))}."
            )
        value = real(value, name) if name == "frictionLoss" else np.atleast_1d(numbers(value, name)).copy()
        object.__setattr__(self, name, value)

    def filled(self, joint: GraphJoint, name: str) -> dict[str, Floats]:
        """All of them with the sizes of a joint.

        Args:
            joint: The joint.
            name: Its name, for messages.

        Returns:
            Arrays (nq,) and (nv,) by their names.

        Raises:
            ModelError: One has another size.
        """
        empty = {"minConfig": -np.inf, "maxConfig": np.inf, "maxVel": np.inf, "maxEffort": np.inf}
        out = {}
        for key in (*self.PER_Q, *self.PER_V):
            size, value = joint.nq if key in self.PER_Q else joint.nv, getattr(self, key)
            out[key] = value if value.size else np.full(size, empty.get(key, 0.0))
            if out[key].shape != (size,):
                raise ModelError(f"Joint {name!r}: {key} has shape {value.shape}; expected ({size},).")
        return out

    def append(self, jlimit: JointLimits, nq: int, nv: int) -> None:
        """Appends the limits of another joint.

        Args:
            jlimit: The limits.
            nq: How many entries of q the other joint has.
            nv: How many entries of v.

        Raises:
            ModelError: The limits have another size.
        """
        for key in (*self.PER_Q, *self.PER_V):
            size, more = nq if key in self.PER_Q else nv, getattr(jlimit, key)
            if more.size and more.size != size:
                raise ModelError(f"{key} has shape {more.shape}; expected ({size},).")
            setattr(self, key, np.concatenate([getattr(self, key), more]))


class EdgeParameters:
    """A joint of a graph: what it joins, and where.

    Args:
        name: Its name.
        source_vertex: The body that carries it.
        source_to_joint: Pose of the joint in that body; the identity by default.
        target_vertex: The body that it moves.
        joint_to_target: Pose of that body behind the joint; the identity by default.
        joint: Its kind; fixed by default.
        q_ref: What its coordinates are counted from; None for their zero.
    """

    def __init__(
        self,
        name: str = "",
        source_vertex: str = "",
        source_to_joint: SE3 | None = None,
        target_vertex: str = "",
        joint_to_target: SE3 | None = None,
        joint: GraphJoint | None = None,
        q_ref: Any = None,
    ) -> None:
        self.name, self.source_vertex, self.target_vertex = name, source_vertex, target_vertex
        self.source_to_joint = SE3() if source_to_joint is None else source_to_joint
        self.joint_to_target = SE3() if joint_to_target is None else joint_to_target
        self.joint = JointFixed() if joint is None else joint
        self.q_ref = q_ref
        self.jlimit = JointLimits()
        """Its limits."""
        self.check()

    def check(self) -> None:
        """Raises ArgumentError where a field is not of the class that it should be."""
        for name in ("name", "source_vertex", "target_vertex"):
            check_text(getattr(self, name), name)
        for name in ("source_to_joint", "joint_to_target"):
            if not isinstance(getattr(self, name), SE3):
                raise ArgumentError(f"`{name}` is {getattr(self, name)!r}; expected an SE3.")
        if not isinstance(self.joint, GraphJoint):
            raise ArgumentError(
                f"`joint` is {self.joint!r}; expected a joint of pinocchio.graph, such as JointRevolute(axis)."
            )

    def changed(self, **fields: Any) -> EdgeParameters:
        """A copy with other fields."""
        out = copy.copy(self)
        out.jlimit = copy.deepcopy(self.jlimit)
        out.__dict__.update(fields)
        out.check()
        return out

    @property
    def placed(self) -> SE3:
        """The pose of the joint in its source body, where its coordinates are counted from."""
        return (
            self.source_to_joint if self.q_ref is None else self.source_to_joint * self.joint.pose(self.q_ref)
        )
