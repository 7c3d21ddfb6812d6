"""Kernels as objects: pickling, copying, threads, references, memory, and the path without the fast call."""

from __future__ import annotations

import contextlib
import copy
import gc
import itertools
import math
import multiprocessing
import os
import pickle
import subprocess
import sys
import threading
import time
import tracemalloc
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.runtime import jit
from ulna.compiler.runtime import object_layout as layout
from ulna.compiler.runtime.kernel import KernelBase
from ulna.errors import CompileError


def _mixed(q, v):
    """A function with sines, a choice, a loop, and two outputs."""
    root = nm.loop(
        lambda x: abs(x * x - 2.0) > 1e-12, lambda x: (0.5 * (x + 2.0 / x),), (1.0 + v[0] * v[0],), 60
    )[0]
    return nm.where(q[0] < v[1], np.sin(q) * root, np.cos(q)), q @ v


@pytest.fixture(scope="module")
def kernel():
    return compile(_mixed, q=(3,), v=(3,))


Q, V = np.array([0.1, -0.7, 1.3]), np.array([0.4, 0.5, -2.0])
QQ, VV = np.linspace(-2, 2, 60).reshape(20, 3), np.linspace(3, -1, 60).reshape(20, 3)


def equal(a, b) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


@pytest.mark.parametrize(
    "clone",
    [copy.copy, copy.deepcopy, *(lambda k, p=p: pickle.loads(pickle.dumps(k, p)) for p in range(2, 6))],
)
def test_copies_compute_the_same(kernel, clone):
    twin = clone(kernel)
    assert isinstance(twin, KernelBase)
    assert equal(twin(Q, V), kernel(Q, V))
    assert equal(twin(QQ, VV), kernel(QQ, VV))
    assert twin.function.fingerprint == kernel.function.fingerprint
    assert twin.dtype == kernel.dtype
    assert twin.function.doc == kernel.function.doc


def test_pickling_keeps_the_type_and_the_check():
    kernel = compile(trace(lambda x: x + 1.0, x=()), np.float32, checked=True)
    twin = pickle.loads(pickle.dumps(kernel))
    assert twin.dtype == np.float32
    with pytest.raises(ValueError, match="nan"):
        twin(np.nan)


def test_a_function_can_be_pickled_and_goes_on_sharing_its_nodes(kernel):
    function = pickle.loads(pickle.dumps(kernel.function))
    assert equal(function(Q, V), kernel.function(Q, V))
    before = len(function.graph)
    for index in range(before):
        op, args = function.graph.op[index], function.graph.args[index]
        if op not in (0, 1, 2, 28, 29):
            assert function.graph.node(op, *args) == index
    assert len(function.graph) == before


def _in_child(kernel, q, v, sender):
    sender.send(kernel(q, v))


def test_a_spawned_process_takes_a_kernel(kernel):
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_in_child, args=(kernel, Q, V, sender))
    child.start()
    sender.close()  # a child that ends without an answer ends the test at once: `recv` raises EOFError
    got = receiver.recv()
    child.join(600)
    assert child.exitcode == 0
    assert equal(got, kernel(Q, V))


def test_weak_references_and_attributes():
    kernel = compile(lambda x: x + 3.0, x=())
    reference = weakref.ref(kernel)
    kernel.note = "mine"
    assert kernel.note == "mine"
    assert reference() is kernel
    del kernel
    gc.collect()
    assert reference() is None


def test_a_gufunc_outlives_its_kernel():
    kernel = compile(lambda x: np.exp(x) * 3.0, x=(2,))
    gufunc, expected = kernel.gufunc, kernel(np.ones((40, 2)))
    name, doc = gufunc.__name__, gufunc.__doc__
    del kernel
    gc.collect()
    junk = [bytes(200) for _ in range(10000)]
    np.testing.assert_array_equal(gufunc(np.ones((40, 2))), expected)
    assert (gufunc.__name__, gufunc.__doc__, gufunc.signature) == (name, doc, "(2)->(2)")
    del gufunc, junk
    gc.collect()


def test_the_type_cannot_be_made_or_called_wrongly(kernel):
    if not kernel.is_fast:
        pytest.skip("the fast call does not work here")
    with pytest.raises(TypeError, match="cannot create"):
        type(kernel)()
    assert callable(kernel)
    assert type(kernel).__name__ == "Kernel"
    assert type(kernel).__module__ == "ulna.compiler.runtime.kernel"


