"""Laws of the compiler about memory: compiled code touches what belongs to its arguments, and all of its results."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.checked_code import READ, WRITE, CheckedCode, instrumented, runs
from support.fenced import fenced
from support.odd_layouts import Laid, laid
from support.random_functions import functions
from ulna.compiler import Function, compile, trace
from ulna.compiler.codegen import batch_loop, scheduling
from ulna.compiler.codegen.ir_text import BYTES
from ulna.compiler.codegen.module import emit_batch
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.entry_point import entry_ir

SWEEP = settings(
    max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
)
TYPE = {"double": np.float64, "float": np.float32}
CANARY = {"double": np.uint64(0x7FF8DEADBEEFCAFE), "float": np.uint32(0x7FC0BEEF)}
WORDS = {"double": np.uint64, "float": np.uint32}


@contextmanager
def small_limits(parts: bool, scratch: bool) -> Iterator[None]:
    """With `parts`, functions are split as only large ones are; with `scratch`, it holds one row."""
    with pytest.MonkeyPatch.context() as patch:
        if parts:
            patch.setattr(scheduling, "_SIZES", {False: 12, True: 12})
            patch.setattr(scheduling, "_MAX_SINGLE_PART", 0)
        if scratch:
            patch.setattr(batch_loop, "_SCRATCH", 0)
        yield


def fill(rng: np.random.Generator, array: np.ndarray) -> None:
    values = rng.normal(size=array.shape) * rng.choice([0.1, 1.0, 10.0, 1e9, 1e30], size=array.shape)
    array[...] = np.where(rng.random(array.shape) < 0.1, rng.choice([0.0, -0.0, np.inf, np.nan]), values)


class Batch:
    """A function's loop over a batch, checked."""

    def __init__(self, f: Function, element: Any, target: Any, ir: str | None = None) -> None:
        self.f, self.element, self.target = f, element, target
        self.code = CheckedCode(ir or emit_batch(f, target, element), "batch")
        self.run = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(self.code.address("batch"))

    def call(self, rng: np.random.Generator, rows: int) -> None:
        f, kind, size = self.f, TYPE[self.element], BYTES[self.element]
        inputs = [laid(rng, rows, p.shape, kind, repeats=True) for p in f.inputs]
        outputs = [self.output(rng, rows, p.shape, inputs) for p in f.outputs]
        for x in inputs:
            fill(rng, x.array)
        given = [x.array.copy() for x in inputs]
        for o in outputs:
            if not any(o is x for x in inputs):
                o.array[...] = CANARY[self.element].view(kind)
        arrays = [*inputs, *outputs]
        pointers = np.array([a.array.ctypes.data for a in arrays], np.uint64)
        dimensions = np.array([rows, *(n for a in arrays for n in a.array.shape[1:])], np.int64)
        steps = np.array(
            [a.strides[0] for a in arrays] + [s for a in arrays for s in a.strides[1:]], np.int64
        )
        areas = [(b.ctypes.data, b.ctypes.data + 8 * len(b), READ) for b in (pointers, dimensions[:1], steps)]
        for a, rights in [(x, READ) for x in inputs] + [(o, WRITE) for o in outputs]:
            areas += [(*run, rights) for row in set(map(tuple, a.addresses())) for run in runs(row, size)]
        self.code.open(areas)
        self.run(pointers.ctypes.data, dimensions.ctypes.data, steps.ctypes.data, None)
        context = rows, self.element, self.target.register_bytes, [a.name for a in arrays]
        assert self.code.fault() is None, (self.code.fault(), context)
        for o in outputs:
            bits = np.ascontiguousarray(o.array).view(WORDS[self.element])
            assert not np.any(bits == CANARY[self.element]), ("not written", context)
        for x, before in zip(inputs, given, strict=True):
            if not any(o is x for o in outputs):
                assert np.array_equal(x.array, before, equal_nan=True)

    def output(self, rng: np.random.Generator, rows: int, shape: tuple[int, ...], inputs: list[Laid]) -> Laid:
        """Memory for an output: its own, or that of an input."""
        free = [x for x in inputs if x.array.shape[1:] == shape and 0 not in x.strides]
        if free and rng.random() < 0.5:
            return free[0]
        return laid(rng, rows, shape, TYPE[self.element], repeats=False)


