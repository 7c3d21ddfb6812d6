"""Surfaces of the links of a robot: meshes and shapes joined by colour, or a skeleton of rods and balls."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterable
from typing import Any, Literal

import numpy as np

from ulna.checks.values import one_of
from ulna.errors import MissingExtra, ModelWarning, UlnaError
from ulna.geometry import Geometry, Mesh
from ulna.model import Link
from ulna.viewer.mesh.mesh_files import Detail, check_detail, load_mesh
from ulna.viewer.mesh.primitives import ball, tessellate, tube
from ulna.viewer.mesh.surface import DEFAULT_COLOUR, RGBA, Surface, colour
from ulna.viewer.progress import Report, silent

RobotDisplay = Literal["visual", "collision", "both", "skeleton"]
ROBOT_DISPLAYS: tuple[str, ...] = ("visual", "collision", "both", "skeleton")

_COLLISION_COLOUR: RGBA = (0.96, 0.55, 0.18, 1.0)
_ROD_COLOUR: RGBA = (0.20, 0.36, 0.62, 1.0)
_JOINT_COLOUR: RGBA = (0.93, 0.52, 0.13, 1.0)


def link_names(robot: Any) -> tuple[str, ...]:
    """Names of the links as nodes: `/`, which would make groups, becomes `.`."""
    out: dict[str, None] = {}
    for link in robot.model.links:
        plain = link.name.replace("/", ".").strip() or "link"
        names = itertools.chain([plain], (f"{plain}'{k}" for k in itertools.count(2)))
        out[next(n for n in names if n not in out)] = None
    return tuple(out)


def checked_display(show: str) -> RobotDisplay:
    """A way to show a robot.

    Raises:
        UnknownName: There is no such way.
    """
    return one_of("way to show a robot", show, ROBOT_DISPLAYS)


def surfaces_by_link(
    robot: Any, show: RobotDisplay, rgba: RGBA | None = None, report: Report = silent, detail: Detail = "seen"
) -> list[tuple[Surface, ...]]:
    """The surfaces of each link, in the link's frame.

    Args:
        robot: The robot.
        show: "visual", "collision", "both" or "skeleton".
        rgba: One colour for everything; those of the materials by default.
        report: Called with the number of links done and of all links.
        detail: As for `ulna.viewer.mesh.mesh_files.load_mesh`.

    Returns:
        Surfaces by link, in the order of `robot.model.links`.

    Raises:
        UnknownName: There is no such way to show it, or no such detail.
    """
    checked_display(show)
    check_detail(detail)
    links = robot.model.links
    if show == "skeleton":
        return _skeleton(robot, rgba)
    out = []
    for k, link in enumerate(links):
        report(k, len(links))
        pieces: tuple[Surface, ...] = ()
        if show in ("visual", "both"):
            pieces += link_surfaces(_visuals(link), link.name, rgba, detail)
        if show in ("collision", "both"):
            base_colour = rgba or _COLLISION_COLOUR
            collision_colour = (*base_colour[:3], base_colour[3] * (0.35 if show == "both" else 1.0))
            pieces += link_surfaces(link.collisions, link.name, collision_colour, detail)
        out.append(pieces)
    report(len(links), len(links))
    return out


def _visuals(link: Link) -> tuple[Geometry, ...]:
    """What a link looks like: its collision shapes where every mesh of its visuals is missing."""
    shapes = [geometry.shape for geometry in link.visuals]
    all_missing = bool(shapes) and all(isinstance(shape, Mesh) and shape.missing for shape in shapes)
    return link.collisions if all_missing else link.visuals


def link_surfaces(
    geometries: Iterable[Geometry], link: str = "", rgba: RGBA | None = None, detail: Detail = "seen"
) -> tuple[Surface, ...]:
    """What geometries of a link look like, in the link's frame: surfaces, those of one colour joined.

    A mesh that is missing or broken is left out with a `ModelWarning`: a robot without a shell is still a robot.

    Args:
        geometries: The link's visuals or collisions.
        link: The link's name, for messages.
        rgba: One colour for everything; the materials' own when None.
        detail: As for `ulna.viewer.mesh.mesh_files.load_mesh`.

    Returns:
        The surfaces.
    """
    pieces: list[Surface] = []
    for geometry in geometries:
        pose = geometry.placement.matrix()
        material = getattr(geometry, "material", None)
        material_colour = getattr(material, "rgba", None)
        material_colour = None if material_colour is None else np.clip(material_colour, 0.0, 1.0)
        shape = geometry.shape
        if isinstance(shape, Mesh):
            if shape.path is None or shape.missing:
                continue
            try:
                parts = [s.moved(pose) for s in load_mesh(shape.path, shape.scale, detail)]
            except MissingExtra as error:  # the same text for each link, so that it is shown once
                warnings.warn(f"Meshes are left out. {error}", ModelWarning, stacklevel=2)
                continue
            except UlnaError as error:
                warnings.warn(f"Link {link!r} is drawn without a mesh. {error}", ModelWarning, stacklevel=2)
                continue
            if material_colour is not None:  # the material of the model colours meshes without a material
                parts = [s.coloured(material_colour) if s.rgba == DEFAULT_COLOUR else s for s in parts]
        else:
            parts = [
                tessellate(
                    shape, DEFAULT_COLOUR if material_colour is None else colour(material_colour)
                ).moved(pose)
            ]
        pieces += parts if rgba is None else [p.coloured(rgba) for p in parts]
    return joined_by_colour(pieces)


def joined_by_colour(pieces: Iterable[Surface]) -> tuple[Surface, ...]:
    """Surfaces with those of one colour and without texture joined into one."""
    by_colour: dict[Any, list[Surface]] = {}
    for piece in pieces:
        by_colour.setdefault(piece.rgba if piece.texture is None else id(piece), []).append(piece)
    out = []
    for group in by_colour.values():
        if len(group) == 1:
            out.append(group[0])
            continue
        offsets = np.cumsum([0, *(len(s.vertices) for s in group)])
        out.append(
            Surface(
                np.concatenate([s.vertices for s in group]),
                np.concatenate([s.triangles + o for s, o in zip(group, offsets, strict=False)]),
                np.concatenate([s.normals for s in group]),
                group[0].rgba,
            )
        )
    return tuple(out)


def _skeleton(robot: Any, rgba: RGBA | None) -> list[tuple[Surface, ...]]:
    """A ball at each link's origin, and rods from there to the joints on either side, as thick as suits the robot."""
    links, model = robot.model.links, robot.model
    poses = robot.link_poses(model.neutral)
    reach = float(np.ptp(poses[:, :3, 3], axis=0).max()) or 1.0
    number = {link.name: k for k, link in enumerate(links)}
    pieces: list[list[Surface]] = [[ball(0.02 * reach, rgba or _JOINT_COLOUR)] for _ in links]
    for link in links:
        if link.parent is not None:
            for bearer, joint in ((link.parent, link.origin), (link.name, link.offset.inverse())):
                end = joint.matrix()[:3, 3]
                if np.linalg.norm(end) > 1e-9:
                    rod = tube(np.linspace((0.0, 0.0, 0.0), end, 2), 0.010 * reach, rgba or _ROD_COLOUR, 12)
                    pieces[number[bearer]].append(rod)
    return [joined_by_colour(p) for p in pieces]