def test_single_calls_neither_leak_memory_nor_references(kernel):
    dtype, one, name = np.dtype(float), compile(lambda x: x * 2.0, x=()), "q"
    watched = (dtype, np.ndarray, Q, V, kernel, one, name)

    def rounds(count: int) -> None:
        for _ in range(count):
            kernel(Q, V)
            one(3.0)
            one(Q[0])
            kernel(QQ[0:2], V)
            with contextlib.suppress(TypeError):
                kernel(Q)

    rounds(200)
    gc.collect()
    before = [sys.getrefcount(w) for w in watched]
    tracemalloc.start()
    rounds(200)
    grown = math.inf
    for _ in range(5):  # other threads may allocate meanwhile, though not each time
        start = tracemalloc.get_traced_memory()[0]
        rounds(2000)
        gc.collect()
        grown = min(grown, tracemalloc.get_traced_memory()[0] - start)
        if grown < 20_000:
            break
    tracemalloc.stop()
    after = [sys.getrefcount(w) for w in watched]
    assert max(abs(a - b) for a, b in zip(after, before, strict=True)) <= 3
    assert grown < 20_000


def test_a_hundred_thousand_calls_do_not_grow_the_process(kernel):
    from support.memory import least_growth  # this module is imported by programs that know no `support`

    def calls(count: int) -> None:
        for _ in range(count):
            kernel(Q, V)

    calls(20_000)
    assert least_growth(lambda: calls(100_000), 4 * 2**20) < 4 * 2**20


def _straight(k: int):
    return lambda x: np.sin(x) * (k + 2.5)


def _looped(k: int):
    return lambda x: nm.loop(lambda y, n: n < 5.0, lambda y, n: (0.5 * y + k, n + 1.0), (x[0], 0.0), 9)[0]


@pytest.mark.parametrize("function", [_straight, _looped])
def test_machine_code_of_deleted_kernels_is_freed(monkeypatch, function):
    monkeypatch.setenv("ULNA_CACHE", "0")
    from support.memory import least_growth

    numbers = itertools.count()

    def compilations(count: int) -> None:
        for k in itertools.islice(numbers, count):
            compile(function(k), x=(6,))

    compilations(30)
    most = 100 * 6 * 2**10  # bytes; once it was 12 kB for each
    assert least_growth(lambda: compilations(100), most) < most


def test_kernels_that_come_and_go_leave_nothing_behind():
    alive = []
    for k in range(12):
        kernel = compile(lambda x, k=k: x * float(k + 2), x=())
        assert kernel(2.0) == 2.0 * (k + 2)
        assert kernel(np.ones(20))[0] == k + 2
        alive.append(weakref.ref(kernel.gufunc.__class__ and kernel))
        alive.append(weakref.ref(kernel.function))
        del kernel
    gc.collect()
    assert [r() for r in alive] == [None] * len(alive)


def test_results_are_new_arrays_that_own_their_memory(kernel):
    first, second = kernel(Q, V)[0], kernel(Q, V)[0]
    assert first.flags.owndata
    assert first.flags.writeable
    first[:] = 7.0
    assert not (second == 7.0).any()


def test_a_kernel_survives_the_loss_of_its_attributes():
    kernel = compile(lambda x: x + 0.25, x=(2,))
    kernel.__dict__.clear()
    gc.collect()
    junk = [bytes(100) for _ in range(10_000)]
    assert kernel([1, 2]).tolist() == [1.25, 2.25]
    assert kernel(np.ones((20, 2))).shape == (20, 2)
    del junk


def test_many_threads_share_a_kernel(kernel):
    rows = [(QQ[k % 20], VV[k % 20]) for k in range(400)]
    expected = [kernel(q, v) for q, v in rows]
    with ThreadPoolExecutor(8) as pool:
        for got, right in zip(pool.map(lambda a: kernel(*a), rows), expected, strict=True):
            assert equal(got, right)
        batch = kernel(QQ, VV)
        for got in pool.map(lambda _: kernel(QQ, VV), range(100)):
            assert equal(got, batch)


def test_many_threads_compile_at_once():
    def make(k: int) -> float:
        kernel = compile(lambda x: np.sin(x) * float(k % 3) + 1.0, x=())
        return float(kernel(np.full(20, 0.5))[7]) - float(kernel(0.5))

    with ThreadPoolExecutor(6) as pool:
        assert max(map(abs, pool.map(make, range(18)))) <= 2.3e-16


def test_the_first_batch_may_come_from_many_threads():
    kernel = compile(lambda x: np.cos(x) - 0.125, x=(2,))
    barrier = threading.Barrier(6)

    def run(_: int) -> np.ndarray:
        barrier.wait()
        return kernel(np.ones((50, 2)))

    with ThreadPoolExecutor(6) as pool:
        results = list(pool.map(run, range(6)))
    assert all(np.array_equal(r, results[0]) for r in results)


