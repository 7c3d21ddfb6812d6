"""All visible content of a scene as triangles in the world frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.node import Snapshot
from ulna.viewer.mesh.surface import Surface, Texture, albedo, normalized
from ulna.viewer.render.projection import Projection

_MIN_LINE_WIDTH = 1.3  # samples across that a line has at least: what is thinner would be drawn in dots


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles in the world.

    Args:
        corners: Corners [m], shape (m, 3, 3).
        normals: Normals at the corners, shape (m, 3, 3).
        rgba: Linear colours that they reflect, and opacity, shape (m, 4).
        shadow: Which cast a shadow, shape (m,).
        show_occluded: Which are drawn, translucent, in front of what occludes them, shape (m,).
        piece: The number of the surface that each is of, shape (m,).
        picture: The number of the texture on each, -1 for none, shape (m,).
        uv: Where the corners lie in it, shape (m, 3, 2).
        textures: The textures.
    """

    corners: Floats
    normals: Array
    rgba: Array
    shadow: Array
    show_occluded: Array
    surface: Array
    texture: Array
    uv: Array
    textures: tuple[Texture, ...]


def world_triangles(snapshot: Snapshot, view: Projection) -> Triangles:
    """The triangles of all visible nodes in the world frame; lines are as thick as can be drawn at least.

    Args:
        snapshot: The scene.
        view: Camera and samples of the picture.

    Returns:
        The triangles.
    """
    parts: list[tuple[Array, ...]] = [
        (
            np.zeros((0, 3, 3)),
            np.zeros((0, 3, 3), np.float32),
            np.zeros((0, 4), np.float32),
            *(np.zeros(0, bool),) * 2,
            *(np.zeros(0, np.int32),) * 2,
            np.zeros((0, 3, 2), np.float32),
        )
    ]
    textures: list[Texture] = []
    for i in np.flatnonzero(snapshot.visible & (snapshot.opacity > 0.002)):
        node, pose, scale, tint = snapshot.nodes[i], snapshot.poses[i], snapshot.scales[i], snapshot.tint[i]
        mirrored = bool(np.prod(scale) < 0)
        for surface in (*node.surfaces, *_content_surfaces(snapshot, int(i), view)):
            count, opacity = len(surface.triangles), surface.rgba[3] * snapshot.opacity[i]
            if count == 0 or opacity <= 0.002:
                continue
            faces = surface.triangles[:, ::-1] if mirrored else surface.triangles
            shown = np.asarray(surface.rgba[:3] if tint[0] < 0 else tint)
            texture = surface.texture if tint[0] < 0 else None
            if texture is not None:
                textures.append(texture)
            uv = np.zeros((count, 3, 2)) if texture is None else texture.uv[faces]
            parts.append(
                (
                    *_corners_and_normals(surface, scale, pose, faces),
                    np.broadcast_to(np.array([*albedo(shown), opacity], np.float32), (count, 4)),
                    np.full(count, node.shadow),
                    np.full(count, node.through),
                    np.full(count, len(parts), np.int32),
                    np.full(count, -1 if texture is None else len(textures) - 1, np.int32),
                    uv.astype(np.float32),
                )
            )
    columns = [np.concatenate(part) for part in zip(*parts, strict=True)]
    return Triangles(*columns, textures=tuple(textures))


def _corners_and_normals(surface: Surface, scale: Array, pose: Array, faces: Array) -> tuple[Array, Array]:
    """Of each of the faces (n, 3) in the world frame, (n, 3, 3) each."""
    rotation, translation = pose[:3, :3], pose[:3, 3]
    normals = surface.normals if (scale == scale[0]).all() else normalized(surface.normals / scale)
    corners = ((surface.vertices * scale) @ rotation.T + translation)[faces]
    return corners, (normals @ rotation.T).astype(np.float32)[faces]


def _content_surfaces(snapshot: Snapshot, i: int, view: Projection) -> tuple[Surface, ...]:
    """The surfaces that a node's content is drawn by."""
    content = snapshot.nodes[i].content
    if content is None:
        return ()
    if not isinstance(content, Lines) or not len(content.segments):
        return content.surfaces
    scale = snapshot.scales[i]
    end_points = (content.segments * scale) @ snapshot.poses[i, :3, :3].T + snapshot.poses[i, :3, 3]
    least = 0.5 * _MIN_LINE_WIDTH * np.maximum(view.local(end_points)[..., 2], 0.0) / view.focus / scale.max()
    radii = np.maximum(least, content.thickness / 2)
    return content.surfaces if (least <= content.thickness / 2).all() else content.as_prisms(radii)
