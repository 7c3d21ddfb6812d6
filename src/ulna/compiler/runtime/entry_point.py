"""IR of a kernel's own code: `entry`, the 100 ns call from Python, and `work`, the same on bare pointers.

`entry` is a CPython vectorcall function that reads the PyArrayObject fields when every argument is exactly a contiguous
array of the right type and shape, and in every other case calls `passed_on` of `fast_call`, or `with_out` once a call
had an `out`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.checks.quaternions import UNIT_TOLERANCE
from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.module import emit_single, one_by_one, serves_batches_one_by_one
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime.object_layout import (
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    HEAD,
    LENGTHS,
    NDIM,
    READABLE,
    TUPLE_ITEMS,
    TYPE,
    TYPE_NUMBER,
    VALUE,
    WORD,
)

# The instance: PyObject head, then one word each.
VECTORCALL, DICT, WEAKREFS, SLOW, PLAN, OTHERWISE, ARRAY_TYPE = (HEAD + WORD * k for k in range(7))
CLASS = OTHERWISE
"""Of an instance that is no kernel: what it says its class is."""
DESCRIPTOR, NEW, TUPLE_NEW, SCALAR_NEW, FLOAT, FLOAT64, END = (HEAD + WORD * k for k in range(7, 14))


def entry_ir(
    f: Function,
    target: Target,
    element: DType = "double",
    checked: bool = False,
    unit_entries: Sequence[tuple[int, Sequence[int]]] = (),
    not_negative: Sequence[int] = (),
) -> str:
    """IR of a single call: the scalar block, `entry`, a CPython vectorcall function around it, and `work`.
    `i32 work(ptr pointers)` takes pointers to all inputs, then all outputs, which may be the inputs; 0 says that it is
    done. With `checked`, `entry` leaves inputs that are not finite or, at `unit_entries`, not unit, or negative where
    they must not be, to the general path, which raises an error; `work` returns 1. Where batches are samples one by
    one, `batch` is their loop.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".
        checked: Whether inputs are examined.
        unit_entries: Pairs of the number of an input and of those of its entries that must be a unit vector.
        not_negative: The numbers of inputs of which no entry may be negative.

    Returns:
        The text of the definitions.
    """
    w = Instructions()
    for k, port in enumerate(f.outputs):
        lengths = ", ".join(f"i64 {n}" for n in port.shape) or "i64 0"
        w.lines.append(f"@lengths{k} = private constant [{max(len(port.shape), 1)} x i64] [{lengths}]")
    w.begin_function("define ptr @entry(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind")
    _begin(w, f, element)
    for k, port in enumerate(f.inputs):
        _check_argument(w, k, port, element, last=k + 1 == len(f.inputs))
    w.open_block("work")
    if checked:
        w.let("invalid", f"call i1 @invalid({_pointers(f.inputs, 'data')})")
        w.branch("%invalid", "general", "valid")
        w.open_block("valid")
    for k, port in enumerate(f.outputs):
        _make_output(w, k, port, element)
    w.write(f"call void @one({_pointers(f.inputs, 'data', f.outputs)})")
    _return(w, f, [_result(w, k, port) for k, port in enumerate(f.outputs)])
    w.open_block("failed")
    w.write("ret ptr null")
    w.open_block("general")
    w.field("other", "%self", OTHERWISE)
    w.let("slow", "call ptr %other(ptr %self, ptr %args, i64 %flagged, ptr %keywords)")
    w.write("ret ptr %slow")
    w.end_function()
    _write_work(w, f, checked)
    if checked:
        _write_invalid(w, f, element, unit_entries, not_negative)
    batch = one_by_one(f, element) if serves_batches_one_by_one(f, target, element) else ""
    return emit_single(f, target, element) + w.text() + batch


def _begin(w: Instructions, f: Function, element: DType) -> None:
    """Reads what the call needs of the instance; leaves keywords and other counts of arguments to the general path."""
    w.let("count", "and i64 %flagged, 9223372036854775807")
    w.let("count.ok", f"icmp eq i64 %count, {len(f.inputs)}")
    w.let("plain", "icmp eq ptr %keywords, null")
    w.let("begin", "and i1 %count.ok, %plain")
    pointers = {"array_type": ARRAY_TYPE, "descriptor": DESCRIPTOR, "array_new": NEW}
    if any(_may_be_number(port, element) for port in f.inputs):
        pointers |= {"float_type": FLOAT, "float64_type": FLOAT64}
    for name, offset in pointers.items():
        w.field(name, "%self", offset)
    for k, port in enumerate(f.outputs):
        if not port.shape:
            w.let(f"res{k}", f"alloca {element}")
    w.branch("%begin", "type0" if f.inputs else "work", "general")


def _make_output(w: Instructions, k: int, port: Port, element: DType) -> None:
    """Makes array k, and reads where its numbers lie; a number comes to lie on the stack."""
    if not port.shape:
        return
    w.let(
        f"out{k}",
        f"call ptr %array_new(ptr %array_type, i32 {len(port.shape)}, ptr @lengths{k}, "
        f"i32 {TYPE_NUMBER[element]}, ptr null, ptr null, i32 0, i32 0, ptr null)",
    )
    w.branch(w.let(f"bad{k}", f"icmp eq ptr %out{k}, null"), "failed", f"made{k}")
    w.open_block(f"made{k}")
    w.field(f"res{k}", f"%out{k}", DATA)


def _result(w: Instructions, k: int, port: Port) -> str:
    """What leaves for output k: the array, or of a number a NumPy scalar, as from a ufunc."""
    if port.shape:
        return f"%out{k}"
    w.field(f"scalar_new{k}", "%self", SCALAR_NEW)
    w.let(f"ret{k}", f"call ptr %scalar_new{k}(ptr %res{k}, ptr %descriptor, ptr null)")
    w.branch(w.let(f"none{k}", f"icmp eq ptr %ret{k}, null"), "failed", f"number{k}")
    w.open_block(f"number{k}")
    return f"%ret{k}"


def _return(w: Instructions, f: Function, results: Sequence[str]) -> None:
    """Returns the result, or a tuple of them."""
    if f.single:
        w.write(f"ret ptr {results[0]}")
        return
    w.field("tuple_new", "%self", TUPLE_NEW)
    w.let("tuple", f"call ptr %tuple_new(i64 {len(results)})")
    w.branch(w.let("bad", "icmp eq ptr %tuple, null"), "failed", "fill")
    w.open_block("fill")
    for k, result in enumerate(results):
        place = w.let(f"item{k}", f"getelementptr i8, ptr %tuple, i64 {TUPLE_ITEMS + WORD * k}")
        w.write(f"store ptr {result}, ptr {place}")
    w.write("ret ptr %tuple")


def _pointers(inputs: Sequence[Port], name: str, outputs: Sequence[Port] = ()) -> str:
    """The arguments of a block: pointers to inputs, then to outputs."""
    return ", ".join(
        [f"ptr %{name}{k}" for k in range(len(inputs))] + [f"ptr %res{k}" for k in range(len(outputs))]
    )


def _write_work(w: Instructions, f: Function, checked: bool) -> None:
    w.begin_function("define i32 @work(ptr %pointers) nounwind")
    names = [f"data{k}" for k in range(len(f.inputs))] + [f"res{k}" for k in range(len(f.outputs))]
    for k, name in enumerate(names):
        w.item(name, "%pointers", k)
    if checked:
        w.let("invalid", f"call i1 @invalid({_pointers(f.inputs, 'data')})")
        w.branch("%invalid", "refused", "valid")
        w.open_block("refused")
        w.write("ret i32 1")
        w.open_block("valid")
    w.write(f"call void @one({_pointers(f.inputs, 'data', f.outputs)})", "ret i32 0")
    w.end_function()


def _write_invalid(
    w: Instructions,
    f: Function,
    element: DType,
    unit_entries: Sequence[tuple[int, Sequence[int]]],
    not_negative: Sequence[int],
) -> None:
    w.begin_function(f"define internal i1 @invalid({_pointers(f.inputs, 'data')}) noinline nounwind")
    _check_finite(w, f, element)
    for number, (k, entries) in enumerate(unit_entries):
        _check_unit(w, number, k, entries, element)
    for k in not_negative:
        _check_not_negative(w, k, f.inputs[k].size, element)
    w.write("ret i1 false")
    w.open_block("general")
    w.write("ret i1 true")
    w.end_function()


def _may_be_number(port: Port, element: DType) -> bool:
    """Whether a float of Python or NumPy, whose bits lie where an array's data would be read, can be the argument."""
    return port.shape == () and element == "double"


