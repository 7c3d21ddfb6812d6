"""Where CPython and NumPy keep the fields that compiled code reads, proven by reading, and the functions it calls."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from functools import cache
from typing import Any

import numpy as np

WORD = 8
HEAD = object.__basicsize__
"""The size of what every object begins with [byte]: 16, 32 in free-threaded builds; its type is the last word of it."""
TYPE = HEAD - WORD
# PyArrayObject: data, number of axes, lengths, distances [byte], base, descriptor, flags, weak references, exported
# buffers, memory handler.
DATA, NDIM, LENGTHS, STEPS, BASE, ARRAY_DESCRIPTOR, FLAGS, WEAK_REFERENCES, BUFFER, MEMORY_HANDLER = (
    HEAD + WORD * k for k in range(10)
)
ALIGNED, MAY_WRITE = 0x0100, 0x0400
READABLE = 0x0001 | ALIGNED  # C-contiguous
WRITEABLE = READABLE | MAY_WRITE
OWNED = 0x0004  # the array frees its data
VALUE = HEAD  # of a Python float and of a NumPy float64
TUPLE_SIZE, TUPLE_ITEMS = HEAD, tuple.__basicsize__  # CPython 3.14 keeps a hash before the items
TYPE_NUMBER = {"double": 12, "float": 11}
NUMPY_TYPE = {"double": np.dtype(np.float64), "float": np.dtype(np.float32)}

LIST_SIZE, LIST_ITEMS = HEAD, HEAD + WORD  # the address of the entries


@cache
def fast_call_works() -> bool:
    """Whether objects lie in memory as compiled code expects; reads only, through known addresses."""
    if os.environ.get("ULNA_FAST", "") == "0" or platform.python_implementation() != "CPython":
        return False
    if ctypes.sizeof(ctypes.c_void_p) != WORD:
        return False
    if sys.byteorder != "little" or hasattr(sys, "gettotalrefcount"):  # debug builds may have longer heads
        return False
    for dtype in NUMPY_TYPE.values():
        probe = np.zeros((2, 3, 5), dtype)[:1]
        at = id(probe)
        expected = (
            (TYPE, ctypes.c_void_p, id(np.ndarray)),
            (DATA, ctypes.c_void_p, probe.ctypes.data),
            (NDIM, ctypes.c_int, 3),
            (ARRAY_DESCRIPTOR, ctypes.c_void_p, id(np.dtype(dtype.type))),
            (FLAGS, ctypes.c_int, int(probe.flags.num)),
        )
        if any(kind.from_address(at + offset).value != value for offset, kind, value in expected):
            return False
        for place, values in ((LENGTHS, probe.shape), (STEPS, probe.strides)):
            table = ctypes.c_void_p.from_address(at + place).value
            if not table or tuple((ctypes.c_int64 * 3).from_address(table)) != values:
                return False
    for number in (1.5, np.float64(2.5)):
        if ctypes.c_double.from_address(id(number) + VALUE).value != number:
            return False
    pair = (probe, None)
    if ctypes.c_ssize_t.from_address(id(pair) + TUPLE_SIZE).value != 2:
        return False
    items = (ctypes.c_void_p * 2).from_address(id(pair) + TUPLE_ITEMS)
    if tuple(items) != (id(probe), id(None)):
        return False
    entries = [probe, None]
    if ctypes.c_ssize_t.from_address(id(entries) + LIST_SIZE).value != 2:
        return False
    address = ctypes.c_void_p.from_address(id(entries) + LIST_ITEMS).value
    return bool(address) and tuple((ctypes.c_void_p * 2).from_address(address)) == tuple(items)


def holder_slot(holder: type) -> str:
    """The name of the one slot of a class, where compiled code can fill it; empty where it cannot.

    Args:
        holder: A class whose instances have one slot and nothing else.

    Returns:
        The name of the slot, or "".
    """
    slots = [name for base in holder.__mro__ for name in base.__dict__.get("__slots__", ())]
    if len(slots) != 1 or holder.__basicsize__ != HEAD + WORD or holder.__itemsize__:
        return ""
    probe, value = object.__new__(holder), object()
    setattr(probe, slots[0], value)
    address = ctypes.c_void_p.from_address(id(probe) + VALUE).value if fast_call_works() else id(value)
    return slots[0] if address == id(value) else ""


def slot_offset(kind: type, name: str) -> int:
    """Where instances of a class, and of classes that derive from it, have what is in a slot [byte].

    Args:
        kind: A class with slots.
        name: The name of one.

    Returns:
        The offset behind the beginning of an instance; 0 where compiled code cannot read it.
    """
    if not fast_call_works():
        return 0
    probe, value = object.__new__(kind), object()
    object.__setattr__(probe, name, value)
    places = range(HEAD, kind.__basicsize__, WORD)
    fitting = [
        place for place in places if ctypes.c_void_p.from_address(id(probe) + place).value == id(value)
    ]
    return fitting[0] if fitting else 0


def c_function(name: str) -> int:
    """The address of a function of CPython."""
    return ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0


def has_gil() -> bool:
    """Whether one thread at a time always runs Python, so that borrowed references stay valid.

    A free-threaded build, known by its longer heads, turns the lock on while a thread loads an extension module, and
    off again: what it says at one moment (`sys._is_gil_enabled`) does not hold later.
    """
    return HEAD == 2 * WORD


def items_of(entries: list[Any]) -> int:
    """The address of the entries of a list, whose length must not change; 0 where reference counts are not plain.

    Args:
        entries: The list.

    Returns:
        The address.
    """
    if not fast_call_works() or not has_gil():
        return 0
    address = ctypes.c_void_p.from_address(id(entries) + LIST_ITEMS).value or 0
    probe = object()
    counted = ctypes.c_int32.from_address(id(probe)).value
    more = (probe, probe)
    if ctypes.c_int32.from_address(id(probe)).value != counted + len(more):
        return 0
    length = ctypes.c_ssize_t.from_address(id(entries) + LIST_SIZE).value
    if length != len(entries) or not address:
        return 0
    items = (ctypes.c_void_p * length).from_address(address)
    return address if list(items) == [id(entry) for entry in entries] else 0


@cache
def _capsule(name: str) -> Any:
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    module: Any = np._core._multiarray_umath  # type: ignore[attr-defined]
    return ctypes.cast(get(getattr(module, name), None), ctypes.POINTER(ctypes.c_void_p))


def array_function(number: int) -> int:
    """The address of a function of NumPy's array interface."""
    return _capsule("_ARRAY_API")[number]


def ufunc_function(number: int) -> int:
    """The address of a function of NumPy's ufunc interface."""
    return _capsule("_UFUNC_API")[number]


ARRAY_NEW, SCALAR_NEW, UFUNC_FROM_SIGNATURE = 93, 60, 31
"""Numbers of PyArray_New, PyArray_Scalar and PyUFunc_FromFuncAndDataAndSignature."""
NEW_FROM_DESCRIPTOR, SET_BASE = 94, 282
"""Numbers of PyArray_NewFromDescr and PyArray_SetBaseObject."""
GET_HANDLER, DEFAULT_HANDLER = 305, 306
"""Numbers of PyDataMem_GetHandler and PyDataMem_DefaultHandler."""
