"""The same robot for Ulna and for Pinocchio, made from either, with the maps between their coordinates."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from support.random_models import KINDS
from ulna.errors import ModelWarning
from ulna.model import (
    Continuous,
    Frame,
    FreeFlyer,
    Helical,
    JointKind,
    Model,
    ModelBuilder,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
)
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

SINGLE_JOINT_KINDS = tuple(
    name
    for name, make in KINDS.items()
    if len(make(np.random.default_rng(0)).elementary_joints(SE3.identity())) == 1
)
"""Kinds of `KINDS` that are one joint of Pinocchio. The others are its composite joints, which must not be in one model with mimic joints:
it crashes, or its results are wrong."""

REFERENCES = {
    "world": pin.WORLD,
    "local": pin.LOCAL,
    "local_world_aligned": pin.LOCAL_WORLD_ALIGNED,
}


@dataclass(frozen=True)
class Twin:
    """A model, Pinocchio's model of the same robot, and how their coordinates and frames correspond."""

    model: Model
    pin: pin.Model
    frames: tuple[tuple[Frame, int], ...]
    """Frames with Pinocchio's index of them."""

    def q(self, q: Floats) -> Floats:
        """The configuration as Pinocchio writes it: free angles as cosine and sine."""
        out = pin.neutral(self.pin)
        for joint, i, nq, _ in self._pairs():
            part = joint.q_of(q)
            if nq == joint.kind.nq + 1:  # the last entry is an angle
                part = np.concatenate([part[:-1], np.cos(part[-1:]), np.sin(part[-1:])])
            out[i : i + nq] = part
        return out

    def v(self, v: Floats) -> Floats:
        """A tangent vector in Pinocchio's order."""
        return v[self.order]

    @property
    def order(self) -> list[int]:
        """For each entry of Pinocchio's v, where it stands in Ulna's."""
        order = [-1] * self.pin.nv
        for joint, _, _, j in self._pairs():
            for k in range(joint.kind.nv):
                order[j + k] = joint.idx_v + k
        return order

    def columns(self, matrix: Floats) -> Floats:
        """A matrix of Pinocchio's whose last axis is v, its columns in Ulna's order."""
        return matrix[..., np.argsort(self.order)]

    def both(self, matrix: Floats) -> Floats:
        """A matrix of Pinocchio's whose last two axes are v, in Ulna's order."""
        return self.columns(np.swapaxes(self.columns(np.swapaxes(matrix, -1, -2)), -1, -2))

    def _pairs(self):
        for joint in self.model.joints:
            if joint.mimic is None:
                i = self.pin.getJointId(joint.name)
                yield joint, self.pin.idx_qs[i], self.pin.nqs[i], self.pin.idx_vs[i]


# ------------------------------------------------------------------------------------ from Pinocchio to Ulna


def from_pinocchio(source: pin.Model) -> Twin:
    """The robot of a Pinocchio model; every frame of it becomes a frame."""
    builder = ModelBuilder("twin")
    builder.gravity = source.gravity.linear
    data = source.createData()
    pin.forwardKinematics(source, data, pin.neutral(source))  # fills the motion subspaces
    bodies = ["body0"]
    builder.add_link("body0")
    for i in range(1, source.njoints):
        bodies.append(f"body{i}")
        builder.add_link(bodies[i], _inertia(source.inertias[i]))
        joint = source.joints[i]
        q, v = slice(joint.idx_q, joint.idx_q + joint.nq), slice(joint.idx_v, joint.idx_v + joint.nv)
        builder.add_joint(
            source.names[i],
            _kind(joint, data.joints[i]),
            bodies[source.parents[i]],
            bodies[i],
            _pose(source.jointPlacements[i]),
            lower=source.lowerPositionLimit[q] if joint.nq == 1 else None,
            upper=source.upperPositionLimit[q] if joint.nq == 1 else None,
            armature=source.armature[v],
        )
    names = [f"{k}:{frame.name}" for k, frame in enumerate(source.frames)]
    for name, frame in zip(names, source.frames, strict=True):
        builder.add_frame(name, bodies[frame.parentJoint], _pose(frame.placement))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)  # some robots have inertias that no body has
        model = builder.build()
    return Twin(model, source, tuple((model.frame(name), k) for k, name in enumerate(names)))


