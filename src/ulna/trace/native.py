"""The two doors from Python into machine code: a callable object that costs 100 ns, and a NumPy generalised ufunc.

The callable is an instance of a small type made here through CPython's own type factory. Its vectorcall slot points to
a JIT-compiled entry that reads the PyArrayObject fields when every argument is exactly a contiguous array of the right
type and shape, and in every other case hands over to the general path, a Python callable kept in the instance.
The layout that the entry relies on is probed once with harmless reads; where anything differs (another interpreter, a
free-threaded build, another NumPy), the fast door stays shut and everything goes through the ufunc.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
import sysconfig
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from ulna.trace.emit import emit_single
from ulna.trace.function import Function, Port
from ulna.trace.irtext import DType, Lanes

_WORD = 8
# The instance: PyObject head, then one word each.
_VECTORCALL, _DICT, _WEAKREFS, _GENERAL, _ARRAY_TYPE, _DESCRIPTOR = (16 + _WORD * k for k in range(6))
_ARRAY_NEW, _CALL, _TUPLE_NEW, _ARRAY_RETURN, _FLOAT, _FLOAT64, _END = (16 + _WORD * k for k in range(6, 13))
# PyArrayObject: data, number of axes, lengths, descriptor, flags.
_DATA, _NDIM, _LENGTHS, _ARRAY_DESCRIPTOR, _FLAGS = 16, 24, 32, 56, 64
_WANTED_FLAGS = 0x0101  # C-contiguous, aligned
_VALUE = 16  # of a Python float and of a NumPy float64
UNIT_TOLERANCE = 1e-5  # on the squared length of what must be a unit vector
_TUPLE_ITEMS = 24
_TYPE_NUMBER = {"double": 12, "float": 11}
_NUMPY_TYPE = {"double": np.dtype(np.float64), "float": np.dtype(np.float32)}


def entry_ir(
    f: Function,
    element: DType = "double",
    checked: bool = False,
    pack: int = 8,
    unit_entries: Sequence[tuple[int, Sequence[int]]] = (),
) -> str:
    """IR of a single call: the scalar block, and `entry`, a CPython vectorcall function around it.

    With `checked`, inputs that are not finite or, at `unit_entries`, not unit go to the general path, which raises.
    """
    size = 8 if element == "double" else 4
    w: list[str] = []
    for k, port in enumerate(f.outputs):
        lengths = ", ".join(f"i64 {n}" for n in port.shape) or "i64 0"
        w.append(f"@lengths{k} = private constant [{max(len(port.shape), 1)} x i64] [{lengths}]")
    w.append("define ptr @entry(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {\nentry:")
    w.append("  %count = and i64 %flagged, 9223372036854775807")
    w.append(f"  %count.ok = icmp eq i64 %count, {len(f.inputs)}\n  %plain = icmp eq ptr %keywords, null")
    w.append("  %begin = and i1 %count.ok, %plain")
    pointers = {"array_type": _ARRAY_TYPE, "descriptor": _DESCRIPTOR, "array_new": _ARRAY_NEW}
    if any(_may_be_number(port, element) for port in f.inputs):
        pointers |= {"float_type": _FLOAT, "float64_type": _FLOAT64}
    for name, offset in pointers.items():
        w.append(
            f"  %{name}.p = getelementptr i8, ptr %self, i64 {offset}\n  %{name} = load ptr, ptr %{name}.p"
        )
    w.append(f"  br i1 %begin, label %{'type0' if f.inputs else 'work'}, label %general")
    for k, port in enumerate(f.inputs):
        _check_argument(w, k, port, element, last=k + 1 == len(f.inputs))
    w.append("work:")
    if checked:
        _check_finite(w, f, element, size)
        for number, (k, entries) in enumerate(unit_entries):
            _check_unit(w, number, k, entries, element)
    for k, port in enumerate(f.outputs):
        w.append(
            f"  %out{k} = call ptr %array_new(ptr %array_type, i32 {len(port.shape)}, ptr @lengths{k}, "
            f"i32 {_TYPE_NUMBER[element]}, ptr null, ptr null, i32 0, i32 0, ptr null)"
        )
        w.append(
            f"  %bad{k} = icmp eq ptr %out{k}, null\n  br i1 %bad{k}, label %failed, label %made{k}\nmade{k}:"
        )
        w.append(
            f"  %res{k}.p = getelementptr i8, ptr %out{k}, i64 {_DATA}\n  %res{k} = load ptr, ptr %res{k}.p"
        )
    arguments = [f"ptr %data{k}" for k in range(len(f.inputs))] + [
        f"ptr %res{k}" for k in range(len(f.outputs))
    ]
    w.append(f"  call void @one({', '.join(arguments)})")
    results = []
    for k, port in enumerate(f.outputs):
        if port.shape:
            results.append(f"%out{k}")
        else:  # a number leaves as a NumPy scalar, as from a ufunc
            w.append(f"  %ret{k}.p = getelementptr i8, ptr %self, i64 {_ARRAY_RETURN}")
            w.append(f"  %ret{k}.f = load ptr, ptr %ret{k}.p\n  %ret{k} = call ptr %ret{k}.f(ptr %out{k})")
            results.append(f"%ret{k}")
    if f.single:
        w.append(f"  ret ptr {results[0]}")
    else:
        w.append(f"  %tuple_new.p = getelementptr i8, ptr %self, i64 {_TUPLE_NEW}")
        w.append("  %tuple_new = load ptr, ptr %tuple_new.p")
        w.append(f"  %tuple = call ptr %tuple_new(i64 {len(results)})")
        w.append("  %bad = icmp eq ptr %tuple, null\n  br i1 %bad, label %failed, label %fill\nfill:")
        for k, result in enumerate(results):
            w.append(f"  %item{k} = getelementptr i8, ptr %tuple, i64 {_TUPLE_ITEMS + _WORD * k}")
            w.append(f"  store ptr {result}, ptr %item{k}")
        w.append("  ret ptr %tuple")
    w.append("failed:\n  ret ptr null\ngeneral:")
    w.append(f"  %call.p = getelementptr i8, ptr %self, i64 {_CALL}\n  %call = load ptr, ptr %call.p")
    w.append(f"  %gen.p = getelementptr i8, ptr %self, i64 {_GENERAL}\n  %gen = load ptr, ptr %gen.p")
    w.append(
        "  %slow = call ptr %call(ptr %gen, ptr %args, i64 %flagged, ptr %keywords)\n  ret ptr %slow\n}\n"
    )
    return emit_single(f, element, pack) + "\n".join(w)


def _may_be_number(port: Port, element: DType) -> bool:
    """Whether a float of Python or NumPy, whose bits lie where an array's data would be read, can be the argument."""
    return port.shape == () and element == "double"


