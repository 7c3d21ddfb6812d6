"""What surrounds the scene in the page, in both themes: panel, lights, background, floor and camera."""

from __future__ import annotations

from dataclasses import asdict
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

from ulna.errors import InputError, UnknownName
from ulna.geometry import Box
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.theme import DARK, LIGHT, Theme
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.page import Page, surroundings
from ulna.viewer.page.gizmo import add_gizmo
from ulna.viewer.panel.panel import Panel
from ulna.viewer.scene import Scene
from ulna.viewer.viewer import Viewer

LIGHTS = {
    "key": ((255, 244, 230), 2.6, (1.6, -1.0, 3.2)),
    "rim": ((230, 240, 255), 0.8, (-2.0, 2.4, 1.6)),
    "fill": ((220, 232, 255), 0.25, (-1.0, -3.0, 1.2)),
}
COLOURS = {
    "light": [
        (False, (142, 163, 187), (217, 225, 233), (180, 190, 201), (141, 152, 166), (169, 179, 191), (30, 41, 59)),
        (1.0, 0.30, 0.42),
    ],
    "dark": [
        (True, (13, 17, 24), (38, 46, 58), (30, 36, 45), (74, 86, 104), (46, 54, 66), (226, 232, 240)),
        (0.85, 0.22, 0.55),
    ],
}  # fmt: skip


def messages(page: Page, kind: str) -> list[Any]:
    buffer = page.server._websock_server.get_message_buffer()
    with buffer.buffer_lock:
        return [m for m in buffer.message_from_id.values() if type(m).__name__ == kind]


@pytest.mark.parametrize(("theme", "name"), [(LIGHT, "light"), (DARK, "dark")])
def test_the_themes_are_as_documented(theme: Theme, name: str) -> None:
    colours, strengths = COLOURS[name]
    assert tuple(asdict(theme).values()) == (*colours, *strengths)


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_panel_lights_and_environment_are_those_of_the_theme(theme: Theme) -> None:
    with Page(Scene(), port=0, theme=theme) as page:
        (panel,) = messages(page, "ThemeConfigurationMessage")
        assert (panel.dark_mode, panel.control_width) == (theme.dark, "medium")
        assert not panel.show_logo and not panel.show_share_button
        assert panel.colors[8] == "#2563eb"
        assert not messages(page, "EnableLightsMessage")[0].enabled
        (environment,) = messages(page, "EnvironmentMapMessage")
        assert environment.environment_intensity == theme.environment_intensity
        assert environment.hdri_data
        (sky,) = messages(page, "HemisphereLightMessage")
        assert asdict(sky.props) == {
            "sky_color": (235, 242, 255),
            "ground_color": (150, 155, 160),
            "intensity": 0.28 * theme.light_factor,
        }
        places = {m.name: m.position for m in messages(page, "SetPositionMessage")}
        found = {m.name: m.props for m in messages(page, "DirectionalLightMessage")}
        assert set(found) == {f"/(page)/{name}" for name in LIGHTS}
        for name, (colour, strength, position) in LIGHTS.items():
            light = found[f"/(page)/{name}"]
            assert (light.color, light.intensity) == (colour, strength * theme.light_factor)
            assert not light.cast_shadow  # our script draws the shadows
            assert places[f"/(page)/{name}"] == position


