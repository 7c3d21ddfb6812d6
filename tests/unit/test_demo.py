"""First motion: the numbers recorded with the Robotics Toolbox and Swift, and a picture to look at."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import demo as demo_module
from ulna.demo import demo, servo
from ulna.spatial import SE3

# Robotics Toolbox 1.5.0 with Swift 2.1.0, headless: gain 1, threshold 0.01, steps of 0.01 s
STEPS = 431
FINAL_Q = [
    -0.2146009353914437,
    0.8461450364946989,
    -0.07430635499818788,
    -1.446805639781611,
    0.11869983928082116,
    2.384906768370784,
    0.44162635248722576,
]
AFTER_ONE = [
    -0.001473868526216757,
    -0.29159686971350146,
    -0.0025235005688773672,
    -2.2003272082902248,
    -0.00038953243259015635,
    2.0087303385767235,
    0.7816205621976252,
]
AFTER_HUNDRED = [
    -0.11661037391919761,
    0.3798429806474609,
    -0.09099276707929453,
    -1.9122458789599093,
    0.07755581250704731,
    2.3873544554033512,
    0.5319686810118566,
]


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def goal_of(panda: ulna.Robot) -> np.ndarray:
    return panda.fk(panda.configurations["qr"]) @ SE3.trans(0.2, 0.2, 0.35).matrix()


def test_the_motion_is_the_recorded_one(panda: ulna.Robot) -> None:
    result = servo(panda, panda.configurations["qr"], goal_of(panda))
    assert result.arrived
    assert result.steps == STEPS
    q = result.recording["q"]
    np.testing.assert_allclose(q[0], AFTER_ONE, atol=1e-12)
    np.testing.assert_allclose(q[99], AFTER_HUNDRED, atol=1e-12)
    np.testing.assert_allclose(result.q, FINAL_Q, atol=1e-12)
    assert result.error == pytest.approx(0.009873547103645802, abs=1e-12)
    assert np.abs(result.recording["v"]).max() == pytest.approx(0.8730338576723322, abs=1e-12)
    assert np.linalg.norm(panda.fk(result.q)[:3, 3] - result.goal[:3, 3]) == pytest.approx(0.0059106064940658)


def test_each_step_can_be_watched_and_stopped(panda: ulna.Robot) -> None:
    times = []

    def watch(t: float, q: np.ndarray) -> bool:
        times.append(t)
        return len(times) < 5

    result = servo(panda, panda.configurations["qr"], goal_of(panda), each_step=watch)
    assert not result.arrived
    np.testing.assert_allclose(times, [0.01, 0.02, 0.03, 0.04, 0.05])


def test_the_search_for_a_goal_out_of_reach_ends(panda: ulna.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo_module, "_MAX_MOTION_TIME", 0.5)
    far = goal_of(panda)
    far[0, 3] += 5
    assert not servo(panda, panda.configurations["qr"], far).arrived


def test_headless_it_reports_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = demo(headless=True, size=(160, 100))
    assert result.steps == STEPS
    said = capsys.readouterr().out
    for words in (
        "reached after 431 steps",
        "4.31 s",
        "5.91 mm",
        "-0.2146",
        "panda_hand_tcp",
        "ulna-demo.png",
    ):
        assert words in said
    assert (tmp_path / "ulna-demo.png").read_bytes().startswith(b"\x89PNG")


def test_without_a_screen_it_is_headless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ULNA_HEADLESS", "1")
    demo(output=str(tmp_path / "a.png"), size=(80, 50))
    assert (tmp_path / "a.png").is_file()


def test_without_viser_it_goes_on_without_a_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "viser", None)
    demo(headless=False, output=str(tmp_path / "a.png"), size=(80, 50))
    assert "pip install 'viser<" in capsys.readouterr().out
    assert (tmp_path / "a.png").is_file()


def test_the_cost_of_a_step_excludes_compilation(panda: ulna.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """The report said 364 us, most of which was the first call."""
    original, calls, now = demo_module._step, [], [0.0]

    def step(*args: Any) -> Any:
        calls.append(args)
        now[0] += 0.5 if len(calls) == 1 else 1e-4
        return original(*args)

    monkeypatch.setattr(demo_module, "_step", step)
    monkeypatch.setattr(demo_module, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    result = servo(panda, panda.configurations["qr"], goal_of(panda))
    assert len(calls) == STEPS + 1
    assert result.seconds_a_step == pytest.approx(1e-4)


class Looked:
    """A page that a browser opens when it is asked for the third time."""

    url, port = "http://localhost:8123", 8123

    def __init__(self, interrupted: bool = False) -> None:
        self.asked, self.interrupted = 0, interrupted

    @property
    def clients(self) -> int:
        self.asked += 1
        if self.interrupted:
            raise KeyboardInterrupt
        return int(self.asked > 2)


@pytest.mark.parametrize("interrupted", [False, True])
def test_through_ssh_the_page_waits_at_its_address(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], interrupted: bool
) -> None:
    """Without a screen there was a picture only, while `ulna show` served its page."""
    pytest.importorskip("viser")
    monkeypatch.setattr("ulna.viewer.page.browser.has_screen", lambda: False)
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")
    monkeypatch.setattr(demo_module.time, "sleep", lambda seconds: None)
    assert demo_module._wait_for_browser(SimpleNamespace(page=Looked(interrupted))) is not interrupted
    words = capsys.readouterr().out
    assert "http://localhost:8123" in words
    assert "ssh -L 8123:localhost:8123" in words
    assert "--headless" in words


def test_at_a_terminal_without_a_screen_there_is_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("viser")
    monkeypatch.setattr("ulna.viewer.page.browser.somebody_can_look", lambda: True)
    monkeypatch.setattr("ulna.viewer.page.browser.open_browser", lambda url: False)
    waited = []
    monkeypatch.setattr(demo_module, "_wait_for_browser", lambda page: bool(waited.append(page.url)))
    result = demo(port=0)
    assert result.arrived
    assert waited[0].startswith("http://localhost:")
