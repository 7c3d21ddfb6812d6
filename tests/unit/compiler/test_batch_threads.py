"""Batches in threads: bit for bit those of one thread, wherever the arrays lie and whoever computes them."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from support.callers import call_at_once
from ulna.compiler import compile
from ulna.compiler.runtime import array_call, shared_batch
from ulna.compiler.runtime.object_layout import fast_call_works
from ulna.compiler.runtime.shared_call import SharedCall
from ulna.errors import InputError, NonFiniteError, ShapeError

ROWS = 777


@pytest.fixture(autouse=True)
def _small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of 16 rows, so that small batches have many."""
    monkeypatch.setattr(array_call, "_LEAST_WORK", 1)


def _two(a: Any, b: Any) -> Any:
    return a @ b + np.sin(b), np.exp(-a[0, 0]) * b[0]


def _kernel(dtype: Any = np.float64) -> Any:
    return compile(_two, dtype=dtype, a=(3, 3), b=(3,))


def _arguments(batch: tuple[int, ...] = (ROWS,), dtype: Any = np.float64) -> list[np.ndarray]:
    rng = np.random.default_rng(3)
    return [rng.uniform(-1, 1, (*batch, 3, 3)).astype(dtype), rng.uniform(-1, 1, (*batch, 3)).astype(dtype)]


def _unaligned(x: np.ndarray) -> np.ndarray:
    moved = np.empty(x.nbytes + 1, np.uint8)[1:].view(x.dtype).reshape(x.shape)
    moved[...] = x
    return moved


