"""Threads with separate Data compute as one does, and what they need is compiled once."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

pytestmark = pytest.mark.usefixtures("compiled_at_once")

THREADS = 6


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _answers(pin: Any, model: Any, q: Any) -> list[Any]:
    data = model.createData()
    return [pin.rnea(model, data, q, q, q), pin.crba(model, data, q), pin.aba(model, data, q, q, q)]


def test_threads_compute_what_one_does_and_compile_once(pin: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    import pinocchio._model.compiled_model

    made: list[Any] = []
    compiled = pinocchio._model.compiled_model.compile_function

    def counted(function: Any, **shapes: Any) -> Any:
        made.append(function)
        return compiled(function, **shapes)

    monkeypatch.setattr(pinocchio._model.compiled_model, "compile_function", counted)
    model = pin.buildSampleModelManipulator()
    states = np.random.default_rng(4).normal(size=(4 * THREADS, model.nq))
    with ThreadPoolExecutor(THREADS) as threads:
        found = list(threads.map(lambda q: _answers(pin, model, q), states))
    assert len(made) == 3
    for q, answers in zip(states, found, strict=True):
        for own, wanted in zip(answers, _answers(pin, model, q), strict=True):
            assert np.array_equal(own, wanted)


def test_a_number_that_changes_while_another_thread_compiles_is_not_missed(
    pin: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pinocchio._model.compiled_model

    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.ones(model.nq)
    compiled = pinocchio._model.compiled_model.compile_function

    def meanwhile(function: Any, **shapes: Any) -> Any:
        found = compiled(function, **shapes)
        model.inertias[2].mass = 7.0
        return found

    monkeypatch.setattr(pinocchio._model.compiled_model, "compile_function", meanwhile)
    pin.rnea(model, data, q, q, q)
    monkeypatch.undo()
    other = model.copy()
    assert np.array_equal(pin.rnea(model, data, q, q, q), pin.rnea(other, other.createData(), q, q, q))
