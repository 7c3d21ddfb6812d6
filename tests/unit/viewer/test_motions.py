"""Trajectories, plans, samples and configurations are played, filmed and exported; traces follow what is shown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Box
from ulna.sim import simulate
from ulna.trajectory import pose_line, quintic, straight
from ulna.viewer import Viewer

TINY: dict[str, Any] = {"width": 32, "height": 20, "samples": 1}


@pytest.fixture(scope="module")
def ur5() -> ulna.Robot:
    return ulna.load("ur5", visuals="simple")


Q0 = np.zeros(6)
Q1 = np.array([0.5, -0.5, 0.5, 0.0, 0.0, 0.0])


@pytest.fixture
def viewer(ur5: ulna.Robot) -> Viewer:
    viewer = Viewer(page=False)
    viewer.add(ur5, Q0)
    return viewer


def test_what_moves_joints_is_played(viewer: Viewer, ur5: ulna.Robot) -> None:
    arm = viewer.robots[0]
    motion = quintic(Q0, Q1, 2.0)
    plan = ur5.plan(Q0, Q1)
    expected: list[tuple[Any, float]] = [
        (motion, 2.0),
        (motion.sample(rate=100), 2.0),
        (motion.sample(n=50, jerk=True), 2.0),
        (straight(ur5, Q0, Q1, 3.0), 3.0),
        (plan, float(sum(np.abs(np.diff(plan.points, axis=0)).max(axis=1)))),
        (np.stack([Q0, Q1]), 0.5),
        ([list(Q0), list(Q1)], 0.5),
        (simulate(ur5, Q0, duration=0.1), 0.1),
    ]
    for played, duration in expected:
        line = viewer.play(played)
        assert line.duration == pytest.approx(duration), played
        line.time = line.duration
        end = Q1 if duration != 0.1 else played.q[-1]
        np.testing.assert_allclose(arm.q, end, atol=1e-12)
        line.time = 0.0
        np.testing.assert_allclose(arm.q, Q0, atol=1e-12)
    line = viewer.play({arm: motion}, speed=0.5)
    line.time = 1.0
    np.testing.assert_allclose(arm.q, motion.q(1.0))
    assert "time line at 1.00 s of 2.00 s" in repr(line)


def test_other_things_move_by_poses(viewer: Viewer) -> None:
    box = viewer.box((0.1, 0.1, 0.1), pose=(1, 0, 0))
    way = pose_line(ulna.SE3.trans(0, 0, 0), ulna.SE3.trans(0, 0, 1.0), 2.0)
    line = viewer.play({box: way, viewer.robots[0]: quintic(Q0, Q1, 1.0)})
    assert line.duration == 2.0
    line.time = 2.0
    np.testing.assert_allclose(box.position, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(viewer.robots[0].q, Q1)
    box.remove()
    line.time = 1.0  # what was removed stays away


def test_films_and_pages_take_motions(viewer: Viewer, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("viser")
    arm, motion = viewer.robots[0], quintic(Q0, Q1, 1.0)
    box = viewer.box((0.1, 0.1, 0.1), pose=(1, 0, 0))
    way = pose_line(ulna.SE3.trans(1, 0, 0), ulna.SE3.trans(1, 0, 1.0), 1.0)
    path = viewer.film(tmp_path / "a.gif", {arm: motion, box: way}, fps=4.0, **TINY)
    with image.open(path) as film:
        assert film.n_frames == 5
    np.testing.assert_array_equal(arm.q, Q0)
    np.testing.assert_array_equal(box.position, [1, 0, 0])
    page = viewer.html(tmp_path / "a.html", motion, fps=5.0)
    assert page.stat().st_size > viewer.html(tmp_path / "b.html").stat().st_size


def test_what_cannot_be_played_is_named(viewer: Viewer, ur5: ulna.Robot) -> None:
    arm = viewer.robots[0]
    poses = pose_line(ulna.SE3.trans(0, 0, 0), ulna.SE3.trans(0, 0, 1.0), 2.0)
    with pytest.raises(InputError, match=r"follow\(robot"):
        viewer.play(poses)
    with pytest.raises(ShapeError, match=r"\(6,\)"):
        viewer.play(quintic(np.zeros(3), np.ones(3), 1.0))
    with pytest.raises(ShapeError, match=r"\(n, 6\)"):
        viewer.play(np.zeros((4, 5)))
    with pytest.raises(ShapeError, match=r"\(n, 6\)"):
        viewer.play(np.zeros(6))
    for wrong in ("a.csv", 3.0, object()):
        with pytest.raises(InputError, match="a trajectory, a recording, a plan"):
            viewer.play(wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="empty"):
        viewer.play({})
    with pytest.raises(InputError, match="what viewer.add returned"):
        viewer.play({"arm": quintic(Q0, Q1, 1.0)})
    wall = World().add("wall", Box((0.05, 3.0, 3.0)), (0.3, 0.0, 0.5))
    with pytest.raises(InputError, match="There is no path to play"):
        viewer.play(ur5.plan(Q0, Q1, wall))
    with pytest.raises(InputError, match="Nothing was simulated"):
        viewer.play()
    box = viewer.box((0.1, 0.1, 0.1))
    with pytest.raises(InputError, match="a trajectory of poses"):
        viewer.play({box: quintic(Q0, Q1, 1.0)})
    viewer.add(ur5, name="another")
    with pytest.raises(InputError, match="2 robots"):
        viewer.play(quintic(Q0, Q1, 1.0))
    viewer.play({arm: quintic(Q0, Q1, 1.0)})


def longest_step(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0))


def drawn(viewer: Viewer, trace: Any) -> np.ndarray:
    viewer.scene.snapshot()
    segments = viewer.scene.node(trace.name).content.segments
    return np.concatenate([segments[:1, 0], segments[:, 1]]) if len(segments) else np.zeros((0, 3))


@pytest.mark.parametrize("by", ["move", "trajectory"])
def test_a_film_draws_the_path_that_it_shows_and_no_other_line(
    viewer: Viewer, ur5: ulna.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, by: str
) -> None:
    """`film(move=)` drew a straight line from the last configuration to the first, which only the camera had seen."""
    pytest.importorskip("PIL")
    from ulna.viewer import export

    arm, motion = viewer.robots[0], quintic(Q0 + 1.0, Q1 + 2.0, 1.0)
    trace = arm.trace()
    before = drawn(viewer, trace)
    seen = []

    def render(*_: Any) -> np.ndarray:
        seen.append(drawn(viewer, trace))
        return np.zeros((20, 32, 3), dtype=np.uint8)

    monkeypatch.setattr(export, "render", render)

    def move(t: float) -> None:
        arm.q = motion.q(t)

    options: Any = {"move": move, "duration": 1.0} if by == "move" else {"motion": motion}
    viewer.film(tmp_path / "a.gif", fps=20.0, **TINY, **options)
    assert len(seen) == 21
    assert len(seen[0]) <= 1
    speed = max(np.linalg.norm((ur5.jacobian(motion.q(t)) @ motion.v(t))[:3]) for t in np.linspace(0, 1, 50))
    for k, points in enumerate(seen[1:], start=1):
        assert longest_step(points) <= speed / 20 * 1.01
        np.testing.assert_allclose(points[0], ur5.fk(motion.q(0.0))[:3, 3], atol=1e-3)
        np.testing.assert_allclose(points[-1], ur5.fk(motion.q(k / 20))[:3, 3], atol=1e-3)
    np.testing.assert_array_equal(drawn(viewer, trace), before)


def test_the_path_of_a_motion_follows_the_time_line(viewer: Viewer, ur5: ulna.Robot) -> None:
    arm, motion = viewer.robots[0], quintic(Q0 + 1.0, Q1 + 2.0, 1.0)
    trace = arm.trace(most=20)
    line = viewer.play(motion)
    for t in (0.7, 0.2, 1.0):
        line.time = t
        points = drawn(viewer, trace)
        assert 2 <= len(points) <= 20
        np.testing.assert_allclose(points[0], ur5.fk(motion.q(0.0))[:3, 3])
        np.testing.assert_allclose(points[-1], ur5.fk(motion.q(t))[:3, 3])
    arm.q = Q1  # moved by hand: what was drawn before comes back
    np.testing.assert_allclose(drawn(viewer, trace), ur5.fk(np.stack([Q0, Q1]))[:, :3, 3])


def test_a_page_has_one_time_line(ur5: ulna.Robot) -> None:
    pytest.importorskip("viser")
    with Viewer(port=0, browser=False) as viewer:
        viewer.add(ur5)
        first = viewer.play(quintic(Q0, Q1, 1.0))
        second = viewer.play(quintic(Q1, Q0, 2.0))
        assert not first.playing
        assert second.playing
        folders = [h for h in viewer._page.server.gui._gui_input_handle_from_uuid.values()]  # type: ignore[union-attr]
        assert sum("time" in str(getattr(h, "label", "")) for h in folders) == 1
        second.remove()
        second.remove()


def test_worlds_are_added(viewer: Viewer) -> None:
    world = (
        World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3)).add("top", Box((1, 1, 0.02)), (0, 0, -0.1))
    )
    handles = viewer.add(world, color="gray", opacity=0.5)
    assert list(handles) == ["post", "top"]
    assert handles["post"].name == "world/post"
    assert handles["post"].opacity == 0.5
    moved = viewer.add(world, name="second", pose=(0.0, 0.0, 1.0))
    np.testing.assert_allclose(moved["post"].world_pose[:3, 3], [0.5, 0.0, 1.3])
    held = world.attach("post", "tool0", ulna.SE3.trans(0, 0, 0.1))
    assert viewer.add(held, name="third")["post"].name.startswith("ur5/")
    with pytest.raises(InputError, match=r"viewer\.play"):
        viewer.add(quintic(Q0, Q1, 1.0))
    with pytest.raises(InputError, match=r"ulna\.Robot\(model\)"):
        viewer.add(ulna.load_model("ur5"))
    with pytest.raises(InputError, match="is no robot"):
        viewer.add(world, "qr")
    with pytest.raises(UnknownName):
        viewer.film("a.avi", quintic(Q0, Q1, 1.0))


def test_a_trace_has_the_points_of_the_moves_so_far(viewer: Viewer, ur5: ulna.Robot) -> None:
    """`points` was empty until something drew the scene."""
    arm = viewer.robots[0]
    trace = arm.trace()
    first = ur5.fk(arm.q)[:3, 3]
    arm.q = Q1
    np.testing.assert_allclose(trace.points, [first, ur5.fk(Q1)[:3, 3]])


def test_each_loop_of_an_html_file_starts_with_an_empty_path(
    viewer: Viewer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The player sends the first messages of a file again: they must make the line as it is at the start."""
    pytest.importorskip("viser")
    from ulna.viewer.page import html_file

    viewer.robots[0].trace()
    recordings, lines, start = [], [], html_file.start_recording

    def recorded(server: Any) -> Any:
        recordings.append(start(server))
        return recordings[0]

    monkeypatch.setattr(html_file, "start_recording", recorded)
    viewer.html(tmp_path / "a.html", quintic(Q0 + 1.0, Q1 + 2.0, 0.5), fps=10.0)
    for time, message in recordings[0]._messages:
        if message["type"] == "LineSegmentsMessage" or "points" in message.get("updates", {}):
            points = message["props" if "props" in message else "updates"]["points"]
            size = recordings[0]._binary_buffers[points["__binary_index"]].nbytes
            lines.append((round(time, 6), message["type"], size // 24))
    assert lines[0][:2] == (0.0, "LineSegmentsMessage")
    assert lines[0][2] <= 1
    assert [kind for _, kind, _ in lines[1:]] == ["SceneNodeUpdateMessage"] * (len(lines) - 1)
    assert [count for *_, count in lines[1:]] == sorted(count for *_, count in lines[1:])
    assert lines[-1][2] > 3