class Single:
    """A function's code for one sample on bare pointers, checked."""

    def __init__(self, f: Function, element: Any, target: Any, refuses: bool) -> None:
        self.f, self.element = f, element
        self.code = CheckedCode(entry_ir(f, target, element, checked=refuses), "work")
        self.run = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)(self.code.address("work"))

    def call(self, rng: np.random.Generator) -> None:
        f, kind, size = self.f, TYPE[self.element], BYTES[self.element]
        blocks = [np.zeros(p.size + 48, kind) for p in (*f.inputs, *f.outputs)]
        arrays = []
        for block, p in zip(blocks, (*f.inputs, *f.outputs), strict=True):
            first = int(rng.integers(16, 32))
            arrays.append(block[first : first + p.size])
        inputs, outputs = arrays[: len(f.inputs)], arrays[len(f.inputs) :]
        for k, o in enumerate(outputs):  # an output may be an input
            fitting = [x for x in inputs if x.size == o.size]
            if k == 0 and fitting and rng.random() < 0.5:
                outputs[0] = fitting[0]
        for x in inputs:
            x[...] = rng.normal(size=x.shape) * rng.choice([0.1, 1.0, 1e9, 1e30], size=x.shape)
        for o in outputs:
            if not any(o is x for x in inputs):
                o[...] = CANARY[self.element].view(kind)
        pointers = np.array([a.ctypes.data for a in (*inputs, *outputs)], np.uint64)
        areas = [(pointers.ctypes.data, pointers.ctypes.data + 8 * len(pointers), READ)]
        for a, rights in [(x, READ) for x in inputs] + [(o, WRITE) for o in outputs]:
            areas.append((a.ctypes.data, a.ctypes.data + size * a.size, rights))
        self.code.open(areas)
        refused = self.run(pointers.ctypes.data)
        assert self.code.fault() is None, self.code.fault()
        assert refused == 0
        for o in outputs:
            assert not np.any(o.view(WORDS[self.element]) == CANARY[self.element]), "not written"


ANY = st.one_of(functions(wide=True), functions(wide=True, lanes=4))
ELEMENTS, REGISTERS = st.sampled_from(["double", "float"]), st.sampled_from([16, 32, 64])
BOOL, SEED = st.booleans(), st.integers(0, 1000)


@pytest.mark.slow
@SWEEP
@given(f=ANY, element=ELEMENTS, register=REGISTERS, parts=BOOL, scratch=BOOL, seed=SEED)
def test_batches_touch_their_rows_and_nothing_else(f, element, register, parts, scratch, seed):
    """From 0 rows to three blocks and one more, of every layout, with outputs that are inputs."""
    target = dataclasses.replace(jit.target(), register_bytes=register)
    with small_limits(parts, scratch):
        batch = Batch(f, element, target)
    rng = np.random.default_rng(seed)
    for rows in range(3 * target.lanes(element) + 2):
        batch.call(rng, rows)


@pytest.mark.slow
@SWEEP
@given(f=ANY, element=ELEMENTS, parts=BOOL, refuses=BOOL, seed=SEED)
def test_single_calls_touch_their_arrays_and_nothing_else(f, element, parts, refuses, seed):
    with small_limits(parts, False):
        single = Single(f, element, jit.target(), refuses)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        single.call(rng)


