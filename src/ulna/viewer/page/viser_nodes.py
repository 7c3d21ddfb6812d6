"""Nodes of a scene as nodes of viser: binary glTF for surfaces, other node types of viser for the rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from ulna.typing import Floats
from ulna.viewer.graph.content import Copies, Lines, Points, Text
from ulna.viewer.graph.node import Node, Snapshot
from ulna.viewer.mesh.gltf import TRANSLUCENT_INSET, glb, label_glb
from ulna.viewer.mesh.surface import Surface, albedo, linear_from_srgb
from ulna.viewer.page.poses import pose_rows, position_wxyz


@final
@dataclass
class ViserNode:
    """A node as the page has it: the viser handles that stand for it, all under one path.

    `is_mesh` nodes are surfaces and labels whose colours, opacity and scale the page changes; the others are
    created again.
    """

    node: Node
    path: str
    handles: list[Any]
    is_mesh: bool
    appearance: tuple[Any, ...]

    def update_content(self, snapshot: Snapshot, i: int) -> bool:
        """Take over the content of a node where that needs no new node of the page.

        Args:
            snapshot: The scene.
            i: The node's row.

        Returns:
            Whether it was possible.
        """
        node, old = snapshot.nodes[i], self.node.content
        if (
            type(node.content) is not type(old)
            or old is None
            or appearance_of(snapshot, i) != self.appearance
        ):
            return False
        translucent = is_translucent(snapshot, i)
        match node.content:
            case Points(positions) if _same_except_positions(node.content, old) and not translucent:
                self.handles[0].points = positions.astype(np.float32)
            case Lines(segments) if _same_except_positions(node.content, old) and not translucent:
                self.handles[0].points = segments.astype(np.float32)
            case Copies(_, poses) if _same_except_positions(node.content, old):
                rows = pose_rows(poses)
                for handle in self.handles:
                    handle.batched_positions, handle.batched_wxyzs = rows[:, :3], rows[:, 3:]
            case Text(text, height) if height == getattr(old, "height", None):
                if not self.is_mesh:
                    self.handles[0].text = text
            case _:
                return False
        self.node = node
        return True

    def update_scale(self, appearance: tuple[Any, ...]) -> bool:
        """Take over another scale, where nothing else of the look is new and its kind has one; whether it did."""
        if appearance[:4] != self.appearance[:4] or isinstance(self.node.content, Text):
            return False
        for handle in self.handles:
            handle.scale = appearance[4:]
        return True

    def set_pose(self, row: Any) -> None:
        """Set the pose through viser's public interface: x y z, w x y z."""
        for handle in self.handles:
            handle.position, handle.wxyz = row[:3], row[3:]

    def set_visible(self, visible: bool) -> None:
        """Show or hide it."""
        for handle in self.handles:
            if handle.visible != visible:
                handle.visible = visible

    def remove(self) -> None:
        """Take it out of the page."""
        for handle in self.handles:
            handle.remove()


def _same_except_positions(new: Any, old: Any) -> bool:
    """Whether two contents of one kind differ in where things are only."""
    match new:
        case Points():
            return new.size == old.size and np.array_equal(new.colours, old.colours)
        case Lines():
            return new.rgba == old.rgba and new.thickness == old.thickness
    same = new.original is old.original and len(new.poses) == len(old.poses) and new.opacity == old.opacity
    return same and np.array_equal(new.scales, old.scales) and np.array_equal(new.colours, old.colours)


def is_drawn(node: Node) -> bool:
    """Whether there is anything to see of a node."""
    return node.content is not None or any(len(s.triangles) for s in node.surfaces)


def appearance_of(snapshot: Snapshot, i: int) -> tuple[Any, ...]:
    """Tint, opacity and scale of a node, which can be compared.

    Args:
        snapshot: The scene.
        i: The node's row.

    Returns:
        Three numbers of the tint, opacity, three of the scale.
    """
    return (*snapshot.tint[i].tolist(), float(snapshot.opacity[i]), *snapshot.scales[i].tolist())


def is_translucent(snapshot: Snapshot, i: int) -> bool:
    """Whether the content of a node is translucent.

    Args:
        snapshot: The scene.
        i: The node's row.

    Returns:
        Whether its opacity is below 0.999.
    """
    return float(snapshot.opacity[i]) * getattr(snapshot.nodes[i].content, "rgba", (1.0,))[-1] < 0.999


def appearance_rows(appearances: list[tuple[Any, ...]], flat: list[bool]) -> Any:
    """Appearances as the page takes them: linear red, green, blue or -1, opacity, three scales.

    Args:
        appearances: What `appearance_of` returned for each node.
        flat: For each node whether it shows its colour as it is, in any light.

    Returns:
        Array (n, 7) float32.
    """
    out = np.array(appearances, dtype=np.float32).reshape(-1, 7)
    has_colour, plain = out[:, 0] >= 0, np.array(flat, dtype=bool)
    out[has_colour & ~plain, :3] = albedo(out[has_colour & ~plain, :3])
    out[has_colour & plain, :3] = linear_from_srgb(out[has_colour & plain, :3])
    return out


