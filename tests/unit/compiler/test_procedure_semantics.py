"""What procedures do at the edges of the language: as Python does, in all three ways, or an error."""

# ruff: noqa: PLC2401  # names that are not ASCII are among what is tested

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from tests.support.procedure_ways import all_ways

from ulna.compiler import trace
from ulna.compiler.codegen.lanes_kernel import lanes_kernel_ir
from ulna.compiler.procedures import (
    Array1,
    Kernel,
    broadcast,
    count_of,
    f32,
    f64,
    lanes_kernel,
    procedure,
    sum_of,
)  # fmt: skip
from ulna.errors import ProcedureError

ENABLED = np.bool_(False)
ONE, TWO = 1, 2


def refused(function: Callable[..., Any], text: str) -> None:
    """Checks that a function is refused with a message that contains `text`."""
    with pytest.raises(ProcedureError) as caught:
        _ = procedure(function).instances
    assert text in str(caught.value)


# loops that never run -------------------------------------------------------------------------------------


@procedure
def _after_a_loop_that_never_runs(a: Array1[f64]) -> int:
    while False:
        a[0] = 9.0
    while ENABLED:
        a[0] = 8.0
    a[1] = 2.0
    return 5


@procedure
def _halved(a, W):
    while W > 1:
        a[0] = 9.0
    a[0] += 1.0
    return a[0] * W


@procedure
def _calls_halved(a: Array1[f64]) -> f64:
    return _halved(a, 1) + _halved(a, 0)


def test_statements_after_a_loop_with_a_false_constant_run() -> None:
    a = np.zeros(2)
    assert all_ways(_after_a_loop_that_never_runs, a) == 5
    assert a.tolist() == [0.0, 2.0]
    a = np.zeros(2)
    assert all_ways(_calls_halved, a) == 1.0
    assert a.tolist() == [2.0, 0.0]
    assert "unreachable" not in _calls_halved.ir()


# augmented assignments ------------------------------------------------------------------------------------


@procedure
def _next(counter: Array1[np.int64]) -> int:
    counter[0] += 1
    return counter[0]


def _index_by_a_call(a: Array1[f64], counter: Array1[np.int64]) -> None:
    a[_next(counter)] += 1.0


def _index_that_a_call_changes(a: Array1[np.int64]) -> None:
    a[a[0]] += _next(a)


@procedure
def _augmented(a: Array1[f64], i: Array1[np.int64]) -> None:
    a[int(a[i[0]])] += 3.0
    k = i[0]
    a[k] += _next(i)


def test_the_target_of_an_augmented_assignment_is_computed_once() -> None:
    refused(
        _index_by_a_call, "a call in the target of an augmented assignment would run twice. Assign the index"
    )
    refused(_index_that_a_call_changes, "the call may change the array in which the index of the target lies")
    a, i = np.array([1.0, 5.0]), np.zeros(1, np.int64)
    all_ways(_augmented, a, i)
    assert a.tolist() == [2.0, 8.0] and i[0] == 1


# what is not evaluated ------------------------------------------------------------------------------------


@procedure
def _chain(a: Array1[f64], i: int, n: int) -> int:
    if 0 <= i < n <= a[i]:
        return 1
    return 0


@procedure
def _chain_with_a_call(a: Array1[np.int64], i: int) -> bool:
    return 0 < i < _next(a)


@procedure
def _constant_chain(a: Array1[f64], i: int) -> bool:
    return 0 < ONE < TWO < i < 8 and not TWO < ONE < i


@procedure
def _mask_chain(a: Array1[f64], i: int) -> int:
    return count_of(0.0 < a[i : i + 4] < 3.0)