class Fenced:
    """A kernel on arrays that begin or end at a page without access, called in every way there is."""

    def __init__(self, f: Function, element: Any, checked: bool, seed: int) -> None:
        self.f, self.kind = f, TYPE[element]
        self.kernel = compile(f, self.kind, checked=checked)
        self.loop = self.kernel.gufunc
        self.rng = np.random.default_rng(seed)

    def array(self, shape: tuple[int, ...]) -> np.ndarray:
        x = fenced(int(np.prod(shape)), self.kind, self.rng.random() < 0.5).reshape(shape)
        x[...] = self.rng.normal(size=shape)
        return x

    def layout(self, rows: int, shape: tuple[int, ...], repeats: bool) -> np.ndarray:
        at_end = self.rng.random() < 0.5
        x = laid(self.rng, rows, shape, self.kind, repeats, lambda n: fenced(n, self.kind, at_end)).array
        x[...] = self.rng.normal(size=x.shape)
        return x

    def single(self) -> None:
        f, kernel = self.f, self.kernel
        inputs = [self.array(p.shape) for p in f.inputs]
        outputs = tuple(self.array(p.shape) for p in f.outputs)
        expected = kernel(*inputs)
        same(kernel(*inputs, out=outputs), expected)
        copies, bound = [x.copy() for x in inputs], kernel.into(*outputs, returns=range(len(outputs)))
        same(results(bound(*inputs)), expected)
        same(
            results(kernel.into(*outputs, returns=[0], trailing_inputs=inputs[-1:])(*inputs[:-1])),
            expected[:1],
        )
        watched = [(self.array((n,)).astype(np.float64), np.zeros(n)) for n in (1, 7, 8, 19)]
        pairs = []
        for kept, _ in watched:
            live, twin = (fenced(kept.size, np.float64, self.rng.random() < 0.5) for _ in range(2))
            live[...] = twin[...] = kept
            pairs.append((live, twin))
        watching = kernel.into(*outputs, returns=[0], watch=pairs, otherwise=lambda *_: "else")
        same(results(watching(*inputs)), expected[:1])
        pairs[-1][0][-1] += 1.0
        assert watching(*inputs) == "else"
        for k, (x, o) in enumerate((x, o) for x in inputs for o in range(len(outputs))):
            if x.shape == outputs[o].shape and k < 3:  # the output is an input
                out = tuple(x if n == o else y for n, y in enumerate(outputs))
                same(kernel(*inputs, out=out), expected)
                for y, before in zip(inputs, copies, strict=True):
                    y[...] = before

    def batch(self, rows: int) -> None:
        f = self.f
        inputs = [self.layout(rows, p.shape, True) for p in f.inputs]
        outputs = tuple(self.layout(rows, p.shape, False) for p in f.outputs)
        expected = self.kernel(*(x.copy() for x in inputs))
        same(self.kernel(*inputs, out=outputs), expected)
        same(self.kernel(*inputs), expected)
        for x, p in zip(inputs, f.inputs, strict=True):
            if p.shape == f.outputs[0].shape and 0 not in x.strides:
                same(self.kernel(*inputs, out=(x, *outputs[1:])), expected)
                return


def results(found: Any) -> tuple[Any, ...]:
    return found if isinstance(found, tuple) else (found,)


def same(found: Any, expected: Any) -> None:
    for x, y in zip(found, expected, strict=True):
        assert np.array_equal(x, y, equal_nan=True)


def in_child(work: Callable[[], None]) -> None:
    """Runs `work` in a forked process, so that a fault of memory fails the test and does not end it."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert status == 0, f"exit code {status}" if status > 0 else f"signal {-status}"


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork and mprotect")
@SWEEP
@given(f=functions(wide=True), element=ELEMENTS, checked=BOOL, seed=SEED)
def test_kernels_stay_between_closed_pages(f, element, checked, seed):
    """Calls with `out`, bound calls with `given` and `watch`, and batches, as users make them."""
    calls = Fenced(f, element, checked, seed)
    last = 3 * jit.target().lanes(element) + 1

    def work() -> None:
        with np.errstate(all="ignore"):
            calls.single()
            for rows in sorted({0, 1, 2, last // 3 - 1, last // 3, last // 3 + 1, last - 1, last}):
                calls.batch(rows)

    in_child(work)


FAULTS = {
    "an output's row": ("ptr %o0, i64 8", "ptr %o0, i64 9"),
    "an input's row": ("ptr %i0, i64 4", "ptr %i0, i64 5"),
    "rows behind the last": ("%last = sub i64 %left, 1", "%last = sub i64 %left, 0"),
    "one row in all lanes": ("%e1 = select i1 %single, i64 0", "%e1 = select i1 %single, i64 8"),
    "scratch": ("%t0 = alloca double, i64 20", "%t0 = alloca double, i64 19"),
    "alignment": ("ptr %p37, align 8", "ptr %p37"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_an_access_outside_is_noticed(fault):
    """What the sweeps would see if such a fault were in the code for a batch."""
    target = dataclasses.replace(jit.target(), register_bytes=32)
    f = trace(lambda a: np.concatenate([2.0 * a, 1.0 + a]), a=(5,))
    ir = emit_batch(f, target)
    broken = ir.replace(*FAULTS[fault])
    assert broken != ir
    rng, batch = np.random.default_rng(5), Batch(f, "double", target, broken)
    with pytest.raises(AssertionError, match="accesses outside"):
        for rows in [*range(14)] * 3:
            batch.call(rng, rows)


def test_an_access_of_an_unknown_form_is_refused():
    with pytest.raises(ValueError, match="not checked"):
        instrumented(
            "define void @f(ptr %p) {\n  call void @llvm.memset.p0.i64(ptr %p, i8 0, i64 8, i1 false)\n}"
        )