def add_node(
    server: Any, path: str, snapshot: Snapshot, i: int, fixed_appearance: bool, is_ulnas_page: bool = False
) -> ViserNode:
    """Add node `i` to the page.

    Args:
        server: The viser server.
        path: Its path there.
        snapshot: The scene.
        i: The node's row.
        fixed_appearance: Whether colours, opacity and scale are part of its content, for a page that cannot change
            them later.
        is_ulnas_page: Whether the page is Ulna's: it draws labels in any colour, and takes surfaces as they are.

    Returns:
        The node as the page has it.
    """
    node, pose = snapshot.nodes[i], snapshot.poses[i]
    position, wxyz = position_wxyz(pose)
    options = {"position": position, "wxyz": wxyz, "visible": bool(snapshot.visible[i])}
    appearance = appearance_of(snapshot, i)
    scale = tuple(float(s) for s in snapshot.scales[i])
    handles: list[Any] = []
    content = node.content
    if node.surfaces:
        shown = node
        if fixed_appearance:
            opacity, tint = snapshot.opacity[i], snapshot.tint[i]
            surfaces = tuple(
                replace(
                    s,
                    rgba=(*(s.rgba[:3] if tint[0] < 0 else tint), s.rgba[3] * opacity),
                    texture=s.texture if tint[0] < 0 else None,
                )
                for s in node.surfaces
            )
            shown = replace(node, surfaces=surfaces)
            options["scale"] = scale
        handles.append(
            server.scene.add_glb(
                path, _glb_content(shown.surfaces, is_ulnas_page), cast_shadow=shown.casts_shadow, **options
            )
        )
        options.pop("scale", None)
    written = is_ulnas_page and isinstance(content, Text)
    if isinstance(content, Text) and written:
        handles.append(server.scene.add_glb(path, label_glb(content.height), cast_shadow=False, **options))
    elif content is not None and not node.surfaces:
        handles += _ADDERS[type(content)](server, path, content, snapshot, i, options | {"scale": scale})
    return ViserNode(node, path, handles, written or (not fixed_appearance and content is None), appearance)


def _glb_content(surfaces: Sequence[Surface], is_ulnas_page: bool) -> Any:
    """Surfaces as a page takes them; ours takes them as they are, not compressed, which costs both sides more time."""
    return np.frombuffer(glb(surfaces, ours=True), dtype=np.uint8) if is_ulnas_page else glb(surfaces)


def _tinted_colours(snapshot: Snapshot, i: int, colours: Any) -> Floats:
    tint = snapshot.tint[i]
    return np.asarray(colours, dtype=float) if tint[0] < 0 else np.broadcast_to(tint, np.shape(colours))


def _colour_bytes(colours: Floats) -> Any:
    return np.round(np.asarray(colours) * 255).astype(np.uint8)


def _add_points(
    server: Any, path: str, content: Points, snapshot: Snapshot, i: int, options: dict[str, Any]
) -> list[Any]:
    if is_translucent(snapshot, i):  # points of the page let no light through
        return _add_copies(server, path, content.as_balls, snapshot, i, options)
    colours = _colour_bytes(_tinted_colours(snapshot, i, content.colours))
    return [
        server.scene.add_point_cloud(
            path,
            content.positions,
            colours,
            point_size=content.size / 2,  # viser means the radius
            point_shape="circle",
            precision="float32",
            **options,
        )
    ]


def _add_lines(
    server: Any, path: str, content: Lines, snapshot: Snapshot, i: int, options: dict[str, Any]
) -> list[Any]:
    colours = _colour_bytes(_tinted_colours(snapshot, i, np.array(content.rgba[:3])))
    if is_translucent(snapshot, i):  # neither do lines
        (tubes,) = content.surfaces
        opacity = float(snapshot.opacity[i] * content.rgba[3])
        shape = tubes.vertices.astype(np.float32), tubes.triangles.astype(np.uint32)
        appearance = {
            "color": tuple(colours.tolist()),
            "opacity": opacity,
            "side": "front",
            "cast_shadow": False,
        }
        return [server.scene.add_mesh_simple(path, *shape, **appearance, **options)]
    return [
        server.scene.add_line_segments(
            path, content.segments, colours, thickness=content.thickness, **options
        )
    ]


def _add_label(
    server: Any, path: str, content: Text, snapshot: Snapshot, i: int, options: dict[str, Any]
) -> list[Any]:
    height = content.height * options.pop("scale")[2]
    return [
        server.scene.add_label(
            path,
            content.text,
            font_size_mode="scene",
            font_scene_height=height,
            depth_test=True,
            anchor="bottom-left",
            **options,
        )
    ]


def _add_copies(
    server: Any, path: str, content: Copies, snapshot: Snapshot, i: int, options: dict[str, Any]
) -> list[Any]:
    rows = pose_rows(content.poses)
    handles = []
    for k, surface in enumerate(content.original):
        has_colour = surface.rgba[:3] if content.colours is None else content.colours
        opacity = float(surface.rgba[3] * content.opacity * snapshot.opacity[i])
        vertices = (
            surface.vertices if opacity >= 0.999 else surface.vertices - TRANSLUCENT_INSET * surface.normals
        )
        handles.append(
            server.scene.add_batched_meshes_simple(
                path if k == 0 else f"{path} ·{k}",
                vertices.astype(np.float32),
                surface.triangles.astype(np.uint32),
                rows[:, 3:],
                rows[:, :3],
                batched_scales=content.scales,
                batched_colors=_colour_bytes(albedo(_tinted_colours(snapshot, i, has_colour))),
                opacity=None if opacity >= 0.999 else opacity,
                cast_shadow=snapshot.nodes[i].shadow and opacity >= 0.999,
                **options,
            )
        )
    return handles


_ADDERS: dict[type, Callable[..., list[Any]]] = {
    Points: _add_points,
    Lines: _add_lines,
    Text: _add_label,
    Copies: _add_copies,
}
