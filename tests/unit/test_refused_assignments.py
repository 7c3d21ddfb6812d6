"""What users hold refuses assignments that would have no effect, such as those to misspelt names."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator

import numpy as np
import pytest

import ulna
from ulna.checks.attributes import FixedAttributes
from ulna.errors import UnknownAttribute
from ulna.geometry import Box

ACCEPTING = {
    "ulna.kernels.Kernel",  # functions take attributes, as Python's do
    "ulna.model.joints.joint_kind.JointKind",  # bases of frozen data
    "ulna.model.constraint.Constraint",
    "ulna.trajectory.trajectory.Trajectory",
    "ulna.scale.job.Job",
    "ulna.sim.plant.Plant",  # nobody is handed one of these
    "ulna.viewer.page.page.Page",
}
"""Public classes whose instances take any attribute, with the reason."""


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def public_classes() -> Iterator[type]:
    """The classes that the package and its public modules name."""
    modules = [
        ulna,
        *(importlib.import_module(f"ulna.{m.name}") for m in pkgutil.iter_modules(ulna.__path__)),
    ]
    for module in modules:
        for name in getattr(module, "__all__", None) or vars(module):
            value = None if name.startswith("_") else getattr(module, name, None)
            if inspect.isclass(value) and value.__module__.startswith("ulna"):
                yield value


def test_public_objects_refuse_unknown_attributes() -> None:
    found = {c for c in public_classes() if not issubclass(c, BaseException)}
    assert len(found) > 120
    accepting = set()
    for c in found:
        internal = c.__module__.startswith(("ulna.compiler", "ulna.idioms"))
        refuses = c.__setattr__ is not object.__setattr__ or not getattr(c, "__dictoffset__", 0)
        if not (refuses or internal):
            accepting.add(f"{c.__module__}.{c.__qualname__}")
    assert accepting <= ACCEPTING


def test_misspelt_settings_are_named(panda: ulna.Robot) -> None:
    viewer = ulna.Viewer(page=False)
    arm, box = viewer.add(panda, "ready"), viewer.add(Box([0.1, 0.1, 0.1]))
    simulation = ulna.Simulation()
    for thing, wrong, right in (
        (simulation.add(panda), "contrl", "control"),
        (simulation, "sped", "speed"),
        (viewer, "tittle", "title"),
        (viewer, "camra", "camera"),
        (arm, "opacty", "opacity"),
        (box, "colour_", "color"),
        (viewer.panel.slider("speed", 0.0, 1.0), "vale", "value"),
        (ulna.ModelBuilder("arm"), "gravty", "gravity"),
    ):
        with pytest.raises(UnknownAttribute, match=f"no attribute '{wrong}'. Did you mean '{right}'"):
            setattr(thing, wrong, 1)
    viewer.title = "Cell 7"
    assert viewer.title == "Cell 7"


def test_misspelt_attributes_that_are_read_are_named(panda: ulna.Robot) -> None:
    simulation, scene = ulna.Simulation(), ulna.Viewer(page=False).scene
    for thing, wrong, right in (
        (simulation.add(panda), "recordng", "recording"),
        (simulation, "paussed", "paused"),
        (scene, "snapshoot", "snapshot"),
    ):
        with pytest.raises(UnknownAttribute, match=f"no attribute '{wrong}'. Did you mean '{right}'"):
            getattr(thing, wrong)
        assert not hasattr(thing, "_private")
    with pytest.raises(AttributeError, match="`poses` of Scene cannot be assigned to"):
        scene.poses = np.zeros((0, 4, 4))  # pyright: ignore[reportAttributeAccessIssue]


def test_arrays_where_writing_would_have_no_effect_are_read_only(panda: ulna.Robot) -> None:
    viewer, body = ulna.Viewer(page=False), ulna.sim.Body(panda)
    body.target = panda.neutral
    arm = viewer.add(panda, "ready")
    cloud, line = viewer.points(np.zeros((3, 3))), viewer.line([(0, 0, 0), (1, 0, 0)])
    boxes = viewer.copies(Box([0.1, 0.1, 0.1]), np.stack([np.eye(4), np.eye(4)]))
    boxes.colors = "red"
    others = [viewer.arrow((0, 0, 1)), viewer.fleet(panda, np.zeros((2, 7)))]
    names = ("q", "qd", "qdd", "tau", "target", "pose", "position", "world_pose", "scale", "points", "vector")
    seen = 0
    for thing in (body, arm, cloud, line, boxes, *others):
        for name in (*names, "poses", "positions", "colors"):
            array = getattr(thing, name, None)
            if array is not None:
                seen += 1
                with pytest.raises(ValueError, match="read-only"):
                    array[...] = 1.0
    assert seen == 39
    arm.q, body.q = arm.q + 0.1, body.q + 0.1
    np.testing.assert_allclose(arm.q - panda.configurations["ready"], 0.1)
    np.testing.assert_allclose(body.q - panda.neutral, 0.1)


def test_points_of_a_plan_are_read_only(panda: ulna.Robot) -> None:
    q = panda.configurations["ready"]
    plan = panda.plan(q, q + [0.3, 0, 0, 0, 0, 0, 0], margin=0.001)
    for array in (plan.points, plan.deviation_bounds):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    plan.trajectory(acceleration=4.0)


def test_what_is_fixed_is_not_replaced(panda: ulna.Robot) -> None:
    """Each of these was accepted, and what had been prepared from the former value went on to count."""
    from ulna.collision import SphereChecker, World
    from ulna.control import Reactive
    from ulna.planning import Planner

    q = panda.configurations["ready"]
    world = World().add("wall", Box((0.2, 2.0, 2.0)), ulna.SE3(0.45, 0.0, 0.5))
    for thing, name in (
        (SphereChecker(panda), "world"),
        (Planner(panda), "robot"),
        (panda, "model"),
        (panda, "limits"),
        (panda.collision, "model"),
        (ulna.Viewer(page=False), "panel"),
        (Reactive(panda), "robot"),
        (ulna.sim.Recording(), "t"),
    ):
        with pytest.raises(AttributeError, match=f"`{name}` of {type(thing).__name__} cannot be assigned to"):
            setattr(thing, name, world)
    with pytest.raises(AttributeError, match="no attribute 'influence'. Nothing can be assigned to"):
        setattr(Reactive(panda), "influence", 0.2)  # noqa: B010
    np.testing.assert_array_equal(panda.model.configurations["ready"], q)


def test_attributes_are_set_once_and_properties_always() -> None:
    class Lamp(FixedAttributes):
        socket: str
        _light = 0.0

        def __init__(self) -> None:
            self.socket = "E27"

        @property
        def light(self) -> float:
            return self._light

        @light.setter
        def light(self, light: float) -> None:
            self._light = light

    lamp = Lamp()
    lamp.light = 2.0
    lamp.light = 3.0
    assert lamp.light == 3.0
    with pytest.raises(
        AttributeError, match=r"`socket` of Lamp cannot be assigned to. Assign to one of: light\."
    ):
        lamp.socket = "E14"
    with pytest.raises(UnknownAttribute, match=r"Lamp has no attribute 'x'. There are: light\."):
        setattr(lamp, "x", 1)  # noqa: B010
    assert lamp.socket == "E27"
