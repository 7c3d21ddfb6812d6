"""What shapes of spatialgeometry, controls and environments of swift are, draw, answer and refuse, as text."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from support.compat_packages import using
from support.transcripts import compare, transcript
from ulna.robots.catalogue import build_bundled

pytest.importorskip("spatialmath")

CALLS = """
env.add(sg.Cuboid([1, 2, 3], pose=SE3(1, 2, 3), color="red"))
env.add(sg.Box([1, 2, 3], color=[0.1, 0.2, 0.3, 0.5]), name="crate")
env.add(sg.Sphere(0.5, base=SE3(1, 0, 0)))
env.add(sg.Cylinder(0.5, 2.0))
env.add(sg.Capsule(0.5, 2.0))
env.add(sg.Cone(0.5, 2.0))
env.add(sg.Ellipsoid([1, 2, 3]))
env.add(sg.Axes(0.5))
env.add(sg.Axes(0.5, arrows=True))
env.add(sg.Arrow(0.5))
env.add(sg.Arrow(0.5, radius=0.05, head_length=0.3, head_radius=0.4))
env.add(sg.Arrow.FromTo([0, 0, 0], [1, 2, 2]))
env.add(sg.Polyline(np.array([[0, 1, 1], [0, 0, 1], [0, 0, 1.0]])))
env.add(sg.Polyline(np.array([[0, 1, 1], [0, 0, 1], [0, 0, 1.0]]), radius=0.1, linewidth=3))
env.add(sg.Path(np.array([[0, 1], [0, 0], [0, 0]])))
env.add(sg.Polyline(np.zeros((2, 2))))
env.add(3)
env.add(sg.Sphere(-1))
env.add(sg.Sphere(0.5, pose=np.zeros((3, 3))))
env.add(sg.Sphere(0.5, pose=SE3(), base=SE3()))
env.add(sg.Sphere(0.5, colour="red"))
setattr(names, "ball", sg.Sphere(0.25, color=(0.2, 0.4, 0.6)))
env.add(names.ball, name="ball")
names.ball.color
names.ball.opacity
names.ball.T
names.ball.v
names.ball.bounds()
names.ball.extents()
names.ball.corners()
names.ball.fk_dict()
names.ball.to_dict()
names.ball.collision
names.ball.copy().radius
setattr(names.ball, "T", SE3(1, 2, 3))
env.step(0.1)
setattr(names.ball, "radius", 0.75)
setattr(names.ball, "color", "blue")
setattr(names.ball, "opacity", 0.5)
names.ball.set_alpha(0.25)
setattr(names.ball, "v", [1, 0, 0, 0, 0, 0.5])
setattr(names.ball, "v", [1, 0])
setattr(names.ball, "radius", -1)
env.step(0.5)
names.ball.T
names.ball.bounds(world=True)
names.ball.tree()
setattr(names, "cube", sg.Cuboid([0.2, 0.2, 0.2], pose=SE3(0, 0, 1)))
names.cube.attach_to(names.ball)
env.add(names.cube)
names.ball.tree()
names.ball.tree_children()
[c.kind for c in names.ball.scene_children]
names.cube.scene_parent.kind
names.cube.attached
names.cube.attach_to(3)
setattr(names.cube, "scale", [1, 1, 2])
names.cube.scale
names.cube.closest_point(names.ball)[0]
names.cube.closest_point(names.ball, 0.01)
names.cube.iscollided(names.ball)
names.cube.closest_point(3)
setattr(names, "group", sg.SceneGroup([sg.Sphere(0.1), sg.Cuboid([1, 1, 1])], pose=SE3(0, 0, 5)))
len(names.group)
names.group[1].kind
env.add(names.group)
setattr(names, "pair", sg.CollisionShapeGroup([sg.Sphere(0.1), sg.Cuboid([1, 1, 1], pose=SE3(2, 0, 0))]))
env.add(names.pair)
names.pair.iscollided(sg.Sphere(0.1, pose=SE3(2, 0, 0)))
names.pair.closest_point(sg.Sphere(0.1, pose=SE3(1, 0, 0)))[0]
names.pair.to_dict()
repr(names.ball)
repr(names.cube)
repr(names.group)
str(names.pair)
setattr(names, "slider", swift.Slider(calls.append, 0, 10, 0.5, 2, "speed", "m/s"))
env.add(names.slider, name="speed")
names.slider.value
names.slider.to_dict()
setattr(names.slider, "value", 4.2)
names.slider.value
setattr(names.slider, "value", 99)
names.slider.value
names.slider.update(7)
names.slider.value
names.slider.update(np.inf)
setattr(names.slider, "min", 20)
swift.Slider(None, 5, 1)
swift.Slider(None, 0, 1, 0)
setattr(names, "box", swift.Checkbox(calls.append, "parts", ["a", "b"], [True, False]))
env.add(names.box)
names.box.checked
names.box.to_dict()
names.box.update([False, True])
names.box.checked
names.box.choose((True, True))
names.box.checked
setattr(names.box, "checked", [True])
names.box.checked
setattr(names.box, "checked", [True, True])
setattr(names, "select", swift.Select(calls.append, "one of", ["x", "y", "z"], 1))
env.add(names.select)
names.select.value
names.select.to_dict()
names.select.update(2)
names.select.value
names.select.choose(0)
names.select.value
setattr(names.select, "value", 5)
setattr(names.select, "options", ["x", "y", "z", "w"])
names.select.to_dict()
setattr(names, "radio", swift.Radio(calls.append, "either", ["x", "y"], 1))
env.add(names.radio)
names.radio.checked
names.radio.to_dict()
names.radio.update(0)
names.radio.checked
setattr(names.radio, "checked", 1)
names.radio.checked
names.radio.choose(0)
names.radio.checked
setattr(names.radio, "checked", 7)
setattr(names, "button", swift.Button(calls.append, "go"))
env.add(names.button)
names.button.to_dict()
names.button.update(1)
setattr(names, "label", swift.Label("words"))
env.add(names.label)
names.label.to_dict()
setattr(names.label, "label", "others")
names.label.label
env.process_events({0: 3})
env.process_events()
env.values
sorted(env.elements)
calls
env.add(names.slider)
env.remove(names.slider)
env.remove(names.slider)
env.remove("crate")
env.remove(99)
env.sim_time
env.add(arm)
env.add(arm, robot_alpha=0.5, collision_alpha=0.25)
env.step(0.1)
setattr(arm, "qd", np.full(6, 0.5))
env.step(0.2)
arm.q
env.step(0)
env.step(-1)
env.sim_time
env.set_camera_pose([1, 2, 3], [0, 0, 0])
env.viewer.camera.position
env.set_camera_pose([1, 2], [0, 0, 0])
env.set_lights([])
env.run(0.1, 0.05)
env.sim_time
env.stop_recording()
env.remove(arm)
env.reset()
env.sim_time
env.viewer.scene.names
env.close()
env.step()
sg.Axes(0.5).to_dict()
sg.Arrow(0.5).to_dict()
sg.Polyline(np.zeros((3, 2))).to_dict()
sg.Cylinder(0.5, 2.0).to_dict()
sg.Ellipsoid([1, 2, 3]).to_dict()
sg.Mesh("nothing.stl").scale
sg.Mesh("nothing.stl", scale=[1, 2, 3]).to_dict()
sg.Mesh("nothing.stl").bounds()
""".strip().splitlines()


@pytest.fixture(scope="module")
def swift() -> Iterator[Any]:
    with using("roboticstoolbox"):
        import swift

        yield swift


def test_what_shapes_controls_and_environments_do(swift: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    import spatialgeometry
    from spatialmath import SE3

    robot = ulna.Robot(build_bundled("ur5", visuals="simple"))
    arm = SimpleNamespace(
        ulna=robot, name="arm", q=np.zeros(6), qd=np.zeros(6), qr=np.zeros(6), base=np.eye(4)
    )
    env = swift.Swift()
    env.launch(headless=True)
    names = {"swift": swift, "sg": spatialgeometry, "SE3": SE3, "env": env, "arm": arm, "calls": []}
    names |= {"names": SimpleNamespace()}
    text = transcript(CALLS, names, env.viewer.scene)
    compare(Path(__file__).parent / "transcript.txt", text)
