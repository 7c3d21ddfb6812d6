"""Generates the LLVM IR of a traced function that procedures call: one sample per SIMD lane.

Arrays lie in structure-of-arrays (SoA) layout: element by element, the lanes of each element side by side.
"""

from __future__ import annotations

from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.language.function import Function


def lanes_kernel_ir(f: Function, lanes: int, element: DType, arithmetic: Arithmetic = COMPLETE) -> str:
    """The module of `void kernel(ptr inputs, ptr outputs)`.

    Element k of the input of lane j is number k * lanes + j of `inputs`, and likewise for the outputs. All inputs
    lie one after the other, and so do all outputs. They may overlap: all inputs are read before any output is written.

    Args:
        f: The function, without loops over lanes.
        lanes: How many samples.
        element: The type of the numbers.
        arithmetic: What the processor computes in one instruction.

    Returns:
        LLVM IR.
    """
    module, layout = Module(), Lanes(lanes, element)
    body = Writer(module, f.graph, layout, "", arithmetic)
    width, kind = lanes * BYTES[element], layout.real
    order = f.graph.live(f.results)
    live = set(order)
    for k, node in enumerate(f.graph.inputs):
        if node in live:
            body.write(f"%ip{k} = getelementptr i8, ptr %inputs, i64 {k * width}")
            body.assign(node, f"load {kind}, ptr %ip{k}, align {BYTES[element]}")
    body.nodes(order)
    for k, node in enumerate(f.results):
        body.write(f"%op{k} = getelementptr i8, ptr %outputs, i64 {k * width}")
        body.write(f"store {kind} {body.names[node]}, ptr %op{k}, align {BYTES[element]}")
    head = "define void @kernel(ptr %inputs, ptr %outputs) nounwind #0 {"
    module.definitions["kernel"] = "\n".join(
        [head, "entry:", *body.local_arrays, *body.lines, "  ret void", "}", ""]
    )
    bits = width * 8
    return (
        module.text()
        + f'\nattributes #0 = {{ "prefer-vector-width"="{bits}" "min-legal-vector-width"="{bits}" }}\n'
    )
