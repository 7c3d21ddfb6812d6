"""UrdfDocument -> ModelBuilder -> Model: finds the meshes, places inertias and shapes, keeps file order."""

from __future__ import annotations

import os
import re
import warnings
from typing import Any

import numpy as np

from ulna.errors import FormatError, InputError, ModelError, ModelWarning, UnknownName
from ulna.formats.markup import read_file
from ulna.formats.poses import pose
from ulna.formats.resolve import Resolver
from ulna.formats.root import root_kind
from ulna.formats.urdf_document import (
    UrdfBody,
    UrdfDocument,
    UrdfInertial,
    UrdfJoint,
    UrdfMaterial,
    UrdfShape,
)
from ulna.formats.urdf_parse import parse_urdf
from ulna.geometry import Box, Capsule, Cylinder, Geometry, Material, Mesh, Shape, Sphere
from ulna.model import (
    Continuous,
    Fixed,
    FreeFlyer,
    JointKind,
    Model,
    ModelBuilder,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
)
from ulna.spatial import Inertia
from ulna.system.callers import level_of_caller


def read_urdf(path: str | os.PathLike[str]) -> UrdfDocument:
    """The document in a URDF file.

    Raises:
        FormatError: the file is missing or broken; says where and how to fix it.
    """
    return parse_urdf(read_file(path), str(path))


def model_from_urdf(
    source: str | os.PathLike[str] | UrdfDocument,
    *,
    root: str | JointKind | None = None,
    mimic: bool = True,
    resolver: Resolver | None = None,
) -> Model:
    """The model that a URDF file or document describes.

    Args:
        source: a path, or a document.
        root: how the root link hangs in the world: None fixed, "free_flyer", or any joint kind.
        mimic: whether mimic joints follow their leader; False lets each move on its own.
        resolver: finds the meshes; by default the places around the file and the ROS environment.

    Returns:
        The model.

    Raises:
        FormatError: the file is missing or broken, or contradicts itself.
    """
    document = source if isinstance(source, UrdfDocument) else read_urdf(source)
    try:
        return urdf_builder(document, root=root, mimic=mimic, resolver=resolver).build()
    except (FormatError, UnknownName):
        raise
    except (ModelError, InputError) as error:
        # What the parser lets through and the builder does not is still a fault of the file.
        place = re.match(re.escape(document.file or "<string>") + r":(\d+): ", str(error))
        text = str(error)[place.end() :] if place else str(error)
        raise FormatError(text, file=document.file, line=int(place[1]) if place else None) from error


def urdf_builder(
    document: UrdfDocument,
    *,
    root: str | JointKind | None = None,
    mimic: bool = True,
    resolver: Resolver | None = None,
) -> ModelBuilder:
    """A builder filled with the links and joints of a document, for adding to it before building.

    Warns (ModelWarning) once about all meshes that were not found.

    Args:
        document: The document.
        root: How the root link hangs in the world: None fixed, "free_flyer", or any joint kind.
        mimic: Whether mimic joints follow their leader; False lets each move on its own.
        resolver: Finds the meshes; by default the places around the file and the ROS environment.

    Returns:
        The builder.
    """
    shapes = _Shapes(document.file, resolver or Resolver(document.file))
    builder = ModelBuilder(document.name, source=document.file)
    kind = root_kind(root)
    if kind is not None:
        builder.root_joint(kind)
    for link in document.links:
        builder.add_link(
            link.name,
            inertia=inertia_of(link.inertial) if link.inertial else None,
            visuals=shapes.geometries(link.name, link.visuals),
            collisions=shapes.geometries(link.name, link.collisions),
            where=_place(document, link.line),
        )
    for joint in document.joints:
        _add_joint(builder, joint, mimic, _place(document, joint.line))
    shapes.report()
    return builder


def link_visuals(document: UrdfDocument, resolver: Resolver | None = None) -> dict[str, tuple[Geometry, ...]]:
    """The visual geometries of a document.

    Args:
        document: The document.
        resolver: Finds the meshes; by default the places around the file and the ROS environment.

    Returns:
        The geometries by link name.
    """
    shapes = _Shapes(document.file, resolver or Resolver(document.file))
    geometries = {link.name: shapes.geometries(link.name, link.visuals) for link in document.links}
    shapes.report()
    return geometries


def inertia_of(inertial: UrdfInertial) -> Inertia:
    """The inertia of a link in the link frame."""
    xx, xy, xz, yy, yz, zz = inertial.inertia
    frame = pose(inertial.origin.xyz, inertial.origin.rpy)
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if any(inertial.origin.rpy):
        matrix = frame.rotation @ matrix @ frame.rotation.T
        matrix = (matrix + matrix.T) / 2.0
    return Inertia(inertial.mass, frame.translation, matrix)


