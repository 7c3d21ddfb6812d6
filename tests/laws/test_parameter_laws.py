"""Laws of models whose numbers are inputs: the same numbers give the same kernel, others that of another model."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from support.random_models import KINDS, random_model, random_pose
from ulna import algorithms as alg
from ulna import kernels
from ulna.compiler import compile, trace
from ulna.model import (
    Model,
    dynamic_parameters,
    lock_joints,
    parameter_names,
    parameters,
    with_parameters,
)
from ulna.model.constraint import PointContact
from ulna.spatial import SE3, SO3, so3_exp
from ulna.typing import Floats

EVERY = (
    *("inertia", "placement", "shift", "base", "tool", "offset", "gravity"),
    *("armature", "damping", "friction"),
)
DYNAMIC = ("inverse_dynamics", "forward_dynamics")


@cache
def tree(name: str) -> Model:
    rng = np.random.default_rng(3)
    if name == "mimics":
        return random_model(rng, ["revolute", "prismatic", "universal"], joints=3, mimics=2)
    if name == "floating":
        return random_model(rng, ["spherical", "continuous", "helical"], root="free_flyer", mimics=1)
    return random_model(rng, [name, "revolute"], mimics=0)


def others(model: Model, name: str, seed: int = 0) -> Floats:
    """A value that is not the model's, and that a model can have."""
    rng = np.random.default_rng([seed, len(name)])
    value = parameters(model, name)
    if name == "inertia":
        scales = rng.uniform(0.5, 1.5, len(model.joints))
        return value * np.repeat(scales, 10)
    if name in ("armature", "damping", "friction"):
        return value + rng.uniform(0.01, 0.3, model.nv)
    return value + rng.normal(0.0, 0.2, value.shape)


def inputs(function: Any, model: Model) -> list[Floats]:
    rng = np.random.default_rng(5)
    ports = function.inputs
    return [
        alg.random(model, rng) if port.name.startswith("q") else rng.uniform(0.1, 1.0, port.shape)
        for port in ports
    ]


def close(actual: Any, expected: Any, tolerance: float = 1e-10) -> None:
    for ours, theirs in zip(*(x if isinstance(x, tuple) else (x,) for x in (actual, expected)), strict=True):
        scale = max(1.0, float(np.abs(theirs).max(initial=0.0)))
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=tolerance * scale)


@pytest.mark.parametrize("quantity", kernels.QUANTITIES)
def test_kernels_with_the_models_parameters_as_inputs_are_the_constant_ones(quantity: str) -> None:
    model = tree("mimics")
    options: dict[str, Any] = {"friction": True} if quantity in DYNAMIC else {}
    if "damping" in kernels.QUANTITIES[quantity].options:
        options = {"damping": 0.1}
    if "constraints" in kernels.QUANTITIES[quantity].options:
        options = {"constraints": [PointContact("tip")]}
    constant = kernels.function(model, quantity, **options)
    varying = kernels.function(model, quantity, parameters=EVERY, **options)
    assert [port.name for port in varying.inputs[len(constant.inputs) :]] == list(EVERY)
    arrays = inputs(constant, model)
    with np.errstate(invalid="ignore"):
        close(varying(*arrays, *(parameters(model, name) for name in EVERY)), constant(*arrays), 1e-9)


@pytest.mark.parametrize(
    "quantity", ["fk", "jacobian", "inverse_dynamics", "forward_dynamics", "center_of_mass"]
)
@pytest.mark.parametrize("name", [*KINDS, "floating"])
def test_other_numbers_are_another_model(name: str, quantity: str) -> None:
    model = tree(name)
    options: dict[str, Any] = {"friction": True} if quantity in DYNAMIC else {}
    values = {key: others(model, key) for key in EVERY}
    if any(len(joint.kind.elementary_joints(joint.placement)) > 1 for joint in model.joints):
        values["offset"] *= 0.0  # no model has an offset there; a kernel takes it, see below
    own = inputs(kernels.function(model, quantity, **options), model)
    varying = kernels.function(model, quantity, parameters=EVERY, **options)(*own, *values.values())
    close(varying, kernels.function(with_parameters(model, values), quantity, **options)(*own), 1e-9)


