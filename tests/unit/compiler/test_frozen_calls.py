"""Clocks and random numbers in functions that are compiled: they are called once, and a warning says so."""

from __future__ import annotations

import datetime
import functools
import random
import time
import warnings
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.control.stages import custom_stage
from ulna.errors import TraceWarning

generator, dice = np.random.default_rng(7000), random.Random(7000)


def noisy(x: Any) -> Any:
    return x * random.random()


def closed() -> Callable[[Any], Any]:
    own = np.random.default_rng(7001)
    return lambda x: x + own.normal(size=3)[0]


def nested(x: Any) -> Any:
    def inner(y: Any) -> Any:
        return y * perf_counter()

    return inner(x)


class Model:
    def cost(self, x: Any) -> Any:
        return x * time.monotonic_ns()


FROZEN: list[tuple[Any, str]] = [
    (lambda x: x * time.time(), r"time\.time"),
    (lambda x: x * np.random.rand(), r"np\.random\.rand"),  # noqa: NPY002
    (lambda x: x * np.random.default_rng().uniform(), r"np\.random\.default_rng"),
    (lambda x: x + generator.normal(), r"generator\.normal"),
    (lambda x: x + dice.gauss(0.0, 1.0), r"dice\.gauss"),
    (lambda x: x * datetime.datetime.now().second, r"datetime\.datetime\.now"),
    (lambda x: x + noisy(x), r"random\.random"),
    (functools.partial(noisy), r"random\.random"),
    (closed(), r"own\.normal"),
    (nested, "perf_counter"),
    (Model().cost, r"time\.monotonic_ns"),
]


@pytest.mark.parametrize(("f", "call"), FROZEN, ids=[call for _, call in FROZEN])
def test_a_call_that_happens_once_is_named(f: Any, call: str) -> None:
    with pytest.warns(TraceWarning, match=rf"calls {call}\(\), which happens once") as caught:
        kernel = ulna.compile(f, x=())
    assert caught[0].filename == __file__
    assert kernel(2.0) == kernel(2.0)  # what the warning says


def seeded(x: Any) -> Any:
    return x * np.random.default_rng(3).uniform()  # the same in every call, compiled or not


def waiting(x: Any) -> Any:
    random.seed(1)
    return x * np.sin(x)


@pytest.mark.parametrize("f", [seeded, waiting, lambda x: np.exp(x) * len("time")])
def test_other_functions_are_compiled_in_silence(f: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ulna.compile(f, x=())


def test_dynamics_and_costs_of_optimal_control_are_looked_at() -> None:
    def step(x: Any, u: Any) -> Any:
        return x + 0.1 * u

    with pytest.warns(TraceWarning, match=r"calls time\.time\(\)"):
        custom_stage(step, lambda x, u: u @ u + time.time(), nx=1, nu=1)
    with pytest.warns(TraceWarning, match=r"`lambda` calls generator\.normal\(\)"):
        custom_stage(lambda x, u: x + u * generator.normal(), lambda x, u: u @ u, nx=1, nu=1)
