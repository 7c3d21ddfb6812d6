"""Each quantity is declared once: its kernel, method, signature and documentation follow, and old names stay."""

from __future__ import annotations

import ast
import doctest
import inspect
import re
import subprocess
import sys
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import kernels
from ulna.methods.former_names import FormerNames
from ulna.model import Model, PointContact
from ulna.quantities import QUANTITIES, THEMES, Quantity
from ulna.quantities.documentation import ARRAYS, cited, with_batch
from ulna.quantities.part import Part

TESTS = Path(__file__).parents[1]
FORMER = [name for name in vars(FormerNames) if not name.startswith("_")]
METHODS: list[tuple[type, str, Any]] = [
    (theme, name, member)
    for theme in THEMES
    for name in vars(theme)
    if inspect.isfunction(member := getattr(theme, name)) and not name.startswith("_")
]
GROUPS = {
    "centroidal", "collision", "configuration_space", "constraints", "derivatives", "operational_space", "parameters",
    "regressors",
}  # fmt: skip


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def options_of(quantity: Quantity) -> dict[str, Any]:
    return {"constraints": (PointContact("panda_hand"),)} if "constraints" in quantity.options else {}


def numbers(model: Model, shape: str) -> tuple[int, ...]:
    """The numbers that a shape such as "(nv, 10 nbodies)" stands for, under one point contact."""
    sizes = {
        "nq": model.nq,
        "nv": model.nv,
        "nbodies": len(model.inertias),
        "nlinks": len(model.links),
        "m": 3,
        "nv+m": model.nv + 3,
    }
    entries = [entry.split() for entry in shape.strip("()").split(",") if entry.strip()]
    return tuple(int(np.prod([sizes.get(word) or int(word) for word in entry])) for entry in entries)


@pytest.mark.parametrize("name", QUANTITIES)
def test_the_declared_arguments_and_shapes_are_those_of_the_kernel(panda: ulna.Robot, name: str) -> None:
    quantity = QUANTITIES[name]
    function = kernels.function(panda.model, name, **options_of(quantity))
    shapes = [
        numbers(panda.model, shape) for shape in re.findall(r"\([^()]*\)", quantity.result.partition(" [")[0])
    ]
    if name == "forward_dynamics_with_jacobian":
        shapes[1] = (1,)  # rows=1
    assert [port.shape for port in function.outputs] == shapes
    names = tuple(port.name for port in function.inputs)
    assert names[: len(quantity.arrays)] == quantity.arrays and set(quantity.arrays) <= set(ARRAYS)
    assert quantity.summary in function.doc and with_batch(quantity.result) in function.doc


UNITLESS = {  # a measure, multiples, entries of several units (said in the text), and motions with a unit for each field
    "manipulability", "manipulability_gradient", "payload_multiples", "constrained_dynamics",
    "forward_dynamics_with_jacobian", "impulse_dynamics", "joint_torque_regressor", "gravity_regressor",
    "frame_regressor", "kinetic_energy_regressor", "potential_energy_regressor", "hessian",
}  # fmt: skip


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_has_a_sentence_and_a_unit(name: str) -> None:
    quantity = QUANTITIES[name]
    assert len(quantity.summary.split()) > 2 and quantity.summary.rstrip().endswith((".", "]"))
    derivative = name.endswith("_derivatives")
    assert bool(re.search(r"\[[^]]+\]$", quantity.result)) == (name not in UNITLESS and not derivative) or name in (
        "integrate_derivatives", "difference_derivatives",
    )  # fmt: skip


@cache
def names_in_checks() -> set[str]:
    """All names and words of strings in tests of laws and against other libraries."""
    words: set[str] = set()
    for folder in ("laws", "oracle"):
        for path in (TESTS / folder).glob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Attribute):
                    words.add(node.attr)
                elif isinstance(node, ast.Name):
                    words.add(node.id)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    words |= set(re.findall(r"\w+", node.value))
    return words


@pytest.mark.parametrize("name", QUANTITIES)
def test_a_law_or_another_library_checks_every_quantity(name: str) -> None:
    methods = {
        method.__name__ for _, _, method in METHODS if getattr(method, "quantity", None) is QUANTITIES[name]
    }
    assert {name, f"frame_{name}", *(methods & {"fk", "payload_capacity"})} & names_in_checks()


@pytest.mark.parametrize(("theme", "name", "method"), METHODS, ids=lambda x: getattr(x, "__qualname__", None))
def test_signatures_and_documentation_are_real(theme: type, name: str, method: Callable[..., Any]) -> None:
    assert isinstance(method, types.FunctionType)
    assert method.__qualname__ == f"{theme.__name__}.{name}" and method.__module__ == theme.__module__
    signature = inspect.signature(method)
    code = method.__code__
    assert list(signature.parameters) == list(
        code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    ) + ["args"] * bool(code.co_flags & 4)
    assert all(p.annotation is not p.empty for p in list(signature.parameters.values())[1:])
    assert signature.return_annotation not in (inspect.Signature.empty, "Any") or name == "is_same"
    doc = inspect.getdoc(method) or ""
    if len(signature.parameters) > 1:
        for parameter in list(signature.parameters)[1:]:
            assert re.search(rf"^    {parameter}: \S", doc, re.M), parameter
    assert "..., " not in doc or "Returns:" in doc


