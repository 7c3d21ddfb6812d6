"""Builders of joints and geometries of a graph: `graph.edgeBuilder().withName("j").withJointType(...).build()`."""

from __future__ import annotations

from typing import Any, Protocol, Self

from pinocchio._graph.edges import EdgeParameters
from pinocchio._graph.joints import GraphJoint
from pinocchio._graph.shapes import Geometry, GeomType, checked_shape
from pinocchio._spatial.se3 import SE3

__all__ = ["EdgeBuilder", "GeometryBuilder"]


class _Graph(Protocol):
    def addJoint(self, *parts: Any) -> None: ...

    def addGeometry(self, body_name: str, geometry: Geometry) -> None: ...


def _sets(field: str, doc: str, of_limits: bool = False) -> Any:
    """A method that sets a field of what is built, and returns the builder."""

    def method(self: Any, value: Any) -> Any:
        setattr(self.param.jlimit if of_limits else self.param, field, value)
        return self

    method.__doc__ = doc
    return method


class EdgeBuilder:
    """Builds one joint of a graph; `build()` adds it."""

    def __init__(self, graph: _Graph) -> None:
        self._graph = graph
        self.param = EdgeParameters()
        """What it builds."""

    withName = _sets("name", "Sets the name of the joint.")
    withSourceVertex = _sets("source_vertex", "Sets the body that carries the joint.")
    withTargetVertex = _sets("target_vertex", "Sets the body that the joint moves.")
    withSourcePose = _sets("source_to_joint", "Sets the pose of the joint in its source body.")
    withTargetPose = _sets("joint_to_target", "Sets the pose of the target body behind the joint.")
    withQref = _sets("q_ref", "Sets what the coordinates are counted from, (nq,).")
    withMinConfig = _sets("minConfig", "Sets the lower limits of q, (nq,).", of_limits=True)
    withMaxConfig = _sets("maxConfig", "Sets the upper limits of q, (nq,).", of_limits=True)
    withMaxVel = _sets("maxVel", "Sets the largest velocities, (nv,).", of_limits=True)
    withMaxEffort = _sets("maxEffort", "Sets the largest torques or forces, (nv,).", of_limits=True)
    withFriction = _sets("friction", "Sets the Coulomb friction, (nv,).", of_limits=True)
    withDamping = _sets("damping", "Sets the viscous friction, (nv,).", of_limits=True)
    withArmature = _sets("armature", "Sets the inertia of the drives, (nv,).", of_limits=True)
    withFrictionLoss = _sets("frictionLoss", "Keeps a number that plays no part.", of_limits=True)

    def withJointType(self, jtype: GraphJoint) -> Self:
        """Sets the kind of the joint."""
        self.param.joint = jtype
        return self

    def build(self) -> None:
        """Adds the joint to the graph."""
        self._graph.addJoint(self.param)


class GeometryBuilder:
    """Builds one geometry of a graph; `build()` adds it."""

    def __init__(self, model_graph: _Graph) -> None:
        self._graph = model_graph
        self._body = ""
        self.param = Geometry()
        """What it builds."""

    withName = _sets("name", "Sets the name of the geometry.")
    withScale = _sets("scale", "Sets the factors along x, y, z, (3,).")
    withColor = _sets("color", "Sets red, green, blue and opacity, (4,).")

    def withBody(self, body_name: str) -> Self:
        """Sets the body that carries the geometry."""
        self._body = body_name
        return self

    def withPlacement(self, placement: SE3) -> Self:
        """Sets its pose in the body."""
        self.param.placement = SE3(placement)
        return self

    def withGeomType(self, geom_type: GeomType) -> Self:
        """Sets whether it is seen, collides, or both."""
        self.param.type = GeomType(geom_type)
        return self

    def withGeom(self, geometry_primitive: Any) -> Self:
        """Sets its shape: Box, Sphere, Cylinder, Capsule or Mesh."""
        self.param.geometry = checked_shape(geometry_primitive)
        return self

    def build(self) -> None:
        """Adds the geometry to the body."""
        g = self.param
        self._graph.addGeometry(
            self._body, Geometry(g.name, g.placement, g.type, g.scale, g.color, g.geometry)
        )
