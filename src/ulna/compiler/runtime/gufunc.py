"""Objects that Python calls as machine code, and NumPy generalised ufuncs around compiled loops.

A kernel and a bound kernel are instances of small types (see `native_types`); their vectorcall slots point to
JIT-compiled code (see `entry_point`, `fast_call`). Where the layout that code relies on differs (another interpreter,
another NumPy), there are no such types, and everything goes through the ufunc.
"""

from __future__ import annotations

import ctypes
import platform
import sys
import weakref
from array import array
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, lru_cache
from typing import Any, NamedTuple, final

import numpy as np

from ulna.compiler.codegen.ir_text import DType
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime import entry_point, jit, native_types, new_array, object_layout
from ulna.compiler.runtime.fast_call import FAST_CALL_IR, FIELDS, REUSED
from ulna.compiler.runtime.free_threaded_call import GUARDED_BOUND_IR
from ulna.compiler.runtime.new_array import NEW_ARRAY_IR
from ulna.compiler.runtime.object_layout import (
    TYPE_NUMBER,
    VALUE,
    array_function,
    c_function,
    has_gil,
    ufunc_function,
)
from ulna.system.later import run_later
from ulna.typing import Array as AnyArray

_KEEP: list[Any] = []  # what NumPy keeps pointers to


def make_kernel(kind: type, slow: Callable[..., Any], element: DType) -> Any:
    """A kernel, of a type from `make_type`, whose calls go to a Python callable until `set_code`.
    All arguments must outlive it.

    Args:
        kind: The type.
        slow: What a call goes to that machine code does not take.
        element: Type of the array elements, "double" or "float".

    Returns:
        The instance of `kind`.
    """
    words = {
        entry_point.VECTORCALL: _fast_call("passed_on"),
        entry_point.SLOW: id(slow),
        entry_point.PLAN: _plan_without_code(),
        entry_point.OTHERWISE: _fast_call("passed_on"),
        entry_point.ARRAY_TYPE: id(np.ndarray),
        entry_point.DESCRIPTOR: id(object_layout.NUMPY_TYPE[element]),
        entry_point.NEW: array_function(object_layout.ARRAY_NEW),
        entry_point.TUPLE_NEW: c_function("PyTuple_New"),
        entry_point.SCALAR_NEW: array_function(object_layout.SCALAR_NEW),
        entry_point.FLOAT: id(float),
        entry_point.FLOAT64: id(np.float64),
    }
    kernel, is_first = native_types.make_instance(kind, words), not _made_by_numpy
    _made_by_numpy.append(weakref.ref(kernel))
    if _array_new.cache_info().currsize or jit.is_stored(NEW_ARRAY_IR):
        use_new_array()
    elif is_first:  # which does not wait for LLVM to compile this
        run_later("ulna new arrays", use_new_array)
    return kernel


@cache
def _plan_without_code() -> int:
    """Address of a plan for the time before there is code, with which `passed_on` finds how to call."""
    words = array("Q", [_common_words()["call"] if field == "call" else 0 for field in FIELDS])
    _KEEP.append(words)
    return words.buffer_info()[0]


def set_code(kernel: Any, code: int, plan: Plan) -> None:
    """Has a kernel run machine code from now on. All arguments must outlive it.

    Args:
        kernel: A kernel from `make_kernel`.
        code: Address of `entry` (see `entry_point.entry_ir`).
        plan: Addresses and shapes for calls with `out=`.
    """
    # Other threads may call meanwhile: `entry` works with either plan.
    for offset, word in ((entry_point.VECTORCALL, code), (entry_point.PLAN, plan.address)):
        ctypes.c_void_p.from_address(id(kernel) + offset).value = word


def take_out(kernel: Any) -> None:
    """Has a kernel with code run it in calls with `out=`, too, which go to the Python callable until then.

    Args:
        kernel: A kernel from `make_kernel`, after `set_code`.
    """
    ctypes.c_void_p.from_address(id(kernel) + entry_point.OTHERWISE).value = _fast_call("with_out")


def make_bound(kind: type, plan: Plan, slow: Callable[..., Any]) -> Any:
    """A bound kernel, of a type from `make_type`.
    All arguments must outlive it.

    Args:
        kind: The type.
        plan: Addresses of code and arrays.
        slow: What a call goes to that the compiled code does not take.

    Returns:
        The instance of `kind`.
    """
    words = {
        entry_point.VECTORCALL: _fast_call("bound"),
        entry_point.SLOW: id(slow),
        entry_point.PLAN: plan.address,
    }
    return native_types.make_instance(kind, words)


def keep(instance: Any, *needed: Any) -> None:
    """Keeps what machine code reads through bare pointers until the instance goes, whatever its attributes become.

    Args:
        instance: A kernel or a bound kernel.
        *needed: The objects that must live as long as it.
    """
    weakref.finalize(instance, _release, *needed).atexit = False


def _release(*_: Any) -> None:
    """Nothing is left to do: the references go with the call."""


