"""Large arrays of kernels lie on the heap: threads with small stacks, several at once, forked children."""

from __future__ import annotations

import ctypes
import os
import re
import sys
import threading
from textwrap import dedent
from typing import Any

import numpy as np
import pytest

import ulna
from support.fork_scripts import run_script
from support.long_robots import long_robot
from ulna.compiler import compile, trace
from ulna.compiler.codegen.heap_arrays import MOST_ON_STACK, bytes_on_heap, with_arrays_on_heap
from ulna.compiler.procedures import Array1, f64, procedure
from ulna.compiler.runtime import jit
from ulna.numeric import loop

HERE = os.path.dirname(__file__)
FOLDERS = (HERE, os.path.dirname(os.path.dirname(HERE)))
LEAST_STACK = (
    128  # kB; that of a thread where the C library is musl, and Python and NumPy are called in it, too
)


def steps(x: Any, u: Any) -> Any:
    """A loop whose gradient needs a tape of 32 kB for a sample, 260 kB for 8."""
    end = loop(
        lambda k, *_: k < 99.0,
        lambda k, *state: (k + 1.0, *(np.array(state) * 0.99 + 0.01 * np.sin(np.roll(state, 1) + u))),
        (0.0, *x),
        limit=99,
    )
    return np.array(end[1:]) @ np.array(end[1:])


def gradient() -> Any:
    return compile(trace(steps, x=(40,), u=(40,)).value_and_gradient("u"))


@procedure
def sums(x: Array1[f64], out: Array1[f64]) -> None:
    """Sums of the numbers so far, by an array of 240 kB in between."""
    between = np.empty((30000,), f64)
    total = 0.0
    for i in range(len(x)):
        total += x[i]
        between[i] = total
    for i in range(len(x)):
        out[i] = between[i]


def check_gradient(kernel: Any, rows: int | None = None, times: int = 1) -> None:
    """Compares with the difference of the function along one direction, and repeated calls with each other."""
    rng = np.random.default_rng(rows or 0)
    x, u, du = (rng.normal(size=(40,) if rows is None else (rows, 40)) for _ in range(3))
    value, slope = kernel(x, u)
    h = 1e-6
    rise = (kernel(x, u + h * du)[0] - kernel(x, u - h * du)[0]) / (2.0 * h)
    np.testing.assert_allclose((slope * du).sum(-1), rise, rtol=1e-6)
    for _ in range(times):
        again = kernel(x, u)
        assert np.array_equal(again[0], value) and np.array_equal(again[1], slope)


def calls() -> list[Any]:
    """Calls of kernels with large arrays, whose results are compared with those in the main thread."""
    rng = np.random.default_rng(4)
    robot = ulna.Robot(long_robot(64))
    made = []
    for name in ("inverse_dynamics", "mass_matrix", "coriolis_matrix", "inverse_dynamics_derivatives"):
        kernel = robot.kernel(name)
        for rows in ((), (9,)):
            q, *others = (rng.normal(size=(*rows, robot.nv)) for _ in kernel.function.inputs)
            made.append(lambda kernel=kernel, given=(q, *others): kernel(*given))
    x = rng.normal(size=30000)
    made.append(lambda: (sums(x, out := np.zeros(x.size)), out)[1])
    return made


def in_a_small_stack() -> None:
    """Calls everything in a thread with a small stack; what was not compiled before, is compiled there."""
    kernel = gradient()
    made = calls()
    expected = [call() for call in made]
    errors: list[BaseException] = []

    def work() -> None:
        try:
            for rows in (None, 3, 20):
                check_gradient(kernel, rows)
            for call, values in zip(made, expected, strict=True):
                for value, wanted in zip(np.atleast_1d(call()), np.atleast_1d(values), strict=True):
                    assert np.array_equal(value, wanted)
        except BaseException as error:
            errors.append(error)

    threading.stack_size(LEAST_STACK * 1024)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert not errors, errors
    print("done")


def script(call: str, text: str = "") -> str:
    return f"sys.path[:0] = {FOLDERS!r}\nimport test_heap_arrays as t\n{text}\n{call}\n"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows makes stacks larger than they are asked for")
def test_kernels_with_large_arrays_run_in_a_small_stack() -> None:
    kernel = gradient()
    single, batch = kernel.report(), kernel.report(batch=True)
    assert single.heap_bytes > MOST_ON_STACK and batch.heap_bytes >= 2 * single.heap_bytes
    assert single.stack_bytes < MOST_ON_STACK and batch.stack_bytes < 2 * MOST_ON_STACK
    assert run_script(script("t.in_a_small_stack()")) == "done\n"