@pytest.mark.parametrize("key", EVERY)
@pytest.mark.parametrize("name", ["mimics", "floating"])
def test_each_number_alone_is_another_model(name: str, key: str) -> None:
    model = tree(name)
    if name == "mimics" and key == "offset":
        model = tree("revolute")
    value = others(model, key)
    changed = with_parameters(model, {key: value})
    assert changed != model
    for quantity in ("fk", *DYNAMIC):
        options: dict[str, Any] = {"friction": True} if quantity in DYNAMIC else {}
        own = inputs(kernels.function(model, quantity, **options), model)
        varying = kernels.function(model, quantity, parameters=key, **options)(*own, value)
        close(varying, kernels.function(changed, quantity, **options)(*own), 1e-9)


@pytest.mark.parametrize("key", EVERY)
def test_its_present_parameters_leave_a_model_unchanged(key: str) -> None:
    model = tree("mimics")
    assert with_parameters(model, {key: parameters(model, key)}) == model


@pytest.mark.parametrize("name", ["mimics", "floating", "composite", "composite_ball", "cylindrical"])
def test_an_offset_is_added_to_q(name: str) -> None:
    model = tree(name)
    varying = kernels.function(model, "fk", parameters="offset")
    rng = np.random.default_rng(0)
    offset = rng.normal(size=varying.inputs[1].shape)
    q = alg.random(model, rng)
    moved = q.copy()
    moved[[k for k, joint in _coordinates(model) if joint]] += offset
    close(varying(q, offset), kernels.function(model, "fk")(moved))


def _coordinates(model: Model) -> list[tuple[int, bool]]:
    """Every entry of q, and whether it is an independent angle or length."""
    whole = ("spherical", "free flyer", "free_flyer", "planar")
    rows = []
    for joint in (j for j in model.joints if j.mimic is None):
        for part in getattr(joint.kind, "kinds", (joint.kind,)):
            rows += [part.name.replace(" ", "_") not in whole] * part.nq
    return list(enumerate(rows))


def test_the_derivative_by_inertia_is_the_regressor() -> None:
    model = tree("floating")
    varying = kernels.kernel(model, "inverse_dynamics", parameters="inertia").jacobian("inertia")
    q, v, a, p = inputs(varying.function, model)
    Y = kernels.kernel(model, "joint_torque_regressor")(q, v, a)
    close(varying(q, v, a, dynamic_parameters(model)), Y)
    close(varying(q, v, a, p), Y)  # it is linear: the same everywhere
    row = kernels.kernel(model, "kinetic_energy", parameters="inertia").jacobian("inertia")(q, v, p)
    close(row, kernels.kernel(model, "kinetic_energy_regressor")(q, v))


@pytest.mark.parametrize("key", ["placement", "shift", "base", "tool", "offset"])
def test_derivatives_by_placements_are_those_of_differences(key: str) -> None:
    model = tree("floating")
    q = alg.random(model, np.random.default_rng(1))
    varying = kernels.function(model, "fk", parameters=key)
    slope = varying.jacobian(key)
    for value in (
        parameters(model, key),
        others(model, key),
    ):  # nothing off is a removable singularity of exp
        steps = 1e-6 * np.eye(value.size).reshape(value.size, *value.shape)
        numeric = (varying(q, value + steps) - varying(q, value - steps)) / 2e-6
        close(np.moveaxis(slope(q, value).reshape(4, 4, -1), -1, 0), numeric, 1e-8)


def test_batches_of_models_and_of_states_broadcast() -> None:
    model = tree("revolute")
    varying = kernels.kernel(model, "forward_dynamics", parameters=("inertia", "placement"))
    rng = np.random.default_rng(0)
    q, v, tau = alg.random(model, rng, (5,)), *rng.standard_normal((2, 5, model.nv))
    p = np.stack([others(model, "inertia", seed) for seed in range(3)])
    off = np.stack([others(model, "placement", seed) for seed in range(3)])
    for states, models in ((slice(0, 3), slice(0, 3)), (0, slice(0, 3)), (slice(None), 0)):
        found = varying(q[states], v[states], tau[states], p[models], off[models])
        rows = np.broadcast_arrays(np.arange(5)[states], np.arange(3)[models])
        single = [varying(q[i], v[i], tau[i], p[j], off[j]) for i, j in zip(*rows, strict=True)]
        close(found, np.stack(single))
    every = varying(q[:, None], v[:, None], tau[:, None], p, off)
    assert every.shape == (5, 3, model.nv)
    close(every[4, 2], varying(q[4], v[4], tau[4], p[2], off[2]))


