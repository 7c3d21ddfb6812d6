"""Colour, opacity, scale, visibility and pose change at run time, for every kind of thing, in pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.geometry import Box
from ulna.typing import Array
from ulna.viewer.graph.camera import Camera
from ulna.viewer.render.renderer import render
from ulna.viewer.viewer import Viewer

EYE = Camera((0.0, -3.0, 0.5), (0.0, 0.0, 0.3), 0.6)
WAY = np.array([(-0.3, 0.0, 0.1), (0.3, 0.0, 0.1), (0.3, 0.0, 0.5), (-0.2, 0.0, 0.4)])


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def stl(folder: Path) -> str:
    """A mesh file with one triangle."""
    corners = "".join(f"vertex {x} {y} {z}\n" for x, y, z in ((-0.3, 0, 0), (0.3, 0, 0), (0, 0, 0.5)))
    (folder / "a.stl").write_text(
        f"solid a\nfacet normal 0 -1 0\nouter loop\n{corners}endloop\nendfacet\nendsolid\n"
    )
    return str(folder / "a.stl")


def with_arm(v: Viewer, panda: ulna.Robot) -> Any:
    arm = v.add(panda, "qr")
    arm.visible = False
    return arm


KINDS: dict[str, Callable[[Viewer, ulna.Robot, Path], Any]] = {
    "box": lambda v, *_: v.box((0.3, 0.3, 0.3)),
    "sphere": lambda v, *_: v.sphere(0.2),
    "ellipsoid": lambda v, *_: v.ellipsoid((0.2, 0.1, 0.3)),
    "cylinder": lambda v, *_: v.cylinder(0.2, 0.3),
    "capsule": lambda v, *_: v.capsule(0.1, 0.3),
    "cone": lambda v, *_: v.cone(0.2, 0.3),
    "mesh": lambda v, _, folder: v.mesh(stl(folder), color=(0.1, 0.1, 0.6)),
    "axes": lambda v, *_: v.axes(0.5),
    "arrow": lambda v, *_: v.arrow((0.3, 0.0, 0.4), radius=0.03),
    "line": lambda v, *_: v.line(WAY, thickness=0.03),
    "curve": lambda v, *_: v.curve(WAY, thickness=0.03),
    "points": lambda v, *_: v.points(WAY, np.eye(4, 3), size=0.1),
    "copies": lambda v, *_: v.copies(Box((0.1, 0.1, 0.1)), positions=WAY),
    "grid": lambda v, *_: v.grid(1.0, 0.125, pose=ulna.SE3.rx(1.0)),
    "text": lambda v, *_: v.text("words", (-0.5, 0.0, 0.0), height=0.3),
    "group": lambda v, *_: (v.box((0.2, 0.2, 0.2), name="a/b/c"), v.line(WAY, name="a/d"), v["a"])[-1],
    "robot": lambda v, panda, _: v.add(panda, "qr"),
    "skeleton": lambda v, panda, _: v.add(panda, "qr", show="skeleton"),
    "fleet": lambda v, panda, _: v.fleet(panda, np.tile(panda.configurations["qr"], (2, 1))),
}


@pytest.fixture
def viewer() -> Viewer:
    return Viewer(page=False)


def picture(viewer: Viewer) -> Array:
    return render(viewer.scene, 96, 64, EYE, 1, floor=-1.0).astype(int)


def much(a: Array, b: Array) -> int:
    """How many pixels of two pictures differ plainly."""
    return int((np.abs(a - b).max(axis=-1) > 12).sum())


def made(viewer: Viewer, kind: str, panda: ulna.Robot, folder: Path) -> tuple[Any, Array, Array]:
    """A thing of that kind, the picture without it, and with it."""
    if kind == "mesh":
        pytest.importorskip("trimesh")
    if kind == "text":
        pytest.importorskip("PIL")
    without = picture(viewer)
    thing = KINDS[kind](viewer, panda, folder)
    before = picture(viewer)
    assert much(before, without) > 10
    return thing, without, before


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_hidden_and_shown(viewer: Viewer, kind: str, panda: ulna.Robot, tmp_path: Path) -> None:
    thing, without, before = made(viewer, kind, panda, tmp_path)
    thing.visible = False
    assert much(picture(viewer), without) == 0
    thing.visible = True
    np.testing.assert_array_equal(picture(viewer), before)


@pytest.mark.parametrize("kind", KINDS)
def test_it_fades(viewer: Viewer, kind: str, panda: ulna.Robot, tmp_path: Path) -> None:
    thing, without, before = made(viewer, kind, panda, tmp_path)
    thing.opacity = 0.5
    half = picture(viewer)
    seen = np.abs(before - without).max(axis=-1) > 60  # plainly there at first
    assert seen.sum() > 5
    share = np.abs(half - without)[seen].sum() / np.abs(before - without)[seen].sum()
    assert 0.3 < share < 0.95, share  # behind the front there may be more of it
    thing.opacity = 0.0
    assert much(picture(viewer), without) == 0
    thing.opacity = 1.0
    np.testing.assert_array_equal(picture(viewer), before)


@pytest.mark.parametrize("kind", KINDS)
def test_it_gets_a_colour_and_the_former_one_back(
    viewer: Viewer, kind: str, panda: ulna.Robot, tmp_path: Path
) -> None:
    thing, without, before = made(viewer, kind, panda, tmp_path)
    thing.color = "green"
    green = picture(viewer)
    seen = np.abs(green - without).max(axis=-1) > 60
    assert seen.sum() > 5
    tinted = green[seen][:, 1] > green[seen][:, [0, 2]].max(axis=-1)
    assert tinted.mean() > 0.9
    assert thing.color[1] > thing.color[0]
    thing.color = None
    np.testing.assert_array_equal(picture(viewer), before)


@pytest.mark.parametrize("kind", KINDS)
def test_it_grows_and_shrinks(viewer: Viewer, kind: str, panda: ulna.Robot, tmp_path: Path) -> None:
    thing, without, before = made(viewer, kind, panda, tmp_path)
    wide = np.ptp(viewer.scene.points(), axis=0)
    thing.scale = 0.5
    if kind != "text":  # words are as large as they are seen
        np.testing.assert_allclose(np.ptp(viewer.scene.points(), axis=0), 0.5 * wide, atol=1e-9)
    small = (np.abs(picture(viewer) - without).max(axis=-1) > 12).sum()
    assert 0 < small < 0.7 * (np.abs(before - without).max(axis=-1) > 12).sum()
    thing.scale = 1.0
    np.testing.assert_array_equal(picture(viewer), before)


@pytest.mark.parametrize("kind", KINDS)
def test_it_moves(viewer: Viewer, kind: str, panda: ulna.Robot, tmp_path: Path) -> None:
    thing, _, before = made(viewer, kind, panda, tmp_path)
    start, points = thing.pose, viewer.scene.points()
    move = ulna.SE3.trans(0.2, 0.1, 0.3) @ ulna.SE3.rz(0.5)
    thing.pose = move.matrix() @ start
    T = move.matrix()
    np.testing.assert_allclose(viewer.scene.points(), points @ T[:3, :3].T + T[:3, 3], atol=1e-9)
    assert much(picture(viewer), before) > 10
    thing.pose = start
    np.testing.assert_array_equal(picture(viewer), before)


@pytest.mark.parametrize(
    "extra",
    [
        lambda arm: arm.frames("panda_hand", 0.4),
        lambda arm: arm.center_of_mass(0.2),
        lambda arm: arm.inertias(),
        lambda arm: arm.manipulability(size=0.4),
        lambda arm: arm.force(vector=(40, 0, 30)),
        lambda arm: arm.ghosts(np.tile(arm.q + 0.2, (2, 1)), opacity=0.9),
    ],
    ids=["frames", "centre of mass", "inertias", "manipulability", "force", "ghosts"],
)
def test_attached_shapes_have_separate_appearances(
    viewer: Viewer, panda: ulna.Robot, extra: Callable[[Any], Any]
) -> None:
    arm = viewer.add(panda, "qr")
    without = picture(viewer)
    thing = extra(arm)
    before = picture(viewer)
    assert much(before, without) > 5
    thing.visible = False
    assert much(picture(viewer), without) == 0
    thing.visible, thing.color = True, (0.0, 1.0, 0.0)
    assert much(picture(viewer), before) > 5
    thing.color, thing.opacity = None, 0.3
    assert much(picture(viewer), before) > 2
    thing.opacity = 1.0
    np.testing.assert_array_equal(picture(viewer), before)
