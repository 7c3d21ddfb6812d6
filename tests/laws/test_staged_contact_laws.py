"""Dynamics on contacts in stages, and their derivatives, equal the algorithms that define them, on random trees."""

from __future__ import annotations

import ctypes
import weakref
from dataclasses import replace
from functools import partial
from itertools import permutations
from typing import Any

import numpy as np
import pytest

from support.random_models import random_model, several_roots
from ulna import algorithms, kernels
from ulna.algorithms import Friction, Proximal
from ulna.compiler import compile
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.forms.columns import DeferredFunction
from ulna.compiler.forms.stages import Stages
from ulna.compiler.runtime import jit
from ulna.errors import TraceError
from ulna.model import FrameContact, FrameLoop, Model, PointContact, PointLoop
from ulna.model.constraint import frame_pairs
from ulna.robot import Robot
from ulna.spatial import SE3

EXACT = Proximal(mu=0.0)
NAMES = ("constrained_dynamics", "impulse_dynamics", "constrained_dynamics_derivatives")
KINDS = ["revolute", "continuous", "prismatic", "helical"]


def tree(seed: int, root: str | None = "free_flyer") -> Model:
    """A tree with branches and about 28 velocities."""
    return random_model(np.random.default_rng(seed), KINDS, 24, root=root, mimics=0, branching=0.6)


def contacts(model: Model, local: bool = False) -> list[Any]:
    """A frame and two points at the ends of long branches, none of which depends on the others."""
    parents = {joint.parent for joint in model.joints}
    ends = [name for name in model.link_names if model.link(name).joint not in parents]
    tips = sorted(ends, key=lambda name: -len(model.support(model.link(name).joint)))[:5]
    axes: Any = "local" if local else "local_world_aligned"
    place = SE3.trans(0.1, -0.2, 0.05) @ SE3.rx(0.4)
    q = Robot(model).random_configuration(seed=0)
    for first, second, third in permutations(tips, 3):
        frame, point = (
            FrameContact(first, place, axes=axes),
            PointContact(second, (0.1, 0.2, -0.1), axes=axes),
        )
        for chosen in ([frame, point, PointContact(third)], [point, PointContact(third)], [point]):
            G = algorithms.delassus_matrix(model, q, frame_pairs(model, chosen))
            if np.linalg.cond(G) < 1e5:
                return chosen
    raise AssertionError("expected contacts that are independent")


def options_of(name: str, standing: list[Any], solver: Proximal = EXACT) -> dict[str, Any]:
    given: dict[str, Any] = {"constraints": tuple(standing)}
    return given if name.endswith("derivatives") else {**given, "solver": solver}


def by_definition(
    model: Model, name: str, arrays: list[np.ndarray], standing: list[Any], solver: Proximal = EXACT
) -> tuple[Any, ...]:
    settings: Any = {} if name.endswith("derivatives") else {"settings": solver}
    return tuple(getattr(algorithms, name)(model, *arrays, frame_pairs(model, standing), **settings))


def state(model: Model, name: str, seed: int) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    count = 2 if name == "impulse_dynamics" else 3
    return [Robot(model).random_configuration(seed=seed), *rng.normal(size=(count - 1, model.nv))]


def compare(name: str, found: Any, expected: Any, tolerance: float = 1e-9) -> None:
    for k, (got, right) in enumerate(zip(found, expected, strict=True)):
        if name.endswith("derivatives") or k != 2:  # a residual is rounding
            assert np.abs(got - right).max() < tolerance * max(np.abs(right).max(), 1.0), (name, k)


@pytest.fixture(autouse=True)
def _new_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "_made", weakref.WeakValueDictionary())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("seed", "root", "local"),
    [
        (1, "free_flyer", False),
        (2, None, False),
        (3, "planar", True),
        (4, "spherical", True),
        (5, "free_flyer", True),
        (6, "several", False),
    ],
)
def test_stages_equal_the_definition(name, seed, root, local):
    model = several_roots(np.random.default_rng(seed)) if root == "several" else tree(seed, root)
    standing = contacts(model, local)
    kernel = kernels.kernel(model, name, **options_of(name, standing))
    if jit.target().register_bytes >= 32:
        assert "@one.0.0" in kernel.ir() or "@head.0.0" in kernel.ir()
    arrays = state(model, name, seed)
    compare(name, kernel(*arrays), by_definition(model, name, arrays, standing))


@pytest.mark.parametrize("name", NAMES[:2])
def test_the_default_solver_finds_forces_of_dependent_contacts_in_stages(name):
    model = tree(6)
    frame = FrameContact(contacts(model)[0].frame)
    standing = [frame, replace(frame, placement=SE3.trans(0.0, 0.1, 0.0))]
    arrays = state(model, name, 6)
    kernel = kernels.kernel(model, name, **options_of(name, standing, Proximal()))
    compare(name, kernel(*arrays), by_definition(model, name, arrays, standing, Proximal()), 1e-6)


def test_forces_that_are_not_unique_have_no_derivatives_in_stages():
    model = tree(6)
    name, frame = NAMES[2], FrameContact(contacts(model)[0].frame)
    standing = [frame, replace(frame, placement=SE3.trans(0.0, 0.1, 0.0))]
    kernel = kernels.kernel(model, name, **options_of(name, standing))
    assert all(np.isnan(x).any() for x in kernel(*state(model, name, 6)))


def test_batches_by_a_graph_with_loops_are_cut_into_parts():
    """The solver iterates, which the form of stages does not say; what a loop returns is handed on to later parts."""
    model, name = tree(7), NAMES[0]
    kernel = kernels.kernel(model, name, **options_of(name, contacts(model), Proximal()))
    assert kernel.function.has_loops
    assert "@block.1(" in kernel.ir(batch=True)