def _laid_out(case: str, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The arrays with other distances between their numbers."""
    if case == "backwards":
        return a[::-1], b[::-1, ::-1]
    if case == "gaps":
        return np.repeat(a, 2, axis=0)[::2], b
    return (np.asfortranarray(a), b) if case == "columns first" else (a, b)


def _equal(kernel: Any, arguments: list[np.ndarray], threads: int = 3) -> None:
    for result, wanted in zip(kernel(*arguments, threads=threads), kernel(*arguments), strict=True):
        np.testing.assert_array_equal(result, wanted)


@pytest.fixture
def shared(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """What `share` answered: whether machine code took the rows."""
    answers: list[bool] = []

    def share(*arguments: Any) -> bool:
        answers.append(shared_batch.share(*arguments))
        return answers[-1]

    monkeypatch.setattr(array_call, "share", share)
    return answers


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("threads", [2, 3, 64])
def test_rows_are_shared_by_machine_code(shared: list[bool], dtype: Any, threads: int) -> None:
    _equal(_kernel(dtype), _arguments(dtype=dtype), threads)
    assert shared == [True]


@pytest.mark.parametrize("rows", [32, 33, 47, 48, 100])
def test_short_batches(shared: list[bool], rows: int) -> None:
    _equal(_kernel(), _arguments((rows,)))
    assert shared == [True]


@pytest.mark.parametrize(
    "case", ["backwards", "gaps", "columns first", "one row", "no row", "rows alike", "two axes"]
)
def test_rows_at_equal_distances_are_shared(shared: list[bool], case: str) -> None:
    a, b = _arguments((7, 111)) if case == "two axes" else _arguments()
    a, b = _laid_out(case, a, b)
    if case == "one row":
        a = a[:1]
    elif case == "no row":
        a = a[0]
    elif case == "rows alike":
        a = np.broadcast_to(a[5], a.shape)
    _equal(_kernel(), [a, b])
    assert shared == [True]


@pytest.mark.parametrize("case", ["unaligned", "broadcast", "transposed"])
def test_other_rows_are_cut_by_numpy(shared: list[bool], case: str) -> None:
    a, b = _arguments() if case == "unaligned" else _arguments((7, 111))
    if case == "unaligned":
        a = _unaligned(a)
    elif case == "broadcast":
        a = a[:1]
    else:
        a = np.ascontiguousarray(a.swapaxes(0, 1)).swapaxes(0, 1)
    _equal(_kernel(), [a, b])
    assert shared == [False]


@pytest.mark.parametrize("case", ["plain", "gaps", "wider"])
def test_results_are_written_where_they_belong(shared: list[bool], case: str) -> None:
    kernel, arguments = _kernel(), _arguments()
    wide = np.full((2 * ROWS, 3), np.nan), np.full(2 * ROWS, np.nan)
    out = {
        "plain": (np.empty((ROWS, 3)), np.empty(ROWS)),
        "gaps": (wide[0][::2], wide[1][::2]),
        "wider": (np.empty((ROWS, 3), np.longdouble), np.empty(ROWS)),
    }[case]
    assert kernel(*arguments, out=out, threads=3)[0] is out[0]
    for result, wanted in zip(out, kernel(*arguments), strict=True):
        np.testing.assert_array_equal(result, wanted)
    assert np.isnan(wide[0][1::2]).all() and np.isnan(wide[1][1::2]).all()
    assert shared == ([True] if case != "wider" else [])


def test_results_in_the_place_of_arguments_are_those_of_one_thread(shared: list[bool]) -> None:
    kernel = compile(lambda x: np.cos(x[::-1]), x=(3,))
    x = _arguments()[1]
    wanted = kernel(x)
    assert kernel(x, out=x, threads=3) is x and not shared
    np.testing.assert_array_equal(x, wanted)


def test_results_are_not_written_to_what_is_read_only() -> None:
    out = np.zeros((ROWS, 3)), np.zeros(ROWS)
    out[1].flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        _kernel()(*_arguments(), out=out, threads=3)
    assert not out[1].any()


def test_several_threads_with_helpers_each() -> None:
    kernel, arguments = _kernel(), _arguments()

    def run() -> None:
        for _ in range(30):
            _equal(kernel, arguments)

    call_at_once(run, 4)


def test_a_kernel_from_a_pickle(shared: list[bool]) -> None:
    _equal(pickle.loads(pickle.dumps(_kernel())), _arguments())
    assert shared == [True]


def test_small_batches_are_left_to_one_thread(shared: list[bool], monkeypatch: pytest.MonkeyPatch) -> None:
    kernel, small = _kernel(), _kernel(np.float32)
    work = 8 * (3 * 3 + 3 + 3 + 1 + kernel.operations // 8)
    monkeypatch.setattr(array_call, "_LEAST_WORK", work * ROWS)  # that of so many rows in float64
    _equal(kernel, _arguments())
    _equal(small, _arguments((3 * ROWS,), np.float32))
    assert not shared
    _equal(kernel, _arguments((3 * ROWS,)))
    _equal(small, _arguments((5 * ROWS,), np.float32))
    assert shared == [True, True]


def test_rows_that_machine_code_does_not_take_are_cut_by_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []

    def share(*arguments: Any) -> bool:
        calls.append(1)
        return False

    monkeypatch.setattr(array_call, "share", share)
    _equal(_kernel(), _arguments())
    assert calls == [1]


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """What calls of `SharedCall` answered: whether machine code took the arrays as they were passed."""
    answers: list[bool] = []
    call = SharedCall.__call__

    def recorded(self: SharedCall, arrays: Any, threads: int) -> bool:
        answers.append(call(self, arrays, threads))
        return answers[-1]

    monkeypatch.setattr(SharedCall, "__call__", recorded)
    return answers


def _used(kernel: Any, arguments: list[np.ndarray]) -> Any:
    """A kernel that shared a batch before, so that machine code examines the arrays of the next one."""
    kernel(*arguments, threads=2)
    return kernel


needs_fast_call = pytest.mark.skipif(not fast_call_works(), reason="arrays lie differently in memory")


@needs_fast_call
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("threads", [2, 3, 64])
@pytest.mark.parametrize("case", ["plain", "backwards", "gaps", "columns first", "no row"])
def test_machine_code_takes_plain_arrays(plain: list[bool], case: str, dtype: Any, threads: int) -> None:
    a, b = _arguments(dtype=dtype)
    kernel = _used(_kernel(dtype), [a, b])
    a, b = _laid_out(case, a, b)
    if case == "no row":
        b = b[0]
    _equal(kernel, [a, b], threads)
    out = np.full((2 * ROWS, 3), np.nan, dtype)[::2], np.full(ROWS, np.nan, dtype)
    assert kernel(a, b, out=out, threads=threads)[0] is out[0]
    for result, wanted in zip(out, kernel(a, b), strict=True):
        np.testing.assert_array_equal(result, wanted)
    assert plain == [True, True]


class _Derived(np.ndarray):
    """A class of arrays."""


@needs_fast_call
@pytest.mark.parametrize(
    "case",
    [
        "derived",
        "another type",
        "other bytes",
        "unaligned",
        "one row",
        "two axes",
        "broadcast",
        "list",
        "many",
    ],
)
def test_other_arrays_go_the_general_way(plain: list[bool], case: str) -> None:
    arguments = _arguments({"two axes": (7, 111), "many": (6000,)}.get(case, (ROWS,)))
    kernel = _used(_kernel(), arguments)
    change: dict[str, Any] = {
        "derived": lambda x: x.view(_Derived),
        "another type": lambda x: x.astype(np.float32).astype(np.longdouble),
        "other bytes": lambda x: x.astype(x.dtype.newbyteorder()),
        "unaligned": _unaligned,
        "one row": lambda x: x[:1],
        "broadcast": lambda x: np.broadcast_to(x, (2, *x.shape)),
        "list": lambda x: x.tolist(),
    }
    a, b = arguments
    _equal(kernel, [a, change.get(case, lambda x: x)(b)], 300 if case == "many" else 3)
    assert not any(plain)


@needs_fast_call
def test_plain_arrays_of_wrong_shape_or_length_are_refused(plain: list[bool]) -> None:
    a, b = _arguments()
    kernel = _used(_kernel(), [a, b])
    out = np.zeros((ROWS, 3)), np.zeros(ROWS)
    for arguments, targets in (
        ((a, b[:-1]), None),
        ((a, b[:, :2]), None),
        ((a[:, :2], b), None),
        ((a,), None),
        ((a, b), out[:1]),
        ((a, b), (out[0][:-1], out[1])),
        ((a, b), (out[0], np.zeros((ROWS, 1)))),
        ((a, b), (out[0], np.zeros(ROWS, np.int64))),
    ):
        with pytest.raises((InputError, TypeError)):
            kernel(*arguments, out=targets, threads=3)
    out[1].flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        kernel(a, b, out=out, threads=3)
    assert not any(plain) and not out[0].any() and not out[1].any()


@needs_fast_call
@pytest.mark.parametrize("shift", [-1, 0, 1])
def test_plain_results_in_the_place_of_arguments_are_those_of_one_thread(
    plain: list[bool], shift: int
) -> None:
    kernel = compile(lambda x: np.cos(x[::-1]), x=(3,))
    memory = np.random.default_rng(1).uniform(-1, 1, (ROWS + 2, 3))
    _used(kernel, [memory])
    x, out = memory[1:-1], memory[1 + shift : ROWS + 1 + shift]
    wanted = kernel(x.copy())
    kernel(x, out=out, threads=3)
    np.testing.assert_array_equal(out, wanted)
    assert plain == [False]


@needs_fast_call
def test_checked_kernels_look_at_numbers_first(plain: list[bool]) -> None:
    a, b = _arguments()
    kernel = _used(compile(_two, checked=True, a=(3, 3), b=(3,)), [a, b])
    _equal(kernel, [a, b])
    assert plain == [True]
    b[700, 1] = np.nan
    out = np.zeros((ROWS, 3)), np.zeros(ROWS)
    for arguments, targets in (((a, b), None), ((a, b), out), ((a, b.tolist()), None)):
        with pytest.raises(NonFiniteError, match=r"b\[700, 1\]"):
            kernel(*arguments, out=targets, threads=3)
    with pytest.raises(ShapeError):
        kernel(a, b[:, :2], threads=3)
    assert plain == [True] and not out[0].any() and not out[1].any()


@needs_fast_call
def test_checked_kernels_look_at_quaternions_first(plain: list[bool]) -> None:
    q = np.tile([0.0, 0.6, 0.0, 0.8], (ROWS, 1))
    kernel = compile(lambda q: 2.0 * q, checked=True, unit_entries=((0, (0, 1, 2, 3)),), q=(4,))
    np.testing.assert_array_equal(_used(kernel, [q])(q, threads=3), 2.0 * q)
    assert plain == [True]
    q[700] *= 1.1
    with pytest.raises(InputError, match="length"):
        kernel(q, threads=3)
