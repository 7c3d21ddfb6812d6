"""URDF to Model: children in the alphabetical order of their joints, fixed joints merged."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from pinocchio._containers.enums import FrameType
from pinocchio._containers.keywords import overloads
from pinocchio._containers.unknown_ids import known
from pinocchio._model import joint_kinds
from pinocchio._model.frame import Frame
from pinocchio._model.joint_kinds import JointModel
from pinocchio._model.live_parameters import FREE
from pinocchio._model.model import Model
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import FormatError
from ulna.formats.markup import read_file
from ulna.formats.poses import pose
from ulna.formats.urdf import inertia_of
from ulna.formats.urdf_document import UrdfDocument, UrdfJoint
from ulna.formats.urdf_parse import parse_urdf

_ORDERS = (
    "{} mimic:bool? verbose?",
    "{} model:Model mimic:bool? verbose?",
    "{} root_joint:JointModel mimic:bool? verbose?",
    "{} root_joint:JointModel model:Model mimic:bool? verbose?",
    "{} root_joint:JointModel root_joint_name:str mimic:bool? verbose?",
    "{} root_joint:JointModel root_joint_name:str model:Model mimic:bool? verbose?",
)


@overloads(*(order.format("urdf_filename") for order in _ORDERS))
def buildModelFromUrdf(
    urdf_filename: Any,
    root_joint: Any = None,
    root_joint_name: Any = None,
    model: Model | None = None,
    verbose: bool = False,
    mimic: bool = False,
) -> Model:
    """The model of a URDF file.

    Args:
        urdf_filename: The file.
        root_joint: How its root moves in the world, such as JointModelFreeFlyer(); it stands still without.
        root_joint_name: The name of that joint; "root_joint" without.
        model: A model to add it to; a new one without.
        verbose: Plays no part.
        mimic: Whether mimic joints follow their source; else each moves independently.

    Returns:
        The model.

    Raises:
        FormatError: the file is missing or broken; says where and how to fix it.
    """
    path = os.fspath(urdf_filename)
    return _built(read_file(path), path, root_joint, root_joint_name or "root_joint", model, mimic)


@overloads(*(order.format("urdf_xml_stream") for order in _ORDERS))
def buildModelFromXML(
    urdf_xml_stream: str,
    root_joint: Any = None,
    root_joint_name: Any = None,
    model: Model | None = None,
    verbose: bool = False,
    mimic: bool = False,
) -> Model:
    """The model of a URDF text; see `buildModelFromUrdf`.

    Args:
        urdf_xml_stream: The text.
        root_joint: The joint of the root link, such as JointModelFreeFlyer(); fixed by default.
        root_joint_name: Its name; "root_joint" by default.
        model: A model to add it to; a new one by default.
        verbose: Accepted and ignored.
        mimic: Whether mimic joints follow their source; else each moves independently.

    Returns:
        The model.
    """
    return _built(urdf_xml_stream, None, root_joint, root_joint_name or "root_joint", model, mimic)


_BUILT: dict[Any, Model] = {}
_MOST_BUILT = 8
"""Models of texts that were built, the newest last, of which copies are returned; how many are kept."""


def _built(
    text: bytes | str,
    file: str | None,
    root: JointModel | None,
    root_name: str,
    model: Model | None,
    mimic: bool,
) -> Model:
    """The model of a URDF text; of one that was built before, a copy, unless it is added to a model."""
    root_kind = None if root is None else (type(root), root.shortname(), root.kind)
    key = text, root_kind, root_name, mimic
    if model is not None or (root is not None and (root.parts or root.mimic)):
        return build_model(parse_urdf(text, file), root, root_name, model, mimic)
    made = _BUILT.pop(key, None) or build_model(parse_urdf(text, file), root, root_name, None, mimic)
    _BUILT[key] = made  # the newest last
    while len(_BUILT) > _MOST_BUILT:
        _BUILT.pop(next(iter(_BUILT)), None)
    return made.copy()


def build_model(
    document: UrdfDocument, root: JointModel | None, root_name: str, model: Model | None, mimic: bool
) -> Model:
    """The model of a document.

    Args:
        document: The URDF document.
        root: The joint of the root link; None for a fixed one.
        root_name: Its name.
        model: A model to add it to; None for a new one.
        mimic: Whether mimic joints follow their source.

    Returns:
        The model.
    """
    out = Model() if model is None else model
    out.name = document.name
    below: dict[str, list[UrdfJoint]] = {}
    for joint in sorted(document.joints, key=lambda j: j.name):
        below.setdefault(joint.parent, []).append(joint)
    inertias = {
        link.name: Inertia() if link.inertial is None else Inertia._from(inertia_of(link.inertial))
        for link in document.links
    }
    top = document.root
    carrier, frame = 0, 0
    if root is not None:
        carrier = out.addJoint(0, root, SE3(), root_name)
        frame = out.addJointFrame(carrier, 0)
    inertia = inertias[top]
    body_frame = Frame(top, carrier, frame, SE3(), FrameType.BODY, Inertia() if carrier else inertia)
    placed = {top: (carrier, out.addFrame(body_frame), SE3())}
    if carrier and not inertia.isZero():
        out.appendBodyToJoint(carrier, inertia, SE3())
    joints = _add_joints(out, top, below, inertias, placed)
    for joint, carrier in joints if mimic else ():
        if joint.mimic is not None:
            out._make_mimic(
                known(out.getJointId(joint.mimic.joint)), carrier, joint.mimic.multiplier, joint.mimic.offset
            )
    return out


def _add_joints(
    out: Model,
    root: str,
    below: dict[str, list[UrdfJoint]],
    inertias: dict[str, Inertia],
    placed: dict[str, tuple[int, int, SE3]],
) -> list[tuple[UrdfJoint, int]]:
    """Adds what hangs from the root link, depth first.

    Args:
        out: The model.
        root: Name of that link.
        below: The joints of each link.
        inertias: The inertia of each link.
        placed: For each link its joint, its frame, and its pose in the joint's frame; those of the root link at first.

    Returns:
        The joints that move, with their indices.
    """
    added: list[tuple[UrdfJoint, int]] = []
    waiting = list(reversed(below.get(root, [])))
    while waiting:
        joint = waiting.pop()
        inertia = inertias[joint.child]
        carrier, before, M = placed[joint.parent]
        M = M * SE3._of(np.array(pose(joint.origin.xyz, joint.origin.rpy).matrix()))
        if joint.kind == "fixed":
            frame = out.addFrame(Frame(joint.name, carrier, before, M, FrameType.FIXED_JOINT, inertia))
        else:
            carrier = out.addJoint(carrier, _kind(joint), M, joint.name, *_bounds(joint))
            added.append((joint, carrier))
            frame = out.addJointFrame(carrier, before)
            M = SE3()
            if not inertia.isZero():
                out.appendBodyToJoint(carrier, inertia, SE3())
        placed[joint.child] = (carrier, out.addBodyFrame(joint.child, carrier, M, frame), M)
        waiting.extend(reversed(below.get(joint.child, [])))
    return added


def _kind(joint: UrdfJoint) -> JointModel:
    if joint.kind == "revolute":
        return joint_kinds.revolute(joint.axis)
    if joint.kind == "continuous":
        return joint_kinds.continuous(joint.axis)
    if joint.kind == "prismatic":
        return joint_kinds.prismatic(joint.axis)
    kinds = {
        "planar": joint_kinds.JointModelPlanar,
        "floating": joint_kinds.JointModelFreeFlyer,
        "spherical": joint_kinds.JointModelSpherical,
    }
    if joint.kind not in kinds:
        raise FormatError(f"joint {joint.name!r} is {joint.kind!r}, which is no kind of joint in URDF")
    return kinds[joint.kind]()


def _bounds(joint: UrdfJoint) -> tuple[Any, ...]:
    """Least and largest effort, speed and position, friction, damping: as addJoint takes them."""
    limit = joint.limit
    effort = FREE if limit is None else min(limit.effort, FREE)
    speed = FREE if limit is None else min(limit.velocity, FREE)
    low, high = -FREE, FREE
    if joint.kind in ("revolute", "prismatic") and limit is not None:
        low, high = max(limit.lower, -FREE), min(limit.upper, FREE)
    elif joint.kind == "continuous":
        low, high = -1.01, 1.01
    return (-effort, effort, -speed, speed, low, high, -joint.friction, joint.friction, joint.damping)