def test_the_gil_is_free_in_a_batch():
    """Another Python thread goes on while one batch runs in machine code."""

    def slow(x):
        return nm.loop(
            lambda v, n: n < 3000.0, lambda v, n: (v / (1.0 + v * v) + 0.5, n + 1.0), (x, 0.0), 3000
        )[0]

    kernel = compile(slow, x=())
    x = np.linspace(0, 1, 20_000)
    kernel(x[:20])
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    most = 0
    for _ in range(20):  # on a busy machine the other thread may get no processor meanwhile
        start = time.perf_counter()
        kernel(x)
        end = time.perf_counter()
        most = max(most, sum(start < t < end for t in tuple(ticks)))
        if most >= 3:
            break
    done.set()
    thread.join()
    assert most >= 3, f"{most} ticks at most"


_CHILD = """
import sys, pickle
sys.path.insert(0, sys.argv[1])
import numpy as np
from test_kernel_life import _mixed, Q, V, QQ, VV
from ulna.compiler import compile, trace
from ulna.compiler.runtime.kernel import SlowKernel
kernel = compile(_mixed, q=(3,), v=(3,))
assert isinstance(kernel, SlowKernel) and not kernel.is_fast
scalar = compile(lambda x: x * 2.0, x=())
empty = compile(lambda: np.array([1.0, 2.0]))
checked = compile(trace(lambda x: x + 1.0, x=(2,)), checked=True)
try:
    checked([np.nan, 1.0])
except ValueError as error:
    message = str(error)
tupled = compile(lambda x: (x,), x=())
twin = pickle.loads(pickle.dumps(scalar))
result = (kernel(Q, V), kernel(QQ, VV), kernel(QQ, V), scalar(3.0), type(scalar(3.0)).__name__, empty(), message,
          tupled(1.0), kernel(q=Q, v=V), repr(kernel), twin(4.0), kernel.gufunc.signature)
sys.stdout.buffer.write(pickle.dumps(result))
"""


def test_without_the_fast_call_everything_is_the_same(kernel, tmp_path):
    child = subprocess.run(
        [sys.executable, "-c", _CHILD, os.path.dirname(__file__)],
        env={**os.environ, "ULNA_FAST": "0"},
        capture_output=True,
        timeout=600,
        check=False,
    )
    assert child.returncode == 0, child.stderr.decode()
    one, batch, broadcast, number, kind, empty, message, tupled, named, shown, twin, signature = pickle.loads(
        child.stdout
    )
    for got, expected in (
        (one, kernel(Q, V)),
        (batch, kernel(QQ, VV)),
        (broadcast, kernel(QQ, V)),
        (named, kernel(Q, V)),
    ):
        for g, e in zip(got, expected, strict=True):
            np.testing.assert_allclose(g, e, rtol=3e-16, atol=0)
    assert (number, kind, empty.tolist(), tupled, twin) == (6.0, "float64", [1.0, 2.0], (1.0,), 8.0)
    assert message.startswith("`x[0]` is nan")
    assert (shown, signature) == (repr(kernel), kernel.gufunc.signature)


_LEAVES = """
import gc, weakref
import numpy as np
from ulna.compiler import compile
from ulna.compiler.runtime import jit

made, load = [], jit._load
def noted(*args, **options):
    code = load(*args, **options)
    made.append(weakref.ref(code))
    return code
jit._load = noted
for k in range(8):
    compile(lambda x: x * (k + 2.0), x=())(np.ones(20))
gc.collect()
print(len(made), sum(code() is not None for code in made))
"""


def test_without_the_fast_call_machine_code_is_freed_too():
    child = subprocess.run(
        [sys.executable, "-c", _LEAVES],
        env={**os.environ, "ULNA_FAST": "0"},
        capture_output=True,
        timeout=600,
        check=True,
    )
    assert child.stdout.split() == [b"8", b"0"]


def test_the_fast_call_works_on_this_interpreter():
    """Everywhere the project is tested it should; where it does not, the general path serves, only slower."""
    standard = sys.implementation.name == "cpython" and not hasattr(sys, "gettotalrefcount")
    if not standard or os.environ.get("ULNA_FAST") == "0":
        pytest.skip("another interpreter")
    assert layout.fast_call_works()
    assert compile(lambda x: x, x=()).is_fast


@pytest.mark.skipif(
    not layout.fast_call_works(), reason="the code of single calls is made for the fast call only"
)
def test_debug_output(capsys, monkeypatch):
    monkeypatch.setenv("ULNA_DEBUG", "graph,ir,asm,time")
    assert compile(lambda x: x * 5.5, x=())(2.0) == 11.0
    said = capsys.readouterr().out
    assert "[ulna] lambda()->(): 1 operations {'mul': 1}" in said
    assert "define ptr @entry" in said
    assert "ms in LLVM" in said or "from the cache" in said


