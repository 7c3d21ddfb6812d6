"""ModelGraph: bodies, frames and sensors, and the joints between them, before a root is chosen."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from pinocchio._containers.arguments import ArgumentError, check_text
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.enums import FrameType
from pinocchio._graph.builders import EdgeBuilder, GeometryBuilder
from pinocchio._graph.edges import BodyFrame, EdgeParameters, GraphFrame
from pinocchio._graph.joints import JointFixed, JointMimic
from pinocchio._graph.shapes import Geometry
from pinocchio._spatial.inertia import Inertia
from ulna.errors import ModelError, UnknownName

__all__ = ["ModelGraph"]


class ModelGraph:
    """Bodies and the joints between them, of which `buildModel` makes a model with any body as its root."""

    def __init__(self) -> None:
        self._frames: dict[str, GraphFrame] = {}
        self._edges: dict[str, EdgeParameters] = {}
        self._geometries: dict[str, list[Geometry]] = {}

    @property
    def frames(self) -> Mapping[str, Any]:
        """The bodies, frames and sensors by their names."""
        return self._frames

    @property
    def edges(self) -> Mapping[str, EdgeParameters]:
        """The joints by their names."""
        return self._edges

    @property
    def geometries(self) -> Mapping[str, list[Geometry]]:
        """The geometries by the names of bodies."""
        return self._geometries

    def addBody(self, vertex_name: str, inertia: Inertia) -> None:
        """Adds a body.

        Args:
            vertex_name: Its name, not given to another one.
            inertia: Its inertia, in its own frame.

        Raises:
            ArgumentError: `inertia` is none.
        """
        if not isinstance(inertia, Inertia):
            raise ArgumentError(f"`inertia` is {inertia!r}; expected an Inertia.")
        self.addFrame(vertex_name, BodyFrame(inertia))

    def addFrame(self, vertex_name: str, frame: Any) -> None:
        """Adds a body, a frame or a sensor.

        Args:
            vertex_name: Its name, not given to another one.
            frame: BodyFrame, OpFrame or SensorFrame.

        Raises:
            ArgumentError: It is none of these.
            ModelError: The name is taken.
        """
        check_text(vertex_name, "vertex_name")
        if not isinstance(frame, GraphFrame):
            raise ArgumentError(f"`frame` is {frame!r}; expected a BodyFrame, OpFrame or SensorFrame.")
        if vertex_name in self._frames:
            raise ModelError(f"The graph has a body or frame {vertex_name!r} already. Give another name.")
        self._frames[vertex_name] = copy.deepcopy(frame)

    def addJoint(self, *parts: Any) -> None:
        """Adds a joint.

        Args:
            *parts: EdgeParameters; or name, joint, source body, pose of the joint in it, target body, and its pose
                behind the joint.

        Raises:
            ArgumentError: The arguments are others.
            UnknownName: There is no such body.
            ModelError: The name is taken, the bodies are joined already, or what is no body moves.
        """
        if len(parts) == 1 and isinstance(parts[0], EdgeParameters):
            edge = parts[0].changed()
        elif len(parts) == 6:
            name, joint, source, to_joint, target, to_target = parts
            edge = EdgeParameters(name, source, to_joint, target, to_target, joint)
        else:
            raise ArgumentError(
                f"addJoint was given {len(parts)} arguments; expected (joint_name, joint, source_body, "
                "source_to_joint, target_body, joint_to_target), or EdgeParameters."
            )
        self._check(edge)
        self._edges[edge.name] = edge

    def _check(self, edge: EdgeParameters) -> None:
        ends = (edge.source_vertex, edge.target_vertex)
        for vertex in ends:
            if vertex not in self._frames:
                raise UnknownName("body of the graph", vertex, list(self._frames))
        if not edge.name or edge.name in self._edges:
            raise ModelError(f"The name of the joint is {edge.name!r}; expected one that no other joint has.")
        if any({e.source_vertex, e.target_vertex} == set(ends) for e in self._edges.values()):
            raise ModelError(f"A joint between {ends[0]!r} and {ends[1]!r} is there already.")
        moves = not isinstance(edge.joint, JointFixed)
        if moves and any(self._frames[v].f_type != FrameType.BODY for v in ends):
            raise ModelError(
                f"Joint {edge.name!r} moves what is no body; join frames and sensors by JointFixed."
            )
        edge.jlimit.filled(edge.joint, edge.name)
        _ = edge.placed
        if isinstance(edge.joint, JointMimic) and edge.q_ref is not None:
            raise ModelError(f"Mimic joint {edge.name!r} has a q_ref; use the offset of JointMimic.")

    def addGeometry(self, body_name: str, geometry: Geometry) -> None:
        """Adds a geometry to a body.

        Args:
            body_name: Name of the body.
            geometry: The geometry, which is copied.

        Raises:
            UnknownName: There is no such body.
            ModelError: The geometry has no name.
        """
        if body_name not in self._frames:
            raise UnknownName("body of the graph", body_name, list(self._frames))
        if not geometry.name:
            raise ModelError("The geometry has no name; set geometry.name.")
        self._geometries.setdefault(body_name, []).append(copy.deepcopy(geometry))

    def addGeometries(self, body_name: str, geometries: Any) -> None:
        """Adds geometries to a body; see `addGeometry`.

        Args:
            body_name: Name of the body.
            geometries: One geometry, or a list of them.
        """
        for geometry in geometries if isinstance(geometries, (list, tuple, StdVec)) else [geometries]:
            self.addGeometry(body_name, geometry)

    def appendGraph(self, g: ModelGraph) -> None:
        """Copies another graph into this one; nothing joins the two yet."""
        for name, frame in list(g._frames.items()):
            self.addFrame(name, frame)
        for edge in list(g._edges.values()):
            self.addJoint(edge)
        for body, geometries in list(g._geometries.items()):
            self.addGeometries(body, list(geometries))

    def edgeBuilder(self) -> EdgeBuilder:
        """A builder of one joint: `.withName(...)...build()`."""
        return EdgeBuilder(self)

    def geometryBuilder(self) -> GeometryBuilder:
        """A builder of one geometry: `.withBody(...)...build()`."""
        return GeometryBuilder(self)
