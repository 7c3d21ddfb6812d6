"""Writes a function for many threads: each evaluates one sample, whose numbers lie where two strides say.

The function takes the number of its thread, so the very text that a GPU runs also runs on a CPU, thread after thread.
Neighbouring threads read and write neighbouring numbers where the stride from sample to sample is 1: then a GPU fetches
them together.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.register_pressure import low_pressure_steps
from ulna.compiler.codegen.scheduling import Sines, Store, made
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op

GLOBAL = "ptr addrspace(1)"
"""The type of addresses in a GPU's main memory."""


def emit_threads(functions: Sequence[tuple[str, Function]], target: Target, element: DType) -> str:
    """IR of `void NAME.thread(i64 thread, i64 count, ptr, i64, i64, ...)` for each function.

    For each input and output there are its address and two strides [numbers]: from sample to sample and from number to
    number. Threads from `count` on do nothing.

    Args:
        functions: Pairs of a name and a function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module.
    """
    module = Module()
    for name, f in functions:
        _write_thread(module, name, f, target, element)
    return module.text()


def emit_kernels(functions: Sequence[tuple[str, Function]], target: Target, element: DType) -> str:
    """IR of a CUDA kernel for each function: `NAME(i64 count, ptr, i64, i64, ...)`, one thread for each sample.

    Args:
        functions: Pairs of a name and a function; names are identifiers.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module.
    """
    text = [emit_threads(functions, target, element)]
    registers = ("ctaid", "ntid", "tid")
    text += [f"declare i32 @llvm.nvvm.read.ptx.sreg.{name}.x()" for name in registers]
    for name, f in functions:
        head = ", ".join(_parameters(f))
        text += ["", f"define ptx_kernel void @{name}(i64 %count, {head}) {{"]
        for register in registers:
            text.append(f"  %{register} = call i32 @llvm.nvvm.read.ptx.sreg.{register}.x()")
            text.append(f"  %{register}.wide = zext i32 %{register} to i64")
        text += [
            "  %first = mul i64 %ctaid.wide, %ntid.wide",
            "  %thread = add i64 %first, %tid.wide",
            f"  call void @{name}.thread(i64 %thread, i64 %count, {head})",
            "  ret void",
            "}",
        ]
    return "\n".join(text) + "\n"


def emit_on_cpu(functions: Sequence[tuple[str, Function]], target: Target, element: DType) -> str:
    """IR that runs the code of a GPU's threads one after the other: `void NAME.all(i64 count, ptr, i64, i64, ...)`.

    Args:
        functions: Pairs of a name and a function.
        target: The processor of the GPU, as for `emit_kernels`.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module for this machine.
    """
    text = [emit_threads(functions, target, element)]
    for name, f in functions:
        head = ", ".join(_parameters(f))
        text += [
            f"define void @{name}.all(i64 %count, {head}) {{",
            "entry:",
            "  br label %step",
            "step:",
            "  %thread = phi i64 [ 0, %entry ], [ %next, %step ]",
            f"  call void @{name}.thread(i64 %thread, i64 %count, {head})",
            "  %next = add i64 %thread, 1",
            # One thread more than there are samples: it must do nothing.
            "  %over = icmp ugt i64 %next, %count",
            "  br i1 %over, label %end, label %step",
            "end:",
            "  ret void",
            "}",
        ]
    return "\n".join(text) + "\n"


def _ports(f: Function) -> list[str]:
    return [f"i{k}" for k in range(len(f.inputs))] + [f"o{k}" for k in range(len(f.outputs))]


def _parameters(f: Function) -> list[str]:
    return [f"{GLOBAL} %{port}, i64 %{port}.sample, i64 %{port}.number" for port in _ports(f)]


def _write_thread(module: Module, name: str, f: Function, target: Target, element: DType) -> None:
    """The function of one thread."""
    w = Writer(module, f.graph, Lanes(1, element), "", target.arithmetic, stack_space=target.stack_space)
    w.branch(w.let("works", "icmp ult i64 %thread, %count"), "work", "done")
    w.open_block("work")
    for port in _ports(f):
        w.let(f"{port}.first", f"mul i64 %thread, %{port}.sample")
        w.let(f"{port}.row", f"getelementptr {element}, {GLOBAL} %{port}, i64 %{port}.first")
    _read(w, f, element)
    for step in low_pressure_steps(f):
        if isinstance(step, Sines):
            _constants(w, f.graph, step.arguments)
            w.sincos(step.arguments)
        elif isinstance(step, Store):
            _constants(w, f.graph, step.values)
            for at, value in enumerate(step.values, step.start):
                place = _place(w, f"o{step.port}", at, element)
                w.write(f"store {element} {w.names[value]}, {place}, align {BYTES[element]}")
        else:
            _constants(w, f.graph, f.graph.args[step])
            w.nodes(made(f.graph, step))
    w.jump("done")
    w.open_block("done")
    arguments = ", ".join(["i64 %thread", "i64 %count", *_parameters(f)])
    head = f"define internal void @{name}.thread({arguments}) alwaysinline nounwind {{"
    module.definitions[f"{name}.thread"] = "\n".join(
        [head, "entry:", *w.local_arrays, *w.lines, "  ret void", "}", ""]
    )


def _constants(w: Writer, g: Graph, nodes: Sequence[int]) -> None:
    for index in nodes:
        if g.op[index] in (Op.CONST, Op.BOOL) and index not in w.names:
            w.node(index)


def _read(w: Writer, f: Function, element: DType) -> None:
    """Reads the numbers of all inputs that matter."""
    g, start = f.graph, 0
    live = set(g.live(f.results))
    for k, port in enumerate(f.inputs):
        for at, node in enumerate(g.inputs[start : start + port.size]):
            if node in live:
                place = _place(w, f"i{k}", at, element)
                w.assign(node, f"load {element}, {place}, align {BYTES[element]}")
        start += port.size


def _place(w: Writer, port: str, at: int, element: DType) -> str:
    """The address of a number of this thread's sample, with its type."""
    offset, pointer = w.fresh("n"), w.fresh("p")
    w.write(f"{offset} = mul i64 %{port}.number, {at}")
    w.write(f"{pointer} = getelementptr {element}, {GLOBAL} %{port}.row, i64 {offset}")
    return f"{GLOBAL} {pointer}"
