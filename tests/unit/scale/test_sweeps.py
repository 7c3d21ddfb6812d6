"""Sweeps over models: statistics of exact samples, worst cases that are worst, the same bits after a stop."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import scale
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.scale.factors import Factors

QUIET: Any = {"workers": 0, "progress": False}
VARY: Any = {"mass": 0.2, "payload": ([0.0, -0.1, -0.1, 0.0], [3.0, 0.1, 0.1, 0.2])}


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


@pytest.fixture(scope="module")
def state(panda: ulna.Robot) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    return {"q": np.array(panda.configurations["qr"]), "v": rng.normal(size=7), "a": rng.normal(size=7)}


def _with(robot: ulna.Robot, found: scale.Sweep, worst: dict[str, float]) -> ulna.Robot:
    """The robot with those masses and that payload, built link by link."""
    masses = np.array([worst[f"mass[{k}]"] for k in range(7)])
    bodies = robot.parameters.dynamic.reshape(7, 10) * masses[:, None]
    carrying = [worst.get(f"payload[{k}]", 0.0) for k in range(4)]
    return robot.with_dynamic_parameters(bodies.ravel()).with_payload(mass=carrying[0], com=carrying[1:])


def test_a_sweep_is_what_its_samples_say(panda: ulna.Robot, state: dict[str, Any]) -> None:
    found = scale.sweep(panda, "inverse_dynamics", VARY, 20_000, at=state, chunk=9_000, seed=5, **QUIET)
    assert found.factors[:2] == ("mass[0]", "mass[1]") and found.factors[-1] == "payload[3]"
    samples, factors, y = scale.Samples(20_000, 9_000, 5), Factors.of(panda.model, VARY, state), []
    kernel, x = panda.kernel("inverse_dynamics", parameters="inertia"), []
    for part in range(3):
        rng, left = samples.generator(part), samples.size(part)
        while left:
            rows = min(left, 8192)
            x.append(factors.scaled(rng.uniform(-1.0, 1.0, (rows, 11))))
            y.append(kernel(state["q"], state["v"], state["a"], factors.arguments(x[-1])["inertia"]))
            left -= rows
    X, Y = np.concatenate(x), np.concatenate(y)
    np.testing.assert_allclose(found.mean, Y.mean(axis=0), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.deviation, Y.std(axis=0), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.greatest, Y.max(axis=0), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.least_at, X[Y.argmin(axis=0)], rtol=1e-12)
    fit = np.linalg.lstsq(np.column_stack([np.ones(len(X)), X]), Y, rcond=None)[0]
    np.testing.assert_allclose(found.slope, fit[1:].T, atol=1e-9)
    residual = Y - np.column_stack([np.ones(len(X)), X]) @ fit
    np.testing.assert_allclose(found.explained, 1.0 - residual.var(axis=0) / Y.var(axis=0), atol=1e-9)
    np.testing.assert_allclose(found.share.sum(axis=-1), found.explained, atol=0.05)
    worst = found.worst(1)
    other = _with(panda, found, worst).inverse_dynamics(state["q"], state["v"], state["a"])
    np.testing.assert_allclose(other[1], found.greatest[1], atol=1e-9)
    assert "payload[0]" in repr(found)


def test_a_grid_has_its_corners(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    found = scale.sweep(
        panda, "gravity_forces", {"payload": (0.0, 3.0), "gravity": ([0, 0, -9.9], [0, 0, -9.7])},
        levels=3, at={"q": q}, **QUIET,
    )  # fmt: skip
    assert found.job["samples"] == 9 and found.factors == ("payload[0]", "gravity[2]")
    torques = [
        panda.with_payload(mass=mass).with_parameters({"gravity": [0.0, 0.0, g]}).gravity_forces(q)
        for mass in (0.0, 1.5, 3.0)
        for g in (-9.9, -9.8, -9.7)
    ]
    np.testing.assert_allclose(found.least, np.min(torques, axis=0), atol=1e-12)
    np.testing.assert_allclose(found.greatest, np.max(torques, axis=0), atol=1e-12)
    np.testing.assert_allclose(found.mean, np.mean(torques, axis=0), atol=1e-12)
    assert found.worst(1, greatest=bool(found.slope[1, 0] > 0))["payload[0]"] == 3.0


def test_states_and_placements_vary(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    found = scale.sweep(
        panda,
        "fk",
        {"q": 1e-3, "placement": 1e-3},
        3000,
        at={"q": q},
        settings={"frame": "panda_hand"},
        **QUIET,
    )
    assert found.mean.shape == (4, 4) and found.slope.shape == (4, 4, 49)
    np.testing.assert_allclose(found.mean, panda.fk(q, "panda_hand"), atol=1e-3)
    J = panda.jacobian(q, "panda_hand")
    np.testing.assert_allclose(found.slope[:3, 3, :7], J[:3], atol=0.02)
    assert (found.explained[:3, 3] > 0.98).all() and found.deviation[3].max() == 0.0
    assert (found.share[3] == 0.0).all()


def test_a_stopped_sweep_continues_with_the_same_bits(
    client: Any, panda: ulna.Robot, state: Any, tmp_path: Path
) -> None:
    def made(**options: Any) -> scale.Sweep:
        return scale.sweep(
            panda, "inverse_dynamics", VARY, 30_000, at=state, chunk=2_000, **{**QUIET, **options}
        )

    def stop(progress: scale.Progress) -> None:
        if progress.done == 4:
            raise KeyboardInterrupt

    to, expected = tmp_path / "sweep.zarr", made()
    with pytest.raises(KeyboardInterrupt):
        made(to=to, progress=stop)
    found = made(to=to, scheduler=client, workers=None)
    for field in fields(scale.Sweep):
        if field.name != "job":
            for other in (found, scale.Sweep.load(to), made(to=to)):
                np.testing.assert_array_equal(getattr(other, field.name), getattr(expected, field.name))


def test_invalid_sweeps_are_refused(panda: ulna.Robot) -> None:
    for quantity, vary, more, error, text in (
        ("inverse_dynamcs", VARY, {}, UnknownName, "inverse_dynamics"),
        ("fk", {"mas": 0.1}, {}, UnknownName, "mass"),
        ("fk", {"tau": 0.1}, {}, UnknownName, "No argument of 'fk' named 'tau'"),
        ("fk", {}, {}, InputError, "Nothing varies"),
        ("fk", {"shift": -0.1}, {}, InputError, "'shift' is -0.1"),
        ("fk", {"shift": np.zeros(4)}, {}, ShapeError, r"\(7, 3\)"),
        ("fk", {"shift": (0.2, 0.1)}, {}, InputError, "not above"),
        ("fk", {"payload": 1.0}, {}, InputError, "pair"),
        ("fk", {"shift": 0.1}, {"levels": 5}, InputError, "grid of 5 levels of 21 factors"),
        ("fk", {"base": 0.1}, {"levels": 2, "samples": 3}, InputError, "beside `levels`"),
        ("interpolate", {"base": 0.1}, {}, InputError, "takes q0, q1, t"),
        ("fk", {"base": 0.1}, {"at": {"q": np.zeros(6)}}, ShapeError, r"\(7,\)"),
        ("inverse_dynamics_derivatives", {"gravity": 0.1}, {}, InputError, "returns 3 arrays"),
    ):
        with pytest.raises(error, match=text):
            scale.sweep(panda, quantity, vary, **QUIET, **more)  # type: ignore[arg-type]
