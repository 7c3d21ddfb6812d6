"""Operational-space dynamics in stages equal the algorithms that define them, on random trees."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms, kernels
from ulna.compiler.runtime import jit
from ulna.model import Model
from ulna.robot import Robot

ALGORITHMS = {
    "operational_inertia": algorithms.operational_inertia,
    "operational_coriolis": algorithms.operational_coriolis,
    "operational_gravity": algorithms.operational_gravity,
}
WAYS = [
    {"reference": "local_world_aligned"},
    {"reference": "local"},
    {"reference": "world"},
    {"representation": "rpy/zyx"},
]
DAMPING = 0.7
"""So that the inertia is finite for frames that cannot move in all directions."""


def tree(seed: int, root: str | None) -> Model:
    rng = np.random.default_rng(seed)
    return random_model(rng, ["revolute", "prismatic", "helical"], 26, root=root, mimics=0, branching=0.5)


def samples(model: Model, name: str, count: int) -> list[np.ndarray]:
    rng, robot = np.random.default_rng(3), Robot(model)
    q = np.array([robot.random_configuration(seed=k) for k in range(count)])
    return [q, rng.normal(size=(count, model.nv))][: 2 if "coriolis" in name else 1]


@pytest.mark.parametrize("way", WAYS, ids=lambda way: "-".join(way.values()))
@pytest.mark.parametrize(("seed", "root"), [(1, "free_flyer"), (2, None), (3, "planar")])
@pytest.mark.parametrize("name", ALGORITHMS)
def test_stages_equal_the_algorithm(name, seed, root, way):
    model = tree(seed, root)
    kernel = kernels.kernel(model, name, damping=DAMPING, **way)
    if jit.target().register_bytes >= 32:
        assert "one.0.0" in kernel.ir()
    arrays = samples(model, name, 11)
    task = algorithms.Task(model.frame(model.tool), damping=DAMPING, **way)
    one, many = kernel(*(x[0] for x in arrays)), kernel(*arrays)
    for got, k in ((one, 0), (many[0], 0), (many[10], 10)):
        expected = ALGORITHMS[name](model, *(x[k] for x in arrays), task)
        np.testing.assert_allclose(got, expected, rtol=1e-8, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("name", ALGORITHMS)
def test_float32_is_precise(name):
    model = tree(4, "free_flyer")
    arrays = [x.astype(np.float32) for x in samples(model, name, 9)]
    options = {"damping": DAMPING}
    got = kernels.kernel(model, name, dtype=np.float32, **options)(*arrays)
    right = kernels.kernel(model, name, **options)(*(x.astype(float) for x in arrays))
    assert np.abs(got - right).max() < 1e-3 * np.abs(right).max()


def test_frames_that_nothing_moves_need_no_stages():
    model = tree(5, None)
    world = next(frame for frame in model.frames if frame.joint < 0)
    task = algorithms.Task(world, damping=DAMPING)
    assert algorithms.stages_of_operational_inertia(model, task) is None
    q = samples(model, "operational_inertia", 1)[0][0]
    kernel = kernels.kernel(model, "operational_inertia", frame=world.name, damping=DAMPING)
    np.testing.assert_allclose(kernel(q), np.eye(6) / DAMPING**2)
