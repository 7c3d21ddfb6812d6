"""Graphs made of others: joined, with locked joints, with other names; and the conversion of configurations."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._containers.arrays import vector
from pinocchio._graph.building import ModelGraphBuildInfo, neutral_of
from pinocchio._graph.edges import EdgeParameters
from pinocchio._graph.joints import GraphJoint, JointFixed, JointMimic
from pinocchio._graph.model_graph import ModelGraph
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna.errors import ModelError, UnknownName
from ulna.typing import Floats

__all__ = ["ModelConfigurationConverter", "createConverter", "lockJoints", "merge", "prefixNames"]

_FIXED = JointFixed()


def merge(
    g1: ModelGraph,
    g2: ModelGraph,
    g1_body: str,
    g2_body: str,
    pose_g2_body_in_g1: SE3,
    merging_joint: GraphJoint = _FIXED,
    merging_joint_name: str = "merging_joint",
) -> ModelGraph:
    """A graph with the bodies and joints of two, and a joint between them.

    Args:
        g1: The first graph.
        g2: The second one; no name is in both (`prefixNames`).
        g1_body: The body of the first graph that carries the joint.
        g2_body: The body of the second graph that it moves.
        pose_g2_body_in_g1: Pose of the second body behind the joint.
        merging_joint: The joint; fixed by default.
        merging_joint_name: Its name.

    Returns:
        The graph.
    """
    out = ModelGraph()
    out.appendGraph(g1)
    out.appendGraph(g2)
    out.addJoint(merging_joint_name, merging_joint, g1_body, SE3(), g2_body, pose_g2_body_in_g1)
    return out


def prefixNames(g: ModelGraph, prefix: str) -> ModelGraph:
    """A graph with the same bodies and joints, their names with a prefix.

    Args:
        g: The graph.
        prefix: What stands before each name.

    Returns:
        The graph.
    """
    out = ModelGraph()
    for name, frame in g.frames.items():
        out.addFrame(prefix + name, frame)
    for edge in g.edges.values():
        joint = edge.joint
        if isinstance(joint, JointMimic):
            joint = copy.copy(joint)
            joint.primary_name = prefix + joint.primary_name
        names = {key: prefix + getattr(edge, key) for key in ("name", "source_vertex", "target_vertex")}
        out.addJoint(edge.changed(joint=joint, **names))
    for body, geometries in g.geometries.items():
        for geometry in geometries:
            renamed = copy.deepcopy(geometry)
            renamed.name = prefix + geometry.name
            out.addGeometry(prefix + body, renamed)
    return out


def lockJoints(
    g: ModelGraph, joints_to_lock: Sequence[str], reference_configurations: Sequence[Any]
) -> ModelGraph:
    """A graph in which some joints do not move.

    Args:
        g: The graph.
        joints_to_lock: Names of joints.
        reference_configurations: Where each is held, (nq,).

    Returns:
        The graph.

    Raises:
        UnknownName: There is no such joint.
        ModelError: There are not as many configurations as joints, or a mimic joint follows one of them.
    """
    if len(joints_to_lock) != len(reference_configurations):
        raise ModelError(
            f"lockJoints was given {len(joints_to_lock)} joints and {len(reference_configurations)} configurations; "
            "expected one for each."
        )
    for name in joints_to_lock:
        if name not in g.edges:
            raise UnknownName("joint of the graph", name, list(g.edges))
    locked = dict(zip(joints_to_lock, reference_configurations, strict=True))
    out = ModelGraph()
    for name, frame in g.frames.items():
        out.addFrame(name, frame)
    for edge in g.edges.values():
        follows = edge.joint.primary_name if isinstance(edge.joint, JointMimic) else ""
        if (edge.name in locked and follows) or follows in locked:
            raise ModelError(
                f"Joint {edge.name!r} follows {follows!r}, and one of them is to be locked; lock none, or join the "
                "bodies by JointFixed."
            )
        out.addJoint(_locked(edge, locked[edge.name]) if edge.name in locked else edge)
    for body, geometries in g.geometries.items():
        out.addGeometries(body, list(geometries))
    return out


def _locked(edge: EdgeParameters, q: Any) -> EdgeParameters:
    return EdgeParameters(
        edge.name, edge.source_vertex, edge.placed, edge.target_vertex, edge.joint_to_target,
        JointFixed(edge.joint.pose(q)),
    )  # fmt: skip


class ModelConfigurationConverter:
    """Maps configurations and velocities between two models of one graph; `createConverter` makes it."""

    def __init__(
        self, source: Model, target: Model, source_info: ModelGraphBuildInfo, target_info: ModelGraphBuildInfo
    ) -> None:
        self._source, self._target = source, target
        self._turned = {
            name: source_info.is_reversed[name] != target_info.is_reversed[name]
            for name in source_info.joints
            if name in target_info.joints and source_info.joints[name].nq
        }
        self._joints = {
            name: joint.reversed() if source_info.is_reversed[name] else joint
            for name, joint in source_info.joints.items()
            if name in self._turned
        }

    def convertConfigurationVector(self, q_source: Any, q_target: Any = None) -> Floats | None:
        """The configuration of the target model at which the bodies are in the same places.

        Args:
            q_source: Configuration of the source model, (nq,).
            q_target: Where to write it, (nq of the target,); joints that the source lacks stay as they are. None for a
                new array, in which those are neutral.

        Returns:
            The new array, (nq of the target,); None where there was one to write into.
        """
        q = vector(q_source, self._source.nq, "q_source")
        out = neutral_of(self._target) if q_target is None else vector(q_target, self._target.nq, "q_target")
        for name, turned in self._turned.items():
            here, there = self._pair(name)
            part = q[here.idx_q : here.idx_q + here.nq]
            out[there.idx_q : there.idx_q + there.nq] = self._joints[name].reverse_q(part) if turned else part
        return out if q_target is None else None

    def convertTangentVector(self, q_source: Any, v_source: Any, v_target: Any = None) -> Floats | None:
        """The velocity of the target model with which the bodies move alike.

        Args:
            q_source: Configuration of the source model, (nq,).
            v_source: Its velocity, (nv,).
            v_target: Where to write it, (nv of the target,); None for a new array, in which joints that
                the source lacks do not move.

        Returns:
            The new array, (nv of the target,); None where there was one to write into.
        """
        q = vector(q_source, self._source.nq, "q_source")
        v = vector(v_source, self._source.nv, "v_source")
        out = np.zeros(self._target.nv) if v_target is None else vector(v_target, self._target.nv, "v_target")
        for name, turned in self._turned.items():
            here, there = self._pair(name)
            at, part = q[here.idx_q : here.idx_q + here.nq], v[here.idx_v : here.idx_v + here.nv]
            out[there.idx_v : there.idx_v + there.nv] = (
                self._joints[name].reverse_v(at, part) if turned else part
            )
        return out if v_target is None else None

    def _pair(self, name: str) -> tuple[Any, Any]:
        return tuple(m.joints[m.getJointId(name)] for m in (self._source, self._target))  # type: ignore[return-value]


def createConverter(
    source_model: Model,
    target_model: Model,
    source_info: ModelGraphBuildInfo,
    target_info: ModelGraphBuildInfo,
) -> ModelConfigurationConverter:
    """What maps configurations and velocities of one model of a graph to another model of it.

    Args:
        source_model: The model whose vectors are given.
        target_model: The model whose vectors are wanted.
        source_info: What `buildModelWithBuildInfo` returned with the source model.
        target_info: What it returned with the target model.

    Returns:
        The converter.
    """
    return ModelConfigurationConverter(source_model, target_model, source_info, target_info)
