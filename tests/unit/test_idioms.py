"""Names of other libraries: every entry of the tables is refused with an expression that works."""

from __future__ import annotations

import ast
import copy
import inspect
import pickle
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import ulna
import ulna.robots.catalogue
from ulna.errors import UlnaError, UnknownArgument, UnknownAttribute
from ulna.idioms import IDIOMS
from ulna.idioms.module_names import MODEL, MODULE
from ulna.idioms.robot_names import MUJOCO, PINOCCHIO, ROBOT, TOOLBOX
from ulna.idioms.scene_names import KEYWORDS

ALL = [(subject, name) for subject, names in IDIOMS.items() for name in names]


@pytest.fixture(scope="module")
def things() -> dict[str, Any]:
    robot = ulna.load("panda")
    q = robot.configurations["qr"]
    viewer = ulna.Viewer(page=False)
    T = robot.fk(q)
    return {
        "robot": robot,
        "model": robot.model,
        "module ulna": ulna,
        "viewer": viewer,
        "handle": viewer.add(robot, q),
        "kernel": robot.kernel("fk"),
        "solution": robot.ik(T),
        "world": ulna.collision.World().add("name", ulna.geometry.Sphere(0.1), [0.5, 0.0, 2.0]),
        "simulation": ulna.Simulation(realtime=False),
        "SE3": ulna.SE3.from_matrix(T),
        "SO3": ulna.SE3.from_matrix(T).so3(),
    }


@pytest.fixture(scope="module")
def words(things: dict[str, Any]) -> dict[str, Any]:
    """What the expressions speak of."""
    robot = things["robot"]
    rng = np.random.default_rng(0)
    q = robot.configurations["qr"]
    v, a, tau = rng.standard_normal((3, 7))
    T = things["SE3"]
    more = {k: v for k, v in things.items() if k not in ("module ulna", "SE3", "SO3")}
    return more | {
        "ulna": ulna, "np": np, "q": q, "v": v, "a": a, "tau": tau, "T": T, "R": T.so3(), "frame": "panda_hand",
        "path": "panda", "joints": ["panda_joint1"], "name": "new", "shape": ulna.geometry.Sphere(0.1), "pose": T,
        "q0": q, "q1": q + 0.1, "T0": T.matrix(), "T1": robot.fk(q + 0.1), "rng": rng, "x": 1.0, "y": 1.0, "z": 1.0, "angle": 0.1,
        "rpy": [0.1, 0.2, 0.3], "quat": [0.0, 0.0, 0.0, 1.0], "vector": np.ones(3), "motion": ulna.Motion.zero(),
        "points": np.zeros((2, 3)) + [[0.0], [1.0]], "other": T, "s": 0.5, "t": np.zeros(3), "axis": [0.0, 0.0, 1.0],
        "position": [0.4, 0.2, 0.3], "point": [0.0, 0.1, 0.5], "direction": [0.0, 0.0, -1.0],
        "angles": [0.1, 0.2, 0.3], "f": lambda q: 2 * q, "values": {"gravity": [0.0, 0.0, -9.0]},
        "forces": {"panda_hand": np.ones(6)}, "tail": np.zeros(3), "tip": np.ones(3), "target": np.zeros((4, 4)),
        "thing": ulna.geometry.Sphere(0.1), "gravity": [0.0, 0.0, -9.0], "recording": None,
    }  # fmt: skip


@pytest.mark.parametrize("subject", IDIOMS)
def test_every_foreign_name_says_what_to_use(things: dict[str, Any], subject: str) -> None:
    thing = things[subject]
    for name, idiom in IDIOMS[subject].items():
        assert not hasattr(thing, name), name
        with pytest.raises(UnknownAttribute) as caught:
            getattr(thing, name)
        said = str(caught.value)
        assert isinstance(caught.value, UlnaError) and caught.value.name == name
        assert repr(name) in said and f"Use: {idiom.use}." in said
        assert name not in dir(thing)


