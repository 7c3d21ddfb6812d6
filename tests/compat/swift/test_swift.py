"""The environment of Ulna's package without a page: what is stepped, and when, and that nothing waits for a browser."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from support.compat_packages import using
from ulna.errors import InputError, UlnaWarning, UnknownName, ViewerError

pytest.importorskip("spatialmath")
QD = [0.1, 0, 0, 0, 0, 0, 0.1]


@pytest.fixture(scope="module")
def swift() -> Iterator[Any]:
    with using("roboticstoolbox"):
        import swift

        yield swift


@pytest.fixture(scope="module")
def sg(swift: Any) -> Any:
    import spatialgeometry

    return spatialgeometry


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture
def arm(panda: ulna.Robot) -> Any:
    """What the environment asks of a robot of the toolbox."""
    start = np.array(panda.configurations["qr"])
    return SimpleNamespace(ulna=panda, name="panda", q=start.copy(), qd=np.zeros(7), qr=start, base=np.eye(4))


@pytest.fixture
def env(swift: Any) -> Any:
    env = swift.Swift()
    env.launch(headless=True)
    return env


def test_velocities_count_whether_they_were_set_before_adding_or_after(
    env: Any, swift: Any, arm: Any
) -> None:
    arm.qd = QD
    env.add(arm)
    for _ in range(100):
        env.step(0.05)
    assert np.abs(arm.q - (arm.qr + 5 * np.array(QD))).max() < 1e-12
    after = SimpleNamespace(**vars(arm))
    after.q, after.qd = arm.qr.copy(), np.zeros(7)
    other = swift.Swift()
    other.launch(headless=True)
    other.add(after)
    after.qd[0] = after.qd[6] = 0.1  # element by element, too
    for _ in range(100):
        other.step(0.05)
    assert np.array_equal(after.q, arm.q) and env.sim_time == pytest.approx(5.0)


def test_what_a_page_records_of_a_robot_has_its_velocity(swift: Any, arm: Any) -> None:
    pytest.importorskip("viser")
    env = swift.Swift()
    env.launch(headless=False, browser="none")
    try:
        arm.qd = QD
        env.add(arm)
        env.step(0.1)
        env.step(0.1)
        arm.qd = np.zeros(7)
        env.step(0.1)
        (robot,) = env.viewer.robots
        np.testing.assert_allclose(robot.body.recording["v"], [np.zeros(7), QD, QD, np.zeros(7)], atol=1e-12)
        np.testing.assert_allclose(robot.body.recording.q[-1], arm.q)
    finally:
        env.close()


def test_the_handle_and_the_robot_are_of_one_state(env: Any, arm: Any) -> None:
    handle = env.add_robot(arm)
    handle.qd = QD
    env.step(1.0)
    assert np.allclose(handle.q, arm.q) and arm.q[0] == pytest.approx(0.1)
    handle.q = arm.qr
    arm.qd = np.zeros(7)
    env.step(1.0)
    assert np.array_equal(arm.q, arm.qr) and len(handle.part_poses()) == len(arm.ulna.link_names)


def test_a_robot_added_twice_has_two_states(env: Any, arm: Any) -> None:
    first, second = env.add(arm), env.add(arm)
    second.qd = QD
    env.step(1.0)
    assert second.q[0] == pytest.approx(0.1) and first.q[0] == 0.0 == arm.q[0]


def test_joints_stop_at_their_limits(env: Any, arm: Any, panda: ulna.Robot) -> None:
    env.add(arm)
    arm.qd = np.full(7, 100.0)
    for _ in range(3):
        env.step(0.05)
    assert np.array_equal(arm.q, panda.limits.upper)


def test_modes_of_control(env: Any, arm: Any) -> None:
    handle = env.add(arm)
    arm.qd = QD
    handle.control_mode = "p"
    env.step(1.0)
    assert np.array_equal(arm.q, arm.qr)
    handle.control_mode = "a"
    with pytest.raises(NotImplementedError, match="control_mode 'a'"):
        env.step(1.0)
    with pytest.raises(InputError, match="'z'"):
        handle.control_mode = "z"


def test_what_is_readonly_is_shown_only(env: Any, arm: Any) -> None:
    env.add(arm, readonly=True)
    arm.qd = QD
    env.step(1.0)
    assert np.array_equal(arm.q, arm.qr)
    arm.q = arm.qr + 0.1
    env.step(1.0)
    assert np.allclose(env.viewer.robots[0].q, arm.qr + 0.1)


def test_translucent_robots_and_what_they_collide_with(env: Any, arm: Any) -> None:
    env.add(arm, robot_alpha=0.5, collision_alpha=0.25)
    look, hull = env.viewer.robots
    assert (look.show, look.opacity, hull.show, hull.opacity) == ("visual", 0.5, "collision", 0.25)
    arm.qd = QD
    env.step(1.0)
    assert np.array_equal(look.q, arm.q) and np.array_equal(hull.q, arm.q)
    env.remove(arm)
    assert not env.viewer.robots
    env.add(arm, robot_alpha=0)  # not to be seen, and still moves
    q = arm.q.copy()
    env.step(1.0)
    assert not env.viewer.robots and arm.q[0] == pytest.approx(q[0] + 0.1)


def test_the_base_moves_the_robot(env: Any, arm: Any) -> None:
    env.add(arm)
    arm.base = _at(1, 2, 3)
    env.step(0.01)
    assert np.array_equal(env.viewer.robots[0].world_pose, arm.base)


def test_a_step_of_no_time_only_shows(env: Any, arm: Any, sg: Any) -> None:
    ball = sg.Sphere(0.1)
    env.add(arm), env.add(ball)
    arm.q, arm.qd, ball.T = arm.qr + 0.1, np.ones(7), _at(1, 0, 0)
    env.step(0)
    assert env.sim_time == 0 and np.array_equal(env.viewer.robots[0].q, arm.qr + 0.1)
    assert env.viewer["sphere 1"].position[0] == 1
    with pytest.raises(InputError, match="at least zero"):
        env.step(-0.1)


def test_shapes_move_by_their_velocity_in_the_world(env: Any, sg: Any) -> None:
    box = sg.Cuboid([1, 1, 1], pose=_turned())
    box.v = [1, 0, 0, 0, 0, 1]
    number = env.add(box)
    assert env.add(box) == number
    env.step(0.5)
    # as Swift 2.1 has it
    assert np.allclose(box.T[:3, 3], [1.5, 0, 0])
    assert np.allclose(box.T[0, :3], [0.87758256, -0.25903472, 0.40342268])
    assert np.allclose(env.viewer["cuboid 0"].pose, box.T)


def test_shapes_change_and_hang_on_others(env: Any, sg: Any) -> None:
    hand, ball = sg.Cuboid([1, 1, 1]), sg.Sphere(0.1, pose=_at(0, 0, 1), color="red")
    env.add(hand)
    ball.attach_to(hand)
    number = env.add(ball)
    hand.v, ball.radius, ball.color = [1, 0, 0, 0, 0, 0], 0.2, [0, 0, 255, 128]
    env.step(1.0)
    handle = env.viewer[f"sphere {number}"]
    assert (
        np.allclose(handle.position, [1, 0, 1]) and handle.color == (0, 0, 1) and 0.49 < handle.opacity < 0.51
    )
    assert env.viewer.scene.points()[:, 2].max() == pytest.approx(1.2, abs=1e-3)
    assert env[number] is ball
    env.remove(number)
    with pytest.raises(UnknownName):
        env.remove(ball)


def test_callbacks_say_where_things_are(env: Any, arm: Any, sg: Any, swift: Any) -> None:
    seen = []
    env.add(swift.Slider(None, 0, 10, 1, 3), name="gain")

    def to(t: float, values: dict[str, Any]) -> Any:
        seen.append((t, values))
        return arm.qr + t

    handle = env.add_robot(arm, callback=to, name="arm")
    ball = sg.Sphere(0.1)
    env.add_shape(ball, callback=lambda t, values: _at(t, 0, 0))
    env.step(0.1)
    assert seen == [(pytest.approx(0.1), {"gain": 3.0})]
    assert np.allclose(handle.q, arm.qr + 0.1) and ball.T[0, 3] == pytest.approx(0.1) and env["arm"] is handle


def test_a_shape_that_is_there_takes_a_callback_and_a_name(env: Any, sg: Any) -> None:
    ball, other = sg.Sphere(0.1), sg.Sphere(0.1)
    number = env.add(ball)
    env.add(other, name="other")
    assert env.add_shape(ball, callback=lambda t, values: _at(t, 0, 0), name="ball") == number
    assert env.add_shape(ball, name="ball") == number  # which leaves the callback
    env.step(0.1)
    assert env["ball"] is ball and ball.T[0, 3] == pytest.approx(0.1)
    with pytest.raises(InputError, match="'other' already"):
        env.add_shape(ball, name="other")
    assert env["ball"] is ball and env["other"] is other


def test_assemblies_of_parts(env: Any, sg: Any) -> None:
    parts = [sg.Sphere(0.1), sg.Sphere(0.2)]
    handle = env.add_assembly(lambda q: [_at(q[0], 0, 0), _at(0, q[1], 0)], parts, q0=[1, 2])
    handle.qd = [1, 1]
    env.step(0.5)
    assert np.allclose(handle.q, [1.5, 2.5]) and parts[1].T[1, 3] == 2.5
    assert sorted(env.viewer[n].position.max() for n in handle.drawn) == [1.5, 2.5]
    handle._fk = lambda q: [np.eye(4)]
    with pytest.raises(InputError, match="1 poses for 2 parts"):
        env.step(0.1)


def test_an_assembly_that_cannot_be_placed_leaves_nothing(env: Any, sg: Any) -> None:
    for fk, parts in (
        (lambda q: [np.eye(4)], [sg.Sphere(0.1), sg.Sphere(0.2)]),
        (np.ones, [sg.Sphere(0.1), 3]),
    ):
        with pytest.raises((InputError, AttributeError)):
            env.add_assembly(fk, parts, q0=[1.0], name="arm")
        assert "arm · 0" not in env.viewer and "arm · 1" not in env.viewer
    handle = env.add_assembly(lambda q: [np.eye(4)], [sg.Sphere(0.1)], q0=[1.0], name="arm")
    assert handle.drawn == ["arm · 0"]


@pytest.mark.parametrize("key", [np.zeros(3), True, None, 0.5])
def test_what_is_no_name_or_number_is_not_there(env: Any, sg: Any, key: Any) -> None:
    shape = sg.Sphere(0.1)
    number = env.add(shape)
    assert env[number] is shape and env[np.int64(number)] is shape
    for call in (env.__getitem__, env.remove):
        with pytest.raises(LookupError, match="object in the environment"):
            call(key)


def test_controls_keep_values_and_call_in_the_thread_of_the_script(env: Any, swift: Any) -> None:
    from swift._option_controls import Tick

    said: list[Any] = []
    slider = swift.Slider(said.append, min=0, max=10, step=1, value=3, label="gain", unit="m")
    select = swift.Select(said.append, "which", ["a", "b"], 1)
    boxes = swift.Checkbox(said.append, "flags", ["a", "b"], [True])
    radio = swift.Radio(said.append, "one", ["a", "b"], [False, True])
    button, label = swift.Button(said.append, "go"), swift.Label("words")
    for name, element in {"s": slider, "m": select, "c": boxes, "r": radio, "b": button, "l": label}.items():
        assert env.add(element, name=name) is element
    assert (values := env.values) == {"s": 3.0, "m": 1}  # as in Swift, of sliders and menus
    for element, value in ((slider, 4.0), (select, 0), (boxes, Tick(1, True)), (radio, 0), (button, 0)):
        env._controls._enqueue(element, value)  # as the page does, from its thread
    assert said == []
    env.step(0.01)
    assert said == [4.0, 0, [True, True], 0, 0]
    assert values == {"s": 4.0, "m": 0} and boxes.checked == [True, True] and radio.checked == [True, False]
    slider.value, label.label, radio.checked, boxes.checked, select.value = 7, "other", 1, [False, True], "b"
    shown = [
        c.value for e in (slider, label, radio, boxes, select) for c in e._controls if hasattr(c, "value")
    ]
    assert shown == [7.0, "other", "b", False, True, "b"]
    env.process_events({0: 5.0})
    assert said[-1] == 5.0 and len(said) == 6 and values == {"s": 5.0, "m": 1} and values is env.values
    select.options = ["a"]
    env.remove(slider)
    slider.value = 8
    assert values == {"m": 0}
    env.add(slider, name="t")
    assert values == {"m": 0, "t": 8.0}
    env.remove(slider)
    slider = swift.Slider(said.append, value=3)
    env.add(slider, name="s")
    with pytest.raises(InputError, match="already"):
        env.add(slider)


def test_controls_change_and_go_at_any_time(env: Any, swift: Any) -> None:
    slider = env.add(swift.Slider(None, 0, 10, 1, 3, label="gain", unit="m"), name="gain")
    select = env.add(swift.Select(None, "which", ["a", "b", "c"], 2), name="which")
    boxes = env.add(swift.Checkbox(None, "flags", ["a", "b"], [False, True]))
    slider.max, slider.min, slider.step, slider.label, slider.unit = 100, 20, 5, "stiffness", "N/m"
    (dial,) = slider._controls
    assert (dial.limits, dial.step, dial.label, dial.unit, dial.value) == (
        (20, 100),
        5,
        "stiffness",
        "N/m",
        20,
    )
    with pytest.raises(InputError, match="set `max` first"):
        slider.min = 200
    with pytest.raises(InputError, match="finite"):
        slider.value = np.nan
    assert slider.min == 20.0 and slider.to_dict()["unit"] == "N/m"
    select.options, select.label = ["d", "e"], "one of"
    (menu,) = select._controls
    assert (menu.options, menu.value, menu.label, select.value) == (("d", "e"), "e", "one of", 1)
    with pytest.raises(InputError, match="each once"):
        select.options = ["d", "d"]
    assert select.options == ["d", "e"]
    with pytest.warns(DeprecationWarning, match="former name of `label`"):
        boxes.options, boxes.desc = ["x", "y", "z"], "more"
    heading, *ticks = boxes._controls
    assert heading.label == "more" and [t.value for t in ticks] == [False, True, False] == boxes.checked
    env._controls._enqueue(slider, 50.0)  # the page was quicker than the script
    env.remove(slider)
    env.step(0.01)
    assert slider.value == 3.0 and dial.removed and env.values == {"which": 1} and not slider.shown
    with pytest.raises(UnknownName, match="Slider 'stiffness'"):
        env.remove(slider)
    env.add(slider, name="gain")
    assert env.values["gain"] == 3.0 and sorted(env.elements) == [1, 2, 3]


def test_controls_are_found_by_numbers_as_text(env: Any, swift: Any) -> None:
    slider = env.add(swift.Slider(None, 0, 10, 1, 3))
    elements, key = env.elements, str(slider.id)
    assert (
        elements[key] is elements.get(key) is elements[slider.id]
        and key in elements
        and slider.id in elements
    )
    for absent in ("7", 7, "gain", None, "-1"):
        assert (
            absent not in elements and elements.get(absent) is None and elements.get(absent, slider) is slider
        )
        with pytest.raises(UnknownName, match="No control named"):
            elements[absent]


def test_things_are_removed_one_by_one(env: Any, arm: Any, sg: Any) -> None:
    handle, other, ball = env.add(arm), env.add(arm), env.add(sg.Sphere(0.1))
    for several in ([handle, other], (handle, ball), {ball}, np.array([0, 1])):
        with pytest.raises(UnknownName, match=r"No object .* env\.remove takes one: call it for each"):
            env.remove(several)
    env.remove(other)
    assert env.has(arm)
    with pytest.raises(UnknownName):
        env.remove(other)
    env.remove(arm)
    assert not env.has(arm)


def test_boxes_are_ticked_by_an_index_or_by_any_sequence(env: Any, swift: Any) -> None:
    said: list[Any] = []
    boxes = env.add(swift.Checkbox(said.append, "x", ["a", "b", "c"], checked=1))
    assert boxes.checked == [False, True, False]
    boxes.checked = np.int64(2)
    assert boxes.checked == [False, False, True] == [box.value for box in boxes._controls[1:]]
    for ticks in ((True, False, True), np.array([True, True, False])):
        env.process_events({boxes.id: ticks})
        assert boxes.checked == list(ticks) and said[-1] is ticks
    pair = env.add(swift.Checkbox(said.append, "y", ["a", "b"]))
    env.process_events({pair.id: (True, False)})
    assert pair.checked == [True, False] and said[-1] == (True, False)
    for wrong in (3, -1, None, 1.5, "d"):
        with pytest.raises((InputError, UnknownName)):
            pair.checked = wrong
        with pytest.raises((InputError, UnknownName)):
            swift.Radio(None, "z", ["a", "b"], wrong)
    assert pair.checked == [True, False]


@pytest.mark.parametrize("kind", ["Slider", "Button", "Label", "Select", "Radio", "Checkbox"])
def test_the_warning_about_desc_points_at_the_script(swift: Any, kind: str) -> None:
    with pytest.warns(DeprecationWarning, match="former name of `label`") as warned:
        assert getattr(swift, kind)(desc="x").label == "x"
    assert [w.filename for w in warned] == [__file__]


def test_controls_are_described_as_in_swift(swift: Any) -> None:
    assert swift.Slider(None, 0, 10, 1, 3, label="L", unit="m").to_dict() == {
        "element": "slider", "id": None, "builtin": False, "min": 0.0, "max": 10.0, "step": 1.0, "value": 3.0,
        "label": "L", "unit": "m", "precision": 3,
    }  # fmt: skip
    assert swift.Radio(None, "C", ["a", "b"], 1).to_dict()["checked"] == [False, True]
    with pytest.warns(DeprecationWarning, match="former name of `label`"):
        assert swift.Label(desc="x").label == "x" == swift.Label("x").desc
    for bad in (
        lambda: swift.Slider(None, 3, 3),
        lambda: swift.Select(None, "x", ["a"], 4),
        lambda: swift.Checkbox(None, "x", ["a"], [True, True]),
        lambda: swift.Radio(None, "x", ["a", "a"]),
    ):
        with pytest.raises(InputError):
            bad()


def test_nothing_waits_without_a_screen(
    swift: Any, arm: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ULNA_HEADLESS", "1")
    env = swift.Swift()
    env.launch(realtime=True)
    env.add(arm)
    waited: list[float] = []
    clock = SimpleNamespace(sleep=waited.append, perf_counter=time.perf_counter)
    monkeypatch.setattr("ulna.sim.simulation.time", clock)
    for _ in range(100):
        env.step(0.05)
        env.hold()  # as the third script of the seed is printed: in the loop
    env.run()
    env.hold(10)
    assert waited == [] and env.headless and env.viewer.url == ""
    assert capsys.readouterr().out.count("There is no screen") == 1


def test_headless_steps_keep_their_time_when_asked_to(swift: Any) -> None:
    env = swift.Swift()
    env.launch(realtime=2.0, headless=True)
    began = time.monotonic()
    env.run(0.4, dt=0.05)
    assert time.monotonic() - began > 0.15 and env.sim_time == pytest.approx(0.4)


def test_reset_begins_anew(env: Any, arm: Any, swift: Any) -> None:
    env.add(arm, name="arm")
    button = env.add(swift.Button(None, "x"))
    env.step(1.0)
    env.reset()
    assert env.add(button).shown
    env.remove(button)
    assert env.sim_time == 0 and env.elements == {} and env.viewer.robots == ()
    with pytest.raises(UnknownName):
        env["arm"]
    env.add(arm, name="arm")
    env.step(1.0)
    assert env["arm"].robot is arm


def test_pictures_and_films(
    env: Any, arm: Any, sg: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image = pytest.importorskip("PIL.Image")
    draw, sizes = type(env.viewer).picture, []

    def small(viewer: Any, path: Any = None, width: int = 1600, height: int = 1000, **more: Any) -> Any:
        sizes.append((width, height))
        return draw(viewer, path, width // 10, height // 10, **more)

    monkeypatch.setattr(type(env.viewer), "picture", small)
    ball = sg.Sphere(0.1)
    ball.v = [0, 0.5, 0, 0, 0, 0]
    env.add(arm), env.add(ball)
    arm.qd = np.ones(7)
    env.set_camera_pose([2, 2, 1], [0, 0, 0.3])
    assert env.viewer.camera.position == (2.0, 2.0, 1.0)
    env.screenshot(str(tmp_path / "shot"))
    with image.open(tmp_path / "shot.png") as shot:
        assert shot.size == (160, 100) and sizes == [(1600, 1000)]
    env.start_recording(str(tmp_path / "run"), 10, format="gif")
    with pytest.raises(InputError, match="already"):
        env.start_recording("x", 10)
    for _ in range(4):
        env.step(0.1)
    env.stop_recording()
    with image.open(tmp_path / "run.gif") as film:
        assert film.n_frames == 5 and film.info["duration"] == 100
    assert np.array_equal(env.viewer.robots[0].q, arm.q)
    env.start_recording(str(tmp_path / "stills"), 10, format="png")
    env.step(0.1)
    env.stop_recording()
    assert len(list((tmp_path / "stills").glob("*.png"))) == 2
    with pytest.raises(InputError, match="start_recording"):
        env.stop_recording()
    with pytest.raises(NotImplementedError, match="png"):
        env.start_recording("x", 10, format="jpg")


def test_what_is_not_offered_says_so(env: Any, swift: Any, arm: Any) -> None:
    with pytest.raises(AttributeError, match="theme"):
        swift.PointLight
    with pytest.raises(NotImplementedError, match="theme"):
        env.set_lights([])
    with pytest.raises(AttributeError, match=r"env\.show"):
        env.swift_objects
    with pytest.warns(UlnaWarning, match="floor"):
        env.launch(headless=True, ground_opacity=0.5)
    with pytest.raises(TypeError, match="nonsense"):
        env.launch(headless=True, nonsense=1)
    with pytest.raises(ViewerError, match=r"launch\(\)"):
        swift.Swift().step()
    with pytest.raises(InputError, match="Cannot add 3"):
        env.add(3)
    with pytest.raises(InputError, match="robot_alpha"):
        env.add(arm, robot_alpha=2)
    with pytest.raises(InputError, match="of the camera are both"):
        env.set_camera_pose([0, 0, 0], [0, 0, 0])
    env.launch(headless=True, comms="websocket")  # of Swift 1
    assert "Swift of 0 objects" in repr(env)
    env.close()
    assert "not launched" in repr(env)


def test_joints_without_limits_are_not_held(swift: Any, env: Any) -> None:
    import roboticstoolbox as rtb

    robot = rtb.Robot(rtb.ETS([rtb.ET.Rz(), rtb.ET.tx(1), rtb.ET.tz(), rtb.ET.Ry(qlim=[-1, 1])]), name="free")
    env.add(robot)
    robot.qd = [10, 10, 10]
    env.step(1.0)
    assert np.array_equal(robot.q, [10, 10, 1])  # as in Swift, though qlim tells -pi and pi of the first


def test_rooms_have_the_names_that_swift_has(swift: Any) -> None:
    from swift.Elements import Slider
    from swift.Handle import AssemblyHandle
    from swift.Swift import Swift

    assert (Slider, AssemblyHandle, Swift) == (swift.Slider, swift.AssemblyHandle, swift.Swift)
    assert isinstance(swift.Swift, type)


def test_a_robot_of_another_size_is_refused_by_name(env: Any, arm: Any) -> None:
    arm.q = np.zeros(6)
    with pytest.raises(InputError, match="`q` has shape"):
        env.add(arm)
    assert env.viewer.robots == ()


def _at(x: float, y: float, z: float) -> np.ndarray:
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out


def _turned() -> np.ndarray:
    c, s = np.cos(1.0), np.sin(1.0)
    return np.array([[1, 0, 0, 1], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]], dtype=float)


@pytest.mark.parametrize("dt", [-1, "x", None, float("nan")])
def test_steps_that_are_no_time_are_refused_as_swift_does(env: Any, dt: Any) -> None:
    with pytest.raises(TypeError, match="a time of at least zero"):
        env.step(dt)
    with pytest.raises(ValueError, match="`dt`"):
        env.step(dt)