_NO_MEMORY = """
import _testcapi
import numpy as np
from ulna.compiler import compile

count = 25  # so many results are no tuple that Python keeps for its next use
kernel = compile(lambda x: tuple(np.sin(x + k) if k % 2 else x[0] * k for k in range(count)), x=(30,))
x = np.linspace(0.0, 1.0, 30)
expected = kernel(x)
bound = kernel.into(*(np.empty_like(y) for y in expected), returns=range(count))
for call in (kernel, bound):
    refused = 0
    for k in range(80):
        hold = [np.empty(30) for _ in range(60)]  # empties NumPy's store of small blocks
        _testcapi.set_nomemory(k, k + 1)
        try:
            results = call(x)
        except MemoryError:
            refused += 1
            continue
        finally:
            _testcapi.remove_mem_hooks()
        for result, wanted in zip(results, expected, strict=True):
            assert np.array_equal(result, wanted)
    assert refused > count, refused
"""


def test_without_memory_for_a_result_a_call_raises_memory_error():
    """Each allocation of a call fails once: of an array, of its data, of a number, of the tuple."""
    pytest.importorskip("_testcapi")
    child = subprocess.run(
        [sys.executable, "-c", _NO_MEMORY], capture_output=True, text=True, timeout=600, check=False
    )
    assert child.returncode == 0, f"{child.returncode}: {child.stderr}"


@pytest.fixture
def compiled(monkeypatch) -> list[str]:
    """What of kernels is compiled or loaded, by the name of its first function."""
    names: list[str] = []
    load = jit.load

    def noted(f, ir, wanted):
        names.append(wanted[0])
        return load(f, ir, wanted)

    monkeypatch.setattr(jit, "load", noted)
    return names


def test_single_calls_are_compiled_by_the_first_of_them_only(compiled):
    kernel = compile(lambda x: np.stack([x[0] * 7.25, x[1]]), x=(2,))
    if not kernel.is_fast:
        pytest.skip("needs the fast call")
    others = kernel.jacobian()
    assert kernel.ir() and not compiled
    assert kernel(np.ones((3, 2))).tolist() == [[7.25, 1.0]] * 3
    assert compiled == ["batch"]
    out = np.zeros(2)
    assert kernel(np.ones(2), out=out) is out and out.tolist() == [7.25, 1.0]
    assert compiled == ["batch", "entry"]
    assert kernel([1.0, 2.0]).tolist() == [7.25, 2.0] and kernel(x=np.ones(2))[0] == 7.25
    assert compiled == ["batch", "entry"]
    assert others(np.ones(2)).tolist() == [[7.25, 0.0], [0.0, 1.0]]
    assert compiled == ["batch", "entry", "entry"]


def test_binding_a_kernel_compiles_it(compiled):
    kernel, out = compile(lambda x: x * 7.5, x=(2,)), np.zeros(2)
    bound = kernel.into(out)
    assert compiled == (["entry"] if kernel.is_fast else [])
    bound(np.ones(2))
    assert out.tolist() == [7.5, 7.5]


@pytest.mark.parametrize("count", [8])
def test_threads_that_call_first_at_once_compile_once(compiled, count):
    kernel = compile(lambda x: np.sin(x * 7.75), x=(40,))
    x, begin, results = np.linspace(0.0, 1.0, 40), threading.Barrier(count), []

    def call():
        begin.wait()
        results.append(kernel(x))

    threads = [threading.Thread(target=call) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(compiled) == 1 and len(results) == count
    for result in results:
        np.testing.assert_allclose(result, np.sin(x * 7.75), rtol=1e-14)


def test_a_kernel_that_cannot_be_compiled_raises_at_its_call(monkeypatch):
    kernel = compile(lambda x: x * 8.25, x=(2,))
    if not kernel.is_fast:
        pytest.skip("needs the fast call")

    def failing(*_):
        raise CompileError("no code")

    with monkeypatch.context() as patch:
        patch.setattr(jit, "load", failing)
        with pytest.raises(CompileError, match="no code"):
            kernel(np.ones(2))
    assert kernel(np.ones(2)).tolist() == [8.25, 8.25]


def test_a_kernel_that_was_never_called_is_freed():
    kernel = compile(lambda x: x * 8.5, x=(2,))
    kept = weakref.ref(kernel._array_call)
    del kernel
    gc.collect()
    assert kept() is None
