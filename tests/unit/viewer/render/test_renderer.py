"""Pictures made with NumPy alone: what is in them, not only that there are some."""

from collections.abc import Iterable

import numpy as np
import pytest

from ulna.errors import InputError
from ulna.geometry import Box, Plane, Sphere
from ulna.viewer.graph.camera import Camera, camera_for
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.render.renderer import render
from ulna.viewer.scene import Scene

RED = (0.8, 0.05, 0.05, 1.0)
SIDE = Camera((3.0, 0.0, 0.5), (0.0, 0.0, 0.5), np.deg2rad(40))


def at(*place: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = place
    return pose


def boxes(*places: tuple[float, float, float], rgba: Iterable[float] = RED) -> Scene:
    scene = Scene()
    for k, place in enumerate(places):
        scene.add(f"box{k}", [tessellate(Box((0.4, 0.4, 0.4)), tuple(rgba))], at(*place))
    return scene


def is_red(pixel: np.ndarray) -> bool:
    r, g, b = (int(c) for c in pixel)
    return r > g + 60 and r > b + 60


def test_a_red_box_stands_where_it_is() -> None:
    picture = render(boxes((0, 0, 0.5)), 120, 90, SIDE)
    assert picture.shape == (90, 120, 3)
    assert picture.dtype == np.uint8
    assert is_red(picture[45, 60])
    assert not is_red(picture[45, 10])
    red = np.array([[is_red(p) for p in row] for row in picture])
    rows, columns = np.nonzero(red)
    # 0.4 m high in front of a camera 2.8 m away: 0.4 / (2 * 2.8 * tan 20 deg) of the height
    assert np.ptp(rows) + 1 == pytest.approx(90 * 0.4 / (2 * 2.8 * np.tan(np.deg2rad(20))), abs=1.5)
    assert columns.mean() == pytest.approx(59.5, abs=1.0)


def test_the_nearer_hides_the_farther() -> None:
    scene = boxes((0, 0, 0.5))
    scene.add("near", [tessellate(Sphere(0.1), (0.05, 0.1, 0.8, 1.0))], at(1.0, 0, 0.5))
    pixel = render(scene, 60, 45, SIDE)[22, 30]
    assert pixel[2] > pixel[0]


def test_a_ghost_lets_what_is_behind_through() -> None:
    scene = boxes((0, 0, 0.5))
    solid = render(scene, 60, 45, SIDE)[22, 30].astype(int)
    scene.add("ghost", [tessellate(Sphere(0.3), (0.1, 0.1, 0.9, 0.4))], at(1.0, 0, 0.5))
    mixed = render(scene, 60, 45, SIDE)[22, 30].astype(int)
    assert mixed[2] > solid[2] + 20
    assert solid[0] > mixed[0] > 60


def test_a_ghost_in_the_same_place_does_not_flicker_through() -> None:
    scene = boxes((0, 0, 0.5))
    alone = render(scene, 60, 45, SIDE)
    scene.add("ghost", [tessellate(Box((0.4, 0.4, 0.4)), (0.1, 0.1, 0.9, 0.4))], at(0, 0, 0.5))
    np.testing.assert_array_equal(render(scene, 60, 45, SIDE), alone)


def test_lines_show_faintly_through_what_hides_them() -> None:
    scene = boxes((0, 0, 0.5), rgba=(0.9, 0.9, 0.9, 1.0))
    before = render(scene, 60, 45, SIDE)[22, 30].astype(int)
    scene.add_path("line", [(-1, -1, 0.5), (-1, 1, 0.5)], (0.9, 0.1, 0.1), radius=0.05)
    after = render(scene, 60, 45, SIDE)[22, 30].astype(int)
    assert before[1] - after[1] > 15
    assert after[1] > 60


def test_a_box_throws_its_shadow_away_from_the_light() -> None:
    down = Camera((0.0, 0.0, 6.0), (0.0, 0.0, 0.0), np.deg2rad(30), (0.0, 1.0, 0.0))
    with_box = render(boxes((0, 0, 0.6)), 100, 100, down).astype(int)
    without = render(Scene(), 100, 100, down).astype(int)
    darker = (without - with_box).sum(axis=2)
    pixels_a_metre = 100 / (2 * 6 * np.tan(np.deg2rad(15)))
    # the light comes from +x, -y: the shadow of the middle of the box falls 0.6 m * (-1.6, 1.0) / 3.2 further
    x, y = 50 - 0.3 * pixels_a_metre, 50 - 0.1875 * pixels_a_metre
    assert darker[int(y), int(x - 3)] > 40
    assert abs(darker[100 - int(y), 100 - int(x - 6)]) < 10


def test_the_floor_lies_below_what_hangs_below_the_base() -> None:
    low = render(boxes((0, 0, -1.0)), 60, 45, Camera((4.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
    assert is_red(low[22, 30])


def test_pictures_are_the_same_each_time() -> None:
    scene = boxes((0, 0, 0.5), (0.3, 0.2, 0.2))
    np.testing.assert_array_equal(render(scene, 64, 48), render(scene, 64, 48))


@pytest.mark.parametrize(
    "camera",
    [
        Camera((0.0, 0.0, 0.5), (1.0, 0.0, 0.5)),  # within the box
        Camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0)),  # straight down
        Camera((2.0, 0.0, -1.0), (0.0, 0.0, 0.0)),  # from below the floor
        Camera((2.0, 0.0, 0.5), (4.0, 0.0, 0.5)),  # looking away
    ],
)
def test_odd_cameras_still_give_pictures(camera: Camera) -> None:
    scene = boxes((0, 0, 0.5))
    scene.add("sheet", [tessellate(Plane())], at(0, 0, 0.1))  # reaches behind every camera
    assert render(scene, 40, 30, camera).std() > 0


def test_an_empty_scene_is_a_floor() -> None:
    picture = render(Scene(), 80, 50)
    assert picture.min() > 60
    assert picture.std() > 1


@pytest.mark.parametrize("size", [(0, 10), (10, 20000), (-1, 5)])
def test_invalid_sizes_are_refused(size: tuple[int, int]) -> None:
    with pytest.raises(InputError, match="1 to 16384"):
        render(Scene(), *size)


def test_a_picture_too_large_for_memory_is_refused() -> None:
    with pytest.raises(InputError, match="smaller picture"):
        render(Scene(), 16384, 16384, samples=4)


@pytest.mark.parametrize("samples", [1, 2, 3])
def test_more_samples_make_smoother_edges(samples: int) -> None:
    picture = render(boxes((0, 0, 0.5)), 60, 45, SIDE, samples=samples)
    assert is_red(picture[22, 30])


@pytest.mark.parametrize("direction", [(1.55, -1.75, 0.7), (0.0, 0.0, 1.0), (-1.0, 0.2, 0.1)])
def test_a_framed_scene_lies_within_the_picture_and_fills_it(direction: tuple[float, float, float]) -> None:
    scene = boxes((0, 0, 0.5), (1.0, 2.0, 1.5), (-0.5, 0.3, 0.2))
    camera = camera_for(scene, 1.5, direction, margin=1.1)
    local = (scene.points() - camera.position) @ camera.axes()
    x, y = (local[:, k] / -local[:, 2] / np.tan(camera.fov / 2) for k in (0, 1))
    reach = max(np.abs(x).max() / 1.5, np.abs(y).max())
    assert 0.8 < reach < 1.0


def test_an_empty_scene_is_framed_too() -> None:
    assert camera_for(Scene()) == Camera()
    assert np.rad2deg(Camera().fov) == pytest.approx(27.0)


def test_words_have_their_units() -> None:
    """Pillow's own font draws a box for what it lacks: two letters that it lacks would look alike."""
    ImageFont = pytest.importorskip("PIL.ImageFont")
    from ulna.viewer.render.labels import _font

    font = _font(40.0)
    if font.getname() == ImageFont.load_default(40).getname():
        pytest.skip("no other font is here")
    drawn = [bytes(font.getmask(letter)) for letter in "µ²Στθ"]
    assert len(set(drawn)) == len(drawn)
