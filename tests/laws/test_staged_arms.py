"""Derivatives and operational space of arms in stages equal the graphs of the same quantities, single calls and batches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from support.random_models import random_model
from ulna import kernels
from ulna.compiler import compile
from ulna.compiler.runtime import jit
from ulna.model import FrameContact, Model
from ulna.robot import Robot

JOINTS = ["revolute", "continuous", "prismatic", "helical"]
SIZES = {
    "inverse_dynamics_derivatives": (6, 7, 10),
    "forward_dynamics_derivatives": (6, 8, 13),
    "centroidal_derivatives": (6, 7, 10),
    "coriolis_matrix": (7, 8, 10),
    "operational_coriolis": (6, 7, 10),
    "operational_gravity": (8, 10, 13),
    "constrained_dynamics_derivatives": (6, 8, 10),
}
"""Numbers of joints: about the one from which on there are stages, which fill registers, and do not."""
FROM_MORE_JOINTS = ["coriolis_matrix", "operational_gravity"]


def arm(joints: int) -> Model:
    """An arm with joints of several kinds."""
    return random_model(np.random.default_rng(joints), JOINTS, joints, root=None, mimics=0, branching=0.0)


def outputs(x: Any) -> tuple[Any, ...]:
    return x if isinstance(x, tuple) else (x,)


def compare(got: Any, expected: Any) -> None:
    for values, right in zip(outputs(got), outputs(expected), strict=True):
        np.testing.assert_allclose(values, right, rtol=1e-8, atol=1e-10 * np.abs(right).max())


@pytest.mark.parametrize(
    ("name", "joints"), [(name, joints) for name, sizes in SIZES.items() for joints in sizes]
)
def test_arms_in_stages_equal_the_graph(name, joints):
    model, quantity = arm(joints), kernels.QUANTITIES[name]
    options: dict[str, Any] = {}
    if "constraints" in quantity.options:
        options = {"constraints": (FrameContact(model.tool),)}
    kernel = kernels.kernel(model, name, **options)
    is_in_form = joints >= quantity.stages_from or (
        quantity.columns is not None and joints >= quantity.columns_from
    )
    graph = compile(kernels._graph(model, name, kernels.choose(name, options)[1]))
    assert graph.function.columns is None
    assert (kernel.function.columns is not None) == is_in_form
    if jit.target().register_bytes >= 32:
        assert (kernel.ir() != graph.ir()) == is_in_form
        if not is_in_form:  # the same text: LLVM would compile it twice
            return
    rng = np.random.default_rng(joints)
    q = np.array([Robot(model).random_configuration(seed=k) for k in range(11)])
    arrays = [q, *(rng.normal(size=(11, port.size)) for port in kernel.function.inputs[1:])]
    for k in range(3):
        sample = [x[k] for x in arrays]
        compare(kernel(*sample), graph(*sample))
    compare(kernel(*arrays), graph(*arrays))


@pytest.mark.parametrize("name", ["constrained_dynamics_derivatives", "forward_dynamics_derivatives"])
def test_batches_of_arms_keep_the_graph(name):
    model = arm(7)
    options = {"constraints": (FrameContact(model.tool),)} if "constrained" in name else {}
    form = kernels.kernel(model, name, **options).function.columns
    assert form is not None and not form.serves_batches


@pytest.mark.parametrize("name", [name for name in SIZES if name not in FROM_MORE_JOINTS])
def test_arms_in_stages_are_precise_in_float32(name):
    """Rows shorter than a register of eight numbers take registers of four."""
    model, options = arm(7), dict[str, Any]()
    if "constraints" in kernels.QUANTITIES[name].options:
        options = {"constraints": (FrameContact(model.tool),)}
    kernel = kernels.kernel(model, name, np.float32, **options)
    function = kernels._graph(model, name, kernels.choose(name, options)[1])
    graph, exact = compile(function, np.float32), compile(function)
    assert kernel.function.columns is not None
    if jit.target().register_bytes >= 32:
        assert "<4 x float>" in kernel.ir() and "<8 x float>" not in kernel.ir()
    rng = np.random.default_rng(7000)
    for seed in range(3):
        q = Robot(model).random_configuration(seed=seed)
        sample = [q, *(rng.normal(size=port.size) for port in kernel.function.inputs[1:])]
        sample = [x.astype(np.float32) for x in sample]
        right = outputs(exact(*(x.astype(float) for x in sample)))
        for got, same, values in zip(outputs(kernel(*sample)), outputs(graph(*sample)), right, strict=True):
            allowed = 10 * np.abs(same - values).max() + 5e-5 * np.abs(values).max()
            assert np.abs(got - values).max() <= allowed