def _check_argument(w: list[str], k: int, port: Port, element: DType, last: bool) -> None:
    """Branches to the general path unless argument k is exactly what the block reads."""
    following = "work" if last else f"type{k + 1}"
    w.append(
        f"type{k}:\n  %arg{k}.p = getelementptr ptr, ptr %args, i64 {k}\n  %arg{k} = load ptr, ptr %arg{k}.p"
    )
    w.append(f"  %kind{k}.p = getelementptr i8, ptr %arg{k}, i64 8\n  %kind{k} = load ptr, ptr %kind{k}.p")
    number = _may_be_number(port, element)
    if number:
        w.append(f"  %value{k} = getelementptr i8, ptr %arg{k}, i64 {_VALUE}")
        w.append(f"  %is.float{k} = icmp eq ptr %kind{k}, %float_type")
        w.append(f"  %is.float64{k} = icmp eq ptr %kind{k}, %float64_type")
        w.append(f"  %is.number{k} = or i1 %is.float{k}, %is.float64{k}")
        w.append(f"  br i1 %is.number{k}, label %ready{k}, label %array{k}\narray{k}:")
    w.append(f"  %kind{k}.ok = icmp eq ptr %kind{k}, %array_type")
    w.append(f"  br i1 %kind{k}.ok, label %fields{k}, label %general\nfields{k}:")
    for name, offset, kind in (
        ("descr", _ARRAY_DESCRIPTOR, "ptr"),
        ("ndim", _NDIM, "i32"),
        ("flags", _FLAGS, "i32"),
        ("memory" if number else "data", _DATA, "ptr"),
        ("lengths", _LENGTHS, "ptr"),
    ):
        w.append(f"  %{name}{k}.p = getelementptr i8, ptr %arg{k}, i64 {offset}")
        w.append(f"  %{name}{k} = load {kind}, ptr %{name}{k}.p")
    w.append(f"  %descr{k}.ok = icmp eq ptr %descr{k}, %descriptor")
    w.append(f"  %ndim{k}.ok = icmp eq i32 %ndim{k}, {len(port.shape)}")
    w.append(f"  %wanted{k} = and i32 %flags{k}, {_WANTED_FLAGS}")
    w.append(f"  %flags{k}.ok = icmp eq i32 %wanted{k}, {_WANTED_FLAGS}")
    w.append(f"  %a{k}.ok = and i1 %descr{k}.ok, %ndim{k}.ok\n  %b{k}.ok = and i1 %a{k}.ok, %flags{k}.ok")
    w.append(f"  br i1 %b{k}.ok, label %shape{k}, label %general\nshape{k}:")
    good = "true"
    for axis, n in enumerate(port.shape):
        w.append(f"  %n{k}.{axis}.p = getelementptr i64, ptr %lengths{k}, i64 {axis}")
        w.append(
            f"  %n{k}.{axis} = load i64, ptr %n{k}.{axis}.p\n  %n{k}.{axis}.ok = icmp eq i64 %n{k}.{axis}, {n}"
        )
        w.append(f"  %all{k}.{axis} = and i1 {good}, %n{k}.{axis}.ok")
        good = f"%all{k}.{axis}"
    w.append(f"  br i1 {good}, label %{f'ready{k}' if number else following}, label %general")
    if number:
        w.append(f"ready{k}:\n  %data{k} = phi ptr [ %value{k}, %type{k} ], [ %memory{k}, %shape{k} ]")
        w.append(f"  br label %{following}")


