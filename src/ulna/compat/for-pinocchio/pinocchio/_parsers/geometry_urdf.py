"""Geometries of URDF files: those of links, placed on the joints of a model."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.enums import FrameType, GeometryType
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._geometry.geometry_object import ConvexMesh, GeometryObject
from pinocchio._spatial.se3 import SE3
from ulna.errors import FormatError, excerpt
from ulna.formats.markup import parse_markup, read_file
from ulna.geometry import Capsule, Cylinder, Geometry, Mesh
from ulna.model import Link

if TYPE_CHECKING:
    from pinocchio._model.model import Model


def geometries_of_links(filename: Any, package_dirs: Any, text: str | None = None) -> Mapping[str, Link]:
    """The links of a URDF file with their visuals and collisions; meshes resolved.

    Args:
        package_dirs: One or several folders to look for packages in, or None.
        text: URDF text, in place of the file.

    Returns:
        The links by name.
    """
    from ulna.formats.resolve import Resolver
    from ulna.formats.urdf import read_urdf, urdf_builder
    from ulna.formats.urdf_parse import parse_urdf
    from ulna.robots import example_robot_data

    file = None if text is not None else os.fspath(filename)
    folders = [package_dirs] if isinstance(package_dirs, (str, os.PathLike)) else list(package_dirs or ())
    share = example_robot_data.share_folder()
    resolver = Resolver(file, [*(f for f in folders if os.fspath(f)), *((share.parent,) if share else ())])
    document = read_urdf(file) if file is not None else parse_urdf(text or "")
    links = urdf_builder(document, resolver=resolver).build().links
    replacements = _collisions_replaced((text or "").encode() if file is None else read_file(file), file)
    return {
        link.name: _with_replaced(link, replacements[link.name]) if link.name in replacements else link
        for link in links
    }


def _collisions_replaced(data: bytes, file: str | None) -> dict[str, dict[str, str]]:
    """For links of a URDF the collisions that Pinocchio replaces, by their names: "capsule" or "convex".

    Its own element says so: <collision_checking><capsule name="..."/><convex name="..."/></collision_checking>.
    """
    tag = "collision_checking"
    if tag.encode() not in data:
        return {}
    return {
        link.name(): {child.name(): child.tag for group in link.children(tag) for child in group.children()}
        for link in parse_markup(data, file, "robot", "URDF").children("link")
    }


def _with_replaced(link: Link, replacements: Mapping[str, str]) -> Link:
    def replaced(geometry: Geometry) -> Geometry:
        match replacements.get(geometry.name), geometry.shape:
            case "capsule", Cylinder(radius=radius, length=length):
                return dataclasses.replace(geometry, shape=Capsule(radius, length))
            case "convex", Mesh(path=path, scale=scale, missing=missing):
                return dataclasses.replace(geometry, shape=ConvexMesh(path, scale, missing))
        return geometry

    return dataclasses.replace(link, collisions=tuple(replaced(g) for g in link.collisions))


def geometry_model_of(
    model: Model,
    links: Mapping[str, Link],
    kind: GeometryType,
    into: GeometryModel | None = None,
    mesh_loader: Any = None,
    own_names: bool = False,
) -> GeometryModel:
    """The geometries of links, placed by the frames of bodies, in their order.

    Args:
        links: The links by name.
        own_names: Whether geometries keep their names; else they have those of the links, and a number.
        kind: GeometryType.VISUAL or COLLISION.
        into: A GeometryModel to add to; None for a new one.
        mesh_loader: A coal.MeshLoader for the files of meshes; None for coal's own.

    Returns:
        The GeometryModel.

    Raises:
        FormatError: No body has the name of a link.
    """
    check_mesh_loader(mesh_loader)
    out = GeometryModel() if into is None else into
    bodies = [
        (i, f) for i, f in enumerate(model.frames) if (f.type == FrameType.BODY or i == 0) and f.name in links
    ]
    if not bodies and links:
        raise FormatError("No body of the model has the name of a link of this file. Is it the same robot?")
    for i, frame in bodies:
        link = links[frame.name]
        shapes: Iterable[Geometry] = link.visuals if kind == GeometryType.VISUAL else link.collisions
        for k, geometry in enumerate(shapes):
            shape, material = geometry.shape, geometry.material
            placement = frame.placement * SE3(np.asarray(geometry.placement.matrix(), dtype=float))
            named: dict[str, Any] = {"mesh_path": type(shape).__name__.upper()}
            if isinstance(shape, Mesh):
                named = {"mesh_path": shape.path or "", "mesh_scale": np.array(shape.scale)}
            if material is not None and (material.rgba or material.texture) and kind == GeometryType.VISUAL:
                named |= {"override_material": True, "mesh_texture_path": material.texture or ""}
                if material.rgba is not None:
                    named["mesh_color"] = np.array(material.rgba)
            name = geometry.name if own_names else f"{frame.name}_{k}"
            made = GeometryObject(name, frame.parentJoint, i, placement, shape, **named)
            made._read_mesh_with(mesh_loader)
            out.addGeometryObject(made)
    return out


def check_mesh_loader(mesh_loader: Any) -> None:
    """Checks what is to read the files of meshes.

    Args:
        mesh_loader: None, or a coal.MeshLoader.

    Raises:
        ArgumentError: It is something else.
    """
    if mesh_loader is None or any(cls.__name__ == "MeshLoader" for cls in type(mesh_loader).__mro__):
        return
    raise ArgumentError(
        f"The mesh loader is {excerpt(repr(mesh_loader))}; expected None, or one of coal, such as "
        "coal.MeshLoader(coal.BV_OBBRSS) or coal.CachedMeshLoader(coal.BV_OBBRSS)."
    )


def buildGeomFromUrdf(
    model: Model,
    urdf_filename: Any,
    geom_type: GeometryType,
    geometry_model: Any = None,
    package_dirs: Any = None,
    mesh_loader: Any = None,
) -> GeometryModel:
    """The geometries that a URDF file gives the bodies of a model.

    Args:
        model: The model of the same file.
        urdf_filename: The file.
        geometry_model: One to add to. Package folders may stand here, too.
        package_dirs: One or several folders to look for packages in. Those around the file and the installed
            example-robot-data are looked in anyway.
        mesh_loader: A coal.MeshLoader that reads the files of meshes, each when its geometry is first read.

    Returns:
        The GeometryModel.

    Raises:
        FormatError: The file is missing, broken, or of another robot. A missing mesh only warns.
    """
    if geometry_model is not None and not isinstance(geometry_model, GeometryModel):
        geometry_model, package_dirs = None, geometry_model
    return geometry_model_of(
        model, geometries_of_links(urdf_filename, package_dirs), geom_type, geometry_model, mesh_loader
    )


def buildGeomFromUrdfString(
    model: Model,
    urdf_string: str,
    geom_type: GeometryType,
    geometry_model: Any = None,
    package_dirs: Any = None,
    mesh_loader: Any = None,
) -> GeometryModel:
    """The geometries that a URDF text gives the bodies of a model; see `buildGeomFromUrdf`.

    Args:
        model: The model of the same text.
        urdf_string: The text.
        geometry_model: A GeometryModel to add to; folders of packages may stand here, too.
        package_dirs: One or several folders to look for packages in.

    Returns:
        The GeometryModel.
    """
    if geometry_model is not None and not isinstance(geometry_model, GeometryModel):
        geometry_model, package_dirs = None, geometry_model
    links = geometries_of_links(None, package_dirs, urdf_string)
    return geometry_model_of(model, links, geom_type, geometry_model, mesh_loader)