def test_tab_completion_shows_daily_methods_and_groups(panda: ulna.Robot) -> None:
    names = {name for name in dir(panda) if not name.startswith("_")}
    assert len(names) <= 66 and names >= GROUPS
    assert names >= {
        "fk",
        "jacobian",
        "ik",
        "inverse_dynamics",
        "forward_dynamics",
        "mass_matrix",
        "collides",
    }
    assert not names & set(FORMER) and not set(dir(ulna.Robot)) & set(FORMER)
    for group in GROUPS:
        part = getattr(panda, group)
        assert isinstance(part, Part) and "panda" in repr(part)
        assert inspect.getdoc(getattr(ulna.Robot, group)), group
    assert "jacobian" in dir(panda.constraints) and "jacobian" in repr(panda.constraints)


def test_help_shows_the_signature_and_the_arguments(panda: ulna.Robot) -> None:
    import pydoc

    text = pydoc.plain(pydoc.render_doc(panda.fk))
    signature = "".join(text.replace("'", "").split())  # 3.13 breaks long lines, 3.14 drops these quotes
    assert "fk(q:ArrayLike,frame:FrameName=None,out:" in signature and "->Floats" in signature
    assert "q: Configuration, (..., nq) [rad or m]." in text and "Featherstone 2008" in text
    whole = pydoc.plain(pydoc.render_doc(ulna.Robot)).replace("'", "")
    assert "mass_matrix(self, q: ArrayLike) -> Floats" in whole and "Contacts, closed loops" in whole


@pytest.mark.parametrize("name", FORMER)
def test_former_names_are_the_very_functions_of_the_groups(panda: ulna.Robot, name: str) -> None:
    former = getattr(ulna.Robot, name)
    kinds = [type(getattr(panda, group)) for group in sorted(GROUPS)]
    homes = [  # read as attributes: once a method was called, machine code stands for it in the class
        kind
        for kind in kinds
        if any(getattr(kind, key) is former for key in vars(kind) if not key.startswith("_"))
    ]
    assert len(homes) == 1
    assert hasattr(panda, name) and name not in dir(panda)


def test_former_spellings_return_what_the_new_ones_do(panda: ulna.Robot) -> None:
    rng = np.random.default_rng(0)
    q = panda.random_configuration(5, seed=0)
    v, a, tau = rng.standard_normal((3, 5, 7))
    held = [PointContact("panda_hand")]
    load = {"panda_hand": np.ones(6)}
    pairs = [
        (panda.center_of_mass_jacobian(q), panda.centroidal.jacobian(q)),
        (
            panda.center_of_mass_velocity(q, v, "panda_joint3"),
            panda.centroidal.velocity(q, v, "panda_joint3"),
        ),
        (panda.centroidal_matrix(q), panda.centroidal.momentum_matrix(q)),
        (panda.operational_inertia(q, damping=0.1), panda.operational_space.inertia(q, damping=0.1)),
        (panda.hessian(q, "panda_link4", "local"), panda.derivatives.jacobian(q, "panda_link4", "local")),
        (panda.joint_torque_regressor(q, v, a), panda.regressors.joint_torque(q, v, a)),
        (panda.constraint_jacobian(q, held), panda.constraints.jacobian(q, held)),
        (panda.constraint_anchors(q, held), panda.constraints.anchors(q, held)),
        (panda.configuration_distance(q, q + 0.1), panda.configuration_space.distance(q, q + 0.1)),
        (panda.normalize(q), panda.configuration_space.normalize(q)),
        (panda.parameters("inertia"), panda.parameters["inertia"]),
        (panda.dynamic_parameters, panda.parameters.dynamic),
        *zip(
            panda.constrained_dynamics(q, v, tau, held, load, "local", True),
            panda.constraints.forward_dynamics(q, v, tau, held, load, "local", True),
            strict=True,
        ),
        *zip(
            panda.inverse_dynamics_derivatives(q, v, a, load, "local"),
            panda.derivatives.inverse_dynamics(q, v, a, load, "local"),
            strict=True,
        ),
    ]
    for old, new in pairs:
        np.testing.assert_array_equal(old, new)


