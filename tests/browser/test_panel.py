"""Controls of the panel in a real browser: they change and go while somebody looks, and what is out of use stays still."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from support.patience import patient
from ulna.viewer.progress import progress
from ulna.viewer.viewer import Viewer

pytestmark = pytest.mark.browser


wait = patient()


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    with Viewer(port=0, browser=False) as viewer:
        yield viewer


@pytest.fixture(scope="module")
def tab(viewer: Viewer, chromium: Any) -> Iterator[Any]:
    context = chromium.new_context(viewport={"width": 900, "height": 900})
    tab = context.new_page()
    tab.goto(f"{viewer.url}/?fixedDpr=1")
    assert wait(lambda: tab.evaluate("() => !!window.__viserMutable?.messageQueue?.ulna"))
    yield tab
    context.close()


def test_a_slider_gets_other_limits_and_words(viewer: Viewer, tab: Any) -> None:
    heard: list[float] = []
    slider = viewer.panel.slider("gain", 0.0, 1.0, 0.5, heard.append, step=0.1)
    shown = tab.get_by_role("slider").first
    state = lambda: [float(shown.get_attribute(f"aria-value{part}")) for part in ("min", "now", "max")]  # noqa: E731
    assert wait(lambda: tab.get_by_text("gain").count() == 1)
    assert wait(lambda: state() == [0.0, 0.5, 1.0])
    slider.limits, slider.label, slider.unit = (10.0, 20.0), "force", "N"
    assert wait(lambda: state() == [10.0, 10.0, 20.0])
    assert wait(lambda: tab.get_by_text("force [N]").count() == 1 and tab.get_by_text("gain").count() == 0)
    assert heard == []  # the program did that itself
    slider.step = 2.0
    mark = viewer.panel.text("the step is there")  # messages arrive in order
    assert wait(lambda: tab.get_by_text("the step is there").count() == 1)
    shown.focus()
    shown.press("ArrowRight")
    assert wait(lambda: slider.value == 12.0 and heard == [12.0])
    slider.remove()
    mark.remove()
    assert wait(lambda: tab.get_by_role("slider").count() == 0)


def test_controls_are_hidden_and_out_of_use(viewer: Viewer, tab: Any) -> None:
    heard: list[Any] = []
    button = viewer.panel.button("press me", lambda: heard.append("pressed"))
    box = viewer.panel.checkbox("tick me", False, heard.append)
    shown = tab.get_by_role("button", name="press me")
    assert wait(lambda: shown.count() == 1 and shown.is_enabled())
    button.disabled = box.disabled = True
    assert wait(lambda: shown.is_disabled() and tab.get_by_label("tick me").is_disabled())
    button.label, button.disabled = "now press", False
    shown = tab.get_by_role("button", name="now press")
    assert wait(lambda: shown.count() == 1 and shown.is_enabled())
    shown.click()
    assert wait(lambda: heard == ["pressed"] and button.value == 1)
    box.visible = False
    assert wait(lambda: not tab.get_by_text("tick me").is_visible())
    box.visible, box.disabled = True, False
    assert wait(lambda: tab.get_by_text("tick me").is_visible())
    tab.get_by_label("tick me").check()
    assert wait(lambda: box.value and heard == ["pressed", True])
    button.remove()
    box.remove()
    assert wait(lambda: shown.count() == 0 and tab.get_by_text("tick me").count() == 0)


def test_boxes_and_menus_get_other_choices(viewer: Viewer, tab: Any) -> None:
    heard: list[Any] = []
    way = viewer.panel.radio("way", ("left", "right"), "right", heard.append)
    menu = viewer.panel.select("mode", ("slow", "fast"), "fast", heard.append)
    row = viewer.panel.buttons("go", ("home", "park"), heard.append)
    assert wait(lambda: tab.get_by_label("right").is_checked())
    way.options, way.label = ("up", "down"), "other way"
    assert wait(lambda: tab.get_by_label("left").count() == 0 and tab.get_by_label("up").is_checked())
    assert wait(lambda: tab.get_by_text("other way").count() == 1)
    tab.get_by_label("down").check()
    assert wait(lambda: way.value == "down" and heard == ["down"])
    menu.options = ("walk", "run")
    field = tab.get_by_role("textbox", name="mode").or_(tab.get_by_role("combobox")).first
    assert wait(lambda: field.input_value() == "walk")
    row.options, row.label = ("start", "stop"), "machine"
    assert wait(lambda: tab.get_by_text("stop", exact=True).count() >= 1)
    tab.get_by_text("stop", exact=True).first.click()
    assert wait(lambda: row.value == "stop" and heard[-1] == "stop")
    for control in (way, menu, row):
        control.remove()
    assert wait(lambda: tab.get_by_text("machine").count() == 0 and tab.get_by_label("down").count() == 0)


def test_a_folder_goes_with_all_within(viewer: Viewer, tab: Any) -> None:
    with viewer.panel.folder("settings") as folder:
        viewer.panel.text("words within")
        viewer.panel.plot("speed", ("v",)).add(0.0, 1.0)
    assert wait(lambda: tab.get_by_text("words within").count() == 1)
    folder.label = "more settings"
    assert wait(lambda: tab.get_by_text("more settings").count() == 1)
    folder.visible = False
    assert wait(lambda: not tab.get_by_text("words within").is_visible())
    folder.visible = True
    assert wait(lambda: tab.get_by_text("words within").is_visible())
    folder.remove()
    assert wait(lambda: tab.get_by_text("words within").count() == 0)


def test_long_work_is_shown_and_gone_when_it_is_done(viewer: Viewer, tab: Any) -> None:
    with progress("Loading something") as report:
        assert wait(lambda: tab.get_by_text("Loading something").count() == 1)
        report(3, 7)
        assert wait(lambda: tab.get_by_text("3 of 7").count() == 1)
    assert wait(lambda: tab.get_by_text("Loading something").count() == 0)


def test_the_panel_shows_no_address_and_no_switches_for_developers(chromium: Any) -> None:
    with Viewer(port=0, browser=False) as viewer:
        viewer.box((1, 1, 1))
        context = chromium.new_context(viewport={"width": 900, "height": 900})
        tab = context.new_page()
        tab.goto(f"{viewer.url}/?fixedDpr=1")
        assert wait(lambda: tab.get_by_text("Save Canvas").is_visible())
        for words in ("Dev Settings", "Orbit Origin Tool"):
            assert tab.get_by_text(words).count() == 1  # viser has it
            assert not tab.get_by_text(words).is_visible()
        address = tab.locator(f"input[value*='{viewer.url.rpartition('/')[2]}']")
        assert address.count() == 1
        assert not address.is_visible()
        text = viewer.panel.text("words")
        assert wait(lambda: tab.get_by_text("words", exact=True).count() == 1)
        text.remove()
        context.close()