@pytest.mark.parametrize("shadows", [True, False])
def test_only_the_key_light_casts_shadows_of_viser(shadows: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    with Page(Scene(), port=0) as page:
        surroundings.configure_scene(page.server, LIGHT, shadows)
        casting = {m.name for m in messages(page, "DirectionalLightMessage") if m.props.cast_shadow}
        assert casting == ({"/(page)/key"} if shadows else set())


def test_the_background_goes_from_the_top_to_the_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    with Page(Scene(), port=0) as page:
        images: list[Any] = []
        monkeypatch.setattr(
            page.server.scene, "set_background_image", lambda image, format: images.append((image, format))
        )
        surroundings.configure_scene(page.server, DARK)
    ((image, format_),) = images
    assert (image.shape, image.dtype, format_) == ((512, 8, 3), np.uint8, "png")
    np.testing.assert_array_equal(image[0, 0], DARK.top)
    np.testing.assert_array_equal(image[169:, :], np.broadcast_to(DARK.horizon, (343, 8, 3)))
    assert (np.diff(image[:, 0].astype(int), axis=0) >= 0).all()
    share = (84 / 511 / 0.33) ** 0.8
    expected = np.floor(np.array(DARK.top) + share * np.subtract(DARK.horizon, DARK.top))
    np.testing.assert_array_equal(image[84, 3], expected)


def floor_of(page: Page) -> tuple[Any, float, bool]:
    (grid,) = messages(page, "GridMessage")
    name = "/(page)/floor"
    height = next(m for m in messages(page, "SetPositionMessage") if m.name == name).position[2]
    visible = next(m for m in messages(page, "SetSceneNodeVisibilityMessage") if m.name == name).visible
    return grid.props, height, visible


def test_the_floor_has_lines_each_metre_and_tenth() -> None:
    with Page(Scene(), port=0, theme=DARK) as page:
        floor, height, visible = floor_of(page)
        assert (height, visible) == (-0.001, True)
        assert asdict(floor) | {"width": 0, "height": 0} == {
            "width": 0, "height": 0, "plane": "xy", "infinite_grid": True, "scale": 1.0,
            "cell_size": 0.1, "cell_thickness": 0.7, "cell_color": DARK.cell,
            "section_size": 1.0, "section_thickness": 1.1, "section_color": DARK.section,
            "plane_color": DARK.floor, "plane_opacity": 1.0, "shadow_opacity": DARK.shadow,
            "fade_distance": 14.0, "fade_strength": 1.6, "fade_from": "camera",
        }  # fmt: skip


def below() -> Scene:
    """A scene in which a box reaches half a metre below zero."""
    scene = Scene()
    scene.add("box", [tessellate(Box((1, 1, 1)))])
    return scene


def test_the_floor_is_where_it_is_put_or_below_everything() -> None:
    with Page(below(), port=0) as page:
        assert floor_of(page)[1] == pytest.approx(-0.501)
        page.set_theme(DARK, -2.0)
        assert floor_of(page)[0].plane_color == DARK.floor
        assert floor_of(page)[1] == pytest.approx(-2.001)
        page.set_theme(LIGHT, None, grid=False)
        floor, height, visible = floor_of(page)
        assert (height, visible) == (pytest.approx(-0.501), False)
        assert floor.plane_color == LIGHT.floor
    with Page(below(), port=0, floor=0.25) as page:
        assert floor_of(page)[1] == pytest.approx(0.249)


def test_a_camera_that_is_given_is_that_of_new_tabs_and_of_open_ones() -> None:
    camera = Camera((1.0, 2.0, 3.0), (0.1, 0.2, 0.3), fov=0.7)
    with Page(Scene(), port=0, camera=camera) as page:
        first = page.server.initial_camera
        np.testing.assert_allclose(first.position, camera.position)
        np.testing.assert_allclose(first.look_at, camera.target)
        np.testing.assert_allclose(first.up, camera.up)
        assert first.fov == 0.7
    tab = SimpleNamespace(camera=SimpleNamespace())
    server = SimpleNamespace(initial_camera=SimpleNamespace(), get_clients=lambda: {1: tab})
    surroundings.set_camera(server, camera)
    assert vars(tab.camera) == {
        "up_direction": camera.up, "position": camera.position, "look_at": camera.target, "fov": 0.7
    }  # fmt: skip


def test_a_gizmo_reports_where_it_was_dragged(monkeypatch: pytest.MonkeyPatch) -> None:
    pose = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    posted: list[Any] = []
    with Page(Scene(), port=0) as page:
        monkeypatch.setattr(page, "post_event", lambda *event: posted.append(event))
        gizmo = add_gizmo(page, "goal", pose, print, 0.3)
        handle = gizmo._handle
        assert (handle.name, handle.scale, handle.line_width) == ("/(page)/goal", 0.3, 3.0)
        assert (handle.depth_test, handle.opacity) == (False, 0.9)
        np.testing.assert_allclose(gizmo.pose, pose, atol=1e-6)
        assert gizmo.visible and not gizmo.is_dragged
        gizmo.visible = False
        assert not gizmo.visible and not handle.visible
        (listener,) = handle._impl_aux.update_cb
        for phase, dragged in (("start", True), ("update", True), ("end", False)):
            with pytest.raises(StopIteration):
                listener(SimpleNamespace(phase=phase)).send(None)
            assert gizmo.is_dragged is dragged
        assert [event[0] for event in posted] == [None, id(handle), None]
        assert {event[1] for event in posted} == {print}
        assert [event[2][1] for event in posted] == ["start", "update", "end"]
        np.testing.assert_allclose(posted[0][2][0], pose, atol=1e-6)
        gizmo.remove()


def test_without_a_page_nothing_is_dragged_or_put_into_a_panel() -> None:
    with pytest.raises(InputError, match="There is no page to drag"):
        Panel(None).gizmo("goal", np.eye(4), print)
    with Viewer(page=False) as viewer:
        with pytest.raises(UnknownName, match="option of simulated robots"):
            viewer.simulate(recrod=True)
        with pytest.raises(InputError, match="Nothing was simulated here"):
            viewer.play()
        for wrong in ({"a": 1}, {}, 7):
            with pytest.raises(InputError, match="Cannot play"):
                viewer.play(wrong)  # type: ignore[arg-type]
        viewer.floor = -0.25
        viewer.theme = "dark"
        assert (viewer.floor, viewer.theme) == (-0.25, DARK)
        viewer.camera = camera = Camera((1.0, 2.0, 3.0), (0.0, 0.0, 0.0))
        assert viewer.camera is camera
        viewer.camera = None
        assert viewer.camera != camera
