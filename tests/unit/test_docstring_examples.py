"""The examples in the docstrings of the names that are used most run, and print what they say."""

from __future__ import annotations

import ast
import doctest
import importlib
import inspect
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna

ROOT = Path(__file__).parents[2]

NEEDED = {
    "ulna.Robot.collides": "coal",
    "ulna.Robot.distance": "coal",
    "ulna.Robot.ik_free": "coal",
    "ulna.Viewer.film": "PIL",
    "ulna.Viewer.html": "viser",
    "ulna.collision.first_contact": "coal",
    "ulna.compiler.KernelBase.dask": "dask",
    "ulna.interop.to_torch": "torch",
    "ulna.scale.data_set": "zarr",
    "ulna.scale.reach": "dask",
}
"""The optional packages of examples."""

SLOW = {"ulna.Robot.save_html", "ulna.identification.identify", "ulna.interop.to_torch"}
"""Examples that take longer than a second or two."""

NAMES = [
    "ulna.Inertia.from_box",
    "ulna.Inertia.from_mesh",
    "ulna.Inertia.zero",
    "ulna.ModelBuilder",
    "ulna.ModelBuilder.add_joint",
    "ulna.ModelBuilder.add_link",
    "ulna.ModelBuilder.build",
    "ulna.Robot",
    "ulna.Robot.analytical_jacobian",
    "ulna.Robot.attach",
    "ulna.Robot.bias_forces",
    "ulna.Robot.center_of_mass",
    "ulna.Robot.collides",
    "ulna.Robot.configurations",
    "ulna.Robot.coriolis_matrix",
    "ulna.Robot.difference",
    "ulna.Robot.distance",
    "ulna.Robot.fk",
    "ulna.Robot.forward_dynamics",
    "ulna.Robot.frame_acceleration",
    "ulna.Robot.frame_velocity",
    "ulna.Robot.function",
    "ulna.Robot.gravity_forces",
    "ulna.Robot.ik",
    "ulna.Robot.ik_all",
    "ulna.Robot.ik_free",
    "ulna.Robot.integrate",
    "ulna.Robot.interpolate",
    "ulna.Robot.inverse_dynamics",
    "ulna.Robot.inverse_mass_matrix",
    "ulna.Robot.jacobian",
    "ulna.Robot.jacobian_dot",
    "ulna.Robot.kernel",
    "ulna.Robot.kinetic_energy",
    "ulna.Robot.link_poses",
    "ulna.Robot.lock",
    "ulna.Robot.manipulability",
    "ulna.Robot.mass_matrix",
    "ulna.Robot.perturbed",
    "ulna.Robot.plan",
    "ulna.Robot.random_configuration",
    "ulna.Robot.regressors.joint_torque",
    "ulna.Robot.save_html",
    "ulna.Robot.static_torque",
    "ulna.Robot.with_configuration",
    "ulna.Robot.with_payload",
    "ulna.Robot.with_tool",
    "ulna.SE3",
    "ulna.SE3.act",
    "ulna.SE3.as_matrix",
    "ulna.SE3.distance",
    "ulna.SE3.from_matrix",
    "ulna.SE3.from_quat_xyzw",
    "ulna.SE3.from_rpy",
    "ulna.SE3.interpolate",
    "ulna.SE3.inverse",
    "ulna.SE3.log",
    "ulna.SE3.looking_at",
    "ulna.SE3.pointing",
    "ulna.SE3.pointing_down",
    "ulna.SE3.rx",
    "ulna.SE3.trans",
    "ulna.Simulation",
    "ulna.Simulation.run",
    "ulna.Simulation.step",
    "ulna.Viewer",
    "ulna.Viewer.add",
    "ulna.Viewer.box",
    "ulna.Viewer.film",
    "ulna.Viewer.html",
    "ulna.Viewer.line",
    "ulna.Viewer.picture",
    "ulna.Viewer.play",
    "ulna.Viewer.sphere",
    "ulna.collision.World",
    "ulna.collision.World.add",
    "ulna.collision.World.attach",
    "ulna.collision.World.move",
    "ulna.collision.first_contact",
    "ulna.compile",
    "ulna.compiler.KernelBase.dask",
    "ulna.compiler.KernelBase.jacobian",
    "ulna.compiler.KernelBase.packed",
    "ulna.compiler.KernelBase.pattern",
    "ulna.compiler.KernelBase.report",
    "ulna.control.computed_torque",
    "ulna.control.impedance",
    "ulna.control.joint_pd",
    "ulna.control.stage",
    "ulna.diagnosis.diagnose",
    "ulna.diagnosis.repair_inertias",
    "ulna.diagnosis.report",
    "ulna.diagnosis.shape_inertias",
    "ulna.export",
    "ulna.geometry.Box",
    "ulna.geometry.Sphere",
    "ulna.identification.base_parameters",
    "ulna.identification.identify",
    "ulna.ik.DifferentialIK",
    "ulna.ik.DifferentialIK.velocity",
    "ulna.ik.FrameTask",
    "ulna.interop.to_torch",
    "ulna.load",
    "ulna.model.ConstantVelocity",
    "ulna.model.Revolute",
    "ulna.model.Rolling",
    "ulna.model.attach",
    "ulna.numeric.cos",
    "ulna.numeric.erf",
    "ulna.numeric.sin",
    "ulna.numeric.sqrt",
    "ulna.numeric.vector",
    "ulna.numeric.where",
    "ulna.p_servo",
    "ulna.planning.PathConstraint.pointing",
    "ulna.planning.Plan.trajectory",
    "ulna.planning.Planner",
    "ulna.planning.Region",
    "ulna.planning.plan",
    "ulna.scale.data_set",
    "ulna.scale.reach",
    "ulna.scale.run",
    "ulna.show",
    "ulna.sim.Recording.save",
    "ulna.sim.simulate",
    "ulna.trajectory.Trajectory.plot",
    "ulna.trajectory.Trajectory.reversed",
    "ulna.trajectory.Trajectory.sample",
    "ulna.trajectory.Trajectory.v",
    "ulna.trajectory.check",
    "ulna.trajectory.circle",
    "ulna.trajectory.concatenate",
    "ulna.trajectory.cubic_spline",
    "ulna.trajectory.follow",
    "ulna.trajectory.load",
    "ulna.trajectory.minimum_jerk",
    "ulna.trajectory.pose_line",
    "ulna.trajectory.quintic",
    "ulna.trajectory.s_curve",
    "ulna.trajectory.save",
    "ulna.trajectory.time_optimal",
    "ulna.trajectory.trapezoidal",
    "ulna.viewer.Camera",
    "ulna.viewer.RobotHandle.ghosts",
    "ulna.viewer.RobotHandle.trace",
]
"""Names that have an example."""

