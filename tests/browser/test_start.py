"""How the page starts and is lit: a browser keeps its program, one lamp throws shadows, a tab comes back by itself."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from support.ports import free_port
from ulna.viewer.graph.camera import Camera
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.render.lighting import KEY_DIRECTION
from ulna.viewer.viewer import Viewer

pytestmark = pytest.mark.browser
SIZE = {"width": 640, "height": 400}  # drawn by the processor here, so small
EYE = Camera((0.0, -3.0, 2.5), (0.0, 0.0, 0.2), 0.6)
LAMPS = """() => { const out = []; window.__viserMutable.scene.traverse(
    o => { if (o.isDirectionalLight && o.castShadow) out.push(o); }); return out.length; }"""
COUNT = """() => { window.drawn = 0; window.__viserMutable.scene.traverse(o => { if (o.isDirectionalLight && o.castShadow) {
    const before = o.shadow.updateMatrices; o.shadow.updateMatrices = function (...x) { window.drawn++; return before.apply(this, x); };
    } }); }"""


wait = patient()


def has(tab: Any, path: str) -> bool:
    return bool(tab.evaluate("n => !!window.__viserMutable?.nodeRefFromName[n]", path))


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    with Viewer(port=0, browser=False, camera=EYE) as viewer:
        viewer.box((0.5, 0.5, 0.1), name="box", pose=ulna.SE3.trans(0.0, 0.0, 0.6))
        yield viewer


@pytest.fixture(scope="module")
def context(chromium: Any) -> Iterator[Any]:
    context = chromium.new_context(viewport=SIZE)
    yield context
    context.close()


@pytest.fixture(scope="module")
def tab(viewer: Viewer, context: Any) -> Any:
    tab = context.new_page()
    tab.goto(f"{viewer.url}/?fixedDpr=1")
    assert wait(lambda: has(tab, "/box"))
    return tab


def test_the_program_of_the_page_is_fetched_once(viewer: Viewer, context: Any, tab: Any) -> None:
    fetched = """() => performance.getEntriesByType("resource").filter(e => e.name.includes("/ulna-"))
        .map(e => [e.name.split(".").pop(), e.transferSize])"""
    assert wait(lambda: dict(tab.evaluate(fetched)).keys() == {"js", "css", "wasm"})
    first = dict(tab.evaluate(fetched))
    assert first["js"] > 100_000
    again = context.new_page()
    again.goto(f"{viewer.url}/?fixedDpr=1")
    assert wait(lambda: has(again, "/box"))
    assert wait(lambda: len(again.evaluate(fetched)) == 3)
    assert dict(again.evaluate(fetched)) == {"js": 0, "css": 0, "wasm": 0}
    again.close()


def test_one_light_casts_shadows_which_are_drawn_when_something_moved(viewer: Viewer, tab: Any) -> None:
    assert wait(lambda: tab.evaluate(LAMPS) == 1)
    tab.evaluate(COUNT)

    def frames_draw_no_shadows() -> bool:
        tab.evaluate("window.drawn = 0")
        for _ in range(5):
            tab.evaluate("window.__viserMutable.requestRender()")
            tab.wait_for_timeout(200)
        return tab.evaluate("window.drawn") == 0

    assert wait(frames_draw_no_shadows)  # once all is loaded and drawn
    viewer["box"].position = (0.0, 0.0, 0.7)
    assert wait(lambda: tab.evaluate("window.drawn") > 0)
    viewer["box"].position = (0.0, 0.0, 0.6)
    cube, places = ulna.geometry.Box((0.1, 0.1, 0.1)), 0.5 * np.eye(3)
    for change in (
        lambda: viewer.copies(cube, positions=np.eye(3), name="many"),
        lambda: setattr(viewer["many"], "positions", places),
        lambda: viewer.remove("many"),
    ):
        tab.wait_for_timeout(1000)
        tab.evaluate("window.drawn = 0")
        change()
        assert wait(lambda: tab.evaluate("window.drawn") > 0)


def test_the_shadow_falls_away_from_the_light(viewer: Viewer, tab: Any) -> None:
    Image = pytest.importorskip("PIL.Image")
    away = np.array(KEY_DIRECTION) / KEY_DIRECTION[2] * 0.6

    def brightness(point: np.ndarray) -> float:
        """Of the floor around a point, free of the lines of the grid."""
        x, y, z = (point - np.array(EYE.position)) @ EYE.axes()
        focus = SIZE["height"] / (2 * np.tan(EYE.fov / 2))
        column, row = int(SIZE["width"] / 2 - focus * x / z), int(SIZE["height"] / 2 + focus * y / z)
        image = np.asarray(Image.open(io.BytesIO(tab.screenshot())).convert("L"), dtype=float)
        return float(np.median(image[row - 3 : row + 4, column - 3 : column + 4]))

    shaded, lit = -away * [1, 1, 0], np.array([-1.0, 0.2, 0.0])
    assert wait(lambda: brightness(shaded) < 0.88 * brightness(lit))


def test_a_processor_draws_no_mirrored_room_and_hides_nothing_meanwhile(tab: Any) -> None:
    assert tab.evaluate("window.__viserMutable.ulnaSoftware") is True
    assert tab.evaluate("window.__viserMutable.scene.environment === null")
    assert tab.evaluate('+(document.querySelector("canvas[data-engine]").style.opacity || 1)') == 1


LEVELS = """() => { const out = {}; window.__viserMutable.scene.traverse(
    o => { const level = o.geometry?.userData.level; if (level) out[level] = o.visible; }); return out; }"""
DRAWN = """() => { const scene = window.__viserMutable.scene, before = scene.onAfterRender; window.frames_ = 0;
    scene.onAfterRender = (...x) => { window.frames_++; before?.apply(scene, x); }; }"""


def test_a_heavy_surface_has_few_triangles_while_it_moves_and_all_at_rest(viewer: Viewer, tab: Any) -> None:
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 240), np.linspace(-0.5, 0.5, 240))
    vertices = np.stack([x, y, np.full_like(x, 0.05)], axis=-1).reshape(-1, 3)
    corner = (240 * np.arange(239)[:, None] + np.arange(239)).reshape(-1, 1)
    triangles = np.concatenate([corner + (0, 1, 241), corner + (0, 241, 240)])
    sheet = viewer.add(
        Surface(vertices, triangles, np.tile((0.0, 0.0, 1.0), (len(vertices), 1))), name="sheet"
    )
    assert wait(lambda: tab.evaluate(LEVELS) == {"few": False, "all": True})
    tab.evaluate(DRAWN)

    def rests() -> bool:
        tab.evaluate("window.frames_ = 0")
        tab.wait_for_timeout(2500)
        return tab.evaluate("window.frames_") == 0

    assert wait(rests)  # a heavy picture that is there is not drawn again

    def moved() -> bool:
        sheet.position = sheet.position + (0.0, 0.0, 0.01)
        return tab.evaluate(LEVELS) == {"few": True, "all": False}

    assert wait(moved)
    assert wait(lambda: tab.evaluate(LEVELS) == {"few": False, "all": True})
    viewer.remove(sheet)
    assert wait(lambda: not has(tab, "/sheet"))


def test_a_tab_comes_back_to_the_next_program(chromium: Any) -> None:
    port = free_port()
    context = chromium.new_context(viewport=SIZE)
    tab = context.new_page()
    with Viewer(port=port, browser=False, title="one") as first:
        first.sphere(0.1, name="first")
        tab.goto(f"{first.url}/?fixedDpr=1")
        assert wait(lambda: has(tab, "/first"))
    with Viewer(port=port, browser=False, title="two") as second:
        second.sphere(0.1, name="second")
        assert second.url == first.url
        assert wait(lambda: has(tab, "/second") and not has(tab, "/first"))
        assert wait(lambda: tab.title() == "two · Ulna")
    context.close()