def test_a_base_that_is_off_moves_everything() -> None:
    rng = np.random.default_rng(2)
    x = np.concatenate([rng.normal(size=3), rng.normal(size=3)])
    B = SE3(so3_exp(x[3:]), x[:3])
    for name in ("mimics", "floating"):
        model = tree(name)
        q = alg.random(model, rng)
        moved = with_parameters(model, {"base": x})
        twice = with_parameters(moved, {"base": x})
        for frame in model.frame_names:
            pose = alg.frame_pose(model, q, model.frame(frame))
            close(alg.frame_pose(moved, q, moved.frame(frame)).matrix(), (B @ pose).matrix())
            close(alg.frame_pose(twice, q, twice.frame(frame)).matrix(), (B @ B @ pose).matrix())


def test_a_model_with_other_placements_can_be_built_on() -> None:
    model = tree("mimics")
    model = with_parameters(model, {"placement": others(model, "placement"), "tool": np.full(6, 0.1)})
    q = alg.random(model, np.random.default_rng(0))
    again = lock_joints(model, [])
    for frame in model.frames:
        close(
            alg.frame_pose(again, q, again.frame(frame.name, frame.kind)).matrix(),
            alg.frame_pose(model, q, frame).matrix(),
        )
    locked = lock_joints(model, [model.joints[0].name], q)
    rest = [k for k in range(model.nq) if k not in range(model.joints[0].idx_q, model.joints[0].nq)]
    close(
        alg.frame_pose(locked, q[rest], locked.frame("tip")).matrix(),
        alg.frame_pose(model, q, model.frame("tip")).matrix(),
    )


def test_what_is_off_is_written_in_the_axes_of_the_frame() -> None:
    model = tree("revolute")
    joint, rng = model.joints[0], np.random.default_rng(0)
    off = random_pose(rng)
    x = np.zeros((len(model.joints), 6))
    x[0] = [*off.translation, *SO3(off.rotation).log()]
    close(
        with_parameters(model, {"placement": x}).joints[0].placement.matrix(),
        (joint.placement @ off).matrix(),
    )


def test_functions_of_users_take_models_with_traced_parameters() -> None:
    model = tree("mimics")

    def power(q: Any, v: Any, p: Any, g: Any) -> Any:
        varied = with_parameters(model, {"inertia": p, "gravity": g})
        return alg.gravity_forces(varied, q) @ v

    shapes: dict[str, Any] = {"q": model.nq, "v": model.nv, "p": 10 * len(model.joints), "g": 3}
    made = compile(trace(power, **shapes))
    q, v = alg.random(model, np.random.default_rng(0)), np.ones(model.nv)
    p, g = others(model, "inertia"), np.array([1.0, 2.0, 3.0])
    expected = alg.gravity_forces(with_parameters(model, {"inertia": p, "gravity": g}), q) @ v
    close(made(q, v, p, g), expected)


def test_the_order_of_parameters_does_not_matter() -> None:
    model = tree("revolute")
    values = {name: others(model, name) for name in ("tool", "offset", "placement", "base", "shift")}
    changed = with_parameters(model, values)
    assert with_parameters(model, dict(reversed(values.items()))) == changed
    q = alg.random(model, np.random.default_rng(0))
    expected = alg.frame_pose(changed, q, changed.frame("tip")).matrix()
    for name, value in values.items():  # one is a number of the model, the others come with the trace
        rest = {other: x for other, x in values.items() if other != name}

        def pose(q: Any, *varying: Any, known: Any = {name: value}, names: Any = tuple(rest)) -> Any:  # noqa: B006
            varied = with_parameters(model, known | dict(zip(names, varying, strict=True)))
            return alg.frame_pose(varied, q, varied.frame("tip")).matrix()

        shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate((q, *rest.values()))}
        close(trace(pose, **shapes)(q, *rest.values()), expected)


def test_added_frames_have_separate_parameters() -> None:
    model = tree("mimics")
    assert parameter_names(model)[-2:] == ("frame:tip", "frame:side")
    q, x = alg.random(model, np.random.default_rng(0)), others(model, "frame:side")
    varying = kernels.function(model, "fk", frame="side", parameters=("frame:side",))
    close(varying(q, x), kernels.function(with_parameters(model, {"frame:side": x}), "fk", frame="side")(q))
