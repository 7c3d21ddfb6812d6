"""Methods whose calls go to a kernel of their object, found by machine code, without running Python.

An object keeps its kernels in two tables: those of default options in the slots of one object, and all of them in
nested dictionaries, a level for each option. Machine code sorts the arguments of a call as Python would, compares
options with their default values, looks the kernel up, and calls it with the arrays. Where anything is not as expected
(a kernel that is not made yet, a missing argument, another class), the Python function is called, which gives the same
answer.

Machine code has no reference of its own to a kernel while that runs. So a kernel stays in the tables of its object once
it is there, and nothing takes its place: other threads run meanwhile where there is no global lock, and in a batch
where there is one.

The object that does so stands for the function in its class only where a method is called: read as an attribute, of the
class or of an instance, it is the function, with its signature and documentation. Programs that look into the class's
dictionary, such as `unittest.mock`, take it for a function, and copies of it are the function.
"""

from __future__ import annotations

import copyreg
import functools
import sys
import types
from array import array
from collections.abc import Callable
from typing import Any, NamedTuple

from ulna.compiler.runtime import entry_point, jit, native_types
from ulna.compiler.runtime.kernel import native_type
from ulna.compiler.runtime.method_code import FIELDS, METHOD_IR
from ulna.compiler.runtime.object_layout import c_function, slot_offset


class Tables(NamedTuple):
    """Where instances of a class keep their kernels."""

    kernels: str
    """The slot with an object whose slots are the kernels of default options."""
    kernels_type: type
    """The type of that object."""
    by_options: str
    """The slot with the dictionary of all: `by_options[name][first][second]`."""


class Parameters(NamedTuple):
    """What a method takes, after the instance."""

    names: tuple[str, ...]
    """All of them: arrays, options, and `out` and `threads` where `takes_out` says so."""
    arrays: int
    """How many arrays come first."""
    defaults: tuple[Any, ...]
    """The values of the others."""
    takes_out: bool
    """Whether the last two are `out` and `threads`, which are passed on."""
    has_tables: bool
    """Whether kernels of other options are in the dictionaries; else the function is called for these."""


def method_call(
    function: Callable[..., Any], owner: type, kind: type, tables: Tables, name: str, parameters: Parameters
) -> Any:
    """What stands for a function in a class so that calls of the method take no time of Python.

    Args:
        function: The function; called whenever its kernel is not there.
        owner: The class that has the method.
        kind: The class of most instances, `owner` or one that derives from it.
        tables: Where they keep their kernels.
        name: That of the kernel.
        parameters: What the function takes.

    Returns:
        The object, or None where machine code cannot be called in this way.
    """
    made = _own_type()
    offsets = (
        slot_offset(owner, tables.kernels),
        slot_offset(tables.kernels_type, name),
        slot_offset(owner, tables.by_options),
    )
    if made is None or not all(offsets):
        return None
    type_, code, words = made
    names = [sys.intern(n) for n in parameters.names]
    defaults = [0] * parameters.arrays + [id(value) for value in parameters.defaults]
    rows = array("Q", map(id, names)), array("Q", defaults)
    values = {
        **words, "kind": id(kind), "owner": id(owner), "kernels": offsets[0], "kernel": offsets[1],
        "tables": offsets[2], "name": id(name), "by_options": parameters.has_tables,
        "arrays": parameters.arrays, "parameters": len(names),
        "options": len(names) - parameters.arrays - 2 * parameters.takes_out, "takes_out": parameters.takes_out,
        "names": rows[0].buffer_info()[0], "defaults": rows[1].buffer_info()[0],
    }  # fmt: skip
    plan = array("Q", [int(values[field]) for field in FIELDS])
    instance = native_types.make_instance(
        type_,
        {
            entry_point.VECTORCALL: code,
            entry_point.SLOW: id(function),
            entry_point.PLAN: plan.buffer_info()[0],
            entry_point.CLASS: id(types.FunctionType),
        },
    )
    _KEEP.append((instance, function, owner, kind, tables, name, parameters, names, rows, plan))
    return functools.update_wrapper(instance, function, (*functools.WRAPPER_ASSIGNMENTS, *_OF_FUNCTIONS))


_OF_FUNCTIONS = ("__code__", "__defaults__", "__kwdefaults__", "__globals__", "__closure__")
_KEEP: list[Any] = []


def is_ready() -> bool:
    """Whether `method_call` takes a moment, since nothing has to be compiled: once on a machine that takes 20 ms."""
    return native_type() is None or bool(_own_type.cache_info().currsize) or jit.is_stored(METHOD_IR)


@functools.cache
def _own_type() -> tuple[type, int, dict[str, int]] | None:
    """The type of such methods, the address of their code, and the words that are the same in all plans."""
    kernel_type = native_type()
    if kernel_type is None:
        return None
    code = jit.load_text(METHOD_IR, ("method", "bind"), has_loops=False)
    kind = native_types.make_type(
        object,
        "method_call",
        flags=native_types.LIKE_A_METHOD,
        descriptor=code.address("bind"),
        members={"__class__": entry_point.CLASS},
    )
    assert kind is not None
    copyreg.pickle(kind, lambda method: (_itself, (method.__wrapped__,)))
    out_names = (sys.intern("out"),)
    words = {
        "kernel_type": id(kernel_type), "out_names": id(out_names), "none": id(None),
        "type_error": id(TypeError),
        "is_subtype": c_function("PyType_IsSubtype"),
        "call": c_function("PyObject_Vectorcall"), "get": c_function("PyDict_GetItemWithError"),
        "occurred": c_function("PyErr_Occurred"), "matches": c_function("PyErr_ExceptionMatches"),
        "clear": c_function("PyErr_Clear"), "method_new": c_function("PyMethod_New"), "incref": c_function("Py_IncRef"),
    }  # fmt: skip
    _KEEP.append((code, out_names))
    return kind, code.address("method"), words


def _itself(function: Callable[..., Any]) -> Callable[..., Any]:
    """What a copy of such a method is."""
    return function