def test_options_that_are_lists_are_looked_up_as_tuples(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    rows = [True, True, True, False, False, False]
    np.testing.assert_array_equal(
        panda.derivatives.manipulability(q, rows), panda.derivatives.manipulability(q, "trans")
    )
    with pytest.raises(ulna.errors.InputError, match="the name of one frame"):
        panda.frame_velocity(q, q, ["panda_hand"])  # type: ignore[arg-type]
    with pytest.raises(ulna.errors.InputError, match="`frame` is {}; expected the name of a frame"):
        panda.frame_velocity(q, q, {})  # type: ignore[arg-type]


def test_groups_can_be_copied_and_pickled(panda: ulna.Robot) -> None:
    import copy
    import pickle

    q = panda.configurations["qr"]
    for group in (pickle.loads(pickle.dumps(panda.derivatives)), copy.copy(panda.derivatives)):
        np.testing.assert_array_equal(group.jacobian(q), panda.derivatives.jacobian(q))


def test_sources_in_brackets_are_cited_and_units_are_not() -> None:
    assert cited("A matrix [Featherstone 2008, section 6.2].") == (
        "A matrix.",
        "Featherstone 2008, section 6.2",
    )
    assert cited("A matrix [1/kg] of bodies.") == ("A matrix [1/kg] of bodies.", "")
    assert with_batch("(nv, nv), (nv, nv) [1]") == "(..., nv, nv) each [1]"
    assert with_batch("() [J]") == "(...) [J]" and with_batch("(6,)") == "(..., 6)"
    assert with_batch("(nv,), (m,), (), ()") == "(..., nv), (..., m), (...), (...)"


WITH_EXAMPLES = (
    "fk", "jacobian", "ik", "inverse_dynamics", "forward_dynamics", "mass_matrix", "bias_forces", "center_of_mass",
    "random_configuration", "ik_all",
)  # fmt: skip


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_in_documentation_run(name: str) -> None:
    finder = doctest.DocTestFinder(recurse=False)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    (example,) = finder.find(getattr(ulna.Robot, name), name, globs={"ulna": ulna, "np": np})
    assert example.examples, f"robot.{name} has no example"
    assert runner.run(example).failed == 0


def test_documentation_that_is_stripped_does_no_harm() -> None:
    script = "import ulna; r = ulna.load('panda'); print(r.fk.__doc__, r.mass_matrix([0] * 7).shape)"
    done = subprocess.run([sys.executable, "-OO", "-c", script], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "None (7, 7)", done.stderr


def test_the_page_of_quantities_is_up_to_date() -> None:
    script = TESTS.parent / "scripts" / "quantities_page.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("call", [
    lambda robot, q: robot.fk(q, "nowhere"),
    lambda robot, q: robot.jacobian(q, "nowhere", "local"),
    lambda robot, q: robot.jacobian(q, reference="nowhere"),
    lambda robot, q: robot.frame_velocity(q, q, "nowhere"),
    lambda robot, q: robot.manipulability(q, frame="nowhere"),
    lambda robot, q: robot.inverse_dynamics(q, q, q, reference="nowhere"),
    lambda robot, q: robot.bias_forces(q, q, reference="nowhere"),
])  # fmt: skip
def test_errors_of_options_follow_from_no_key_error(panda: ulna.Robot, call: Any) -> None:
    with pytest.raises(ulna.errors.UnknownName, match="nowhere") as caught:
        call(panda, np.zeros(7))
    assert caught.value.__context__ is None


def test_methods_find_kernels_by_equal_options_of_other_objects(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    local = "".join(["lo", "cal"])  # equal to a literal, but another object
    aligned = "".join(["local_world", "_aligned"])
    np.testing.assert_array_equal(panda.jacobian(q, None, local), panda.jacobian(q, reference="local"))
    np.testing.assert_array_equal(panda.jacobian(q, None, aligned), panda.jacobian(q))
    frames = ["panda_link4", "panda_hand"]
    for names in (frames, tuple(frames), np.array(frames)):
        np.testing.assert_allclose(panda.fk(q, names)[1], panda.fk(q, "panda_hand"), atol=1e-15)
    axes = np.array([True, True, True, False, False, False])
    assert panda.manipulability(q, axes=axes) == panda.manipulability(q, axes=axes.tolist())


def test_methods_write_into_out_by_name_and_by_place(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    T, J = np.empty((4, 4)), np.empty((6, 7))
    assert panda.fk(q, None, T) is T and panda.jacobian(q, "panda_hand", out=J) is J
    np.testing.assert_array_equal(T, panda.fk(q))
    np.testing.assert_array_equal(J, panda.jacobian(q, "panda_hand"))
    many = panda.random_configuration((3000,), seed=1)
    np.testing.assert_array_equal(panda.fk(many, threads=2), panda.fk(many))


def test_methods_that_look_at_their_results_can_be_part_of_functions() -> None:
    robot = ulna.load("panda", root="free_flyer")
    q = 2.0 * robot.random_configuration(seed=0)
    kernel = ulna.compile(lambda q: robot.configuration_space.normalize(q), robot)
    np.testing.assert_allclose(kernel(q), robot.configuration_space.normalize(q), atol=1e-15)
    q = robot.configuration_space.normalize(q)
    load = ulna.compile(lambda q: robot.payload_capacity(q), robot)  # the base has no limits
    np.testing.assert_allclose(load(q), robot.payload_capacity(q), rtol=1e-12)
    assert np.isinf(load(q)[:6]).all() and np.isfinite(load(q)[6:12]).all()
