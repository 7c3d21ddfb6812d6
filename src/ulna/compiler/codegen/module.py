"""Writes a function's graph as LLVM IR text: one sample, a block of SIMD lanes, and the loop over a batch.

`node_writer` writes the nodes, `scheduling` chooses the order and the parts, `rows` moves rows into lanes and back,
`batch_loop` writes the loop around.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from ulna.compiler.codegen.batch_loop import batch_loop
from ulna.compiler.codegen.columns import columns_target, write_columns
from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes, local_array
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.packed import write_packed
from ulna.compiler.codegen.row_table import write_rows
from ulna.compiler.codegen.rows import load, store
from ulna.compiler.codegen.sample_stages import suits_sample_stages, write_sample_stages
from ulna.compiler.codegen.scheduling import Step, Store, parts, scratch_places
from ulna.compiler.codegen.stages import write_stages
from ulna.compiler.codegen.straight_line import define, write_steps
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.columns import ColumnForm
from ulna.compiler.forms.packed import PackedForm
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.language.function import Function
from ulna.compiler.language.ops import Op
from ulna.compiler.language.ports import SecondForm

_MAX_TAPE_BYTES = 4_000_000
"""Size of all tapes of loops up to which several samples are computed in lanes; larger, one at a time [byte]."""

_SCRATCH = "ptr noalias %scratch"
_ALIGNED = ' "stackrealign"'
"""The attribute of functions whose spilled registers stay within a cache line.