MOST_USED = 60
"""Of how many names that the pages call most an example is asked."""

FOREIGN = {"np", "math", "plt", "pin", "rtb", "sympy", "torch", "dask", "da", "json", "Path", "mujoco"}
"""How the pages name other packages."""

PYTHONS = {"replace", "index"}
"""Methods of strings and lists whose names are names of Ulna, too."""

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w.])")
_SCALAR = re.compile(r"np\.(?:float64|int64|bool|bool_|True_|False_)(?:\(([^()]*)\)|\b)")


def _plain(text: str) -> str:
    """What is printed, as every version of NumPy prints it, without spaces."""
    text = text.replace("np.True_", "True").replace("np.False_", "False")
    return "".join(_SCALAR.sub(lambda m: m[1] or "", text).split())


class Tolerant(doctest.OutputChecker):
    """Numbers may differ by a unit of the last place that is printed."""

    def check_output(self, want: str, got: str, optionflags: int) -> bool:
        """Whether an output is as expected.

        Args:
            want: What is expected.
            got: What was printed.
            optionflags: Those of doctest.

        Returns:
            Whether it is.
        """
        wanted, printed = _plain(want), _plain(got)
        if _NUMBER.sub("#", wanted).replace("#.", "#") != _NUMBER.sub("#", printed).replace("#.", "#"):
            return False
        words = _NUMBER.findall(wanted)
        places = max((len(w.partition("e")[0].partition(".")[2]) for w in words), default=0)
        unit = np.array([1.01 * 10.0**-places if "." in w else 0.0 for w in words])
        expected, values = (np.array([float(w) for w in _NUMBER.findall(t)]) for t in (wanted, printed))
        return bool(np.all(np.abs(values - expected) <= unit * np.maximum(1.0, np.abs(expected))))