def _calls(tree: ast.AST) -> Iterator[tuple[ast.expr, ast.Call | None]]:
    """Chains of attributes from a name, with the call of them where there is one."""
    called = {id(node.func): node for node in ast.walk(tree) if isinstance(node, ast.Call)}
    for node in ast.walk(tree):
        root = node
        while isinstance(root, ast.Attribute):
            root = root.value
        if isinstance(node, ast.Attribute) and isinstance(root, ast.Name):
            yield node, called.get(id(node))


@pytest.mark.parametrize("subject", IDIOMS)
def test_every_expression_has_names_and_arguments_that_exist(words: dict[str, Any], subject: str) -> None:
    for name, idiom in IDIOMS[subject].items():
        tree = ast.parse(idiom.use, mode="eval")
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                assert node.id in words or node.id in ("len", "print"), (name, idiom.use)
        for chain, call in _calls(tree):
            thing = eval(ast.unparse(chain), {}, words)
            if call is not None and not isinstance(thing, type(words["kernel"])):
                given = [object()] * len(call.args)
                inspect.signature(thing).bind(*given, **{str(k.arg): None for k in call.keywords})


def _opens_a_page_or_a_file(use: str) -> bool:
    parts = (
        "show(",
        "Viewer()",
        "hold()",
        "film(",
        "picture(",
        "play(",
        "close()",
        "clear()",
        "mesh(path)",
        "identify(",
    )
    return any(part in use for part in parts)


@pytest.mark.parametrize(
    "subject", [pytest.param(s, marks=pytest.mark.slow) if s == "robot" else s for s in IDIOMS]
)
def test_every_expression_runs(words: dict[str, Any], subject: str) -> None:
    world = words["world"].add("new", ulna.geometry.Sphere(0.1))
    here = words | {"world": world, "name": "new"}
    if subject == "handle":  # which an expression removes
        here["handle"] = words["viewer"].add(words["robot"], words["q"])
    for idiom in IDIOMS[subject].values():
        if _opens_a_page_or_a_file(idiom.use):
            continue
        use = idiom.use.replace("world.add(name", 'world.add("another"').replace("Mesh(path)", "Sphere(1.0)")
        named = "panda_joint1" if "joint" in use else "panda_hand"
        use = (
            use.replace('"name"', repr(named))
            if "model." in use
            else use.replace("viewer.add(robot)", "handle")
        )
        use = use.replace('viewer.remove("name")', "viewer")
        assert eval(use, {}, dict(here)) is not ..., use


def test_unknown_attributes_offer_the_nearest(things: dict[str, Any]) -> None:
    for subject, given, nearest in [
        ("viewer", "spere", "sphere"),
        ("kernel", "operation", "operations"),
        ("world", "ad", "add"),
        ("simulation", "steep", "step"),
        ("module ulna", "lod", "load"),
    ]:
        with pytest.raises(UnknownAttribute, match=f"no attribute '{given}'. Did you mean '{nearest}'"):
            getattr(things[subject], given)


@pytest.mark.parametrize(
    "subject", [s for s in IDIOMS if s not in ("handle", "viewer", "simulation", "module ulna")]
)
def test_copies_and_tools_do_not_suffer(things: dict[str, Any], subject: str) -> None:
    thing = things[subject]
    assert pickle.loads(pickle.dumps(thing)) is not None
    assert copy.copy(thing) is not None and copy.deepcopy(thing) is not None
    shown = {name for name, _ in inspect.getmembers(thing)}
    assert not shown & set(IDIOMS[subject])
    for name in (
        "_repr_svg_",
        "__array_interface__",
        "_ipython_canary_method_should_not_exist_",
        "_ipython_display_",
    ):
        assert not hasattr(thing, name)
        with pytest.raises(AttributeError):
            getattr(thing, name)


