"""IR of a kernel's own code: `entry`, the 100 ns call from Python, and `work`, the same on bare pointers.

`entry` is a CPython vectorcall function that reads the PyArrayObject fields when every argument is exactly a contiguous
array of the right type and shape, and in every other case hands over to `with_out` of `fast_call`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime.object_layout import (
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    LENGTHS,
    NDIM,
    READABLE,
    TUPLE_ITEMS,
    TYPE_NUMBER,
    VALUE,
    WORD,
)

# The instance: PyObject head, then one word each.
VECTORCALL, DICT, WEAKREFS, SLOW, PLAN, OTHERWISE, ARRAY_TYPE = (16 + WORD * k for k in range(7))
DESCRIPTOR, NEW, TUPLE_NEW, RETURN, FLOAT, FLOAT64, END = (16 + WORD * k for k in range(7, 14))
UNIT_TOLERANCE = 1e-5  # on the squared length of what must be a unit vector


def entry_ir(
    f: Function,
    target: Target,
    element: DType = "double",
    checked: bool = False,
    unit_entries: Sequence[tuple[int, Sequence[int]]] = (),
) -> str:
    """IR of a single call: the scalar block, `entry`, a CPython vectorcall function around it, and `work`.
    `i32 work(ptr pointers)` takes pointers to all inputs, then all outputs, which may be the inputs; 0 says that it is
    done. With `checked`, `entry` leaves inputs that are not finite or, at `unit_entries`, not unit to the general
    path,
    which raises an error; `work` returns 1.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".
        checked: Whether inputs are examined.
        unit_entries: Pairs of the number of an input and of those of its entries that must be a unit vector.

    Returns:
        The text of the definitions.
    """
    size = BYTES[element]
    w: list[str] = []
    for k, port in enumerate(f.outputs):
        lengths = ", ".join(f"i64 {n}" for n in port.shape) or "i64 0"
        w.append(f"@lengths{k} = private constant [{max(len(port.shape), 1)} x i64] [{lengths}]")
    w.append("define ptr @entry(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {\nentry:")
    w.append("  %count = and i64 %flagged, 9223372036854775807")
    w.append(f"  %count.ok = icmp eq i64 %count, {len(f.inputs)}\n  %plain = icmp eq ptr %keywords, null")
    w.append("  %begin = and i1 %count.ok, %plain")
    pointers = {"array_type": ARRAY_TYPE, "descriptor": DESCRIPTOR, "array_new": NEW}
    if any(_may_be_number(port, element) for port in f.inputs):
        pointers |= {"float_type": FLOAT, "float64_type": FLOAT64}
    for name, offset in pointers.items():
        w.append(
            f"  %{name}.p = getelementptr i8, ptr %self, i64 {offset}\n  %{name} = load ptr, ptr %{name}.p"
        )
    w.append(f"  br i1 %begin, label %{'type0' if f.inputs else 'work'}, label %general")
    for k, port in enumerate(f.inputs):
        _check_argument(w, k, port, element, last=k + 1 == len(f.inputs))
    w.append("work:")
    if checked:
        w.append(f"  %invalid = call i1 @invalid({_pointers(f.inputs, 'data')})")
        w.append("  br i1 %invalid, label %general, label %valid\nvalid:")
    for k, port in enumerate(f.outputs):
        w.append(
            f"  %out{k} = call ptr %array_new(ptr %array_type, i32 {len(port.shape)}, ptr @lengths{k}, "
            f"i32 {TYPE_NUMBER[element]}, ptr null, ptr null, i32 0, i32 0, ptr null)"
        )
        w.append(
            f"  %bad{k} = icmp eq ptr %out{k}, null\n  br i1 %bad{k}, label %failed, label %made{k}\nmade{k}:"
        )
        w.append(
            f"  %res{k}.p = getelementptr i8, ptr %out{k}, i64 {DATA}\n  %res{k} = load ptr, ptr %res{k}.p"
        )
    w.append(f"  call void @one({_pointers(f.inputs, 'data', f.outputs)})")
    results = []
    for k, port in enumerate(f.outputs):
        if port.shape:
            results.append(f"%out{k}")
        else:  # a number leaves as a NumPy scalar, as from a ufunc
            w.append(f"  %ret{k}.p = getelementptr i8, ptr %self, i64 {RETURN}")
            w.append(f"  %ret{k}.f = load ptr, ptr %ret{k}.p\n  %ret{k} = call ptr %ret{k}.f(ptr %out{k})")
            w.append(f"  %none{k} = icmp eq ptr %ret{k}, null")
            w.append(f"  br i1 %none{k}, label %failed, label %number{k}\nnumber{k}:")
            results.append(f"%ret{k}")
    if f.single:
        w.append(f"  ret ptr {results[0]}")
    else:
        w.append(f"  %tuple_new.p = getelementptr i8, ptr %self, i64 {TUPLE_NEW}")
        w.append("  %tuple_new = load ptr, ptr %tuple_new.p")
        w.append(f"  %tuple = call ptr %tuple_new(i64 {len(results)})")
        w.append("  %bad = icmp eq ptr %tuple, null\n  br i1 %bad, label %failed, label %fill\nfill:")
        for k, result in enumerate(results):
            w.append(f"  %item{k} = getelementptr i8, ptr %tuple, i64 {TUPLE_ITEMS + WORD * k}")
            w.append(f"  store ptr {result}, ptr %item{k}")
        w.append("  ret ptr %tuple")
    w.append("failed:\n  ret ptr null\ngeneral:")
    w.append(f"  %other.p = getelementptr i8, ptr %self, i64 {OTHERWISE}\n  %other = load ptr, ptr %other.p")
    w.append(
        "  %slow = call ptr %other(ptr %self, ptr %args, i64 %flagged, ptr %keywords)\n  ret ptr %slow\n}\n"
    )
    _write_work(w, f, checked)
    if checked:
        _write_invalid(w, f, element, size, unit_entries)
    return emit_single(f, target, element) + "\n".join(w)


def _pointers(inputs: Sequence[Port], name: str, outputs: Sequence[Port] = ()) -> str:
    """The arguments of a block: pointers to inputs, then to outputs."""
    return ", ".join(
        [f"ptr %{name}{k}" for k in range(len(inputs))] + [f"ptr %res{k}" for k in range(len(outputs))]
    )


def _write_work(w: list[str], f: Function, checked: bool) -> None:
    w.append("define i32 @work(ptr %pointers) nounwind {\nentry:")
    names = [f"data{k}" for k in range(len(f.inputs))] + [f"res{k}" for k in range(len(f.outputs))]
    for k, name in enumerate(names):
        w.append(
            f"  %{name}.p = getelementptr ptr, ptr %pointers, i64 {k}\n  %{name} = load ptr, ptr %{name}.p"
        )
    if checked:
        w.append(f"  %invalid = call i1 @invalid({_pointers(f.inputs, 'data')})")
        w.append("  br i1 %invalid, label %refused, label %valid\nrefused:\n  ret i32 1\nvalid:")
    w.append(f"  call void @one({_pointers(f.inputs, 'data', f.outputs)})\n  ret i32 0\n}}\n")


def _write_invalid(
    w: list[str], f: Function, element: DType, size: int, unit_entries: Sequence[tuple[int, Sequence[int]]]
) -> None:
    w.append(f"define internal i1 @invalid({_pointers(f.inputs, 'data')}) noinline nounwind {{\nentry:")
    _check_finite(w, f, element, size)
    for number, (k, entries) in enumerate(unit_entries):
        _check_unit(w, number, k, entries, element)
    w.append("  ret i1 false\ngeneral:\n  ret i1 true\n}\n")


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
        w.append(f"  %value{k} = getelementptr i8, ptr %arg{k}, i64 {VALUE}")
        w.append(f"  %is.float{k} = icmp eq ptr %kind{k}, %float_type")
        w.append(f"  %is.float64{k} = icmp eq ptr %kind{k}, %float64_type")
        w.append(f"  %is.number{k} = or i1 %is.float{k}, %is.float64{k}")
        w.append(f"  br i1 %is.number{k}, label %ready{k}, label %array{k}\narray{k}:")
    w.append(f"  %kind{k}.ok = icmp eq ptr %kind{k}, %array_type")
    w.append(f"  br i1 %kind{k}.ok, label %fields{k}, label %general\nfields{k}:")
    for name, offset, kind in (
        ("descr", ARRAY_DESCRIPTOR, "ptr"),
        ("ndim", NDIM, "i32"),
        ("flags", FLAGS, "i32"),
        ("memory" if number else "data", DATA, "ptr"),
        ("lengths", LENGTHS, "ptr"),
    ):
        w.append(f"  %{name}{k}.p = getelementptr i8, ptr %arg{k}, i64 {offset}")
        w.append(f"  %{name}{k} = load {kind}, ptr %{name}{k}.p")
    w.append(f"  %descr{k}.ok = icmp eq ptr %descr{k}, %descriptor")
    w.append(f"  %ndim{k}.ok = icmp eq i32 %ndim{k}, {len(port.shape)}")
    w.append(f"  %wanted{k} = and i32 %flags{k}, {READABLE}")
    w.append(f"  %flags{k}.ok = icmp eq i32 %wanted{k}, {READABLE}")
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