def _check_finite(w: list[str], f: Function, element: DType, size: int) -> None:
    """x * 0 is nan for nan and inf, and nan survives a sum."""
    total = "0.0"
    for k, port in enumerate(f.inputs):
        for j in range(port.size):
            w.append(f"  %f{k}.{j}.p = getelementptr {element}, ptr %data{k}, i64 {j}")
            w.append(f"  %f{k}.{j} = load {element}, ptr %f{k}.{j}.p, align {size}")
            w.append(f"  %f{k}.{j}.z = fmul {element} %f{k}.{j}, 0.0")
            w.append(f"  %f{k}.{j}.s = fadd reassoc {element} {total}, %f{k}.{j}.z")
            total = f"%f{k}.{j}.s"
    w.append(f"  %infinite = fcmp uno {element} {total}, 0.0")
    w.append("  br i1 %infinite, label %general, label %finite\nfinite:")


def _check_unit(w: list[str], number: int, k: int, entries: Sequence[int], element: DType) -> None:
    """The squared length of some entries of input k, whose values `_check_finite` has loaded, must be 1."""
    total = "0.0"
    for j in entries:
        w.append(f"  %u{number}.{j}.q = fmul {element} %f{k}.{j}, %f{k}.{j}")
        w.append(f"  %u{number}.{j}.s = fadd {element} {total}, %u{number}.{j}.q")
        total = f"%u{number}.{j}.s"
    w.append(f"  %u{number}.d = fsub {element} {total}, 1.0")
    bound = Lanes(1, element).constant(float(np.float32(UNIT_TOLERANCE)))
    w.append(f"  %u{number}.over = fcmp ogt {element} %u{number}.d, {bound}")
    w.append(f"  %u{number}.minus = fneg {element} %u{number}.d")
    w.append(f"  %u{number}.under = fcmp ogt {element} %u{number}.minus, {bound}")
    w.append(f"  %u{number}.bad = or i1 %u{number}.over, %u{number}.under")
    w.append(f"  br i1 %u{number}.bad, label %general, label %unit{number}\nunit{number}:")


