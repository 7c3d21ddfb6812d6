"""Makes arrays as `PyArray_New` does, by NumPy's public structures, without what other kinds of arrays need.

It makes the object, lengths and steps in one block, and data by NumPy's own allocator: `resize`, `del` and whatever
else happens to the array find what they expect. That takes two thirds of the time. Where anything differs (a memory
handler of the user's, an empty array, no memory), `PyArray_New` is called.

Source: NumPy, ndarraytypes.h (PyArrayObject_fields, PyDimMem_NEW), and NEP 49 (memory handlers).
"""

from __future__ import annotations

import ctypes

import numpy as np

from ulna.compiler.runtime.object_layout import (
    ALIGNED,
    ARRAY_DESCRIPTOR,
    ARRAY_NEW,
    BASE,
    BUFFER,
    DATA,
    DEFAULT_HANDLER,
    FLAGS,
    GET_HANDLER,
    LENGTHS,
    MAY_WRITE,
    MEMORY_HANDLER,
    NDIM,
    NUMPY_TYPE,
    OWNED,
    STEPS,
    TYPE_NUMBER,
    WEAK_REFERENCES,
    WORD,
    array_function,
    c_function,
    fast_call_works,
    has_gil,
)

_WORDS = (
    "array_new", "get_handler", "handler", "malloc", "context",
    "object_new", "object_free", "raw_malloc", "raw_free", "track", "incref", "decref", "double", "float",
)  # fmt: skip
"""The words of the table that `fill` fills: functions and objects of CPython and NumPy."""
_C_FUNCTIONS = {
    "object_new": "_PyObject_New", "object_free": "PyObject_Free", "raw_malloc": "PyMem_RawMalloc",
    "raw_free": "PyMem_RawFree", "track": "PyTraceMalloc_Track", "incref": "Py_IncRef", "decref": "Py_DecRef",
}  # fmt: skip
_TRACE_DOMAIN = 389047
"""The number under which NumPy tells `tracemalloc` of data."""
_MADE = 0x0001 | ALIGNED | MAY_WRITE | OWNED
_FORTRAN = 0x0002
_HANDLER_VERSION, _HANDLER_CONTEXT = 127, 128
"""Of a memory handler (NEP 49): its version, behind its name, and context, malloc, calloc, realloc and free [byte]."""
_TP_ALLOC, _TP_FREE = 47, 74
"""Numbers of slots of types in CPython's stable interface."""
_FIRST_VERSION, _LAST_VERSION = (2, 0), (2, 4)
"""NumPy's, by whose sources and behaviour this was checked: with which allocator it frees lengths cannot be read."""
_MOST_AXES = 7
"""NumPy keeps blocks of up to 15 lengths and steps for other arrays; longer ones are not worth it."""


def _word(name: str, kind: str = "ptr") -> str:
    """Lines that load a word of the table as `%name`."""
    at = f"getelementptr (i64, ptr @new_array_words, i64 {_WORDS.index(name)})"
    return f"  %{name} = load {kind}, ptr {at}"


def _store(value: str, offset: int, kind: str = "ptr") -> str:
    """Lines that store a field of `%array`."""
    return (
        f"  %at.{offset} = getelementptr i8, ptr %array, i64 {offset}\n"
        f"  store {kind} {value}, ptr %at.{offset}"
    )


_ARGUMENTS = (
    "ptr %type, i32 %axes, ptr %lengths, i32 %number, ptr %steps, ptr %data.given, i32 %itemsize, i32 %flags, "
    "ptr %from"
)

