"""What a page keeps of a motion, and what the end of a program waits for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.viewer.page import ending, motion_log
from ulna.viewer.page.motion_log import MotionLog
from ulna.viewer.page.visits import Visits
from ulna.viewer.scene import Scene
from ulna.viewer.viewer import Viewer


def scene_with(*names: str) -> Scene:
    scene = Scene()
    for name in names:
        scene.add(name)
    return scene


def place(scene: Scene, name: str, x: float) -> None:
    scene.set_pose(name, (x, 0.0, 0.0))


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(motion_log, "time", SimpleNamespace(monotonic=lambda: clock.now))
    return clock


def test_simulated_steps_have_their_time_and_nodes_at_rest_are_left_out() -> None:
    scene, log, t = scene_with("moving", "standing"), MotionLog(), [0.0]
    log.follow_simulation(lambda: t[0])
    for k in range(101):
        t[0] = 0.01 * k
        place(scene, "moving", t[0])
        log.add_step(scene.snapshot)
    (part,) = log.parts({"moving": ["/moving"], "standing": ["/standing"]})
    assert part.paths == ["/moving"]
    assert np.allclose(part.t, 0.02 * np.arange(51), atol=1e-12)  # every second step: at most 60 in a second
    assert np.allclose(part.rows[:, 0, 0], part.t, atol=1e-7) and part.rows.shape == (51, 1, 7)


def test_the_last_step_counts_and_time_can_be_set_back() -> None:
    scene, log, t = scene_with("a"), MotionLog(), [0.0]
    log.follow_simulation(lambda: t[0])
    for time in (0.0, 0.1, 0.2, 0.205):
        t[0] = time
        place(scene, "a", time)
        log.add_step(scene.snapshot)
    assert [f.t for f in log.frames] == [0.0, 0.1, 0.2]
    log.add_step(scene.snapshot, at_end=True)
    assert [f.t for f in log.frames] == [0.0, 0.1, 0.2, 0.205]
    t[0] = 0.1
    log.add_step(scene.snapshot)
    assert [f.t for f in log.frames] == [0.0, 0.1] and log.frames[1].rows[0, 0] == np.float32(0.205)
    log.follow_simulation(lambda: t[0])
    assert log.frames == ()


def test_on_the_wall_clock_rests_are_short(clock: SimpleNamespace) -> None:
    scene, log = scene_with("a"), MotionLog()
    labels = []
    for passed in (0.0, 30.0, 0.5, 60.0, 0.5):
        clock.now += passed
        labels.append(log.add_published(scene.snapshot()))
    assert np.allclose(labels, [0.0, 0.1, 0.6, 1.6, 2.1])


def test_frames_close_together_are_one(clock: SimpleNamespace) -> None:
    scene, log = scene_with("a"), MotionLog()
    for k in range(101):
        place(scene, "a", 0.001 * k)
        log.add_published(scene.snapshot())
        clock.now += 0.001
    t = [f.t for f in log.frames]
    assert len(t) <= 8 and t[0] == 0.0 and abs(t[-1] - 0.1) < 1e-9
    assert log.frames[-1].rows[0, 0] == np.float32(0.1)  # the newest is there


def test_memory_is_bounded() -> None:
    scene, log, t = scene_with("a", "b"), MotionLog(capacity=56 * 1000), [0.0]
    log.follow_simulation(lambda: t[0])
    for k in range(5000):
        t[0] = 0.05 * k
        place(scene, "a", 0.001 * k)
        log.add_step(scene.snapshot)
    times = [f.t for f in log.frames]
    assert 300 < len(times) <= 1001 and times[0] == 0.0 and times == sorted(times)
    assert all(abs(f.rows[0, 0] - 0.02 * f.t) < 1e-6 for f in log.frames)  # what is left is true
    assert max(np.diff(times)) < 1.0


def test_things_that_come_and_go_make_parts() -> None:
    scene, log, t = scene_with("a"), MotionLog(), [0.0]
    log.follow_simulation(lambda: t[0])
    for k in range(4):
        t[0] = float(k)
        place(scene, "a", float(k))
        if k == 2:
            scene.add("b")
        log.add_step(scene.snapshot)
    one, two = log.parts({"a": ["/a", "/a 2"], "b": ["/b"]})
    assert (one.paths, one.t, two.paths, two.t) == (["/a", "/a 2"], [0.0, 1.0], ["/a", "/a 2"], [2.0, 3.0])
    assert log.parts({"b": ["/b"]}) == []


def test_a_simulation_that_is_shown_is_kept_and_a_motion_is_played_to_its_end() -> None:
    pytest.importorskip("viser")
    with Viewer(port=0, browser=False) as viewer:
        arm = viewer.add(ulna.load("panda", visuals="simple"), "qr")
        sim = viewer.simulate(realtime=False, control="velocity")
        arm.qd = [0.5, 0, 0, 0, 0, 0, 0]
        sim.run(1.0, dt=0.05)
        frames = viewer._page.motion.frames
        assert np.allclose([f.t for f in frames][-20:], 0.05 * np.arange(1, 21))
    with Viewer(port=0, browser=False) as viewer:
        box = viewer.box((0.1, 0.1, 0.1), name="box")
        viewer.play({box: ulna.trajectory.pose_line(np.eye(4), ulna.SE3.trans(0.0, 0.0, 1.0), 3600.0)})
        page: Any = viewer._page
        with page._tick_lock:
            page.play_out()
        assert abs(box.position[2] - 1.0) < 1e-9
        assert page.motion.frames[-1].t + 5.0 > 3600.0 and len(page.motion.frames) < 6100


def request(path: str = "/", **headers: str) -> Any:
    return SimpleNamespace(path=path, headers={"Accept-Encoding": "gzip", **headers})


def test_a_tab_loads_from_its_first_request_until_its_socket_opens() -> None:
    now = [10.0]
    visits = Visits(now=lambda: now[0])
    assert not visits.is_loading()
    visits.note_request(request("/favicon.ico"))
    visits.note_request(SimpleNamespace(path="/", headers={}))  # no browser
    assert not visits.is_loading()
    visits.note_opened()
    assert visits.is_loading()
    now[0] += 1.0
    visits.note_request(request("/?token=1"))
    assert visits.is_loading()
    now[0] += 1.0
    visits.note_request(request(Upgrade="websocket"))
    assert visits.is_loading()  # it gets nothing before the socket is open
    visits.note_connected()
    assert not visits.is_loading()
    now[0] += 1.0
    visits.note_request(request())
    now[0] += 31.0
    assert not visits.is_loading()  # it has gone


def test_a_tab_of_an_earlier_program_is_not_the_tab_that_was_just_opened() -> None:
    now = [10.0]
    visits = Visits(now=lambda: now[0])
    visits.note_opened()
    now[0] += 1.0
    visits.note_connected()  # an old tab: it did not ask for the page
    assert visits.is_loading()
    now[0] += 1.0
    visits.note_request(request())
    now[0] += 1.0
    visits.note_connected()
    assert not visits.is_loading()


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    state = SimpleNamespace(visits=Visits(), connected=True, delivered=True, now=0.0, sleeps=0)

    def sleep(seconds: float) -> None:
        state.now, state.sleeps = state.now + seconds, state.sleeps + 1

    monkeypatch.setattr(ending, "time", SimpleNamespace(monotonic=lambda: state.now, sleep=sleep))
    monkeypatch.setattr(ending, "visits_of", lambda server: server.visits)
    monkeypatch.setattr(ending, "is_connected", lambda server: server.connected)
    monkeypatch.setattr(ending, "has_delivered", lambda server: server.delivered)
    return state


def test_the_end_waits_for_what_is_on_its_way_and_no_longer(server: Any, capsys: Any) -> None:
    ending.wait_for_tabs(server, at_exit=True)
    assert server.sleeps == 0
    server.delivered = False
    ending.wait_for_tabs(server, at_exit=False)
    assert 10.0 < server.now < 10.1
    assert capsys.readouterr().err.count("The page is still receiving; it gets 10 s at most") == 1
    server.now, server.connected = 0.0, False
    server.visits.note_opened()
    assert ending.has_tabs(server, at_exit=True) and not ending.has_tabs(server, at_exit=False)
    ending.wait_for_tabs(server, at_exit=False)
    assert server.now == 0.0
    ending.wait_for_tabs(server, at_exit=True)
    assert 15.0 <= server.now < 15.1
    assert capsys.readouterr().err.count("still loading") == 1


def test_ctrl_c_ends_the_waiting(server: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: float) -> None:
        raise KeyboardInterrupt

    server.delivered = False
    monkeypatch.setattr(ending.time, "sleep", interrupted)
    ending.wait_for_tabs(server, at_exit=True)
    assert server.now == 0.0
