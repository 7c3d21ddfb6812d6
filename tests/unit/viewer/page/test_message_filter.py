"""Hostile messages with valid ids: the server survives, functions of the user see valid values only."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

import msgspec
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

import ulna
from support.patience import patient
from ulna.viewer import Viewer
from ulna.viewer.page import ending

wait = patient()
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1.0, 1.0, 1.0],
    "fov": 1.0,
    "near": 0.01,
    "far": 100.0,
    "image_height": 100,
    "image_width": 100,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}
PAYLOADS: list[Any] = [
    None, True, False, 0, 1, -1, 7, 2**63 - 1, -(2**63), 0.5, math.nan, math.inf, -math.inf, 1e300, -1e300, 5e-324,
    "", "nan", "inf", "1", "red", "green", "open", "x" * 70_000, b"\0\xff", [], [0.5], [math.nan] * 3, [[0.0]], {},
    {"value": 1.0}, [1e308] * 4, ["a", "b"], [None] * 3, [0.0, 0.0, 0.0, 0.0],
]  # fmt: skip


class Tab:
    """A program that speaks as the page in a browser does."""

    def __init__(self, viewer: Viewer) -> None:
        self._address = viewer.url.replace("http", "ws")
        self._open()

    def _open(self) -> None:
        protocol: Any = f"viser-v{viser.__version__}"
        self.socket = connect(self._address, subprotocols=[protocol], max_size=None)
        self.send(CAMERA)

    def send(self, message: Any) -> None:
        """Send a message; a connection that the server has closed is opened again."""
        try:
            self.socket.send(msgspec.msgpack.encode(message))
        except ConnectionClosed:
            self._open()

    def update(self, control: Any, updates: Any) -> None:
        """Change a control, as moving a slider does."""
        self.send({"type": "GuiUpdateMessage", "uuid": control._handle._impl.uuid, "updates": updates})


class Panel:
    """One control of each kind, and what their functions were called with."""

    def __init__(self, viewer: Viewer) -> None:
        self.calls: dict[str, list[Any]] = {
            name: [] for name in ("slider", "number", "checkbox", "select", "radio", "button", "buttons")
        }
        panel = viewer.panel
        self.slider = panel.slider("force", 0.0, 40.0, 10.0, self.calls["slider"].append)
        self.number = panel.number("mass", 1.0, self.calls["number"].append)
        self.checkbox = panel.checkbox("on", False, self.calls["checkbox"].append)
        self.select = panel.select("colour", ("red", "green"), None, self.calls["select"].append)
        self.radio = panel.radio("state", ("open", "closed"), None, self.calls["radio"].append)
        self.button = panel.button("go", lambda: self.calls["button"].append(None))
        self.buttons = panel.buttons("row", ("a", "b"), self.calls["buttons"].append)
        self.controls = [self.slider, self.number, self.checkbox, self.select, self.button, self.buttons]

    def check(self) -> None:
        assert all(type(x) is float and 0.0 <= x <= 40.0 for x in self.calls["slider"])
        assert all(type(x) is float and math.isfinite(x) for x in self.calls["number"])
        assert all(type(x) is bool for x in self.calls["checkbox"])
        assert set(self.calls["select"]) <= {"red", "green"}
        assert set(self.calls["radio"]) <= {"open", "closed"}
        assert set(self.calls["buttons"]) <= {"a", "b"}
        assert 0.0 <= self.slider.value <= 40.0
        assert math.isfinite(self.number.value)
        assert self.select.value in ("red", "green")
        assert (self.slider.limits, self.slider.visible, self.slider.disabled) == ((0.0, 40.0), True, False)
        assert self.select.options == ("red", "green")


@pytest.fixture
def viewer(monkeypatch: pytest.MonkeyPatch) -> Iterator[Viewer]:
    monkeypatch.setattr(ending, "_DELIVERY_TIME", 0.0)  # the tabs here never answer
    viewer = Viewer(port=0, browser=False)
    yield viewer
    viewer.close()


def test_valid_messages_reach_the_functions(viewer: Viewer) -> None:
    panel, tab = Panel(viewer), Tab(viewer)
    for control, value in zip(panel.controls, (25, -3.5, True, "green", True, "b"), strict=True):
        tab.update(control, {"value": value})
    called = ("slider", "number", "checkbox", "select", "button", "buttons")
    assert wait(lambda: all(panel.calls[name] for name in called)), panel.calls
    assert panel.calls["slider"] == [25.0] and panel.calls["number"] == [-3.5]
    assert panel.calls["select"] == ["green"] and panel.calls["buttons"] == ["b"]
    panel.check()


def test_values_that_no_page_sends_reach_no_function(viewer: Viewer) -> None:
    panel, tab = Panel(viewer), Tab(viewer)
    hostile: list[tuple[Any, Any]] = [
        (panel.slider, {"value": "nan"}),
        (panel.slider, {"value": math.nan}),
        (panel.slider, {"value": 41.0}),
        (panel.slider, {"value": 1e300}),
        (panel.slider, {"value": True}),
        (panel.slider, {"value": [1.0]}),
        (panel.slider, {"removed": True}),
        (panel.slider, {"update_cb": [], "value": 1.0}),
        (panel.slider, ["value"]),
        (panel.number, {"value": math.inf}),
        (panel.number, {"value": 2**63}),
        (panel.number, {"value": "12"}),
        (panel.checkbox, {"value": "False"}),
        (panel.select, {"value": "blue"}),
        (panel.select, {"value": 3}),
        (panel.button, {"value": "pressed"}),
        (panel.buttons, {"value": "c"}),
        (panel.buttons, {"is_button": False}),
    ]
    for control, updates in hostile:
        tab.update(control, updates)
    tab.update(panel.slider, {"value": 12.0})
    assert wait(lambda: panel.calls["slider"] == [12.0]), panel.calls
    panel.check()
    assert panel.calls["number"] == [2.0**63]
    assert not any(panel.calls[name] for name in ("checkbox", "select", "radio", "button", "buttons"))


def test_a_target_is_not_dragged_to_what_is_no_pose(viewer: Viewer) -> None:
    arm = viewer.add(ulna.load("panda", visuals="simple"), q="qr")
    teach_panel, tab = viewer.teach_panel(arm), Tab(viewer)
    before, name = teach_panel.gizmo.pose, teach_panel.gizmo._handle.name
    for position in ([math.nan] * 3, [math.inf, 0, 0], [1e200, 0, 0], ["nan"] * 3, [0.0]):
        tab.send(
            {"type": "TransformControlsUpdateMessage", "name": name, "owner": "", "wxyz": [1, 0, 0, 0]}
            | {"position": position}
        )
    for wxyz in ([0, 0, 0, 0], [math.nan] * 4, [1e200, 0, 0, 0], [1, 0, 0], "abcd"):
        tab.send(
            {"type": "TransformControlsUpdateMessage", "name": name, "owner": "", "position": [0, 0, 0]}
            | {"wxyz": wxyz}
        )
    panel, last = Panel(viewer), Tab(viewer)  # viser closes the connection of what it cannot decode
    last.update(panel.slider, {"value": 3.0})
    assert wait(lambda: panel.calls["slider"] == [3.0])
    assert teach_panel.goal is None
    np.testing.assert_allclose(teach_panel.gizmo.pose, before, atol=1e-6)


def test_clicks_on_nodes_reach_functions_where_they_are_rays(viewer: Viewer) -> None:
    viewer.box([0.1, 0.1, 0.1], name="box")  # so that the scene is there
    assert viewer._page is not None
    clicked: list[Any] = []
    box = viewer._page.server.scene.add_box("/clicked", dimensions=(0.1, 0.1, 0.1))
    box.on_click(lambda event: clicked.append(event.ray_origin))
    tab = Tab(viewer)
    click = {
        "type": "SceneNodeClickMessage",
        "name": "/clicked",
        "instance_index": None,
        "modifier": None,
        "owner": "",
    }
    place = {"ray_origin": [0.0, 0.0, 1.0], "ray_direction": [0.0, 0.0, -1.0], "screen_pos": [0.5, 0.5]}
    for wrong in (
        {"ray_origin": [math.nan] * 3},
        {"ray_direction": [1e200, 0, 0]},
        {"screen_pos": [math.inf, 0.5]},
    ):
        tab.send(click | place | wrong)
    tab.send(click | place)
    assert wait(lambda: len(clicked) > 0)
    assert [list(origin) for origin in clicked] == [[0.0, 0.0, 1.0]]


def _hostile_message(random_: random.Random, identities: list[str], names: list[str]) -> Any:
    kind = random_.randrange(10)
    if kind < 6:
        keys = [
            "value",
            "value",
            "min",
            "max",
            "options",
            "visible",
            "removed",
            "update_cb",
            "props",
            "uuid",
            "x",
        ]
        updates: Any = {
            random_.choice(keys): random_.choice(PAYLOADS) for _ in range(random_.choice((1, 1, 2, 5)))
        }
        updates = random_.choice((updates, updates, updates, random_.choice(PAYLOADS)))
        return {"type": "GuiUpdateMessage", "uuid": random_.choice(identities), "updates": updates}
    if kind < 8:
        vectors = (random_.choice(PAYLOADS), random_.choice(PAYLOADS))
        fields = {"name": random_.choice(names), "owner": "", "wxyz": vectors[0], "position": vectors[1]}
        return {"type": "TransformControlsUpdateMessage"} | fields
    if kind < 9:
        others = [
            "FileTransferStartUpload",
            "GuiFormSubmitMessage",
            "CommandTriggerMessage",
            "ScenePointerMessage",
        ]
        fields = {"uuid": random_.choice(identities), "source_component_uuid": random_.choice(identities)}
        return {"type": random_.choice(others), "part_count": 2**40, "size_bytes": 2**50} | fields
    return random_.choice(
        [{"type": "NoSuchMessage"}, {"type": 5}, CAMERA | {"position": random_.choice(PAYLOADS)}]
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
@pytest.mark.parametrize("seed", range(2))
def test_any_payload_is_survived(viewer: Viewer, seed: int) -> None:
    arm = viewer.add(ulna.load("panda", visuals="simple"), q="qr")
    teach_panel, panel, tab = viewer.teach_panel(arm), Panel(viewer), Tab(viewer)
    controls = [*panel.controls, *teach_panel.sliders]
    identities = [c._handle._impl.uuid for c in controls]
    random_ = random.Random(seed)
    for _ in range(600):
        tab.send(_hostile_message(random_, identities, [teach_panel.gizmo._handle.name, "/(page)/key"]))
    last = Tab(viewer)
    target = 7.0 if panel.slider.value != 7.0 else 8.0
    last.update(panel.slider, {"value": target})
    assert wait(lambda: panel.calls["slider"][-1:] == [target])
    panel.check()
    limits = arm.robot.limits
    assert np.isfinite(arm.q).all() and (arm.q >= limits.lower).all() and (arm.q <= limits.upper).all()
    assert viewer.clients >= 1 and not viewer.closed
