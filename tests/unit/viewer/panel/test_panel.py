"""Controls of the panel change at run time, the same with a page and without."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, UnknownAttribute, UnknownName
from ulna.geometry import Box, Geometry
from ulna.viewer.panel.panel import Panel, ignore_value
from ulna.viewer.viewer import Viewer


@pytest.fixture(scope="module", params=["without a page", "with a page"])
def viewer(request: pytest.FixtureRequest) -> Iterator[Viewer]:
    if request.param == "with a page":
        pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
    with Viewer(port=0, browser=False, page=request.param == "with a page") as viewer:
        yield viewer


@pytest.fixture
def panel(viewer: Viewer) -> Panel:
    return viewer.panel


MAKERS: dict[str, Any] = {
    "slider": lambda p: p.slider("a", 0.0, 1.0, 0.5),
    "number": lambda p: p.number("a", 1.0),
    "checkbox": lambda p: p.checkbox("a"),
    "select": lambda p: p.select("a", ("x", "y")),
    "radio": lambda p: p.radio("a", ("x", "y")),
    "button": lambda p: p.button("a", lambda: None),
    "buttons": lambda p: p.buttons("a", ("x", "y"), ignore_value),
    "menu of buttons": lambda p: p.buttons("a", tuple("abcdefgh"), ignore_value),
    "plot": lambda p: p.plot("a", ("x", "y")),
    "text": lambda p: p.text("a"),
}


@pytest.mark.parametrize("kind", MAKERS)
def test_every_control_is_hidden_and_removed(panel: Panel, kind: str) -> None:
    control = MAKERS[kind](panel)
    assert control.visible and not control.removed
    control.visible = False
    assert not control.visible
    control.visible = True
    control.remove()
    control.remove()  # twice is no mistake
    assert control.removed
    with pytest.raises(InputError, match="was removed"):
        control.visible = False


@pytest.mark.parametrize("kind", [k for k in MAKERS if k != "text"])
def test_every_control_with_words_gets_others(panel: Panel, kind: str) -> None:
    control = MAKERS[kind](panel)
    assert control.label == "a"
    control.label = "b"
    assert control.label == "b"
    if kind not in ("plot", "buttons"):
        assert control._handle.label == "b"  # what the page shows
    control.remove()
    with pytest.raises(InputError, match="'b' was removed"):
        control.label = "c"
    assert control.label == "b"


@pytest.mark.parametrize("kind", ["slider", "number", "checkbox", "select", "radio", "button"])
def test_a_control_is_out_of_use_for_a_while(panel: Panel, kind: str) -> None:
    control = MAKERS[kind](panel)
    assert control.disabled is False
    control.disabled = True
    assert control.disabled is True
    control.disabled = False
    assert control.disabled is False
    control.remove()


@pytest.mark.parametrize("kind", MAKERS)
def test_what_a_control_does_not_have_is_refused(panel: Panel, kind: str) -> None:
    control = MAKERS[kind](panel)
    with pytest.raises(UnknownAttribute, match="Did you mean 'visible'"):
        control.visibel = False
    control.remove()


@pytest.mark.parametrize("step", [0.0, -1.0, np.nan])
def test_steps_of_a_slider_are_above_zero(panel: Panel, step: float) -> None:
    with pytest.raises(InputError, match="above zero"):
        panel.slider("a", 0.0, 1.0, step=step)


def test_limits_of_a_slider_change_and_its_value_stays_within(panel: Panel) -> None:
    slider = panel.slider("gain", 0.0, 1.0, 0.5, unit="N")
    assert slider.step == pytest.approx(0.001)
    slider.limits = (10, 20)
    assert (slider.low, slider.high, slider.limits, slider.value) == (10.0, 20.0, (10.0, 20.0), 10.0)
    assert slider.step == pytest.approx(0.01)  # as fine as it was
    slider.high, slider.low = 15.0, 12.0
    assert slider.value == 12.0
    slider.value = 99
    assert slider.value == 15.0
    slider.limits = (-3, -2)
    assert slider.value == -2.0
    slider.step = 0.25
    slider.limits = (0, 1)
    assert slider.step == 0.25  # it was chosen
    slider.limits = (0, 0.1)
    assert slider.step == pytest.approx(0.1)
    for limits in ((1, 1), (2, 1), (0, np.inf), (np.nan, 1)):
        with pytest.raises(InputError, match=r"expected (low < high|finite numbers)"):
            slider.limits = limits
    for step in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match="above zero"):
            slider.step = step
    with pytest.raises(InputError, match="finite"):
        slider.value = np.nan
    assert slider.limits == (0.0, 0.1)
    slider.unit = "kN"
    assert slider.unit == "kN" and slider._handle.label == "gain [kN]"
    slider.remove()


@pytest.mark.parametrize("kind", ["select", "radio"])
def test_choices_change_and_the_first_is_chosen_where_the_old_one_is_gone(panel: Panel, kind: str) -> None:
    choice = getattr(panel, kind)("way", ("a", "b", "c"), "b")
    choice.options = ("b", "d")
    assert choice.options == ("b", "d") and choice.value == "b"
    choice.options = ["e", "f"]
    assert choice.options == ("e", "f") and choice.value == "e"
    choice.value = "f"
    assert choice.value == "f"
    with pytest.raises(UnknownName, match="'e'"):
        choice.value = "E"
    with pytest.raises(InputError, match="at least one"):
        choice.options = ()
    with pytest.raises(InputError, match="each once"):
        choice.options = ("a", "a")
    assert choice.options == ("e", "f")
    choice.remove()


@pytest.mark.parametrize("options", [("a", "b"), tuple("abcdefgh")])
def test_buttons_get_other_choices(panel: Panel, options: tuple[str, ...]) -> None:
    row = panel.buttons("go", options, ignore_value)
    assert row.value == "" and row.options == options
    row.options = ("left", "right")
    assert row.options == ("left", "right")
    row.remove()


def test_a_folder_takes_all_within_along(panel: Panel) -> None:
    with panel.folder("outer") as outer:
        first = panel.slider("a", 0, 1)
        with panel.folder("inner"):
            second = panel.checkbox("b")
        third = panel.radio("c", ("x", "y"))
    after = panel.text("outside")
    outer.label = "other"
    outer.visible = False
    assert not outer.visible
    outer.remove()
    assert first.removed and second.removed and third.removed and not after.removed
    after.remove()


def test_a_teach_panel_is_removed_with_its_robot_and_alone(
    viewer: Viewer, capsys: pytest.CaptureFixture[str]
) -> None:
    if viewer.url == "":
        with pytest.raises(InputError, match="no page"):
            viewer.teach_panel(viewer.add(ulna.load("panda", visuals="simple")))
        return
    arm, other = (viewer.add(ulna.load("panda", visuals="simple"), "qr") for _ in range(2))
    panels = [viewer.teach_panel(robot) for robot in (arm, other)]
    arm.remove()
    due = time.monotonic() + 30.0
    while not panels[0].sliders[0].removed and time.monotonic() < due:
        time.sleep(0.02)
    assert panels[0].sliders[0].removed and not panels[1].sliders[0].removed
    panels[1].remove()
    panels[1].remove()
    assert panels[1].sliders[0].removed
    viewer.flush()
    assert capsys.readouterr().err == ""
    viewer.clear()


def test_the_axes_of_a_target_are_a_fifth_of_the_scene_wherever_it_lies(viewer: Viewer) -> None:
    if viewer.url == "":
        pytest.skip("targets are dragged in a page")
    rod = ulna.ModelBuilder("rod").add_link(
        "rod", ulna.Inertia.from_point(1.0), visuals=[Geometry("box", Box((0.1, 0.2, 1.5)))]
    )
    rod.add_link("end", ulna.Inertia.from_point(1.0))
    rod.add_joint("j", ulna.model.Revolute((0, 1, 0)), "rod", "end", lower=-1.0, upper=1.0)
    robot = ulna.Robot(rod.build())
    for pose in (np.zeros(3), np.array([7.0, 0.0, 0.0])):
        shown = viewer.add(robot, pose=pose)
        panel = viewer.teach_panel(shown)
        assert panel.gizmo._handle.scale == pytest.approx(0.3)
        panel.remove()
        viewer.clear()


def test_a_panel_whose_page_was_closed_keeps_what_it_is_given() -> None:
    pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
    viewer = Viewer(port=0, browser=False)
    made = {kind: make(viewer.panel) for kind, make in MAKERS.items()}
    viewer.close()
    made |= {f"late {kind}": make(viewer.panel) for kind, make in MAKERS.items()}
    for kind, control in made.items():
        control.visible = False
        if "text" not in kind:
            control.label = "b"
    for late in ("", "late "):
        made[f"{late}slider"].value, made[f"{late}number"].value = 0.75, 5.0
        made[f"{late}select"].options, made[f"{late}radio"].value = ("z",), "y"
        assert made[f"{late}slider"].value == 0.75 and made[f"{late}select"].value == "z"
        assert made[f"{late}radio"].value == "y" and made[f"{late}number"].label == "b"
    viewer.camera, viewer.theme = None, "dark"
    for control in made.values():
        control.remove()
