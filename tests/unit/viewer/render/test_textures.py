"""Textures in NumPy pictures: each corner in its own colour, seen from afar as their mean; thin lines without gaps."""

from __future__ import annotations

import io

import numpy as np
import pytest

from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.content import Lines
from ulna.viewer.mesh.surface import Surface, Texture, linear_from_srgb
from ulna.viewer.output.png import encode_png
from ulna.viewer.render.renderer import render
from ulna.viewer.render.textures import sample_texture
from ulna.viewer.scene import Scene

RED, GREEN, BLUE, WHITE = (220, 20, 20), (20, 200, 20), (20, 20, 220), (240, 240, 240)
QUARTERS = np.array([[RED, GREEN], [BLUE, WHITE]], dtype=np.uint8)  # red at the upper left
FRONT = Camera((0.0, -3.0, 0.5), (0.0, 0.0, 0.5), 0.6)


def wall(image: np.ndarray, repeat: float = 1.0) -> Scene:
    """A square of 1 m in the plane y = 0 with a picture on its front."""
    corners = np.array([(-0.5, 0, 0), (0.5, 0, 0), (0.5, 0, 1), (-0.5, 0, 1)], dtype=float)
    uv = repeat * np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    surface = Surface(
        corners,
        np.array([(0, 1, 2), (0, 2, 3)]),
        np.tile((0.0, -1.0, 0.0), (4, 1)),
        texture=Texture(uv, encode_png(image)),
    )
    scene = Scene()
    scene.add("wall", [surface])
    return scene


def test_a_texture_lies_the_right_way_round() -> None:
    pytest.importorskip("PIL")
    picture = render(wall(np.repeat(np.repeat(QUARTERS, 8, 0), 8, 1)), 100, 100, FRONT).astype(int)
    assert picture[35, 35].argmax() == 0
    assert picture[35, 65].argmax() == 1
    assert picture[65, 35].argmax() == 2
    assert np.ptp(picture[65, 65]) < 25


def test_a_tint_hides_a_texture_and_opacity_keeps_it() -> None:
    pytest.importorskip("PIL")
    scene = wall(np.full((4, 4, 3), RED, dtype=np.uint8))
    assert render(scene, 60, 60, FRONT)[30, 30].argmax() == 0
    scene.set_look("wall", "opacity", 0.5)
    assert render(scene, 60, 60, FRONT)[30, 30].argmax() == 0
    scene.set_look("wall", "tint", (0.0, 0.0, 1.0))
    assert render(scene, 60, 60, FRONT)[30, 30].argmax() == 2


def test_a_fine_texture_is_seen_as_its_mean_and_does_not_flicker() -> None:
    pytest.importorskip("PIL")
    board = np.zeros((256, 256, 3), dtype=np.uint8)
    board[::2, ::2] = board[1::2, 1::2] = 255
    picture = render(wall(board, repeat=4.0), 60, 60, FRONT)[22:38, 22:38].astype(int)
    assert picture.std(axis=(0, 1)).max() < 4.0
    assert 60 < picture.mean() < 220


def test_texels_are_read_between_each_other_and_repeat() -> None:
    pytest.importorskip("PIL")
    image = encode_png(QUARTERS)
    middles = np.array([(0.25, 0.75), (0.75, 0.75), (0.25, 0.25), (0.75, 0.25)])
    expected = linear_from_srgb(QUARTERS.reshape(-1, 3) / 255)
    for shift in (0.0, 1.0, -3.0):
        found = sample_texture(image, middles + shift, np.zeros(4))
        np.testing.assert_allclose(found, expected, atol=1e-5)
    between = sample_texture(image, np.array([(0.5, 0.75)]), np.zeros(1))
    np.testing.assert_allclose(between, expected[:2].mean(axis=0, keepdims=True), atol=1e-5)
    mean = sample_texture(image, middles, np.ones(4))
    np.testing.assert_allclose(mean, np.tile(expected.mean(axis=0), (4, 1)), atol=1e-5)


def test_jpeg_files_and_odd_sizes_are_read_and_broken_ones_are_not() -> None:
    Image = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    Image.new("RGB", (7, 3), BLUE).save(file, "JPEG")
    found = sample_texture(file.getvalue(), np.array([(0.5, 0.5)]), np.array([1.0]))
    assert found is not None and found[0].argmax() == 2
    assert sample_texture(b"no picture", np.zeros((1, 2)), np.zeros(1)) is None


def test_a_line_thinner_than_a_pixel_has_no_gaps() -> None:
    scene = Scene()
    ends = np.array([[(-0.8, 0.0, 0.1), (0.8, 0.0, 0.9)]])
    scene.add("line", content=Lines(ends, (0.8, 0.0, 0.0, 1.0), 1e-4), shadow=False)
    picture = render(scene, 80, 60, FRONT, 1, floor=-1.0).astype(int)
    red = picture[..., 0] > picture[..., 2] + 60
    columns = np.flatnonzero(red.any(axis=0))
    assert len(columns) > 40 and (np.diff(columns) == 1).all()
    assert red.sum(axis=0).max() <= 3