@cache
def _fast_call(name: str) -> int:
    """Address of code that all kernels share."""
    text = FAST_CALL_IR[name] if has_gil() or name != "bound" else GUARDED_BOUND_IR
    code = jit.load_text(text, (name,), has_loops=name == "bound", is_rare=name == "passed_on")
    _KEEP.append(code)
    return code.address(name)


_made_by_numpy: list[weakref.ref[Any]] = []
"""Kernels whose results NumPy makes, until `use_new_array`."""


def use_new_array() -> None:
    """Has all kernels make their results by compiled code, which is compiled or loaded now."""
    address = _array_new()
    with suppress(IndexError):  # several threads may take from the list
        while True:
            kernel = _made_by_numpy.pop()()
            if kernel is not None:
                ctypes.c_void_p.from_address(id(kernel) + entry_point.NEW).value = address


@cache
def _array_new() -> int:
    """Address of what makes arrays, a function of the type of `PyArray_New`."""
    if not new_array.works():
        return array_function(object_layout.ARRAY_NEW)
    code = jit.load_text(NEW_ARRAY_IR, ("new_array", "new_array_words"), has_loops=False)
    _KEEP.append(code)
    new_array.fill(code.address("new_array_words"))
    return code.address("new_array")


class Binding(NamedTuple):
    """What a kernel is bound to.

    Attributes:
        targets: Arrays that take the outputs, each contiguous and of the shape of its output (...).
        watched: Pairs (live array, reference copy); the kernel does not apply once they differ.
        returned: Indices of the outputs that a call returns.
        trailing_inputs: Arrays for the last inputs, each of the shape of its input (...), read at every call as they
            then are.
        holder: A class with one slot, of which one instance holds the result; see `holder_slot`. Or float, or bool.
        input_holders: For each input that calls pass, from the first on, a class of which an instance is passed in
            place of the array that it holds, or None.
        condition: The output, one float64, that must be above zero, or None.
        answer: What calls return where no output is returned.
    """

    targets: Sequence[AnyArray] = ()
    watched: Sequence[tuple[AnyArray, AnyArray]] = ()
    returned: Sequence[int] = ()
    trailing_inputs: Sequence[AnyArray] = ()
    holder: type | None = None
    input_holders: Sequence[type | None] = ()
    condition: int | None = None
    answer: Any = None


_UNBOUND = Binding()