@pytest.mark.parametrize("cls", [ulna.Robot, ulna.Model, ulna.SE3, ulna.SO3])
def test_classes_explain_and_hide_them_too(cls: Any) -> None:
    subject = {"Robot": "robot", "Model": "model"}.get(cls.__name__, cls.__name__)
    name = next(iter(IDIOMS[subject]))
    with pytest.raises(UnknownAttribute, match="Use: "):
        getattr(cls, name)
    assert not set(dir(cls)) & set(IDIOMS[subject])
    assert {"__init__", "__doc__"} <= set(dir(cls))
    help_text = __import__("pydoc").render_doc(cls)
    assert f" {name} =" not in help_text


def test_reading_what_is_there_costs_no_more() -> None:
    """`__getattr__` would make every call of a method slower by half."""
    for cls in (ulna.Robot, ulna.Model, ulna.SE3):
        assert not any("__getattr__" in vars(base) for base in cls.__mro__)


def test_an_argument_that_another_library_has_is_named(things: dict[str, Any]) -> None:
    viewer = things["viewer"]
    with pytest.raises(UnknownArgument, match="no argument `colour`. Did you mean `color`"):
        viewer.sphere(0.1, colour="red")
    with pytest.raises(TypeError, match="no argument `alpha`. Did you mean `opacity`"):
        viewer.box((1, 1, 1), alpha=0.5)
    with pytest.raises(UnknownArgument, match="no argument `position`. Did you mean `pose`"):
        viewer.axes(0.1, position=[0, 0, 1])
    with pytest.raises(UnknownArgument, match="It has: `points`, "):
        viewer.line([[0, 0, 0], [1, 1, 1]], zzz=1)
    parameters = {
        name for f in (viewer.add, viewer.mesh, viewer.text, viewer.axes, viewer.box, viewer.sphere, viewer.cone)
        for name in inspect.signature(f).parameters
    }  # fmt: skip
    assert set(KEYWORDS.values()) <= parameters
    assert "color" in inspect.signature(viewer.add).parameters  # the signature is the function's own


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("floating floating_base free_flyer freeflyer root_joint base fixed_base useFixedBase", "root"),
        ("package_dir mesh_dir mesh_folder packages", "package_dirs"),
        ("file filename urdf name path", "name_or_path"),
    ],
)
def test_arguments_of_other_readers_are_named(words: str, meant: str) -> None:
    for word in words.split():
        with pytest.raises(UnknownArgument, match=f"no argument `{word}`. Did you mean `{meant}`"):
            ulna.load("panda", **{word: 1})


def test_names_of_pinocchio_and_mujoco_are_theirs() -> None:
    """A name that the other library does not have would never be asked for."""
    pin, mujoco = pytest.importorskip("pinocchio"), pytest.importorskip("mujoco")
    wrapper = pin.RobotWrapper(pin.buildSampleModelManipulator())
    theirs = {
        PINOCCHIO: {
            name for thing in (pin, pin.Model, pin.SE3, wrapper, wrapper.data) for name in dir(thing)
        },
        MUJOCO: {name for thing in (mujoco, mujoco.MjModel, mujoco.MjData) for name in dir(thing)},
    }
    older = {"frameJacobian", "jointJacobian", "kineticEnergy", "potentialEnergy", "nJoints", "qM"}
    for library, names in theirs.items():
        for table in (ROBOT, MODEL, MODULE):
            assert not set(table[library]) - names - older


def test_names_of_the_toolbox_are_its_own() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rtb, sm = pytest.importorskip("roboticstoolbox"), pytest.importorskip("spatialmath")
        robots = rtb.models.Panda(), rtb.models.DH.Puma560()
        things = rtb, rtb.models, rtb.ETS, rtb.backends, sm, sm.SE3, sm.base, *robots, *map(type, robots)
        names = {name for thing in things for name in dir(thing)} | {"Swift"}
    older = {
        "elinks",
        "maniplty",
        "ikine_min",
        "ikine",
        "paycap",
        "ikine_global",
        "gripper",
        "ikine_LMS",
        "dyntable",
        "pay",
    }
    older.add("Twist")  # Twist3 in spatialmath
    for table in (ROBOT, MODEL, MODULE):
        assert not set(table.get(TOOLBOX, ())) - names - older
