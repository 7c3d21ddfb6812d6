"""The time line: it runs, stops, is scrubbed, and pauses a simulation; its clock is set by hand here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError
from ulna.sim import Recording, Simulation
from ulna.viewer import Viewer
from ulna.viewer.panel import timeline as module
from ulna.viewer.panel.timeline import Timeline
from ulna.viewer.robot.handle_motion import recorded_motion

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")


class Bench:
    """A viewer with a page and one robot, a clock that is set by hand, and the functions that the page would call."""

    def __init__(self, viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        self.ticks: list[Callable[[], None]] = []
        self.page: Any = viewer._page
        self.robot = next(iter(viewer.robots), None) or viewer.add(ulna.load("ur5"))
        self.recording = Recording()
        monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: self.now))
        monkeypatch.setattr(self.page, "add_tick", self.ticks.append)

    def record(self, *times: float) -> None:
        for t in times:
            self.recording.add(t, np.full(6, t))

    def timeline(self, **options: Any) -> Timeline:
        return Timeline(self.page, lambda: [recorded_motion(self.robot, lambda: self.recording)], **options)

    def after(self, seconds: float) -> None:
        """Let time go by until the page calls again."""
        self.now += seconds
        self.ticks[-1]()


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    with Viewer(port=0, browser=False) as viewer:
        yield viewer


@pytest.fixture
def bench(viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(viewer, monkeypatch)


def test_it_runs_at_its_speed_stops_at_the_end_and_begins_again(bench: Bench) -> None:
    bench.record(0.0, 1.0)
    line = bench.timeline(speed=0.5)
    assert (line.time, line.duration, line.playing) == (0.0, 1.0, False)
    bench.after(0.4)
    assert line.time == 0.0  # at rest
    line.play()
    bench.after(0.4)
    assert line.time == pytest.approx(0.2)
    np.testing.assert_allclose(bench.robot.q, 0.2)
    assert line.playing
    line.play(2.0)
    bench.after(0.3)
    assert line.time == pytest.approx(0.8)
    bench.after(0.3)
    assert (line.time, line.playing) == (1.0, False)
    np.testing.assert_allclose(bench.robot.q, 1.0)
    line.play()
    assert (line.time, line.playing) == (0.0, True)
    bench.after(0.1)
    assert line.time == pytest.approx(0.2)
    line.pause()
    assert not line.playing
    bench.after(1.0)
    assert line.time == pytest.approx(0.2)


def test_the_time_is_kept_within_the_recording(bench: Bench) -> None:
    line = bench.timeline()
    assert line.duration == 0.0
    line.time = 3.0  # nothing is recorded yet
    assert line.time == 0.0
    bench.record(0.0, 2.0)
    for t, expected in ((3.0, 2.0), (-1.0, 0.0), (0.5, 0.5)):
        line.time = t
        assert line.time == expected
        np.testing.assert_allclose(bench.robot.q, expected)
    for speed in (0.0, -1.0, np.inf):
        with pytest.raises(InputError, match="above zero"):
            line.play(speed)
        with pytest.raises(InputError, match="above zero"):
            bench.timeline(speed=speed)


@pytest.mark.parametrize(
    ("speed", "chosen"), [(0.5, "0.5"), (1.0, "1"), (2.0, "2"), (3.0, "1"), (0.1, "0.1")]
)
def test_the_panel_offers_speeds(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, speed: float, chosen: str
) -> None:
    made = []
    original = module.Panel.select
    monkeypatch.setattr(
        module.Panel, "select", lambda self, *a, **k: made.append(original(self, *a, **k)) or made[-1]
    )
    line = bench.timeline(speed=speed)
    assert made[0].value == chosen
    assert tuple(made[0].options) == ("0.1", "0.25", "0.5", "1", "2", "5")
    bench.record(0.0, 9.0)
    line._set_speed("5")
    line.play()
    bench.after(0.2)
    assert line.time == pytest.approx(1.0)


def test_the_panel_shows_time_and_end_fifteen_times_a_second(bench: Bench) -> None:
    bench.record(0.0, 1.5)
    line = bench.timeline()
    bench.after(1.0)
    assert line._clock.value == "**0.00 s** of 1.50 s, at rest"
    assert (line._slider.value, line._slider.max) == (0.0, 1.5)
    line.play()
    bench.after(0.05)  # too early
    assert line._slider.value == 0.0
    bench.after(0.05)
    assert line._slider.value == 0.1
    assert line._clock.value == "**0.10 s** of 1.50 s, running"
    bench.record(2.0)
    bench.after(0.1)
    assert line._slider.max == 2.0


def test_scrubbing_pauses_and_the_button_runs_and_pauses(bench: Bench) -> None:
    bench.record(0.0, 2.0)
    line = bench.timeline()
    line._toggle()
    assert line.playing
    line._scrub(1.25)
    assert (line.time, line.playing) == (1.25, False)
    np.testing.assert_allclose(bench.robot.q, 1.25)
    line._toggle()
    line._toggle()
    assert not line.playing


def test_a_running_simulation_is_followed_paused_and_resumed(bench: Bench) -> None:
    simulation = Simulation(substep=0.1)
    body = simulation.add(ulna.load("ur5"))
    line = Timeline(bench.page, lambda: [recorded_motion(bench.robot, lambda: body.recording)], simulation)
    simulation.step(0.1)
    line.play()
    bench.after(0.01)
    assert (line.time, line.playing) == (pytest.approx(0.1), False)  # what is newest is shown
    bench.after(0.1)
    assert line._clock.value.endswith("running")
    line._toggle()
    assert simulation.paused
    bench.after(0.1)
    assert line._clock.value.endswith("at rest")
    line._toggle()
    assert not simulation.paused
    line._set_speed("0.25")
    assert simulation.speed == 0.25
    bench.after(0.51)  # no step for half a second: it is at rest, so its recording is played
    assert line._clock.value.endswith("at rest")
    line._toggle()
    assert line.playing and not simulation.paused
    line.pause()
    assert not simulation.paused  # what is not running need not be paused
    simulation.step(0.1)
    line.pause()
    assert simulation.paused
    line.play()
    assert not simulation.paused and not line.playing


def test_the_slider_of_the_page_scrubs(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    posted: list[Any] = []
    monkeypatch.setattr(
        bench.page, "post_event", lambda key, function, value: posted.append((function, value))
    )
    bench.record(0.0, 1.0)
    line = bench.timeline()
    (scrubbed,) = line._slider._impl.update_cb
    for client in (None, object()):  # a change of ours, and one of a tab
        coroutine = scrubbed(SimpleNamespace(client=client))
        with pytest.raises(StopIteration):
            coroutine.send(None)
    ((function, value),) = posted
    assert value == line._slider.value
    function(0.75)
    assert line.time == 0.75
