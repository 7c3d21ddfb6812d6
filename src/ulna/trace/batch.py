"""Writes the loop over a batch: NumPy's inner loop of a generalised ufunc, around the block of SIMD lanes.

The block takes `lanes` rows at a time where they lie. A port whose samples have strides inside goes through a scratch
of that many contiguous rows. What is left at the end is done by moving the last block back over rows already done;
where a batch is written over its own input, and where there are fewer rows than lanes, row by row, in all lanes alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from ulna.trace.function import Function, Port
from ulna.trace.irtext import BYTES, DType

_SCRATCH = 2**16  # bytes on the stack; where more would be needed, a scratch holds one row


def batch_loop(f: Function, element: DType, lanes: int) -> str:
    """IR of `void batch(ptr args, ptr dimensions, ptr steps, ptr data)`, which calls `block`."""
    ports, inputs = [*f.inputs, *f.outputs], len(f.inputs)
    rows = lanes if lanes * BYTES[element] * sum(p.size for p in ports) <= _SCRATCH else 1
    w = ["define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {", "entry:"]
    w.append("  %n = load i64, ptr %dims")
    inner = len(ports)  # position in steps of the next stride inside samples
    for k, port in enumerate(ports):
        _arguments(w, k, port, inner, element)
        w.append(f"  %t{k} = alloca {element}, i64 {max(rows * port.size, 1)}")
        inner += len(port.shape)
    pairs = product(range(inputs), range(inputs, len(ports)))
    shared = _any(w, "shared", [f"icmp eq ptr %a{i}, %a{o}" for i, o in pairs])
    w.append(f"  %last = sub i64 %n, {lanes}\n  %enough = icmp uge i64 %n, {lanes}")
    if rows == 1:
        strided = _any(w, "strided", [f"xor i1 %dense{k}, true" for k in range(len(ports))])
        w.append(f"  %straight = xor i1 {strided}, true\n  %begin = and i1 %enough, %straight")
    begin = "%begin" if rows == 1 else "%enough"
    w.append("  %none = icmp eq i64 %n, 0\n  br i1 %none, label %done, label %step")

    w.append("step:\n  %i = phi i64 [ 0, %entry ], [ %j, %again ]")
    w.append(f"  %wide = phi i1 [ {begin}, %entry ], [ %still, %again ]")
    w.append(f"  %count = select i1 %wide, i64 {lanes}, i64 1\n  br label %get0")
    for k, port in enumerate(ports[:inputs]):
        _move(w, f"get{k}", f"get{k + 1}", k, port, element, gather=True)
    w.append(f"get{inputs}:")
    call = []
    for k, port in enumerate(ports):
        w.append(f"  %o{k} = mul i64 %i, %s{k}\n  %p{k} = getelementptr i8, ptr %a{k}, i64 %o{k}")
        w.append(f"  %r{k} = select i1 %dense{k}, ptr %p{k}, ptr %t{k}")
        w.append(f"  %d{k} = select i1 %dense{k}, i64 %s{k}, i64 {BYTES[element] * port.size}")
        w.append(f"  %e{k} = select i1 %wide, i64 %d{k}, i64 0")
        call.append(f"ptr %r{k}, i64 %e{k}")
    w.append(f"  call void @block({', '.join(call)})\n  br label %put{inputs}")
    for k, port in enumerate(ports[inputs:], inputs):
        _move(w, f"put{k}", f"put{k + 1}", k, port, element, gather=False)
    w.append(f"put{len(ports)}:\n  %next = add i64 %i, %count\n  %left = sub i64 %n, %next")
    w.append("  %end = icmp eq i64 %left, 0\n  br i1 %end, label %done, label %again")
    # A block moved back redoes rows, with equal results unless an output is an input: NumPy makes no copy when they
    # are the very same array.
    w.append(f"again:\n  %fits = icmp uge i64 %left, {lanes}\n  %free = xor i1 {shared}, true")
    w.append("  %may = or i1 %fits, %free\n  %still = and i1 %wide, %may")
    w.append("  %short = xor i1 %fits, true\n  %back = and i1 %still, %short")
    w.append("  %j = select i1 %back, i64 %last, i64 %next\n  br label %step")
    # The bits of the exceptions differ between processors; C libraries pay heed only to those that exist.
    w.append("done:\n  %flags = call i32 @feclearexcept(i32 -1)\n  ret void\n}\n")
    return "\n".join(w)


def _arguments(w: list[str], k: int, port: Port, inner: int, element: DType) -> None:
    """Address %a, stride from row to row %s, strides inside a row %c of port k, and whether its rows are %dense."""
    w.append(f"  %a{k}.p = getelementptr ptr, ptr %args, i64 {k}\n  %a{k} = load ptr, ptr %a{k}.p")
    w.append(f"  %s{k}.p = getelementptr i64, ptr %steps, i64 {k}\n  %s{k} = load i64, ptr %s{k}.p")
    expected, odd = BYTES[element], []
    for axis in reversed(range(len(port.shape))):
        name = f"%c{k}.{axis}"
        w.append(
            f"  {name}.p = getelementptr i64, ptr %steps, i64 {inner + axis}\n  {name} = load i64, ptr {name}.p"
        )
        if port.shape[axis] > 1:
            odd.append(f"icmp ne i64 {name}, {expected}")
        expected *= port.shape[axis]
    w.append(f"  %dense{k} = xor i1 {_any(w, f'odd{k}', odd)}, true")


def _any(w: list[str], tag: str, tests: Sequence[str]) -> str:
    """An i1: whether one of the tests holds."""
    result = "false"
    for number, test in enumerate(tests):
        w.append(f"  %{tag}.{number} = {test}\n  %{tag}.or{number} = or i1 {result}, %{tag}.{number}")
        result = f"%{tag}.or{number}"
    return result


def _move(w: list[str], label: str, following: str, k: int, port: Port, element: DType, gather: bool) -> None:
    """Block `label`: copies %count rows from %i on between port k and its scratch, unless the port is dense."""
    w.append(f"{label}:\n  br i1 %dense{k}, label %{following}, label %{label}.row")
    # One loop over the rows and one for each axis; the counters are the index.
    bounds: list[int | str] = ["%count", *port.shape]
    strides = [f"%s{k}", *(f"%c{k}.{axis}" for axis in range(len(port.shape)))]
    names = [f"{label}.row", *(f"{label}.x{axis}" for axis in range(len(port.shape)))]
    w.append(f"{names[0]}:\n  %{names[0]}.k = phi i64 [ 0, %{label} ], [ %{names[0]}.n, %{names[0]}.end ]")
    w.append(f"  %{names[0]}.at = add i64 %i, %{names[0]}.k")
    pointer, flat, index = f"%a{k}", f"%{names[0]}.k", f"%{names[0]}.at"
    for level, (name, stride) in enumerate(zip(names, strides, strict=True)):
        if level:
            w.append(f"  br label %{name}\n{name}:")
            w.append(f"  %{name}.k = phi i64 [ 0, %{names[level - 1]} ], [ %{name}.n, %{name}.end ]")
            w.append(
                f"  %{name}.m = mul i64 {flat}, {bounds[level]}\n  %{name}.f = add i64 %{name}.m, %{name}.k"
            )
            flat, index = f"%{name}.f", f"%{name}.k"
        w.append(f"  %{name}.o = mul i64 {index}, {stride}")
        w.append(f"  %{name}.p = getelementptr i8, ptr {pointer}, i64 %{name}.o")
        pointer = f"%{name}.p"
    w.append(f"  %{label}.s = getelementptr {element}, ptr %t{k}, i64 {flat}")
    source, target = (pointer, f"%{label}.s") if gather else (f"%{label}.s", pointer)
    w.append(f"  %{label}.v = load {element}, ptr {source}, align {BYTES[element]}")
    w.append(f"  store {element} %{label}.v, ptr {target}, align {BYTES[element]}")
    w.append(f"  br label %{names[-1]}.end")
    for level in reversed(range(len(names))):
        name, after = names[level], f"{names[level - 1]}.end" if level else following
        w.append(f"{name}.end:\n  %{name}.n = add i64 %{name}.k, 1")
        w.append(f"  %{name}.over = icmp eq i64 %{name}.n, {bounds[level]}")
        w.append(f"  br i1 %{name}.over, label %{after}, label %{name}")
