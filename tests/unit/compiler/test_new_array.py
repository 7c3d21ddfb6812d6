"""Arrays that compiled code makes: what NumPy makes of them, and what it does with them."""

from __future__ import annotations

import ctypes
import gc
import math
import pickle
import sys
import tracemalloc
import weakref
from typing import Any

import numpy as np
import pytest

from ulna.compiler import compile, trace
from ulna.compiler.runtime import entry_point, gufunc, new_array
from ulna.compiler.runtime.object_layout import ARRAY_NEW, TYPE_NUMBER, array_function

pytestmark = pytest.mark.skipif(not new_array.works(), reason="NumPy makes the arrays here")

SET_HANDLER = 304
SHAPES = [(3,), (1,), (1, 1), (2, 3), (3, 1), (1, 4), (2, 3, 4), (1, 2, 1), (2,) * 7, (2,) * 8, (0,), (2, 0, 3), (129, 1025)]  # fmt: skip


def made(shape: tuple[int, ...], element: str = "double") -> np.ndarray:
    """A new array, as a call of a kernel makes it."""
    word = ctypes.c_void_p
    make = ctypes.PYFUNCTYPE(
        ctypes.py_object, word, ctypes.c_int, word, ctypes.c_int, word, word, ctypes.c_int, ctypes.c_int, word
    )(gufunc._array_new())
    lengths = (ctypes.c_int64 * len(shape))(*shape)
    address = ctypes.addressof(lengths)
    return make(id(np.ndarray), len(shape), address, TYPE_NUMBER[element], None, None, 0, 0, None)


def handler_of(array: np.ndarray) -> str:
    """The name of what allocated the data of an array."""
    return np._core.multiarray.get_handler_name(array)  # type: ignore[attr-defined]


def test_kernels_make_their_arrays_so():
    assert gufunc._array_new() != array_function(ARRAY_NEW)


def test_the_first_kernel_of_an_empty_cache_does_not_wait_for_it(monkeypatch, tmp_path):
    def maker(kernel: Any) -> int:
        return ctypes.c_uint64.from_address(id(kernel) + entry_point.NEW).value

    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "kernels"))
    monkeypatch.setattr(gufunc, "_made_by_numpy", [])
    later: list[Any] = []
    monkeypatch.setattr(gufunc, "run_later", lambda name, work: later.append(work))
    gufunc._array_new.cache_clear()
    first = compile(lambda x: 2.0 * x, x=(3,))
    assert first(np.ones(3)).tolist() == [2.0] * 3
    assert maker(first) == array_function(ARRAY_NEW)
    second = compile(lambda x: 3.0 * x, x=(3,))
    (work,) = later
    work()
    assert maker(first) == maker(second) == gufunc._array_new() != array_function(ARRAY_NEW)
    assert first(np.ones(3)).tolist() == [2.0] * 3


@pytest.mark.parametrize("element", ["double", "float"])
@pytest.mark.parametrize("shape", SHAPES)
def test_is_as_numpy_makes_it(shape, element):
    array, expected = made(shape, element), np.empty(shape, {"double": "d", "float": "f"}[element])
    assert type(array) is np.ndarray and array.dtype is expected.dtype and array.base is None
    assert (array.shape, array.strides, array.flags.num) == (
        expected.shape,
        expected.strides,
        expected.flags.num,
    )
    assert handler_of(array) == handler_of(expected)
    assert sys.getrefcount(array) == sys.getrefcount(expected)
    values = np.arange(math.prod(shape), dtype=expected.dtype).reshape(shape)
    array[...] = values
    for other in (array.copy(), pickle.loads(pickle.dumps(array)), np.array(array.data)):
        assert np.array_equal(other, values)


def test_is_changed_in_place_as_any_array():
    array = made((4,))
    array[...] = range(4)
    array.resize(100_000)
    assert np.array_equal(array[:5], [0, 1, 2, 3, 0])
    array.resize((2, 2))
    assert np.array_equal(array, [[0, 1], [2, 3]])
    array.shape = (1, 2, 2)
    assert array.strides == (32, 16, 8)
    array.setflags(write=False)
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 0.0


def test_goes_with_its_last_reference():
    array = made((2, 3))
    gone = weakref.ref(array)
    view = array[1:]
    del array
    assert gone() is not None and view.base is gone()
    del view
    assert gone() is None