def test_chained_comparisons_evaluate_what_python_evaluates() -> None:
    a = np.arange(4.0)
    for i in (-1, 0, 2, 3, 4, 10**15):
        assert all_ways(_chain, a, i, 2) == int(0 <= i < 2 <= a[i] if 0 <= i < 4 else 0)
    counter = np.zeros(1, np.int64)
    assert all_ways(_chain_with_a_call, counter, 0) is False and counter[0] == 0
    assert all_ways(_chain_with_a_call, counter, 1) is False and counter[0] == 1
    assert all_ways(_chain_with_a_call, counter, 1) is True and counter[0] == 2
    assert [all_ways(_constant_chain, a, i) for i in (2, 3, 8)] == [False, True, False]
    assert all_ways(_mask_chain, a, 0) == 2


@procedure
def _lanes_of_one_branch(a: Array1[f64], i: int, counter: Array1[np.int64]) -> f64:
    x = a[i : i + 4] if i >= 0 else broadcast(f64(_next(counter)), 4)
    y = x > 2.0 if i >= 0 else a[0:4] > 1.0
    return sum_of(np.where(y, x, 0.0))


def test_only_one_branch_of_lanes_is_evaluated() -> None:
    a, counter = np.arange(4.0), np.zeros(1, np.int64)
    assert all_ways(_lanes_of_one_branch, a, 0, counter) == 3.0 and counter[0] == 0
    assert all_ways(_lanes_of_one_branch, a, -(10**15), counter) == 2.0 and counter[0] == 1


# powers ---------------------------------------------------------------------------------------------------


@procedure
def _squares(i: int, x: f64, y: f32, a: Array1[np.int64]) -> Any:
    return i**2, i**2.0, x**2, x**2.0, y**2, y**2.0, 3**2, 3**2.0, y + 3**2.0, a[0:2] ** 2.0


def _complex_power(x: f64):
    return x ** (2 + 0j)


def test_squares_have_the_type_that_python_gives_them() -> None:
    results = all_ways(_squares, 3, 1.5, np.float32(2.5), np.array([2, 3]))
    for result, expected in zip(
        results[:-1],
        (9, 9.0, 2.25, 2.25, np.float32(6.25), np.float32(6.25), 9, 9.0, np.float32(11.5)),
        strict=True,
    ):
        assert result == expected and type(result) is type(expected)
    assert results[-1].dtype == float and results[-1].tolist() == [4.0, 9.0]
    refused(_complex_power, "cannot be compiled")


# names that are not ASCII ---------------------------------------------------------------------------------


class Größe(NamedTuple):
    länge: Array1[f64]


@procedure
def _плюс(α, ε):
    β = α + ε if α > 0.0 and ε > 0.0 else 0.0
    return β


@procedure
def _längen(größe: Größe, θ: f64, Δt: f64) -> f64:
    ω = θ / Δt
    for é in range(len(größe.länge)):
        ω += _плюс(größe.länge[é], θ)
    return ω


def test_names_need_not_be_ascii() -> None:
    lengths = np.array([1.0, -2.0, 3.0])
    assert all_ways(_längen, Größe(lengths), 0.5, 0.25) == 7.0
    assert _längen.ir().isascii()


# kernels on overlapping arrays ----------------------------------------------------------------------------


@procedure
def _in_place(kernel: Kernel, a: Array1[f64]) -> None:
    kernel(a, a)


def test_a_kernel_may_write_over_its_inputs() -> None:
    kernel = lanes_kernel(trace(lambda x: 2.0 * x[::-1], name="reversed", x=(96,)), 8, np.float64)
    assert "noalias" not in lanes_kernel_ir(kernel.function, 8, "double")
    x = np.random.default_rng(3).normal(size=(96, 8))
    for call in (kernel, kernel.interpret):
        a = x.copy()
        call(a, a)
        assert np.array_equal(a, 2.0 * x[::-1])
    a = x.ravel().copy()
    all_ways(_in_place, kernel, a)
    assert np.array_equal(a, 2.0 * x[::-1].ravel())
    shifted = np.zeros(97 * 8)
    shifted[:-8] = x.ravel()
    kernel(shifted[:-8], shifted[8:])
    assert np.array_equal(shifted[8:], 2.0 * x[::-1].ravel())
