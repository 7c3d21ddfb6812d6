"""Models and geometry models of a graph, with any of its bodies as root."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pinocchio._containers.enums import FrameType, GeometryType
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._graph.edges import EdgeParameters
from pinocchio._graph.joints import GraphJoint, JointFixed, JointMimic
from pinocchio._graph.model_graph import ModelGraph
from pinocchio._graph.shapes import GeomType, Mesh
from pinocchio._model.frame import Frame
from pinocchio._model.joint_compositions import JointModelMimic
from pinocchio._model.model import Model
from pinocchio._parsers.geometry_urdf import check_mesh_loader
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import ModelError, UnknownName
from ulna.geometry import Mesh as MeshShape
from ulna.typing import Floats

__all__ = ["ModelGraphBuildInfo", "buildGeometryModel", "buildModel", "buildModelWithBuildInfo"]

_FIXED = JointFixed()


class ModelGraphBuildInfo:
    """Which joints of a graph were reversed in a model that was built of it."""

    def __init__(self) -> None:
        self.joints: dict[str, GraphJoint] = {}
        """The joints that move, by their names, as the graph has them."""
        self.is_reversed: dict[str, bool] = {}
        """Whether each is reversed in the model."""


@dataclass(frozen=True)
class _DirectedEdge:
    """A joint of the graph, in the direction in which it is traversed from the root."""

    edge: EdgeParameters
    is_reversed: bool

    @property
    def body(self) -> str:
        """The body that is reached."""
        return self.edge.source_vertex if self.is_reversed else self.edge.target_vertex

    @property
    def joint(self) -> GraphJoint:
        """The joint in that direction."""
        return self.edge.joint.reversed() if self.is_reversed else self.edge.joint

    @property
    def before(self) -> SE3:
        """The pose of the joint in the body that is left."""
        return self.edge.joint_to_target.inverse() if self.is_reversed else self.edge.placed

    @property
    def behind(self) -> SE3:
        """The pose of the body that is reached, behind the joint."""
        if not self.is_reversed:
            return self.edge.joint_to_target
        return (self.edge.placed * self.edge.joint.leading).inverse()

    def limits(self) -> list[Floats]:
        """The limits as `Model.addJoint` takes them."""
        limits = self.edge.jlimit.filled(self.edge.joint, self.edge.name)
        low, high = limits["minConfig"], limits["maxConfig"]
        rates = [limits[key] for key in ("maxEffort", "maxVel", "friction", "damping", "armature")]
        if self.is_reversed and low.size:
            low, high = self.edge.joint.reverse_limits(low, high)
            rates = [self.edge.joint.reverse_rates(value) for value in rates]
        effort, speed, friction, damping, armature = rates
        return [-effort, effort, -speed, speed, low, high, -friction, friction, damping, armature]


class _Builder:
    """A model as it is built, from the root outward."""

    def __init__(self, graph: ModelGraph) -> None:
        self.graph, self.model, self.info = graph, Model(), ModelGraphBuildInfo()

    def add_root(self, root: str, position: SE3, joint: GraphJoint, name: str) -> tuple[int, SE3, int]:
        """Adds the root body; returns its joint, its pose in that, and the frame of the joint."""
        if isinstance(joint, JointFixed):
            place = position * joint.joint_offset
            self.add_body(root, 0, place, 0, frame_inertia=True)
            return 0, place, 0
        index = self.model.addJoint(0, joint.model(), position, name)
        frame = self.model.addJointFrame(index, 0)
        self.add_body(root, index, SE3(), frame, frame_inertia=True)
        return index, SE3(), frame

    def add_body(self, name: str, joint: int, place: SE3, before: int, frame_inertia: bool) -> None:
        """Adds the frame of a body, frame or sensor, and its mass unless that is there already."""
        vertex = self.graph.frames[name]
        is_body = vertex.f_type == FrameType.BODY
        inertia = vertex.inertia if is_body and frame_inertia else Inertia()
        self.model.addFrame(Frame(name, joint, before if is_body else 0, place, vertex.f_type, inertia))
        counts = is_body and frame_inertia and joint > 0
        self.model._keep(nbodies=self.model.nbodies + bool(counts))

    def pass_joint(self, way: _DirectedEdge, carrier: int, pose: SE3, frame: int) -> tuple[int, SE3, int]:
        """Adds a joint and the body behind it; takes and returns the joint that carries, the pose in it, its frame."""
        place, joint = pose * way.before, way.joint
        vertex = self.graph.frames[way.body]
        if isinstance(joint, JointFixed):
            place = place * joint.joint_offset
            inertia = vertex.inertia.se3Action(way.behind) if vertex.f_type == FrameType.BODY else Inertia()
            if vertex.f_type == FrameType.BODY:
                fixed = Frame(way.edge.name, carrier, 0, place, FrameType.FIXED_JOINT, inertia)
                frame = self.model.addFrame(fixed)
            place = place * way.behind
            self.add_body(way.body, carrier, place, frame, frame_inertia=False)
            return carrier, place, frame
        index = self._add_moving(way, joint, carrier, place)
        frame = self.model.addJointFrame(index, -1)
        self.model.appendBodyToJoint(index, vertex.inertia, way.behind)
        self.add_body(way.body, index, way.behind, frame, frame_inertia=False)
        self.info.joints[way.edge.name] = way.edge.joint
        self.info.is_reversed[way.edge.name] = way.is_reversed
        return index, way.behind, frame

    def _add_moving(self, way: _DirectedEdge, joint: GraphJoint, carrier: int, place: SE3) -> int:
        """Adds a joint with its limits."""
        kind = joint.model()
        if isinstance(joint, JointMimic):
            if joint.primary_name not in self.model.names:
                raise ModelError(
                    f"Mimic joint {way.edge.name!r} follows {joint.primary_name!r}, which does not come before it; "
                    "take a root from which it does."
                )
            followed = self.model.joints[self.model.getJointId(joint.primary_name)]
            sign = -1.0 if self.info.is_reversed.get(joint.primary_name) else 1.0
            kind = JointModelMimic(kind, followed, sign * joint.scaling, joint.offset)
        *limits, armature = way.limits()
        index = self.model.addJoint(carrier, kind, place, way.edge.name, *limits)
        if kind.nv:
            start = self.model.joints[index].idx_v
            self.model.armature[start : start + kind.nv] = armature
        return index


def buildModelWithBuildInfo(
    g: ModelGraph,
    root_body: str,
    root_position: SE3,
    root_joint: GraphJoint = _FIXED,
    root_joint_name: str = "root_joint",
) -> tuple[Model, ModelGraphBuildInfo]:
    """A model of a graph, and which of the graph's joints it reverses.

    Args:
        g: The graph, without loops.
        root_body: Name of the body that the model begins with.
        root_position: Where that body, or the root joint, is in the world.
        root_joint: The joint between the world and that body; fixed by default.
        root_joint_name: Name of that joint.

    Returns:
        The model, and what `createConverter` needs.

    Raises:
        UnknownName: There is no such body.
        ModelError: The joints make a loop, or a mimic joint stands before what it follows.
        InputError: A joint would be passed in a direction in which there is none like it.
    """
    if root_body not in g.frames:
        raise UnknownName("body of the graph", root_body, list(g.frames))
    builder = _Builder(g)
    joints_of_bodies = {root_body: builder.add_root(root_body, root_position, root_joint, root_joint_name)}
    for before, way in _directed_edges(g, root_body):
        joints_of_bodies[way.body] = builder.pass_joint(way, *joints_of_bodies[before])
    return builder.model, builder.info


def buildModel(
    g: ModelGraph,
    root_body: str,
    root_position: SE3,
    root_joint: GraphJoint = _FIXED,
    root_joint_name: str = "root_joint",
) -> Model:
    """A model of a graph; see `buildModelWithBuildInfo`.

    Args:
        g: The graph, without loops.
        root_body: Name of the body that the model begins with.
        root_position: Where that body, or the root joint, is in the world.
        root_joint: The joint between the world and that body; fixed by default.
        root_joint_name: Name of that joint.

    Returns:
        The model.
    """
    return buildModelWithBuildInfo(g, root_body, root_position, root_joint, root_joint_name)[0]


def _directed_edges(g: ModelGraph, root: str) -> Iterator[tuple[str, _DirectedEdge]]:
    """The joints from the root outward, depth first in the order of their addition, each with the body it begins at."""
    known, passed = {root}, set()
    around: Mapping[str, list[EdgeParameters]] = {name: [] for name in g.frames}
    for edge in g.edges.values():
        around[edge.source_vertex].append(edge)
        around[edge.target_vertex].append(edge)
    open_ = [(root, iter(around[root]))]
    while open_:
        body, rest = open_[-1]
        edge = next((e for e in rest if e.name not in passed), None)
        if edge is None:
            open_.pop()
            continue
        passed.add(edge.name)
        way = _DirectedEdge(edge, edge.source_vertex != body)
        if way.body in known:
            raise ModelError(
                f"Joint {edge.name!r} closes a loop of the graph at {way.body!r}. Leave it out, and close the loop "
                "by a constraint of the model, such as RigidConstraintModel."
            )
        known.add(way.body)
        yield body, way
        open_.append((way.body, iter(around[way.body])))


def buildGeometryModel(
    g: ModelGraph, model: Model, type: GeometryType, mesh_loader: Any = None
) -> GeometryModel:
    """The geometries of a graph on a model that was built of it.

    Args:
        g: The graph.
        type: Which geometries, VISUAL or COLLISION; those for both are among either.

    Returns:
        The geometries.
    """
    wanted = (GeomType.BOTH, GeomType.VISUAL if type == GeometryType.VISUAL else GeomType.COLLISION)
    check_mesh_loader(mesh_loader)
    out = GeometryModel()
    for index, frame in enumerate(model.frames):
        for geometry in g.geometries.get(frame.name, []):
            if frame.type in (FrameType.JOINT, FrameType.FIXED_JOINT) or geometry.type not in wanted:
                continue
            shape, path = geometry.geometry, ""
            if isinstance(shape, Mesh):
                x, y, z = geometry.scale.tolist()
                shape, path = MeshShape(shape.path, (x, y, z)), shape.path
            else:
                shape = shape.shape()
            place = frame.placement * geometry.placement
            looks = (path, geometry.scale, True, geometry.color)
            parts = (geometry.name, frame.parentJoint, index, place, shape, *looks)
            made = GeometryObject(*parts)
            made._read_mesh_with(mesh_loader)
            out.addGeometryObject(made)
    return out


def neutral_of(model: Model) -> Floats:
    """The neutral configuration of a model, joint by joint."""
    out = np.zeros(model.nq)
    for joint in list(model.joints)[1:]:
        if joint.mimic is None and joint.kind is not None:
            out[joint.idx_q : joint.idx_q + joint.nq] = joint.kind.neutral()
    return out