NEW_ARRAY_IR = f"""
@new_array_words = global [{len(_WORDS)} x i64] zeroinitializer
; A new C-contiguous array of float64 or float32, with one axis or more; all arguments behind %number are zero.
define ptr @new_array({_ARGUMENTS}) nounwind {{
entry:
{_word("get_handler")}
{_word("handler")}
{_word("object_new")}
{_word("raw_malloc")}
  %count = zext i32 %axes to i64
  %current = call ptr %get_handler()
  %is.default = icmp eq ptr %current, %handler
  %few = icmp ule i32 %axes, {_MOST_AXES}
  %is.usual = and i1 %is.default, %few
  br i1 %is.usual, label %memory, label %other
memory:
  %block.bytes = shl nuw i64 %count, 4
  %array = call ptr %object_new(ptr %type)
  %block = call ptr %raw_malloc(i64 %block.bytes)
  %no.array = icmp eq ptr %array, null
  %no.block = icmp eq ptr %block, null
  %failed = or i1 %no.array, %no.block
  br i1 %failed, label %release, label %sizes
sizes:
  %is.double = icmp eq i32 %number, {TYPE_NUMBER["double"]}
  %size = select i1 %is.double, i64 8, i64 4
  %block.steps = getelementptr i64, ptr %block, i64 %count
  br label %axis
axis:
  %left = phi i64 [ %count, %sizes ], [ %j, %axis ]
  %step = phi i64 [ %size, %sizes ], [ %bytes, %axis ]
  %long.j = phi i64 [ 0, %sizes ], [ %long, %axis ]
  %j = sub nuw i64 %left, 1
  %from.j = getelementptr i64, ptr %lengths, i64 %j
  %length = load i64, ptr %from.j
  %to.length = getelementptr i64, ptr %block, i64 %j
  %to.step = getelementptr i64, ptr %block.steps, i64 %j
  store i64 %length, ptr %to.length
  store i64 %step, ptr %to.step
  %bytes = mul i64 %step, %length
  %is.long = icmp ne i64 %length, 1
  %one.long = zext i1 %is.long to i64
  %long = add i64 %long.j, %one.long
  %more = icmp ne i64 %j, 0
  br i1 %more, label %axis, label %sized
sized:
{_word("malloc")}
{_word("context")}
  %empty = icmp eq i64 %bytes, 0
  br i1 %empty, label %release, label %filled
filled:
  %data = call ptr %malloc(ptr %context, i64 %bytes)
  %no.data = icmp eq ptr %data, null
  br i1 %no.data, label %release, label %fields
fields:
{_word("track")}
{_word("incref")}
{_word("double")}
{_word("float")}
  %descriptor = select i1 %is.double, ptr %double, ptr %float
  %traced = call i32 %track(i32 {_TRACE_DOMAIN}, ptr %data, i64 %bytes)
  call void %incref(ptr %descriptor)
  %is.flat = icmp ule i64 %long, 1
  %made = select i1 %is.flat, i32 {_MADE | _FORTRAN}, i32 {_MADE}
{_store("%data", DATA)}
{_store("%axes", NDIM, "i32")}
{_store("%block", LENGTHS)}
{_store("%block.steps", STEPS)}
{_store("null", BASE)}
{_store("%descriptor", ARRAY_DESCRIPTOR)}
{_store("%made", FLAGS, "i32")}
{_store("null", WEAK_REFERENCES)}
{_store("null", BUFFER)}
{_store("%current", MEMORY_HANDLER)}
  ret ptr %array
release:
{_word("object_free")}
{_word("raw_free")}
  call void %object_free(ptr %array)
  call void %raw_free(ptr %block)
  br label %other
other:
  %has.error = phi i1 [ false, %entry ], [ %no.array, %release ]
{_word("decref")}
{_word("array_new")}
  call void %decref(ptr %current)
  %is.none = icmp eq ptr %current, null
  %is.over = or i1 %has.error, %is.none
  br i1 %is.over, label %refused, label %general
general:
  %slowly = call ptr %array_new({_ARGUMENTS})
  ret ptr %slowly
refused:  ; CPython has set an exception
  ret ptr null
}}
"""
"""`new_array`, of the type of `PyArray_New`, and the table that it reads, which `fill` fills."""


def works() -> bool:
    """Whether arrays are made of what `new_array` makes them of; reads only."""
    version = np.lib.NumpyVersion(np.__version__)
    if not _FIRST_VERSION <= (version.major, version.minor) <= _LAST_VERSION:
        return False
    if not fast_call_works() or not has_gil():
        return False
    if np.ndarray.__basicsize__ != MEMORY_HANDLER + WORD or not _has_default_allocation(np.ndarray):
        return False
    handler, table = _default_handler()
    if not handler or ctypes.c_uint8.from_address(table + _HANDLER_VERSION).value != 1:
        return False
    for shape in ((3,), (3, 2), (1, 3, 5)):
        for dtype in NUMPY_TYPE.values():
            probe = np.empty(shape, dtype)
            words = {at: _word_at(id(probe) + at) for at in (LENGTHS, STEPS, BASE, BUFFER, MEMORY_HANDLER)}
            is_one_block = words[STEPS] == words[LENGTHS] + WORD * len(shape)
            if not is_one_block or words[BASE] or words[BUFFER] or words[MEMORY_HANDLER] != handler:
                return False
    return True


def fill(table: int) -> None:
    """Fills the table that `new_array` reads; must come before its first call, and only where `works`.

    Args:
        table: The address of `new_array_words`.
    """
    handler, at = _default_handler()
    context, malloc = (_word_at(at + _HANDLER_CONTEXT + WORD * k) for k in range(2))
    words = {
        "array_new": array_function(ARRAY_NEW),
        "get_handler": array_function(GET_HANDLER),
        "handler": handler,
        "context": context,
        "malloc": malloc,
        **{name: id(dtype) for name, dtype in NUMPY_TYPE.items()},
        **{name: c_function(function) for name, function in _C_FUNCTIONS.items()},
    }
    (ctypes.c_uint64 * len(_WORDS)).from_address(table)[:] = [words[name] for name in _WORDS]


def _word_at(address: int) -> int:
    return ctypes.c_uint64.from_address(address).value


def _has_default_allocation(kind: type) -> bool:
    """Whether objects of a type are allocated and freed as those of most types."""
    slot = ctypes.pythonapi.PyType_GetSlot
    slot.restype, slot.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_int]
    return (slot(kind, _TP_ALLOC), slot(kind, _TP_FREE)) == (
        c_function("PyType_GenericAlloc"),
        c_function("PyObject_Free"),
    )


def _default_handler() -> tuple[int, int]:
    """The addresses of NumPy's own memory handler, a capsule, and of the structure in it; zeros where there is none."""
    handler = _word_at(array_function(DEFAULT_HANDLER))
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_char_p]
    return (handler, pointer(handler, b"mem_handler") or 0) if handler else (0, 0)