def _inertia(inertia: pin.Inertia) -> Inertia | None:
    return Inertia(inertia.mass, inertia.lever, inertia.inertia) if inertia.mass > 0 else None


def _pose(M: pin.SE3) -> SE3:
    return SE3(M.rotation.copy(), M.translation.copy())


def _kind(joint: pin.JointModel, data: pin.JointData) -> JointKind:
    name = joint.shortname()
    if name == "JointModelFreeFlyer":
        return FreeFlyer()
    if name == "JointModelSpherical":
        return Spherical()
    if name == "JointModelPlanar":
        return Planar()
    if name == "JointModelTranslation":
        return Translation()
    assert joint.nv == 1, name
    linear, angular = np.asarray(data.S).reshape(6)[:3], np.asarray(data.S).reshape(6)[3:]
    if not angular.any():
        return Prismatic(tuple(linear))
    if linear.any():
        return Helical(tuple(angular), float(linear @ angular))
    return Continuous(tuple(angular)) if joint.nq == 2 else Revolute(tuple(angular))


# ------------------------------------------------------------------------------------ from Ulna to Pinocchio


def to_pinocchio(model: Model) -> Twin:
    """The robot of a model for Pinocchio; free angles become plain ones, mimic joints mimic joints.

    Pinocchio's planar joint lies across z. Another normal is had by turning the frames around the joint, and
    turning them back at whatever it carries.
    """
    out = pin.Model()
    out.gravity.linear = np.array(model.gravity)
    ids, back = {-1: 0}, {-1: SE3.identity()}
    for index, joint in enumerate(model.joints):
        turn = _turn(joint.kind)
        placement = back[joint.parent] @ joint.placement @ turn
        ids[index] = out.addJoint(ids[joint.parent], _pin_kind(joint.kind), _pin_pose(placement), joint.name)
        back[index] = turn.inverse()
        inertia = back[index].act(model.inertias[index])
        out.appendBodyToJoint(
            ids[index], pin.Inertia(float(inertia.mass), inertia.com, inertia.inertia), pin.SE3.Identity()
        )
        if joint.mimic is None:
            k = out.joints[ids[index]].idx_v
            out.armature[k : k + joint.kind.nv] = model.armature[joint.idx_v : joint.idx_v + joint.kind.nv]
    frames = []
    for k, frame in enumerate(model.frames):
        placement = back[frame.joint] @ frame.placement
        pin_frame = pin.Frame(f"{k}:{frame.name}", ids[frame.joint], 0, _pin_pose(placement), pin.OP_FRAME)
        frames.append((frame, out.addFrame(pin_frame)))
    for index, joint in enumerate(model.joints):
        if joint.mimic is not None:
            source = ids[joint.mimic.source]
            out = pin.transformJointIntoMimic(
                out, source, ids[index], joint.mimic.multiplier, joint.mimic.offset
            )
    return Twin(model, out, tuple(frames))


def _turn(kind: JointKind) -> SE3:
    if not isinstance(kind, Planar):
        return SE3.identity()
    return SE3(np.stack([*kind.axes, kind.normal], axis=-1), np.zeros(3))


def _pin_pose(T: SE3) -> pin.SE3:
    return pin.SE3(np.array(T.rotation), np.array(T.translation))


def _pin_kind(kind: JointKind):
    if isinstance(kind, Revolute):
        return pin.JointModelRevoluteUnaligned(np.array(kind.axis))
    if isinstance(kind, Prismatic):
        return pin.JointModelPrismaticUnaligned(np.array(kind.axis))
    if isinstance(kind, Helical):
        return pin.JointModelHelicalUnaligned(np.array(kind.axis), kind.pitch)
    parts = kind.elementary_joints(SE3.identity())
    if len(parts) > 1:  # also for Universal, as Pinocchio's wants perpendicular axes
        out = pin.JointModelComposite()
        for part in parts:
            out.addJoint(_pin_kind(part.kind), _pin_pose(part.placement))
        return out
    plain = {
        Translation: pin.JointModelTranslation,
        Planar: pin.JointModelPlanar,
        Spherical: pin.JointModelSpherical,
        FreeFlyer: pin.JointModelFreeFlyer,
    }
    return plain[type(kind)]()
