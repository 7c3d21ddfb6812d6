"""Nodes of a scene as nodes of viser: every kind of content, its look, its pose, and what is updated in place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

from ulna.geometry import Box, Sphere
from ulna.viewer.graph.content import Copies, Lines, Points, Text, transforms
from ulna.viewer.graph.node import Snapshot
from ulna.viewer.mesh.gltf import TRANSLUCENT_INSET
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import albedo, linear_from_srgb
from ulna.viewer.page import Page
from ulna.viewer.page.viser_nodes import (
    ViserNode,
    add_node,
    appearance_of,
    appearance_rows,
    is_drawn,
    is_translucent,
)
from ulna.viewer.scene import Scene

TURNED = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])  # a quarter about z
WXYZ = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
PLACES = np.array([(0.1, 0.2, 0.3), (0.4, 0.5, 0.6), (0.7, 0.8, 0.9)])
SEGMENTS = np.array([((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 2, 0))], dtype=float)
RGB = np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.2)])
BALL, BOX = tessellate(Sphere(0.1)), tessellate(Box((0.1, 0.2, 0.3)), (0.2, 0.4, 0.6, 0.5))
CONTENTS: dict[str, Callable[[], Any]] = {
    "points": lambda: Points(PLACES, RGB, 0.02),
    "lines": lambda: Lines(SEGMENTS, (1.0, 0.5, 0.0, 1.0), 0.01),
    "text": lambda: Text("hand", 0.25),
    "copies": lambda: Copies((BALL, BOX), transforms(PLACES), RGB, [2.0, 3.0, 4.0], 1.0),
}


@pytest.fixture(scope="module")
def server() -> Iterator[Any]:
    with Page(Scene(), port=0) as page:
        yield page.server


def shown(
    server: Any, content: Any, *, surfaces: Any = (), fixed_appearance: bool = False, **looks: Any
) -> ViserNode:
    return add_node(server, "thing", snapshot_of(content, surfaces, **looks), 0, fixed_appearance)


def snapshot_of(content: Any, surfaces: Any = (), shadow: bool = True, **looks: Any) -> Snapshot:
    scene = Scene()
    scene.add("thing", surfaces, TURNED, content=content, shadow=shadow)
    for key, value in looks.items():
        scene.set_appearance("thing", key, value)
    return scene.snapshot()


@pytest.mark.parametrize("kind", CONTENTS)
def test_every_content_lies_where_the_node_is(server: Any, kind: str) -> None:
    for visible in (True, False):
        node = shown(server, CONTENTS[kind](), visible=visible)
        assert len(node.handles) == (2 if kind == "copies" else 1)
        for handle in node.handles:
            np.testing.assert_allclose(handle.position, (1, 2, 3))
            np.testing.assert_allclose(handle.wxyz, WXYZ)
            assert handle.visible is visible
        assert (node.path, node.is_mesh) == ("thing", False)
        node.remove()


def test_points_are_discs_of_their_diameter(server: Any) -> None:
    (handle,) = shown(server, CONTENTS["points"](), scale=2.0).handles
    np.testing.assert_allclose(handle.points, PLACES, rtol=1e-6)
    np.testing.assert_array_equal(handle.colors, [(255, 0, 0), (0, 255, 0), (0, 0, 51)])
    assert (handle.point_size, handle.point_shape) == (0.01, "circle")
    assert handle.points.dtype == np.float32
    np.testing.assert_allclose(handle.scale, (2, 2, 2))
    (handle,) = shown(server, CONTENTS["points"](), tint=(0.0, 0.2, 1.0)).handles
    np.testing.assert_array_equal(handle.colors, [(0, 51, 255)] * 3)


def test_lines_have_their_colour_and_thickness(server: Any) -> None:
    (handle,) = shown(server, CONTENTS["lines"]()).handles
    np.testing.assert_allclose(handle.points, SEGMENTS)
    np.testing.assert_array_equal(np.reshape(handle.colors, (-1, 3))[0], (255, 128, 0))
    assert handle.thickness == 0.01
    (handle,) = shown(server, CONTENTS["lines"](), tint=(0.2, 0.0, 0.0)).handles
    np.testing.assert_array_equal(np.reshape(handle.colors, (-1, 3))[0], (51, 0, 0))


@pytest.mark.parametrize(
    ("alpha", "opacity", "expected"), [(1.0, 0.5, 0.5), (0.5, 1.0, 0.5), (0.5, 0.5, 0.25)]
)
def test_translucent_lines_are_tubes(server: Any, alpha: float, opacity: float, expected: float) -> None:
    lines = Lines(SEGMENTS, (1.0, 0.5, 0.0, alpha), 0.01)
    (handle,) = shown(server, lines, opacity=opacity).handles
    assert handle.opacity == expected
    assert (tuple(handle.color), handle.side, handle.cast_shadow) == ((255, 128, 0), "front", False)
    np.testing.assert_allclose(handle.vertices, lines.surfaces[0].vertices.reshape(-1, 3), atol=1e-6)
    np.testing.assert_array_equal(handle.faces, lines.surfaces[0].triangles)


def test_translucent_points_are_small_balls(server: Any) -> None:
    (handle,) = shown(server, CONTENTS["points"](), opacity=0.5).handles
    np.testing.assert_allclose(handle.batched_positions, PLACES, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(handle.vertices, axis=1), 0.01 - TRANSLUCENT_INSET, rtol=1e-5)
    assert handle.opacity == 0.5


def test_labels_are_as_high_as_the_scene_says(server: Any) -> None:
    (handle,) = shown(server, CONTENTS["text"](), scale=(1.0, 2.0, 4.0)).handles
    assert (handle.text, handle.font_size_mode, handle.font_scene_height) == ("hand", "scene", 1.0)
    assert (handle.depth_test, handle.anchor) == (True, "bottom-left")


def test_labels_that_the_page_draws_are_meshes(server: Any) -> None:
    snapshot = snapshot_of(CONTENTS["text"]())
    node = add_node(server, "thing", snapshot, 0, False, True)
    assert node.is_mesh and len(node.handles) == 1
    assert node.handles[0].cast_shadow is False
    assert node.update_content(snapshot_of(Text("foot", 0.25)), 0)
    assert not node.update_content(snapshot_of(Text("foot", 0.26)), 0)
    assert not node.update_scale((*node.appearance[:4], 2.0, 2.0, 2.0))


def test_copies_have_their_colours_scales_and_shadows(server: Any) -> None:
    ball, box = shown(server, CONTENTS["copies"]()).handles
    for handle in (ball, box):
        np.testing.assert_allclose(handle.batched_positions, PLACES, rtol=1e-6)
        np.testing.assert_allclose(handle.batched_wxyzs, [(1, 0, 0, 0)] * 3)
        np.testing.assert_allclose(handle.batched_scales, [(2, 3, 4)] * 3)
        np.testing.assert_array_equal(handle.batched_colors, np.round(albedo(RGB) * 255))
    assert (ball.opacity, ball.cast_shadow) == (None, True)
    assert (box.opacity, box.cast_shadow) == (0.5, False)
    np.testing.assert_allclose(ball.vertices, BALL.vertices, atol=1e-6)
    np.testing.assert_allclose(box.vertices, BOX.vertices - TRANSLUCENT_INSET * BOX.normals, atol=1e-6)
    np.testing.assert_array_equal(ball.faces, BALL.triangles)
    assert (ball.name, box.name) == ("/thing", "/thing ·1")


def test_copies_take_the_colours_of_their_surfaces_and_every_opacity(server: Any) -> None:
    content = Copies((BALL, BOX), transforms(PLACES), opacity=0.5)
    ball, box = shown(server, content, opacity=0.5, shadow=False).handles
    assert (ball.opacity, box.opacity) == (0.25, 0.125)
    assert ball.cast_shadow is False
    expected = np.round(albedo(np.array(BOX.rgba[:3])) * 255)
    np.testing.assert_array_equal(np.reshape(box.batched_colors, (-1, 3))[0], expected)
    opaque, _ = shown(server, Copies((BALL, BOX), transforms(PLACES)), shadow=False).handles
    assert opaque.cast_shadow is False


def test_surfaces_are_meshes_that_cast_shadows_where_they_are_opaque(server: Any) -> None:
    for surfaces, shadow, casts in (((BALL,), True, True), ((BOX,), True, False), ((BALL,), False, False)):
        node = shown(server, None, surfaces=surfaces, shadow=shadow, scale=3.0)
        assert node.is_mesh
        assert node.handles[0].cast_shadow is casts
        np.testing.assert_allclose(node.handles[0].scale, 1.0)  # the page applies it
    node = shown(server, None, surfaces=(BALL,), scale=3.0, fixed_appearance=True)
    assert not node.is_mesh
    np.testing.assert_allclose(node.handles[0].scale, 3.0)
    assert node.handles[0].cast_shadow is True
    faint = shown(server, None, surfaces=(BALL,), opacity=0.5, fixed_appearance=True)
    assert faint.handles[0].cast_shadow is False  # a page without a program keeps it so


MOVED = {
    "points": (Points(PLACES + 1, RGB, 0.02), [Points(PLACES, RGB, 0.03), Points(PLACES, RGB[::-1], 0.02)]),
    "lines": (
        Lines(SEGMENTS + 1, (1.0, 0.5, 0.0, 1.0), 0.01),
        [
            Lines(SEGMENTS, (1.0, 0.4, 0.0, 1.0), 0.01),
            Lines(SEGMENTS, (1.0, 0.5, 0.0, 1.0), 0.02),
            Lines(SEGMENTS, (1.0, 0.5, 0.0, 0.5), 0.01),
        ],
    ),
    "text": (Text("foot", 0.25), [Text("hand", 0.3)]),
}


@pytest.mark.parametrize("kind", MOVED)
def test_what_only_moves_is_updated_in_place_and_other_changes_are_not(server: Any, kind: str) -> None:
    node = shown(server, CONTENTS[kind]())
    moved, others = MOVED[kind]
    for other in (*others, None, Copies((BALL,), transforms(PLACES))):
        assert not node.update_content(snapshot_of(other), 0)
    assert not node.update_content(snapshot_of(moved, opacity=0.5), 0)
    snapshot = snapshot_of(moved)
    assert node.update_content(snapshot, 0)
    assert node.node is snapshot.nodes[0]
    (handle,) = node.handles
    if kind == "text":
        assert handle.text == "foot"
    else:
        expected = PLACES + 1 if kind == "points" else SEGMENTS + 1
        np.testing.assert_allclose(handle.points, expected, rtol=1e-6)
    translucent = shown(server, CONTENTS[kind](), opacity=0.5)
    assert translucent.update_content(snapshot_of(moved, opacity=0.5), 0) == (kind == "text")


def test_copies_that_move_are_updated_in_place(server: Any) -> None:
    original, poses = (BALL, BOX), transforms(PLACES)
    node = shown(server, Copies(original, poses, RGB))
    for other in (
        Copies((BALL, BOX), poses, RGB),  # another original
        Copies(original, poses[:2], RGB[:2]),
        Copies(original, poses, RGB, opacity=0.5),
        Copies(original, poses, RGB, 2.0),
        Copies(original, poses, RGB[::-1]),
        Copies(original, poses),
    ):
        assert not node.update_content(snapshot_of(other), 0), other
    turned = np.array([TURNED, np.eye(4), TURNED])
    assert node.update_content(snapshot_of(Copies(original, turned, RGB)), 0)
    for handle in node.handles:
        np.testing.assert_allclose(handle.batched_positions, turned[:, :3, 3])
        np.testing.assert_allclose(handle.batched_wxyzs, [WXYZ, (1, 0, 0, 0), WXYZ], atol=1e-6)


def test_scale_pose_and_visibility_change_in_place(server: Any) -> None:
    node = shown(server, CONTENTS["copies"]())
    assert not node.update_scale((0.5, *node.appearance[1:]))
    assert not node.update_scale((*node.appearance[:3], 0.5, *node.appearance[4:]))
    assert node.update_scale((*node.appearance[:4], 2.0, 3.0, 4.0))
    node.set_pose(np.array([7.0, 8.0, 9.0, 0.0, 1.0, 0.0, 0.0]))
    node.set_visible(False)
    for handle in node.handles:
        np.testing.assert_allclose(handle.scale, (2, 3, 4))
        np.testing.assert_allclose(handle.position, (7, 8, 9))
        np.testing.assert_allclose(handle.wxyz, (0, 1, 0, 0))
        assert handle.visible is False


def test_translucent_begins_at_a_thousandth() -> None:
    assert not is_translucent(snapshot_of(CONTENTS["points"](), opacity=0.999), 0)
    assert is_translucent(snapshot_of(CONTENTS["points"](), opacity=0.9989), 0)
    assert is_translucent(snapshot_of(Lines(SEGMENTS, (1.0, 1.0, 1.0, 0.5))), 0)


def test_appearances_are_linear_colours_opacity_and_scale() -> None:
    snapshot = snapshot_of(CONTENTS["points"](), tint=(0.1, 0.2, 0.3), opacity=0.4, scale=(5.0, 6.0, 7.0))
    appearance = appearance_of(snapshot, 0)
    assert appearance == (0.1, 0.2, 0.3, 0.4, 5.0, 6.0, 7.0)
    plain = (-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0)
    rows = appearance_rows([appearance, appearance, plain, plain], [False, True, False, True])
    rgb = np.array([0.1, 0.2, 0.3], dtype=np.float32)
    np.testing.assert_allclose(rows[0, :3], albedo(rgb), rtol=1e-6)
    np.testing.assert_allclose(rows[1, :3], linear_from_srgb(rgb), rtol=1e-6)
    np.testing.assert_allclose(rows[:2, 3:], [(0.4, 5, 6, 7)] * 2, rtol=1e-6)
    np.testing.assert_array_equal(rows[2:], [plain] * 2)
    assert rows.dtype == np.float32


def test_empty_nodes_are_not_drawn() -> None:
    scene = Scene()
    assert not is_drawn(scene.add("nothing"))
    assert is_drawn(scene.add("text", content=CONTENTS["text"]()))
    assert is_drawn(scene.add("ball", [BALL]))