@pytest.mark.parametrize("solver", [EXACT, Proximal()])
@pytest.mark.parametrize("name", NAMES)
def test_batches_equal_single_calls(name, solver):
    model = tree(7)
    kernel = kernels.kernel(model, name, **options_of(name, contacts(model), solver))
    samples = [state(model, name, seed) for seed in range(3)]
    together = kernel(*(np.stack(column) for column in zip(*samples, strict=True)))
    for k, sample in enumerate(samples):
        compare(name, [x[k] for x in together], kernel(*sample))


@pytest.mark.parametrize("name", NAMES[:2])
def test_batches_in_stages_equal_single_calls(name):
    """Nobody takes them, for the graph is faster, but the form says so by itself."""
    model = tree(7)
    chosen = options_of(name, contacts(model))
    form: Any = kernels.kernel(model, name, **chosen).function.columns
    staged = DeferredFunction(
        name, "", replace(form, serves_batches=True), partial(kernels.function, model, name, **chosen)
    )
    kernel, alone = compile(staged), kernels.kernel(model, name, **chosen)
    if jit.target().register_bytes >= 32:
        assert "@samples.read" in kernel.ir(batch=True)
    samples = [state(model, name, seed) for seed in range(11)]
    together = kernel(*(np.stack(column) for column in zip(*samples, strict=True)))
    for k, sample in enumerate(samples):
        compare(name, [x[k] for x in together], alone(*sample))


@pytest.mark.parametrize("name", NAMES)
def test_results_may_lie_where_arguments_lie(name):
    model = tree(8)
    kernel = kernels.kernel(model, name, **options_of(name, contacts(model)))
    arrays = state(model, name, 8)
    expected = kernel(*arrays)
    out = tuple(np.empty_like(x) for x in expected)
    if not name.endswith("derivatives"):
        out = (arrays[-1], *out[1:])
    kernel(*arrays, out=out)
    for got, right in zip(out, expected, strict=True):
        np.testing.assert_array_equal(got, right)


@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("name", NAMES)
def test_contacts_in_all_widths_of_registers(name, register_bytes):
    if register_bytes > jit.target().register_bytes:
        pytest.skip("this machine has narrower registers")
    model = tree(9)
    standing = contacts(model)
    f = kernels.kernel(model, name, **options_of(name, standing)).function
    for element, dtype, tolerance in (("double", np.float64, 1e-9), ("float", np.float32, 1e-2)):
        ir = emit_single(f, replace(jit.target(), register_bytes=register_bytes), element)
        code = jit.load_text(
            ir.replace("define internal void @one(", "define void @one("), ("one",), has_loops=False
        )
        arrays = [x.astype(dtype) for x in state(model, name, 9)]
        results = [np.full(port.shape, np.nan, dtype) for port in f.outputs]
        pointers = [ctypes.c_void_p(x.ctypes.data) for x in (*arrays, *results)]
        ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(pointers))(code.address("one"))(*pointers)
        right = by_definition(model, name, [x.astype(float) for x in arrays], standing)
        compare(name, results, right, tolerance)


@pytest.mark.parametrize("reference", ["local", "world", "local_world_aligned"])
@pytest.mark.parametrize(("seed", "root"), [(1, "free_flyer"), (2, None), (3, "planar"), (6, "several")])
def test_contacts_under_external_forces_and_friction_equal_the_definition(reference, seed, root):
    model = several_roots(np.random.default_rng(seed)) if root == "several" else tree(seed, root)
    standing, links, rng = contacts(model), model.link_names, np.random.default_rng(seed)
    frames = (links[-1], links[0], links[-1])
    law = Friction(rng.uniform(0.1, 1.0, model.nv), rng.uniform(0.1, 1.0, model.nv))
    kernel = kernels.kernel(
        model, NAMES[0], **options_of(NAMES[0], standing), forces=frames, reference=reference, friction=law
    )
    assert kernel.function.columns is not None
    (q, v, tau), wrenches = state(model, NAMES[0], seed), rng.normal(size=(3, 6))
    external = algorithms.at_joints(model, q, wrenches, [model.frame(name) for name in frames], reference)
    torques = tau + algorithms.friction_torque(v, law)
    right = algorithms.constrained_dynamics(
        model, q, v, torques, frame_pairs(model, standing), external, settings=EXACT
    )
    compare(NAMES[0], kernel(q, v, tau, wrenches), tuple(right))


def test_loops_stabilised_motions_and_elastic_impacts_take_another_form():
    model = tree(10)
    tips = model.link_names[-2:]
    loop = (PointLoop(tips[0], tips[1]),)
    assert kernels.kernel(model, NAMES[0], constraints=loop, solver=EXACT).function.columns is None
    standing = tuple(contacts(model))
    made = kernels.kernel(model, NAMES[0], constraints=standing, solver=EXACT, stabilised=True)
    assert made.function.columns is None
    elastic = kernels.kernel(model, NAMES[1], constraints=standing, solver=EXACT, elastic=True)
    assert elastic.function.columns is None
    weld = (FrameLoop(tips[0], tips[1]),)
    assert algorithms.stages_of_constrained_derivatives(model, frame_pairs(model, weld)) is None


def test_a_stage_that_reads_inputs_writes_no_results():
    stages = Stages("late", 8, x=(8,))
    stages.straight(lambda x: 2.0 * x, ("x",), ("y",))
    with pytest.raises(TraceError, match="reads 'x' and writes results"):
        stages.form("y")


def test_an_array_has_one_shape_in_all_stages():
    stages = Stages("twice", 8, x=(8,))
    stages.straight(lambda x: x[:2], ("x",), ("y",))
    with pytest.raises(TraceError, match="'y' of 'twice' has the shape .* and, in an earlier stage"):
        stages.straight(lambda x: x, ("x",), ("y",))