def test_threads_that_call_the_same_kernel_have_arrays_of_their_own() -> None:
    code = """
        kernel = t.gradient()
        t.check_gradient(kernel, 40)  # compiles both
        errors = []
        def work(k):
            try:
                for rows in (8, 20 + k, 40):
                    t.check_gradient(kernel, rows, times=20)
            except BaseException as error:
                errors.append(error)
        threading.stack_size(t.LEAST_STACK * 1024)
        threads = [threading.Thread(target=work, args=(k,)) for k in range(6)]
        for thread in threads: thread.start()
        for thread in threads: thread.join()
        assert not errors, errors
        x = np.random.default_rng(1).normal(size=(2000, 40))
        for one, two in zip(kernel(x, x), kernel(x, x, threads=3)):
            assert np.array_equal(one, two)
    """
    run_script(script(dedent(code)))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_forked_during_a_call_has_arrays() -> None:
    code = """
        kernel = t.gradient()
        t.check_gradient(kernel)
        t.check_gradient(kernel, 40)
        x, enough = np.random.default_rng(1).normal(size=(20000, 40)), threading.Event()

        def call():  # it has the memory nearly all the time, so at forks, too
            while not enough.is_set():
                kernel(x, x)

        thread = threading.Thread(target=call)
        thread.start()
        time.sleep(0.01)
        for _ in range(5):
            assert child(lambda: (t.check_gradient(kernel), t.check_gradient(kernel, 20))) == 0
        enough.set()
        thread.join()
    """
    run_script(script(dedent(code)))


_TWO = f"""
define ptr @two(i64 %k, ptr %where) nounwind {{
entry:
  %a = alloca [{MOST_ON_STACK} x i8], align 64
  %n = alloca i64
  %b = alloca <8 x float>, i64 100
  %a.end = getelementptr i8, ptr %a, i64 {MOST_ON_STACK}
  store ptr %a, ptr %where
  %where.1 = getelementptr ptr, ptr %where, i64 1
  store ptr %b, ptr %where.1
  store i64 %k, ptr %n
  %is = icmp eq i64 %k, 0
  br i1 %is, label %yes, label %no
yes:
  ret ptr %a.end
no:
  ret ptr %b
}}
"""


def test_arrays_lie_side_by_side_in_lines_of_their_own_and_every_return_gives_them_back() -> None:
    changed = with_arrays_on_heap(_TWO)
    assert bytes_on_heap(_TWO) == MOST_ON_STACK + 3200 and changed.count("call void @heap.give") == 2
    assert re.findall(r"(%\S+) = alloca", changed) == ["%n"]
    code = jit.load_text(_TWO, ("two",))
    two = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p)(code.address("two"))
    found = set()
    for k in (0, 1, 0, 1):
        where = np.zeros(2, np.uint64)
        end = two(k, where.ctypes.data)
        a, b = map(int, where)
        assert b - a == MOST_ON_STACK and a % 64 == 0 and end == b
        found.add(a)
    assert len(found) == 1  # given back each time


def test_small_arrays_stay_on_the_stack() -> None:
    assert with_arrays_on_heap(_TWO.replace(f"[{MOST_ON_STACK} x i8]", "[64 x i8]")).count("alloca") == 3
    small = compile(lambda x: x * 2.0, x=(3,))
    for batch in (False, True):
        ir = small.ir(batch)
        assert with_arrays_on_heap(ir) == ir and bytes_on_heap(ir) == 0


@pytest.mark.skipif(not jit.target().triple.startswith("x86_64"), reason="the assembly of x86-64")
def test_wide_registers_are_spilled_within_cache_lines() -> None:
    code = gradient().asm(batch=True)
    block = code[code.index("\nblock:") :]
    spills = re.findall(r"vmov([au])p[sd]\s+%[yz]mm\d+, -?\d*\(%rsp\)", block)
    assert set(spills) == {"a"} and len(spills) > 50


@pytest.mark.skipif(sys.platform != "linux", reason="limits its memory")
def test_code_whose_arrays_find_no_memory_raises() -> None:
    code = """
        import resource
        from ulna.compiler.runtime import jit
        text = "define i64 @one() {\\n ret i64 1\\n}\\n"
        jit.load_text(text, ("one",))
        limit = 2**30
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        try:
            jit.load_text(f"@m = internal global [{limit} x i8] zeroinitializer\\n"
                          "define ptr @two() {\\n ret ptr @m\\n}\\n", ("two",))
        except MemoryError as error:
            print(error)
    """
    assert "1,073,74" in run_script(dedent(code))