class _MemberDef(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type", ctypes.c_int),
        ("offset", ctypes.c_ssize_t),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


class _GetSetDef(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("get", ctypes.c_void_p),
        ("set", ctypes.c_void_p),
        ("doc", ctypes.c_char_p),
        ("closure", ctypes.c_void_p),
    )


class _Slot(ctypes.Structure):
    _fields_ = (("slot", ctypes.c_int), ("pointer", ctypes.c_void_p))


class _Spec(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("basicsize", ctypes.c_int),
        ("itemsize", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(_Slot)),
    )


_KEEP: list[Any] = []  # what CPython and NumPy keep pointers to


def make_type(base: type) -> type | None:
    """A subtype of `base` (which has no fields) whose instances are called through a pointer of their own."""
    if not fast_door_works():
        return None
    members = (_MemberDef * 4)(
        _MemberDef(b"__vectorcalloffset__", 19, _VECTORCALL, 1, None),  # 19: Py_ssize_t, 1: read only
        _MemberDef(b"__dictoffset__", 19, _DICT, 1, None),
        _MemberDef(b"__weaklistoffset__", 19, _WEAKREFS, 1, None),
        _MemberDef(),
    )
    get, put = _c_address("PyObject_GenericGetDict"), _c_address("PyObject_GenericSetDict")
    properties = (_GetSetDef * 2)(_GetSetDef(b"__dict__", get, put, None, None), _GetSetDef())
    slots = (_Slot * 4)(
        _Slot(50, _c_address("PyVectorcall_Call")),  # Py_tp_call
        _Slot(72, ctypes.addressof(members)),  # Py_tp_members
        _Slot(73, ctypes.addressof(properties)),  # Py_tp_getset
        _Slot(0, None),
    )
    flags = (1 << 18) | (1 << 11) | (1 << 7)  # DEFAULT, HAVE_VECTORCALL, DISALLOW_INSTANTIATION
    name = f"{base.__module__}.Kernel".encode()
    spec = _Spec(name, _END, 0, flags, slots)
    _KEEP.extend((members, properties, slots, name, spec))
    factory = ctypes.pythonapi.PyType_FromSpecWithBases
    factory.restype, factory.argtypes = ctypes.py_object, [ctypes.POINTER(_Spec), ctypes.py_object]
    return factory(ctypes.byref(spec), (base,))


def make_instance(kind: type, entry: int, general: Callable[..., Any], element: DType) -> Any:
    """An instance of a type from `make_type` that runs the code at `entry`; it keeps `general` alive."""
    allocate = ctypes.pythonapi.PyType_GenericAlloc
    allocate.restype, allocate.argtypes = ctypes.py_object, [ctypes.py_object, ctypes.c_ssize_t]
    instance = allocate(kind, 0)
    words = {
        _GENERAL: id(general),
        _ARRAY_TYPE: id(np.ndarray),
        _DESCRIPTOR: id(_NUMPY_TYPE[element]),
        _ARRAY_NEW: _array_api(93),
        _CALL: _c_address("PyObject_Vectorcall"),
        _TUPLE_NEW: _c_address("PyTuple_New"),
        _ARRAY_RETURN: _array_api(76),
        _FLOAT: id(float),
        _FLOAT64: id(np.float64),
        _VECTORCALL: entry,
    }
    for offset, word in words.items():
        ctypes.c_void_p.from_address(id(instance) + offset).value = word
    instance.__dict__["_general"] = general  # the reference behind the pointer
    return instance


@cache
def fast_door_works() -> bool:
    """Whether objects lie in memory as the entry expects; reads only, through known addresses."""
    if os.environ.get("ULNA_FAST", "") == "0" or platform.python_implementation() != "CPython":
        return False
    if sysconfig.get_config_var("Py_GIL_DISABLED") or ctypes.sizeof(ctypes.c_void_p) != _WORD:
        return False
    if sys.byteorder != "little" or hasattr(sys, "gettotalrefcount"):  # debug builds may have longer heads
        return False
    for dtype in _NUMPY_TYPE.values():
        probe = np.zeros((2, 3, 5), dtype)[:1]
        at = id(probe)
        expected = (
            (8, ctypes.c_void_p, id(np.ndarray)),
            (_DATA, ctypes.c_void_p, probe.ctypes.data),
            (_NDIM, ctypes.c_int, 3),
            (_ARRAY_DESCRIPTOR, ctypes.c_void_p, id(np.dtype(dtype.type))),
            (_FLAGS, ctypes.c_int, int(probe.flags.num)),
        )
        if any(kind.from_address(at + offset).value != value for offset, kind, value in expected):
            return False
        lengths = ctypes.c_void_p.from_address(at + _LENGTHS).value
        if not lengths or tuple((ctypes.c_int64 * 3).from_address(lengths)) != probe.shape:
            return False
    for number in (1.5, np.float64(2.5)):
        if ctypes.c_double.from_address(id(number) + _VALUE).value != number:
            return False
    pair = (probe, None)
    items = (ctypes.c_void_p * 2).from_address(id(pair) + _TUPLE_ITEMS)
    return tuple(items) == (id(probe), id(None))


def make_ufunc(f: Function, loop: int, keep: Any, element: DType) -> np.ufunc:
    """A NumPy generalised ufunc with frozen core sizes around the inner loop at address `loop`.

    NumPy keeps pointers to everything passed here; `keep` and all of it live as long as the ufunc.
    """
    count = len(f.inputs) + len(f.outputs)
    functions = (ctypes.c_void_p * 1)(loop)
    data = (ctypes.c_void_p * 1)(None)
    types = ctypes.create_string_buffer(bytes([_TYPE_NUMBER[element]]) * count, count)
    name = ctypes.create_string_buffer(f.name.encode())
    doc = ctypes.create_string_buffer(f.doc.encode())
    signature = ctypes.create_string_buffer(f.signature.encode())
    make = ctypes.PYFUNCTYPE(
        ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, *([ctypes.c_int] * 4),
        ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p,
    )(_ufunc_api(31))  # fmt: skip
    address = ctypes.addressof
    no_identity, unused = -1, 0
    ufunc = make(
        address(functions), address(data), address(types), 1, len(f.inputs), len(f.outputs), no_identity,
        address(name), address(doc), unused, address(signature),
    )  # fmt: skip
    _tie(ufunc, (functions, data, types, name, doc, signature, keep), address(functions), address(types))
    return ufunc


def _tie(ufunc: np.ufunc, kept: tuple[Any, ...], functions: int, types: int) -> None:
    """Ties the life of `kept` to the ufunc through its field `obj`, if that field is where it should be."""
    word = ctypes.c_void_p.from_address
    if (
        fast_door_works()
        and (word(id(ufunc) + 32).value, word(id(ufunc) + 64).value) == (functions, types)
        and word(id(ufunc) + 80).value is None
        and word(id(ufunc) + 88).value is None
    ):
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))
        word(id(ufunc) + 88).value = id(kept)
    else:
        _KEEP.append((ufunc, kept))


def _c_address(name: str) -> int:
    return ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0


@cache
def _capsule(name: str) -> Any:
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    module: Any = np._core._multiarray_umath  # type: ignore[attr-defined]
    return ctypes.cast(get(getattr(module, name), None), ctypes.POINTER(ctypes.c_void_p))


def _array_api(number: int) -> int:
    return _capsule("_ARRAY_API")[number]


def _ufunc_api(number: int) -> int:
    return _capsule("_UFUNC_API")[number]


def ports_of(f: Function) -> Sequence[Port]:
    """Inputs, then outputs."""
    return (*f.inputs, *f.outputs)
