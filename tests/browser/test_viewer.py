"""The viewer in a real browser: every kind of thing appears and changes, controls work, files play offline."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna.geometry import Box
from ulna.sim import Recording
from ulna.viewer.viewer import Viewer

pytestmark = pytest.mark.browser
SIZE = {"width": 640, "height": 400}  # drawn by the processor here, so small


wait = patient()


class Tab:
    """A tab that looks at an address."""

    def __init__(self, chromium: Any, url: str) -> None:
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.context = chromium.new_context(viewport=SIZE)
        self.page = self.context.new_page()
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.on("pageerror", lambda e: self.errors.append(str(e)))
        self.page.goto(url)

    def has(self, path: str) -> bool:
        return bool(self.page.evaluate("n => !!window.__viserMutable?.nodeRefFromName[n]", path))

    def place(self, path: str) -> np.ndarray:
        """Where the browser has a node; nan while it does not."""
        script = "n => window.__viserMutable?.nodeRefFromName[n]?.position.toArray() ?? [NaN, NaN, NaN]"
        return np.array(self.page.evaluate(script, path), dtype=float)

    def look(self, path: str) -> dict[str, Any]:
        """Colour, opacity, scale and visibility of the first mesh of a node."""
        return self.page.evaluate(
            """n => { const node = window.__viserMutable?.nodeRefFromName[n]; let found = null;
                node?.traverse(o => { if (!found && o.material && o.material.color) found = o; });
                return found && {color: found.material.color.toArray(), opacity: found.material.opacity,
                    scale: node.scale.x, visible: node.visible}; }""",
            path,
        )

    def close(self) -> None:
        self.context.close()


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def viewer(panda: ulna.Robot) -> Iterator[Viewer]:
    with Viewer(port=0, browser=False) as viewer:
        viewer.add(panda, "qr")
        yield viewer


@pytest.fixture(scope="module")
def tab(viewer: Viewer, chromium: Any) -> Iterator[Tab]:
    tab = Tab(chromium, f"{viewer.url}/?fixedDpr=1")
    assert wait(lambda: tab.has("/panda/panda_hand"))
    yield tab
    tab.close()


def test_every_kind_of_thing_appears_where_it_is_put(viewer: Viewer, tab: Tab) -> None:
    at = lambda k: ulna.SE3.trans(0.1 * k, 0.5, 0.2)  # noqa: E731
    made = [
        viewer.box((0.1, 0.1, 0.1), name="kinds/box", pose=at(0)),
        viewer.sphere(0.05, name="kinds/sphere", pose=at(1)),
        viewer.cylinder(0.05, 0.1, name="kinds/cylinder", pose=at(2)),
        viewer.capsule(0.05, 0.1, name="kinds/capsule", pose=at(3)),
        viewer.cone(0.05, 0.1, name="kinds/cone", pose=at(4)),
        viewer.axes(name="kinds/axes", pose=at(5)),
        viewer.line([(0, 0, 0), (0, 0, 1)], name="kinds/line", pose=at(6)),
        viewer.points(np.zeros((4, 3)), name="kinds/points", pose=at(7)),
        viewer.copies(Box((0.1, 0.1, 0.1)), positions=np.eye(3), name="kinds/copies", pose=at(8)),
        viewer.grid(name="kinds/grid", pose=at(9)),
    ]
    for handle in made:
        path = f"/{handle.name}"
        assert wait(lambda p=path: tab.has(p)), path
        assert wait(lambda p=path, h=handle: np.abs(tab.place(p) - h.position).max() < 1e-5), path
    viewer["kinds"].pose = ulna.SE3.trans(0, 0, 1)
    assert wait(lambda: abs(tab.place("/kinds/points")[2] - 1.2) < 1e-5)
    viewer.remove("kinds")
    assert wait(lambda: not tab.has("/kinds/box"))
    assert tab.errors == []


def test_looks_change_in_the_browser_and_back(viewer: Viewer, tab: Tab) -> None:
    path = "/panda/panda_hand"
    plain = tab.look(path)
    arm = viewer["panda"]
    arm.color, arm.opacity, arm.scale = (1.0, 0.0, 0.0), 0.5, 1.5
    assert wait(lambda: abs(tab.look(path)["opacity"] - 0.5) < 1e-6)
    look = tab.look(path)
    assert look["color"][0] > 0.5
    assert look["color"][1] < 0.1
    assert look["scale"] == 1.5
    arm.visible = False
    assert wait(lambda: not tab.look(path)["visible"])
    arm.color, arm.opacity, arm.scale, arm.visible = None, 1.0, 1.0, True
    assert wait(lambda: tab.look(path) == plain), (tab.look(path), plain)


def test_a_texture_is_drawn_and_a_colour_hides_it(viewer: Viewer, tab: Tab, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    Image = pytest.importorskip("PIL.Image")
    Image.new("RGB", (4, 4), (255, 0, 0)).save(tmp_path / "red.png")
    (tmp_path / "a.mtl").write_text("newmtl m\nmap_Kd red.png\n")
    (tmp_path / "a.obj").write_text(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"
    )
    thing = viewer.mesh(tmp_path / "a.obj", name="textured")
    mapped = """() => { let map = null; window.__viserMutable.nodeRefFromName["/textured"]?.traverse(
        o => { if (o.material?.map) map = [o.material.map.image.width, o.material.map.image.height]; }); return map; }"""
    assert wait(lambda: tab.page.evaluate(mapped) == [4, 4])
    thing.color = (0, 0, 1)
    assert wait(lambda: tab.page.evaluate(mapped) is None)
    thing.color = None
    assert wait(lambda: tab.page.evaluate(mapped) == [4, 4])
    thing.remove()


def test_a_newcomer_sees_looks_too(viewer: Viewer, chromium: Any) -> None:
    ball = viewer.sphere(0.1, name="ball")
    ball.opacity = 0.25
    newcomer = Tab(chromium, f"{viewer.url}/?fixedDpr=1")
    try:
        assert wait(lambda: (look := newcomer.look("/ball")) and abs(look["opacity"] - 0.25) < 1e-6)
    finally:
        newcomer.close()
        ball.remove()


@pytest.fixture
def shown(chromium: Any) -> Iterator[tuple[Viewer, Any]]:
    """A viewer and its page for one attempt of a test: in a shared one the next attempt would find what this one left."""
    with Viewer(port=0, browser=False) as viewer:
        tab = Tab(chromium, f"{viewer.url}/?fixedDpr=1")
        yield viewer, tab.page
        tab.close()


def test_controls_call_and_are_set(shown: tuple[Viewer, Any]) -> None:
    said: list[Any] = []
    viewer, page = shown
    panel = viewer.panel
    slider = panel.slider("gain", 0.0, 1.0, 0.5, said.append, step=0.1)
    panel.button("press me", lambda: said.append("pressed"))
    radio = panel.radio("way", ("left", "right"), "left", said.append)
    box = panel.checkbox("tick me", False, said.append)
    menu = panel.select("mode", ("slow", "fast"), "fast", said.append)
    panel.number("mass", 2.5, said.append, unit="kg")
    assert menu.value == "fast"
    panel.buttons("many", tuple("abcdefgh"), said.append)
    plot = panel.plot("speed", ("v",))
    plot.add(0.0, 1.0)
    words = panel.text("some words")
    assert wait(lambda: page.get_by_text("some words").count() > 0)  # all of it is there before it is used
    page.get_by_role("button", name="press me").click()
    assert wait(lambda: "pressed" in said)
    page.get_by_label("right").check()
    assert wait(lambda: radio.value == "right" and "right" in said)
    assert wait(lambda: not page.get_by_label("left").is_checked())
    page.get_by_label("tick me").check()
    assert wait(lambda: box.value is True and True in said)
    page.get_by_role("button", name="Go").click()
    assert wait(lambda: "a" in said)
    handle = page.get_by_role("slider").first
    handle.focus()
    handle.press("ArrowRight")
    assert wait(lambda: abs(slider.value - 0.6) < 1e-9)
    slider.value = 0.9
    assert wait(lambda: abs(float(handle.get_attribute("aria-valuenow")) - 0.9) < 1e-9)
    words.value = "other words"
    assert wait(lambda: page.get_by_text("other words").count() > 0)


def test_a_simulation_is_paused_and_scrubbed(panda: ulna.Robot, chromium: Any) -> None:
    with Viewer(port=0, browser=False) as viewer:
        arm = viewer.add(panda, "qr")
        sim = viewer.simulate(realtime=False)
        arm.qd = [0.5, 0, 0, 0, 0, 0, 0]
        sim.run(1.0, 0.05)
        tab = Tab(chromium, f"{viewer.url}/?fixedDpr=1")
        try:
            end = panda.fk(arm.q, "panda_hand")[:3, 3]
            assert wait(lambda: np.abs(tab.place("/panda/panda_hand") - end).max() < 1e-5)
            slider = tab.page.get_by_role("slider").first
            assert wait(lambda: abs(float(slider.get_attribute("aria-valuemax")) - 1.0) < 1e-6)
            slider.focus()
            slider.press("Home")
            start = panda.fk(panda.configurations["qr"], "panda_hand")[:3, 3]
            assert wait(lambda: np.abs(tab.place("/panda/panda_hand") - start).max() < 1e-5)
            tab.page.get_by_role("button", name="Play / pause").click()
            assert wait(lambda: np.abs(tab.place("/panda/panda_hand") - end).max() < 1e-5)
        finally:
            tab.close()


def test_an_html_file_plays_offline(panda: ulna.Robot, chromium: Any, tmp_path: Path) -> None:
    viewer, recording = Viewer(page=False), Recording()
    arm = viewer.add(panda, "qr")
    arm.color = (0.0, 0.0, 1.0)
    q = panda.configurations["qr"]
    angles = np.linspace(0.0, 2.0, 121)
    for t, angle in zip(
        0.5 * np.arange(121), angles, strict=True
    ):  # a minute: a busy machine draws a picture in seconds
        recording.add(t, q + [angle, 0, 0, 0, 0, 0, 0])
    path = viewer.html(tmp_path / "film.html", recording, fps=2.0)
    tab = Tab(chromium, "about:blank")
    tab.context.set_offline(True)
    tab.page.goto(path.as_uri())
    try:
        hand = "/panda/panda_hand"
        assert wait(lambda: tab.has(hand))
        seen: set[int] = set()
        ways = [panda.fk(q + [angle, 0, 0, 0, 0, 0, 0], "panda_hand")[:3, 3] for angle in angles]

        def passes() -> bool:
            distance = np.linalg.norm(np.array(ways) - tab.place(hand), axis=1)
            if distance.min() < 1e-4:
                seen.add(int(distance.argmin()))
            return len(seen) >= 3

        assert wait(passes), seen  # it moves along its way, and nowhere else
        look = tab.look(hand)
        assert look["color"][2] > 0.5 > look["color"][0]
        assert all(u.startswith(("file:", "blob:", "data:", "about:")) for u in tab.requests), tab.requests
        assert tab.errors == []
        assert tab.page.locator(".mantine-Slider-root").count() == 1  # the time line
    finally:
        tab.close()


def test_on_a_network_the_page_asks_for_its_token(panda: ulna.Robot, chromium: Any) -> None:
    with pytest.warns(UserWarning, match="open to the network"):
        viewer = Viewer(port=0, host="0.0.0.0", browser=False)
    with viewer:
        viewer.add(panda, "qr")
        assert "token=" in viewer.url
        bare = viewer.url.partition("/?")[0]
        stranger = Tab(chromium, bare)
        assert wait(lambda: "token" in stranger.page.content())
        assert not stranger.has("/panda/panda_hand")
        stranger.close()
        friend = Tab(chromium, viewer.url)
        try:
            assert wait(lambda: friend.has("/panda/panda_hand"))
            friend.page.goto(bare)  # the cookie remembers
            assert wait(lambda: friend.has("/panda/panda_hand"))
        finally:
            friend.close()