def _value(name: str) -> Any:
    value: Any = ulna
    for part in name.split(".")[1:]:
        value = type(ulna.load("panda").regressors) if part == "regressors" else getattr(value, part)
    return value


PARAMETERS = [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in NAMES]


@pytest.mark.parametrize("name", PARAMETERS)
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip(NEEDED.get(name, "numpy"))
    monkeypatch.chdir(tmp_path)
    finder = doctest.DocTestFinder(recurse=False)
    runner = doctest.DocTestRunner(Tolerant(), optionflags=doctest.NORMALIZE_WHITESPACE)
    (example,) = finder.find(_value(name), name, globs={"ulna": ulna, "np": np})
    assert example.examples, f"{name} has no example"
    assert runner.run(example).failed == 0


@pytest.mark.parametrize(
    ("want", "got", "same"),
    [
        ("array([0.65 , 0.   , 0.354])", "array([ 0.65 , -0.   ,  0.354])", True),
        ("array([0.65 , 0.   , 0.354])", "array([0.65, 0.01, 0.354])", False),
        ("array([0.65 , 0.   , 0.354])", "array([0.65, 0.001, 0.3535])", True),
        ("(10, 3)", "(11, 3)", False),
        ("13", "13", True),
        ("True", "np.True_", True),
        ("0.25", "np.float64(0.25)", True),
        ("'move.gif'", "'moves.gif'", False),
        ("['a', 'b']", "['a']", False),
    ],
)
def test_numbers_are_compared_to_the_last_place(want: str, got: str, same: bool) -> None:
    assert Tolerant().check_output(want, got, 0) is same


def _documented() -> Iterator[tuple[str, Any]]:
    """The public names and their members, without what is inherited."""
    sys.path.insert(0, str(ROOT / "scripts"))
    from docs_site import reference

    for module in reference.MODULES:
        home = importlib.import_module(module)
        for name in reference.public_names(module):
            value = getattr(home, name)
            if not getattr(value, "__module__", "").startswith("ulna"):
                continue
            yield name, value
            for key, member in vars(value).items() if inspect.isclass(value) else ():
                if inspect.isfunction(member) or isinstance(member, property | classmethod | staticmethod):
                    yield f"{name}.{key}", member


def _calls() -> Iterator[str]:
    """The last names of what the pages and the examples call, without those of other packages."""
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    fence = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
    codes = [code for page in pages for code in fence.findall(page.read_text(encoding="utf-8"))]
    codes += [file.read_text(encoding="utf-8") for file in (ROOT / "examples").glob("*.py")]
    for node in (n for code in codes for n in ast.walk(ast.parse(code)) if isinstance(n, ast.Call)):
        first = ast.unparse(node.func).partition(".")[0]
        if isinstance(node.func, ast.Attribute) and first not in FOREIGN:
            yield node.func.attr
        elif isinstance(node.func, ast.Name):
            yield node.func.id


def test_the_names_that_pages_call_most_have_an_example() -> None:
    with_example = {name.rpartition(".")[2] for name in NAMES}
    public = with_example | {name.rpartition(".")[2] for name, _ in _documented()} - PYTHONS
    called = [name for name, _ in Counter(_calls()).most_common() if name in public]
    without = [name for name in called[:MOST_USED] if name not in with_example]
    assert not without, f"of the {MOST_USED} names that are called most, these have no example: {without}"


def test_every_example_is_run() -> None:
    examples = {inspect.getdoc(_value(name)) for name in NAMES}
    for name, value in _documented():
        text = inspect.getdoc(value)
        assert not (text and ">>>" in text) or text in examples, f"the example of {name} is not in NAMES"
