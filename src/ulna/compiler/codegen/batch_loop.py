"""Writes the loop over a batch: NumPy's inner loop of a generalised ufunc, around the block of SIMD lanes.

The block takes `lanes` rows at a time where they lie, and a single row in all lanes alike. A port whose samples have
strides inside, and every port of the last rows, fewer than lanes, go through a scratch of contiguous rows. No row is
done twice, so a batch may be written over its own input.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import BYTES, DType
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port

_SCRATCH = 2**16  # bytes on the stack; where more would be needed, a scratch holds one row


def batch_loop(f: Function, element: DType, lanes: int) -> str:
    """IR of `void batch(ptr args, ptr dimensions, ptr steps, ptr data)`, which calls `block`.

    Args:
        f: The function; its ports and their shapes are all that is used of it.
        element: Type of the array elements, "double" or "float".
        lanes: Number of samples that `block` takes at a time.

    Returns:
        The text of the definition, without declarations.
    """
    ports, inputs = [*f.inputs, *f.outputs], len(f.inputs)
    large = lanes * BYTES[element] * sum(p.size for p in ports) > _SCRATCH
    w = ["define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {", "entry:"]
    w.append("  %n = load i64, ptr %dims\n  %last = sub i64 %n, 1")
    inner = len(ports)  # position in steps of the next stride inside samples
    for k, port in enumerate(ports):
        _arguments(w, k, port, inner, element)
        w.append(f"  %t{k} = alloca {element}, i64 {port.size if large else lanes * port.size}")
        inner += len(port.shape)
    w.append("  %none = icmp eq i64 %n, 0\n  br i1 %none, label %done, label %step")

    w.append(f"step:\n  %i = phi i64 [ 0, %entry ], [ %next, %put{len(ports)} ]")
    w.append(f"  %left = sub i64 %n, %i\n  %many = icmp uge i64 %left, {lanes}")
    if large:  # as many rows as lanes from where they lie, or one row
        odd = _any(w, "odd", [f"xor i1 %dense{k}, true" for k in range(len(ports))])
        w.append(f"  %straight = xor i1 {odd}, true\n  %wide = and i1 %many, %straight")
        w.append("  %single = xor i1 %wide, true")
    else:
        w.append("  %single = icmp eq i64 %left, 1")
    wide = "%wide" if large else "%many"
    w.append(f"  %rows = select i1 %single, i64 1, i64 {lanes}")  # how many the block takes
    w.append(f"  %short = select i1 %single, i64 1, i64 %left\n  %simple = or i1 {wide}, %single")
    w.append(f"  %count = select i1 {wide}, i64 {lanes}, i64 %short")  # how many are left in them
    for k in range(len(ports)):
        w.append(f"  %direct{k} = and i1 %dense{k}, %simple")
    w.append("  br label %get0")
    for k, port in enumerate(ports[:inputs]):
        _move(w, f"get{k}", f"get{k + 1}", k, port, element, gather=True)
    w.append(f"get{inputs}:")
    call = []
    for k, port in enumerate(ports):
        w.append(f"  %o{k} = mul i64 %i, %s{k}\n  %p{k} = getelementptr i8, ptr %a{k}, i64 %o{k}")
        w.append(f"  %r{k} = select i1 %direct{k}, ptr %p{k}, ptr %t{k}")
        w.append(f"  %d{k} = select i1 %direct{k}, i64 %s{k}, i64 {BYTES[element] * port.size}")
        w.append(f"  %e{k} = select i1 %single, i64 0, i64 %d{k}")
        call.append(f"ptr %r{k}, i64 %e{k}")
    w.append(f"  call void @block({', '.join(call)})\n  br label %put{inputs}")
    for k, port in enumerate(ports[inputs:], inputs):
        _move(w, f"put{k}", f"put{k + 1}", k, port, element, gather=False)
    w.append(f"put{len(ports)}:\n  %next = add i64 %i, %count\n  %end = icmp eq i64 %next, %n")
    w.append("  br i1 %end, label %done, label %step")
    # The bits of the exceptions differ between processors; C libraries consider only those that exist.
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
    """Block `label`: copies rows from %i on between port k and its scratch, unless the block reads it directly.

    In go as many as the block takes, the last row again and again where there are no more; out come the real ones.
    """
    w.append(f"{label}:\n  br i1 %direct{k}, label %{following}, label %{label}.row")
    # One loop over the rows and one for each axis; the counters are the index.
    bounds: list[int | str] = ["%rows" if gather else "%count", *port.shape]
    strides = [f"%s{k}", *(f"%c{k}.{axis}" for axis in range(len(port.shape)))]
    names = [f"{label}.row", *(f"{label}.x{axis}" for axis in range(len(port.shape)))]
    w.append(f"{names[0]}:\n  %{names[0]}.k = phi i64 [ 0, %{label} ], [ %{names[0]}.n, %{names[0]}.end ]")
    w.append(f"  %{names[0]}.here = add i64 %i, %{names[0]}.k")
    w.append(f"  %{names[0]}.beyond = icmp ugt i64 %{names[0]}.here, %last")
    w.append(f"  %{names[0]}.at = select i1 %{names[0]}.beyond, i64 %last, i64 %{names[0]}.here")
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