Without it LLVM aligns the stack only where an array asks for it, and spills registers of 64 bytes across two lines."""


def _write_block(module: Module, f: Function, name: str, layout: Lanes, pack: int, target: Target) -> None:
    """`void name(ptr in, i64 stride, ..., ptr out, i64 stride, ...)`: lane j has the rows j * stride [byte].

    A large graph becomes several functions that hand values on in a scratch.
    """
    strided = layout.lanes > 1 or name == "block"
    if f.lanes > 1:
        layout, pack = Lanes(f.lanes, layout.dtype), 1
    names = [f"i{k}" for k in range(len(f.inputs))] + [f"o{k}" for k in range(len(f.outputs))]
    # Outputs may be inputs: sound, because all loads come before all stores.
    arguments = [f"ptr %{port}, i64 %{port}s" if strided else f"ptr %{port}" for port in names]
    attributes = "noinline nounwind #0" if strided or f.lanes > 1 else "noinline nounwind"
    pieces = parts(f, layout.lanes, pack)
    writes_rows_last = (
        layout.lanes > 1 and len(pieces) > 1
    )  # then the last part has the stores and nothing else
    slots = scratch_places(f.graph, pieces, f.results if writes_rows_last else ())
    bodies = []
    for number, steps in enumerate(pieces):
        body = Writer(module, f.graph, layout, "", target.arithmetic, f.lanes > 1, target.stack_space, pack)
        if number == 0:
            _read_inputs(body, f)
        if writes_rows_last and number == len(pieces) - 1:
            _write_output_rows(body, f, slots)
        else:
            write_steps(body, steps, slots, put=_store_columns)
        bodies.append([*body.local_arrays, *body.lines])
    if len(pieces) == 1:
        define(module, name, arguments, attributes, bodies[0])
        return
    calls = local_array("scratch", layout.real, max(slots.values(), default=0) + 1, target.stack_space)
    for number, (steps, lines) in enumerate(zip(pieces, bodies, strict=True)):
        has_rows = writes_rows_last and number == len(pieces) - 1
        given = [*_used(arguments, f, steps, number == 0, has_rows), _SCRATCH]
        define(module, f"{name}.{number}", given, attributes, lines)
        calls.append(f"  call void @{name}.{number}({', '.join(given).replace('noalias ', '')})")
    define(module, name, arguments, attributes, calls)


def _used(
    arguments: Sequence[str], f: Function, steps: Sequence[Step], is_first: bool, has_rows: bool
) -> list[str]:
    """The ports that a part needs as arguments; most need none, and calls with many arguments are much code."""
    inputs = len(f.inputs)
    stored = {step.port for step in steps if isinstance(step, Store)}
    outputs = [a for k, a in enumerate(arguments[inputs:]) if has_rows or k in stored]
    return [*(arguments[:inputs] if is_first else ()), *outputs]


def _store_columns(to: Writer, step: Store) -> None:
    store(to, f"o{step.port}", step.start, [to.names[v] for v in step.values])


def _read_inputs(to: Writer, f: Function) -> None:
    g, start = f.graph, 0
    live = set(g.live(f.results))
    for k, port in enumerate(f.inputs):
        nodes = g.inputs[start : start + port.size]
        for j, value in load(to, f"i{k}", port.size, [j for j, n in enumerate(nodes) if n in live]):
            to.names[nodes[j]] = value
        start += port.size


def _write_output_rows(to: Writer, f: Function, slots: dict[int, int]) -> None:
    """Writes all outputs out of the scratch."""
    g, start = f.graph, 0
    zeros = (
        slots[index] for index in f.results if g.op[index] == Op.CONST and g.data[index].hex() == "0x0.0p+0"
    )
    zero = next(zeros, None)
    for k, port in enumerate(f.outputs):
        write_rows(to, f"o{k}", [slots[index] for index in f.results[start : start + port.size]], zero)
        start += port.size


def emit_single(f: Function, target: Target, element: DType = "double") -> str:
    """IR of one sample: `void one(ptr in0, ..., ptr out0, ...)` on contiguous samples.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module.
    """
    module = Module()
    narrowed = None if f.columns is None else columns_target(f, target, element)
    if f.columns is not None and narrowed is not None:
        _write_form(module, "one", f.columns, narrowed, element)
        return module.text() + _wide_registers(narrowed.lanes(element), element, _ALIGNED)
    pack = target.sines_at_once(f.operations, element)
    _write_block(module, f, "one", Lanes(1, element), pack, target)
    return module.text() + (_wide_registers(f.lanes, element, _ALIGNED) if f.lanes > 1 else "")


def _write_form(module: Module, name: str, form: SecondForm, target: Target, element: DType) -> None:
    """`void name(ptr in0, ..., ptr out0, ...)` by a second form."""
    if isinstance(form, StagedForm):
        write_stages(module, name, form, target, element)
        return
    if isinstance(form, PackedForm):
        _write_form(module, "whole", form.whole, target, element)
        write_packed(module, name, form, "whole", target, element)
        return
    assert isinstance(form, ColumnForm)
    if isinstance(form.head, StagedForm):
        write_stages(module, "head", form.head, target, element)
    else:
        assert isinstance(form.head, Function)
        _write_block(module, form.head, "head", Lanes(1, element), target.packed_sines, target)
    write_columns(module, name, form, target, element)


def emit_library(
    functions: Sequence[tuple[str, Function]],
    target: Target,
    element: DType = "double",
    add: Callable[[Module], None] | None = None,
) -> str:
    """IR of a library: for each function `void NAME(ptr in0, ..., ptr out0, ...)` on one contiguous sample.

    Args:
        functions: Pairs of a name and a function; names are identifiers.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".
        add: Adds definitions to the module, which may call the functions as `NAME.one`.

    Returns:
        The text of an LLVM module; the functions share what they call.
    """
    module = Module()
    for name, f in functions:
        _write_block(module, f, f"{name}.one", Lanes(1, element), target.packed_sines, target)
        ports = len(f.inputs) + len(f.outputs)
        arguments = ", ".join(f"ptr %p{k}" for k in range(ports))
        module.definitions[name] = "\n".join(
            [
                f"define void @{name}({arguments}) nounwind {{",
                f"  call void @{name}.one({arguments})",
                "  ret void",
                "}\n",
            ]
        )
    if add is not None:
        add(module)
    # Without this, LLVM calls memset and memcpy where rows of equal numbers are written or moved.
    text = re.sub(r"^(define .*?)nounwind", r'\1nounwind "no-builtins"', module.text(), flags=re.MULTILINE)
    return text + _wide_registers(max((f.lanes for _, f in functions), default=1), element)


def emit_batch(f: Function, target: Target, element: DType = "double") -> str:
    """IR of the inner loop of a generalised ufunc over samples, as many at a time as the target has lanes.

    `void batch(ptr args, ptr dimensions, ptr steps, ptr data)` is NumPy's PyUFuncGenericFunction. Samples with
    strides inside go through a scratch copy, one by one. Floating-point flags are cleared at the end, because
    both sides of every `where` are computed.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module.
    """
    module = Module()
    lanes = 1 if f.lanes > 1 else target.lanes(element)  # or all lanes work on one sample
    if f.columns is None and f.has_loops and f.tape_size * lanes * BYTES[element] > _MAX_TAPE_BYTES:
        lanes = 1
    wide = max(lanes, f.lanes)
    form = f.columns
    narrowed = None if form is None or not form.serves_batches else columns_target(f, target, element)
    if form is None or narrowed is None:
        _write_block(module, f, "block", Lanes(lanes, element), 1, target)
    elif suits_sample_stages(form, target, element):
        write_sample_stages(module, form, target, element)
    else:
        lanes = 1
        _write_form(module, "one", form, narrowed, element)
        _write_block_of_one(module, f)
    module.declare("declare i32 @feclearexcept(i32)")
    module.definitions["batch"] = batch_loop(f, element, lanes)
    return module.text() + _wide_registers(wide, element, _ALIGNED)


def serves_batches_one_by_one(f: Function, target: Target, element: DType) -> bool:
    """Whether the code of one sample is also that of a batch, which is then nothing but a loop around it.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        Whether `one_by_one` is its loop over a batch.
    """
    form = f.columns
    if form is None or not form.serves_batches or columns_target(f, target, element) is None:
        return False
    return not suits_sample_stages(form, target, element)


def one_by_one(f: Function, element: DType) -> str:
    """The definition of `batch` around `one`, as for `emit_batch`.

    Args:
        f: The function.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text, which a module can have beside that of `emit_single`.
    """
    module = Module()
    _write_block_of_one(module, f)
    module.declare("declare i32 @feclearexcept(i32)")
    module.definitions["batch"] = batch_loop(f, element, 1)
    return module.text()


def _write_block_of_one(module: Module, f: Function) -> None:
    """`block` for one sample at a time, whose strides are of no use, by `one`."""
    names = [f"i{k}" for k in range(len(f.inputs))] + [f"o{k}" for k in range(len(f.outputs))]
    call = f"  call void @one({', '.join(f'ptr %{name}' for name in names)})"
    define(module, "block", [f"ptr %{name}, i64 %{name}s" for name in names], "noinline nounwind #0", [call])


def _wide_registers(lanes: int, element: DType, more: str = "") -> str:
    """The attributes that let a function use registers of so many lanes."""
    bits = lanes * BYTES[element] * 8
    return f'\nattributes #0 = {{ "prefer-vector-width"="{bits}" "min-legal-vector-width"="{bits}"{more} }}\n'