def _check_argument(w: Instructions, k: int, port: Port, element: DType, last: bool) -> None:
    """Branches to the general path unless argument k is exactly what the block reads."""
    following = "work" if last else f"type{k + 1}"
    w.open_block(f"type{k}")
    w.item(f"arg{k}", "%args", k)
    w.field(f"kind{k}", f"%arg{k}", TYPE)
    number = _may_be_number(port, element)
    if number:
        w.let(f"value{k}", f"getelementptr i8, ptr %arg{k}, i64 {VALUE}")
        w.let(f"is.float{k}", f"icmp eq ptr %kind{k}, %float_type")
        w.let(f"is.float64{k}", f"icmp eq ptr %kind{k}, %float64_type")
        w.let(f"is.number{k}", f"or i1 %is.float{k}, %is.float64{k}")
        w.branch(f"%is.number{k}", f"ready{k}", f"array{k}")
        w.open_block(f"array{k}")
    w.let(f"kind{k}.ok", f"icmp eq ptr %kind{k}, %array_type")
    w.branch(f"%kind{k}.ok", f"fields{k}", "general")
    _check_array(w, k, port, "memory" if number else "data", f"ready{k}" if number else following)
    if number:
        w.open_block(f"ready{k}")
        w.let(f"data{k}", f"phi ptr [ %value{k}, %type{k} ], [ %memory{k}, %shape{k} ]")
        w.jump(following)


