"""MJCF to Model and geometries: joints of one body are one composite joint, children in the file's order."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pinocchio._constraints.anchors import FrameAnchorConstraintModel, PointAnchorConstraintModel
from pinocchio._constraints.frame_pair import ContactType
from pinocchio._constraints.rigid_constraint_model import RigidConstraintModel
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.enums import FrameType, GeometryType, ReferenceFrame
from pinocchio._containers.unknown_ids import known
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model import joint_kinds
from pinocchio._model.frame import Frame
from pinocchio._model.joint_compositions import JointModelComposite
from pinocchio._model.joint_model import JointModel
from pinocchio._model.model import Model
from pinocchio._parsers.geometry_urdf import geometry_model_of
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import ModelWarning
from ulna.formats.mjcf import model_with_names
from ulna.formats.mjcf_loops import loops_from_mjcf
from ulna.formats.mjcf_parse import UnnamedParts
from ulna.model import FreeFlyer, JointKind, Prismatic, Revolute, Spherical
from ulna.model import Joint as TowerJoint
from ulna.model import Link as TowerLink
from ulna.model import Model as CoreModel


def buildModelFromMJCF(
    mjcf_filename: Any, root_joint: JointModel | None = None, root_joint_name: str | None = None
) -> Any:
    """The model of an MJCF file; MuJoCo's own compiler reads it (extra `mjcf`).

    Equalities of joints are not followed; keyframes are in `model.referenceConfigurations`, sites are frames.

    Args:
        root_joint: How its root moves in the world, such as JointModelFreeFlyer(); as in Pinocchio it does not count
            where the first body of the file has joints of its own.
        root_joint_name: The name of that joint.

    Returns:
        The model; with `root_joint_name` the model and the constraints that close its loops.

    Raises:
        FormatError: the file is missing or broken; says where and how to fix it.
        MissingExtra: the package mujoco is not installed.
    """
    model = _model(mjcf_filename, root_joint, root_joint_name or "root_joint")
    return model if root_joint_name is None else (model, _rigid_constraints(model, mjcf_filename))


def _model(mjcf_filename: Any, root_joint: JointModel | None, root_joint_name: str) -> Model:
    if root_joint is not None and not isinstance(root_joint, JointModel):
        raise ArgumentError(
            f"`root_joint` is {root_joint!r}; expected a joint model, such as JointModelFreeFlyer()."
        )
    return model_of(_read(os.fspath(mjcf_filename)), root_joint, root_joint_name)


def buildModelFromMJCFAndRootJoint(
    mjcf_filename: Any, root_joint: JointModel, root_joint_name: str = "root_joint"
) -> Model:
    """The model of an MJCF file on a joint, without the closed loops; see `buildModelFromMJCF`.

    Args:
        root_joint: The joint of the root body.
        root_joint_name: Its name.

    Returns:
        The model.
    """
    return _model(mjcf_filename, root_joint, root_joint_name)


def buildModelAndLegacyConstraintsFromMJCF(
    mjcf_filename: Any, root_joint: JointModel | None = None, root_joint_name: str = "root_joint"
) -> tuple[Model, StdVec[RigidConstraintModel]]:
    """The model of an MJCF file, and the constraints of the class RigidConstraintModel that close its loops.

    Args:
        root_joint: The joint of the root body; that of the file by default.
        root_joint_name: Its name.

    Returns:
        The model and the constraints.
    """
    model = _model(mjcf_filename, root_joint, root_joint_name)
    return model, _rigid_constraints(model, mjcf_filename)


def buildModelAndConstraintsFromMJCF(
    mjcf_filename: Any, root_joint: JointModel | None = None, root_joint_name: str = "root_joint"
) -> tuple[Model, StdVec[PointAnchorConstraintModel], StdVec[FrameAnchorConstraintModel]]:
    """The model of an MJCF file, and the anchors of points, then of frames, that close its loops.

    Args:
        root_joint: The joint of the root body; that of the file by default.
        root_joint_name: Its name.

    Returns:
        The model, the anchors of points, the anchors of frames.
    """
    model = _model(mjcf_filename, root_joint, root_joint_name)
    points: StdVec[PointAnchorConstraintModel] = StdVec()
    frames: StdVec[FrameAnchorConstraintModel] = StdVec()
    for size, places in _loops(model, mjcf_filename):
        if size == 3:
            points.append(PointAnchorConstraintModel(model, *places))
        else:
            frames.append(FrameAnchorConstraintModel(model, *places))
    return model, points, frames


def _read(file: str) -> CoreModel:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)  # what is left out here, Pinocchio leaves out, too
        return model_with_names(file, _UNNAMED)


_UNNAMED = UnnamedParts("{body}Joint_{number}", "{body}_free", "{body}Site_{number}")
"""How Pinocchio calls joints and sites without a name; see `UnnamedParts`."""


def _loops(model: Model, file: Any) -> Iterator[tuple[int, list[Any]]]:
    """The closed loops of a file, on the model of that file: how many rows, then joint, placement, joint, placement."""
    for loop in loops_from_mjcf(os.fspath(file)):
        places: list[Any] = []
        for name, pose in loop.ends():
            frame = model.frames[known(model.getBodyId(name)) if name != "world" else 0]
            places += [frame.parentJoint, frame.placement * _pose(pose)]
        yield loop.size, places


def _rigid_constraints(model: Model, file: Any) -> StdVec[RigidConstraintModel]:
    kinds = {3: ContactType.CONTACT_3D, 6: ContactType.CONTACT_6D}
    return StdVec(
        RigidConstraintModel(kinds[size], model, *places, ReferenceFrame.LOCAL)
        for size, places in _loops(model, file)
    )


def buildGeomFromMJCF(
    model: Model, mjcf_filename: Any, geom_type: GeometryType, mesh_loader: Any = None
) -> GeometryModel:
    """The geometries that an MJCF file gives the bodies of a model; see `buildGeomFromUrdf`.

    VISUAL are the geoms of the groups 0 to 2, COLLISION those that may touch others. They have their names in the file;
    without one, that of the body, "Geom_" and their number on it.

    Args:
        geom_type: GeometryType.VISUAL or COLLISION.
        mesh_loader: A coal.MeshLoader for the files of meshes.

    Returns:
        The GeometryModel.
    """
    source = _read(os.fspath(mjcf_filename))
    world = source.links[0]
    links = {("universe" if link is world else link.name): link for link in source.links}
    out = geometry_model_of(model, links, geom_type, None, mesh_loader, own_names=True)
    for geometry in out.geometryObjects:
        unnamed = f"{world.name}Geom_"
        if geometry.parentFrame == 0 and geometry.name.startswith(unnamed):
            geometry.name = f"universeGeom_{geometry.name.removeprefix(unnamed)}"
    return out


def model_of(source: CoreModel, root: JointModel | None = None, root_name: str = "root_joint") -> Model:
    """The Model of a model of Ulna, whose root link is the world.

    Args:
        source: Ulna's model.
        root: The joint that the world's bodies hang from, used as in Pinocchio only where the first one has no joint.
        root_name: Its name.

    Returns:
        The model.
    """
    out = Model()
    out.name, out.gravity.linear = source.name, source.gravity
    top, ids, frames = source.links[0], {-1: 0}, {source.links[0].name: 0}
    if any(link.joint >= 0 for link in source.links[1:2]):
        root = None
    if root is not None:
        ids[-1] = out.addJoint(0, root, SE3(), root_name)
        frames[top.name] = out.addJointFrame(ids[-1], 0)
    rows = _rows(source)
    for row in rows:
        joints = [source.joints[j] for j in row]
        name = joints[0].name if len(row) == 1 else f"Composite_{joints[0].name}"
        kind, at = _joint_model(joints), _pose(joints[0].placement)
        ids |= dict.fromkeys(row, out.addJoint(ids[joints[0].parent], kind, at, name, *_bounds(joints)))
    _copy_armature(out, source, rows, ids)
    inner = {j for row in rows for j in row[:-1]}
    for link in source.links:
        carrier, at = ids[link.joint], _pose(link.placement)
        if link.parent is not None:
            frames[link.name] = frames[link.parent]
            if link.joint in inner:
                continue
            frames[link.name] = _add_body(out, link, carrier, at, frames[link.parent])
        if link.inertia.mass > 0.0:
            out.appendBodyToJoint(carrier, Inertia._from(link.inertia), at)
        for site in (f for f in source.frames if f.kind == "user" and f.link == link.name):
            out.addFrame(
                Frame(site.name, carrier, frames[link.name], _pose(site.placement), FrameType.OP_FRAME)
            )
    if root is None:
        named = {"qpos0": source.neutral, **source.configurations}
        out.referenceConfigurations |= {name: np.array(q) for name, q in named.items()}
    return out


def _pose(pose: Any) -> SE3:
    return SE3._of(np.array(pose.matrix(), dtype=float))


def _rows(source: CoreModel) -> list[list[int]]:
    """The joints in rows, one for each body.

    A joint stands in the row of the one before it where the link between them has no mass, shape, frame or other child.
    """
    named = {f.link for f in source.frames if f.kind == "user"}
    carried = [[link for link in source.links if link.joint == j] for j in range(len(source.joints))]
    below = [[k for k, joint in enumerate(source.joints) if joint.parent == j] for j in range(len(carried))]

    def bare(j: int) -> bool:
        (link, *others), children = carried[j], below[j]
        filled = link.inertia.mass or link.visuals or link.collisions or link.name in named
        return not (filled or others) and len(children) == 1

    rows: dict[int, list[int]] = {}
    for j, joint in enumerate(source.joints):
        rows[j] = rows[joint.parent] if joint.parent >= 0 and bare(joint.parent) else []
        rows[j].append(j)
    return [row for j, row in rows.items() if row[0] == j]


def _joint_model(joints: Sequence[TowerJoint]) -> JointModel:
    """The joint model of one joint, or the composite of several."""
    if len(joints) == 1:
        return _one(joints[0].kind)
    out = JointModelComposite()
    for k, joint in enumerate(joints):
        out.addJoint(_one(joint.kind), _pose(joint.placement) if k else SE3())
    return out


def _one(kind: JointKind) -> JointModel:
    if isinstance(kind, Revolute):
        return joint_kinds.revolute(kind.axis)
    if isinstance(kind, Prismatic):
        return joint_kinds.prismatic(kind.axis)
    return (
        joint_kinds.JointModelFreeFlyer()
        if isinstance(kind, FreeFlyer)
        else joint_kinds.JointModelSpherical()
    )


def _bounds(joints: Sequence[TowerJoint]) -> tuple[Any, ...]:
    """Least and largest effort, speed and position, friction, damping: as addJoint takes them."""
    limits = [joint.limits for joint in joints]
    effort, speed, low, high = (
        np.concatenate([getattr(x, key) for x in limits]) for key in ("effort", "velocity", "lower", "upper")
    )
    for joint, at in zip(joints, np.cumsum([0, *(j.kind.nq for j in joints)]), strict=False):
        turns = slice(at + joint.kind.nq - 4, at + joint.kind.nq)
        if isinstance(joint.kind, (FreeFlyer, Spherical)):  # quaternions, with a margin, as Pinocchio has it
            low[turns], high[turns] = -1.01, 1.01
    friction, damping = (np.concatenate([getattr(j, key) for j in joints]) for key in ("friction", "damping"))
    return (-effort, effort, -speed, speed, low, high, -friction, friction, damping)


def _copy_armature(out: Model, source: CoreModel, rows: list[list[int]], ids: Mapping[int, int]) -> None:
    armature = out.armature.copy()
    for row in rows:
        joint = out.joints[ids[row[0]]]
        armature[joint.idx_v : joint.idx_v + joint.nv] = [a for j in row for a in source.joints[j].armature]
    out.armature = armature


def _add_body(out: Model, link: TowerLink, carrier: int, at: SE3, before: int) -> int:
    """The frame of a link, after that of the joint before it; returns its index."""
    if link.joint >= 0 and not any(f.parentJoint == carrier for f in out.frames):
        before = out.addJointFrame(carrier, before)
    elif (
        out.frames[before].type == FrameType.BODY
    ):  # those of the world have no frame of a joint in Pinocchio
        name = link.parent_joint or f"{link.name}_fixed"
        before = out.addFrame(Frame(name, carrier, before, at, FrameType.FIXED_JOINT, Inertia()))
    return out.addBodyFrame(link.name, carrier, at, before)
