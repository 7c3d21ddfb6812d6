"""Writes the loop over a batch: NumPy's inner loop of a generalised ufunc, around the block of SIMD lanes.

The block takes `lanes` rows at a time where they lie, and a single row in all lanes alike. A port whose samples have
strides inside, and every port of the last rows, fewer than lanes, go through a scratch of contiguous rows. No row is
done twice, so a batch may be written over its own input. The function that copies rows is the same for all ports and
functions, which keeps the loop short: it is compiled once (`rare_functions.py`).
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.copy_rows import NAME, copying
from ulna.compiler.codegen.instructions import Instructions
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
        The text of the definition and of those that it needs, without declarations.
    """
    ports, inputs = [*f.inputs, *f.outputs], len(f.inputs)
    large = lanes * BYTES[element] * sum(p.size for p in ports) > _SCRATCH
    w = Instructions()
    w.lines += copying(element).splitlines()
    inner = len(ports)  # position in steps of the next stride inside samples
    for k, port in enumerate(ports):
        w.lines.append(_table(k, port, inner, k >= inputs))
        inner += len(port.shape)
    w.begin_function("define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind")
    w.let("n", "load i64, ptr %dims")
    inner = len(ports)
    for k, port in enumerate(ports):
        _arguments(w, k, port, inner, element)
        w.let(f"t{k}", f"alloca {element}, i64 {port.size if large else lanes * port.size}")
        inner += len(port.shape)
    w.branch(w.let("none", "icmp eq i64 %n, 0"), "done", "step")
    _step(w, len(ports), lanes, large)
    for k, port in enumerate(ports[:inputs]):
        _move(w, f"get{k}", f"get{k + 1}", k, port, "%rows")
    w.open_block(f"get{inputs}")
    _call(w, ports, element)
    w.jump(f"put{inputs}")
    for k, port in enumerate(ports[inputs:], inputs):
        _move(w, f"put{k}", f"put{k + 1}", k, port, "%count")
    w.open_block(f"put{len(ports)}")
    w.let("next", "add i64 %i, %count")
    w.branch(w.let("end", "icmp eq i64 %next, %n"), "done", "step")
    w.open_block("done")
    # The bits of the exceptions differ between processors; C libraries consider only those that exist.
    w.let("flags", "call i32 @feclearexcept(i32 -1)")
    w.write("ret void")
    w.end_function()
    return w.text()


def _step(w: Instructions, ports: int, lanes: int, large: bool) -> None:
    """Begins a step from row %i on: how many %rows the block takes, how many %count, which ports it reads directly."""
    w.open_block("step")
    w.let("i", f"phi i64 [ 0, %entry ], [ %next, %put{ports} ]")
    w.let("left", "sub i64 %n, %i")
    w.let("last", "sub i64 %left, 1")
    w.let("many", f"icmp uge i64 %left, {lanes}")
    if large:  # as many rows as lanes from where they lie, or one row
        odd = _any(w, "odd", [f"xor i1 %dense{k}, true" for k in range(ports)])
        w.let("straight", f"xor i1 {odd}, true")
        w.let("wide", "and i1 %many, %straight")
        w.let("single", "xor i1 %wide, true")
    else:
        w.let("single", "icmp eq i64 %left, 1")
    wide = "%wide" if large else "%many"
    w.let("rows", f"select i1 %single, i64 1, i64 {lanes}")  # how many the block takes
    w.let("short", "select i1 %single, i64 1, i64 %left")
    w.let("simple", f"or i1 {wide}, %single")
    w.let("count", f"select i1 {wide}, i64 {lanes}, i64 %short")  # how many are left in them
    for k in range(ports):
        w.let(f"direct{k}", f"and i1 %dense{k}, %simple")
    w.jump("get0")


def _call(w: Instructions, ports: Sequence[Port], element: DType) -> None:
    """Calls the block on the rows, or on the scratches."""
    arguments = []
    for k, port in enumerate(ports):
        w.let(f"o{k}", f"mul i64 %i, %s{k}")
        w.let(f"p{k}", f"getelementptr i8, ptr %a{k}, i64 %o{k}")
        pointer = w.let(f"r{k}", f"select i1 %direct{k}, ptr %p{k}, ptr %t{k}")
        w.let(f"d{k}", f"select i1 %direct{k}, i64 %s{k}, i64 {BYTES[element] * port.size}")
        stride = w.let(f"e{k}", f"select i1 %single, i64 0, i64 %d{k}")
        arguments.append(f"ptr {pointer}, i64 {stride}")
    w.write(f"call void @block({', '.join(arguments)})")


def _arguments(w: Instructions, k: int, port: Port, inner: int, element: DType) -> None:
    """Address %a, stride from row to row %s, strides inside a row %c of port k, and whether its rows are %dense."""
    w.item(f"a{k}", "%args", k)
    w.item(f"s{k}", "%steps", k, "i64")
    expected, odd = BYTES[element], []
    for axis in reversed(range(len(port.shape))):
        stride = w.item(f"c{k}.{axis}", "%steps", inner + axis, "i64")
        if port.shape[axis] > 1:
            odd.append(f"icmp ne i64 {stride}, {expected}")
        expected *= port.shape[axis]
    w.let(f"dense{k}", f"xor i1 {_any(w, f'odd{k}', odd)}, true")


def _any(w: Instructions, tag: str, tests: Sequence[str]) -> str:
    """An i1: whether one of the tests holds."""
    result = "false"
    for number, test in enumerate(tests):
        holds = w.let(f"{tag}.{number}", test)
        result = w.let(f"{tag}.or{number}", f"or i1 {result}, {holds}")
    return result


def _move(w: Instructions, label: str, following: str, k: int, port: Port, rows: str) -> None:
    """Block `label`: copies rows from %i on between port k and its scratch, unless the block reads it directly.

    In go as many as the block takes, the last row again and again where there are no more; out come the real ones.
    """
    w.open_block(label)
    if port.size == 0:
        w.jump(following)
        return
    w.branch(f"%direct{k}", following, f"{label}.copy")
    w.open_block(f"{label}.copy")
    w.let(f"{label}.o", f"mul i64 %i, %s{k}")
    row = w.let(f"{label}.p", f"getelementptr i8, ptr %a{k}, i64 %{label}.o")
    table = f"ptr @batch.port{k}, i1 %dense{k}"
    w.write(f"call void @{NAME}(ptr %t{k}, ptr {row}, i64 {rows}, i64 %last, ptr %steps, {table})")
    w.jump(following)


def _table(k: int, port: Port, inner: int, is_output: bool) -> str:
    """A constant with what is known of port k, whose strides inside rows begin at `inner` in steps.

    It has whether the port is an output, where in steps the stride of its rows is, how many numbers a row has, of each
    axis its length and where its stride is, and a zero.
    """
    axes = [number for axis, size in enumerate(port.shape) for number in (size, inner + axis)]
    numbers = [int(is_output), k, port.size, *(axes or (0, 0)), 0]
    items = ", ".join(f"i64 {number}" for number in numbers)
    return f"@batch.port{k} = private unnamed_addr constant [{len(numbers)} x i64] [{items}], align 8"