def _check_array(w: Instructions, k: int, port: Port, data: str, following: str) -> None:
    """Compares type, number of axes, flags and shape of the array that is argument k, and reads where it lies."""
    w.open_block(f"fields{k}")
    w.field(f"descr{k}", f"%arg{k}", ARRAY_DESCRIPTOR)
    w.field(f"ndim{k}", f"%arg{k}", NDIM, "i32")
    w.field(f"flags{k}", f"%arg{k}", FLAGS, "i32")
    w.field(f"{data}{k}", f"%arg{k}", DATA)
    w.field(f"lengths{k}", f"%arg{k}", LENGTHS)
    w.let(f"descr{k}.ok", f"icmp eq ptr %descr{k}, %descriptor")
    w.let(f"ndim{k}.ok", f"icmp eq i32 %ndim{k}, {len(port.shape)}")
    w.let(f"wanted{k}", f"and i32 %flags{k}, {READABLE}")
    w.let(f"flags{k}.ok", f"icmp eq i32 %wanted{k}, {READABLE}")
    w.let(f"a{k}.ok", f"and i1 %descr{k}.ok, %ndim{k}.ok")
    w.let(f"b{k}.ok", f"and i1 %a{k}.ok, %flags{k}.ok")
    w.branch(f"%b{k}.ok", f"shape{k}", "general")
    w.open_block(f"shape{k}")
    good = "true"
    for axis, n in enumerate(port.shape):
        length = w.item(f"n{k}.{axis}", f"%lengths{k}", axis, "i64")
        equal = w.let(f"n{k}.{axis}.ok", f"icmp eq i64 {length}, {n}")
        good = w.let(f"all{k}.{axis}", f"and i1 {good}, {equal}")
    w.branch(good, following, "general")


def _check_finite(w: Instructions, f: Function, element: DType) -> None:
    """x * 0 is nan for nan and inf, and nan survives a sum."""
    total = "0.0"
    for k, port in enumerate(f.inputs):
        for j in range(port.size):
            w.let(f"f{k}.{j}.p", f"getelementptr {element}, ptr %data{k}, i64 {j}")
            w.let(f"f{k}.{j}", f"load {element}, ptr %f{k}.{j}.p, align {BYTES[element]}")
            w.let(f"f{k}.{j}.z", f"fmul {element} %f{k}.{j}, 0.0")
            total = w.let(f"f{k}.{j}.s", f"fadd reassoc {element} {total}, %f{k}.{j}.z")
    w.branch(w.let("infinite", f"fcmp uno {element} {total}, 0.0"), "general", "finite")
    w.open_block("finite")


def _check_unit(w: Instructions, number: int, k: int, entries: Sequence[int], element: DType) -> None:
    """The squared length of some entries of input k, whose values `_check_finite` has loaded, must be 1."""
    unit, total = f"u{number}", "0.0"
    for j in entries:
        square = w.let(f"{unit}.{j}.q", f"fmul {element} %f{k}.{j}, %f{k}.{j}")
        total = w.let(f"{unit}.{j}.s", f"fadd {element} {total}, {square}")
    w.let(f"{unit}.d", f"fsub {element} {total}, 1.0")
    bound = Lanes(1, element).constant(float(np.float32(UNIT_TOLERANCE)))
    w.let(f"{unit}.over", f"fcmp ogt {element} %{unit}.d, {bound}")
    w.let(f"{unit}.minus", f"fneg {element} %{unit}.d")
    w.let(f"{unit}.under", f"fcmp ogt {element} %{unit}.minus, {bound}")
    w.let(f"{unit}.bad", f"or i1 %{unit}.over, %{unit}.under")
    w.branch(f"%{unit}.bad", "general", f"unit{number}")
    w.open_block(f"unit{number}")


def _check_not_negative(w: Instructions, k: int, size: int, element: DType) -> None:
    """No entry of input k, whose values `_check_finite` has loaded, may be negative."""
    bad = "false"
    for j in range(size):
        less = w.let(f"n{k}.{j}.less", f"fcmp olt {element} %f{k}.{j}, 0.0")
        bad = w.let(f"n{k}.{j}.bad", f"or i1 {bad}, {less}")
    w.branch(bad, "general", f"least{k}")
    w.open_block(f"least{k}")