def _place(document: UrdfDocument, line: int | None) -> str:
    return (document.file or "<string>") + (f":{line}" if line else "")


def _add_joint(builder: ModelBuilder, joint: UrdfJoint, mimic: bool, where: str) -> None:
    extra: dict[str, Any] = {"where": where}
    if joint.kind != "fixed":
        extra |= {"damping": joint.damping, "friction": joint.friction}
        if joint.limit is not None:
            limit = joint.limit
            if joint.kind in ("revolute", "prismatic"):
                extra |= {"lower": limit.lower, "upper": limit.upper}
            extra |= {"velocity": limit.velocity, "effort": limit.effort}
        if mimic and joint.mimic is not None:
            extra["mimic"] = (joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset)
    builder.add_joint(
        joint.name, _kind(joint), joint.parent, joint.child, pose(joint.origin.xyz, joint.origin.rpy), **extra
    )


def _kind(joint: UrdfJoint) -> JointKind:
    x, y, z = joint.axis
    if joint.kind == "revolute":
        return Revolute((x, y, z))
    if joint.kind == "continuous":
        return Continuous((x, y, z))
    if joint.kind == "prismatic":
        return Prismatic((x, y, z))
    if joint.kind == "planar":
        return Planar((x, y, z))
    if joint.kind == "floating":
        return FreeFlyer()
    if joint.kind == "spherical":
        return Spherical()
    return Fixed()


class _Shapes:
    """Turns visual and collision elements into geometries, and collects the meshes not found."""

    def __init__(self, file: str | None, resolver: Resolver) -> None:
        self._file, self._resolver = file, resolver
        self._resolved_files: dict[str, str | None] = {}
        self._missing: list[tuple[str, str, int | None, tuple[str, ...]]] = []

    def geometries(self, link: str, bodies: tuple[UrdfBody, ...]) -> tuple[Geometry, ...]:
        out = []
        for index, body in enumerate(bodies):
            out.append(
                Geometry(
                    body.name or f"{link}_{index}",
                    self._shape(body.shape),
                    pose(body.origin.xyz, body.origin.rpy),
                    self._material(body.material) if body.material else None,
                )
            )
        return tuple(out)

    def _shape(self, shape: UrdfShape) -> Shape:
        size = shape.size
        if shape.kind == "box":
            return Box((size[0], size[1], size[2]))
        if shape.kind == "sphere":
            return Sphere(size[0])
        if shape.kind == "cylinder":
            return Cylinder(size[0], size[1])
        if shape.kind == "capsule":
            return Capsule(size[0], size[1])
        scale = (shape.scale[0], shape.scale[1], shape.scale[2])
        path = self._path("mesh", shape.uri, shape.line)
        return Mesh(path or shape.uri, scale, missing=path is None)

    def _material(self, material: UrdfMaterial) -> Material:
        texture = self._path("texture", material.texture, None) if material.texture else None
        rgba = material.rgba
        return Material(material.name, (rgba[0], rgba[1], rgba[2], rgba[3]) if rgba else None, texture)

    def _path(self, what: str, uri: str, line: int | None) -> str | None:
        if uri not in self._resolved_files:
            resolution = self._resolver.resolve(uri)
            self._resolved_files[uri] = resolution.path
            if resolution.path is None:
                self._missing.append((what, uri, line, resolution.tried))
        return self._resolved_files[uri]

    def report(self) -> None:
        """Warn about what was not found, once for the whole file."""
        if not self._missing:
            return
        what, uri, line, tried = self._missing[0]
        count = len(self._missing)
        others = f" and {count - 1} more were" if count > 1 else " was"
        place = (self._file or "<string>") + (f":{line}" if line else "")
        if uri.startswith(("http://", "https://", "ftp://")):
            where = "It is on the network, and Ulna reads local files only."
        else:
            places = ", ".join(tried[:6]) + (f", ... ({len(tried)} places)" if len(tried) > 6 else "")
            where = f"Looked in: {places or 'nowhere'}."
        ros = os.environ.get("ROS_PACKAGE_PATH")
        warnings.warn(
            f"{place}: the {what} {uri!r}{others} not found. {where} "
            f"ROS_PACKAGE_PATH is {ros or 'not set'}. Set it, or pass package_dirs=[folder of the packages]. "
            "The robot is loaded without it.",
            ModelWarning,
            stacklevel=level_of_caller(),
        )