def test_nothing_is_left_of_many():
    descriptor = np.dtype(float)
    probe = np.empty(1)
    handlers = ctypes.c_ssize_t.from_address(new_array._default_handler()[0])
    for _ in range(100):
        made((3, 4))
    gc.collect()
    before = sys.getrefcount(descriptor), handlers.value, sys.getallocatedblocks()
    for _ in range(1000):
        made((3, 4))
    kept = [made((5,)) for _ in range(1000)]
    assert (sys.getrefcount(descriptor) - before[0], handlers.value - before[1]) == (1000, 1000)
    del kept
    gc.collect()
    assert (sys.getrefcount(descriptor), handlers.value) == before[:2]
    assert sys.getallocatedblocks() - before[2] < 50
    del probe


def test_data_are_traced_as_those_of_numpy():
    def traced() -> int:
        domain = tracemalloc.DomainFilter(True, np.lib.tracemalloc_domain)
        statistics = tracemalloc.take_snapshot().filter_traces([domain]).statistics("filename")
        return sum(entry.size for entry in statistics)

    tracemalloc.start()
    try:
        before = traced()
        small, large = made((3, 5)), made((1000, 3), "float")
        assert traced() - before == small.nbytes + large.nbytes
        del small, large
        assert traced() == before
    finally:
        tracemalloc.stop()


def test_the_allocator_of_a_user_is_used():
    """NEP 49: a capsule with a structure of functions."""
    libc, taken = ctypes.pythonapi, []
    libc.PyMem_RawMalloc.restype, libc.PyMem_RawMalloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.PyMem_RawFree.restype, libc.PyMem_RawFree.argtypes = None, [ctypes.c_void_p]
    word, size = ctypes.c_void_p, ctypes.c_size_t

    def allocate(_: object, count: int) -> int:
        taken.append(count)
        return libc.PyMem_RawMalloc(count)

    functions = (
        ctypes.PYFUNCTYPE(word, word, size)(allocate),
        ctypes.PYFUNCTYPE(word, word, size, size)(lambda _, count, each: allocate(_, count * each)),
        ctypes.PYFUNCTYPE(word, word, word, size)(lambda _, at, count: None),
        ctypes.PYFUNCTYPE(None, word, word, size)(lambda _, at, count: libc.PyMem_RawFree(at)),
    )

    class Handler(ctypes.Structure):
        _fields_ = (("name", ctypes.c_char * 127), ("version", ctypes.c_uint8), ("functions", word * 5))

    table = (word * 5)(None, *(ctypes.cast(function, word).value for function in functions))
    handler = Handler(b"of_a_user", 1, table)
    new_capsule = ctypes.pythonapi.PyCapsule_New
    new_capsule.restype, new_capsule.argtypes = ctypes.py_object, [word, ctypes.c_char_p, word]
    capsule = new_capsule(ctypes.addressof(handler), b"mem_handler", None)
    set_handler = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(array_function(SET_HANDLER))
    double = compile(trace(lambda q: q * 2.0, q=(11,)))
    q = np.arange(11.0)
    double(q)
    former = set_handler(capsule)
    try:
        array, twice = made((7,)), double(q)
        assert handler_of(array) == handler_of(twice) == "of_a_user"
        assert taken == [array.nbytes, twice.nbytes] and np.array_equal(twice, 2.0 * q)
        del array, twice
    finally:
        set_handler(former)
    assert handler_of(made((7,))) == handler_of(double(q)) == "default_allocator"


@pytest.mark.parametrize("shape", [(1 << 50,), (1 << 25, 1 << 25)])
def test_too_large_an_array_is_an_error_and_leaves_nothing(shape):
    handlers = ctypes.c_ssize_t.from_address(new_array._default_handler()[0])
    references = sys.getrefcount(np.dtype(float)), handlers.value
    grown = []
    for _ in range(5):  # other threads, and what is imported for the first error, allocate as well
        gc.collect()
        before = sys.getallocatedblocks()
        for _ in range(200):
            with pytest.raises(MemoryError):
                made(shape)
        gc.collect()
        grown.append(sys.getallocatedblocks() - before)
    assert (sys.getrefcount(np.dtype(float)), handlers.value) == references
    assert min(grown) < 100