@final
class Plan:
    """The words that the code of `fast_call` reads: ports and code of a kernel, and the arrays it is bound to.

    Args:
        f: The function.
        element: Its type of numbers.
        work: Address of the kernel's machine code (`work`).
        bound: What it is bound to.
    """

    def __init__(self, f: Function, element: DType, work: int, bound: Binding = _UNBOUND) -> None:
        targets, watched, returned, trailing_inputs, holder, _, condition, answer = bound
        self._references: list[Any] = [*bound]
        accepts_float, first = element == "double", len(f.inputs)
        dtype = object_layout.NUMPY_TYPE[element]
        holders = [*bound.input_holders, *[None] * (first - len(bound.input_holders))]
        guard = {} if has_gil() else self._guard(holders)
        held = holders if has_gil() else [None] * first  # the guard passes the arrays that they hold
        inputs = [self._port(p.shape, dtype, accepts_float, of) for p, of in zip(f.inputs, held, strict=True)]
        outputs = [self._port(p.shape, dtype) for p in f.outputs]
        pairs = [
            (id(live), id(reference), live.nbytes // 8, *self._array_port(live), *self._array_port(reference))
            for live, reference in watched
        ]
        words = {
            "inputs": first - len(trailing_inputs),
            "givens": len(trailing_inputs),
            "outputs": len(f.outputs),
            "work": work,
            "returns_tuple": int(not f.single),
            "ports_in": self._table(inputs),
            "ports_given": self._table([self._array_port(x) for x in trailing_inputs]),
            "ports_out": self._table([self._array_port(x) for x in targets] or outputs),
            "given_arrays": self._table([[id(x) for x in trailing_inputs]]),
            "targets": self._table([[id(x) for x in targets]]),
            "watch_count": len(watched),
            "watched": self._table(pairs),
            "return_count": len(returned),
            "returned": self._table([(*outputs[k][:2], first + k, targets[k].nbytes) for k in returned]),
            "type_number": TYPE_NUMBER[element],
            "descriptor": id(object_layout.NUMPY_TYPE[element]),
            "holder": 0 if holder is None else id(holder),
            "condition": 0 if condition is None else 1 + first + condition,
            "pool": self._pool() if holder not in (None, float, bool) else 0,
            "array_new": 0 if bound is _UNBOUND else _array_new(),
            **_common_words(),
            "none": id(answer),
        }
        self.address = self._table([[(words | guard).get(field, 0) for field in FIELDS]])

    def _port(
        self,
        shape: tuple[int, ...],
        dtype: np.dtype[Any],
        accepts_float: bool = False,
        holder: type | None = None,
    ) -> tuple[int, ...]:
        """The port table entry that the IR function `@take` (fast_call.py) compares an array with."""
        sizes = _sizes(shape)
        self._references += dtype, holder, sizes
        held = 0 if holder is None else id(holder)
        return len(shape), sizes.buffer_info()[0], int(accepts_float and not shape), id(dtype), held

    def _array_port(self, array: AnyArray) -> tuple[int, ...]:
        """The port that takes an array as it is now."""
        return self._port(array.shape, array.dtype)

    def _guard(self, holders: Sequence[type | None]) -> dict[str, int]:
        """The words of `free_threaded_call`."""
        self._references += holders
        row = [0 if holder is None else id(holder) for holder in holders]
        return {
            "holders": self._table([row]) if any(row) else 0,
            "mutex": self._table([[0]]),
            **_guard_words(),
        }

    def _pool(self) -> int:
        """Places for the last instances that were returned."""
        pool = [None] * REUSED
        self._references.append(pool)
        return object_layout.items_of(pool)

    def _table(self, rows: Sequence[Sequence[int]]) -> int:
        """The address of some words in memory."""
        block = array("Q", [word for row in rows for word in row])
        self._references.append(block)
        return block.buffer_info()[0]


@lru_cache(maxsize=1000)
def _sizes(shape: tuple[int, ...]) -> array[int]:
    """A shape in memory; plans that have it share it, and only read it."""
    return array("Q", shape)


@cache
def _common_words() -> dict[str, int]:
    """The words that are the same in all plans."""
    return {
        "array_type": id(np.ndarray),
        "float_type": id(float),
        "float64_type": id(np.float64),
        "tuple_type": id(tuple),
        "out": id(sys.intern("out")),
        "none": id(None),
        "scalar_new": array_function(object_layout.SCALAR_NEW),
        "tuple_new": c_function("PyTuple_New"),
        "incref": c_function("Py_IncRef"),
        "decref": c_function("Py_DecRef"),
        "call": c_function("PyObject_Vectorcall"),
        "allocate": c_function("PyType_GenericAlloc"),
        "float_new": c_function("PyFloat_FromDouble"),
        "bool_type": id(bool),
        "true": id(True),
        "false": id(False),
    }


_SLOT = native_types.MemberDef(b"value", native_types.SLOT_OBJECT, VALUE, 0, None)


@cache
def _guard_words() -> dict[str, int]:
    """The words of `free_threaded_call` that are the same in all plans."""
    return {
        "get_member": c_function("PyMember_GetOne"),
        "member": ctypes.addressof(_SLOT),
        "clear": c_function("PyErr_Clear"),
        "lock": c_function("PyMutex_Lock"),
        "unlock": c_function("PyMutex_Unlock"),
    }


def make_ufunc(f: Function, loop: int, keep: Any, element: DType) -> np.ufunc:
    """A NumPy generalised ufunc with frozen core sizes around the inner loop at address `loop`.

    NumPy keeps pointers to everything passed here; `keep` and all of it live as long as the ufunc.

    Args:
        f: The function; names, text and signature of the ufunc come from it.
        loop: Address of the inner loop (see `module.emit_batch`).
        keep: An object that the machine code needs.
        element: Type of the array elements, "double" or "float".

    Returns:
        The ufunc.
    """
    count = len(f.inputs) + len(f.outputs)
    functions = (ctypes.c_void_p * 1)(loop)
    data = (ctypes.c_void_p * 1)(None)
    types = ctypes.create_string_buffer(bytes([TYPE_NUMBER[element]]) * count, count)
    name = ctypes.create_string_buffer(f.name.encode())
    doc = ctypes.create_string_buffer(f.doc.encode())
    signature = ctypes.create_string_buffer(f.signature.encode())
    make = ctypes.PYFUNCTYPE(
        ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, *([ctypes.c_int] * 4),
        ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p,
    )(ufunc_function(object_layout.UFUNC_FROM_SIGNATURE))  # fmt: skip
    address = ctypes.addressof
    no_identity, unused = -1, 0
    ufunc = make(
        address(functions), address(data), address(types), 1, len(f.inputs), len(f.outputs), no_identity,
        address(name), address(doc), unused, address(signature),
    )  # fmt: skip
    _tie(ufunc, (functions, data, types, name, doc, signature, keep), address(functions), address(types))
    return ufunc


def _tie(ufunc: np.ufunc, references: tuple[Any, ...], functions: int, types: int) -> None:
    """Binds the lifetime of `references` to the ufunc through its field `obj`, if that field is where it should be."""
    first = id(ufunc) + object.__basicsize__  # the head of an object is longer without the GIL
    word = ctypes.c_void_p.from_address
    if (
        platform.python_implementation() == "CPython"
        and (word(first + 16).value, word(first + 48).value) == (functions, types)
        and word(first + 64).value is None
        and word(first + 72).value is None
    ):
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(references))
        word(first + 72).value = id(references)
    else:
        _KEEP.append((ufunc, references))


def ports_of(f: Function) -> Sequence[Port]:
    """Inputs, then outputs."""
    return (*f.inputs, *f.outputs)
