"""Writes a function in its form of columns: the head once, then the body for a register of columns at a time.

The columns of a matrix in memory lie side by side, so an entry of as many columns as there are lanes is one load, and
what all columns share is loaded into all lanes. Where the rows of the columns in a register are zero, the body leaves
them out. The last columns of a row are taken with some before them once more,
so that no lane is idle beyond the row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.row_factors import write_row_factors
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.columns import ColumnForm, zeros_of
from ulna.compiler.forms.packed import PackedForm
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.language.function import Function, trace
from ulna.compiler.language.ops import Op
from ulna.compiler.language.ports import SecondForm

_MAX_SCRATCH = 400_000  # of the matrices, which lie on the stack [byte]
_NARROWEST = 32  # widest registers of a processor for which the form is worth it [byte]
_FEWEST_LANES = 4  # columns in a register, where a row has fewer than the widest holds
_MORE_OPERATIONS = 1.3
"""How many times as many operations shared code of columns may have as their own."""
_PRODUCTS = frozenset(map(int, (Op.MUL, Op.DIV, Op.NEG)))
"""Operations whose result is zero where an operand is."""


def can_write_columns(f: Function | SecondForm, target: Target, element: DType) -> bool:
    """Whether the form of columns suits a processor.

    Args:
        f: A function with such a form, or the form.
        target: The processor.
        element: Type of the array elements, "double" or "float".

    Returns:
        Whether there is a width of registers for it; see `columns_target`.
    """
    return columns_target(f, target, element) is not None


def columns_target(f: Function | SecondForm, target: Target, element: DType) -> Target | None:
    """The processor as a form of columns uses it: a robot of few joints takes narrower registers than there are.

    Args:
        f: A function with such a form, or the form.
        target: The processor.
        element: Type of the array elements, "double" or "float".

    Returns:
        The processor with the widest registers that hold no more numbers than a row has; None where these would be too
        narrow, or the matrices do not fit on the stack.
    """
    form = f.columns if isinstance(f, Function) else f
    assert form is not None
    if isinstance(form, PackedForm):
        form = form.whole
    columns = form.columns if isinstance(form, StagedForm) else form.outputs[0].shape[1]
    size = sum(port.size for port in form.outputs) * BYTES[element]
    if target.stack_space != 0 or size > _MAX_SCRATCH or target.register_bytes < _NARROWEST:
        return None
    while target.lanes(element) >= _FEWEST_LANES:
        if columns >= target.lanes(element):
            return target
        target = replace(target, register_bytes=target.register_bytes // 2)
    return None


def write_columns(module: Module, name: str, form: ColumnForm, target: Target, element: DType) -> None:
    """`void name(ptr in, ..., ptr out, ...)`, which calls `head`; that is written already.

    Args:
        module: Where the definitions go.
        name: The name of the function.
        form: Its form of columns.
        target: The processor.
        element: Type of the array elements, "double" or "float".
    """
    lanes, m, n = target.lanes(element), form.shape[1], form.body.inputs[1].size
    starts = [*range(0, m - lanes, lanes), m - lanes]
    bodies: dict[frozenset[int], str] = {}
    inputs = [f"ptr %i{k}" for k in range(len(form.inputs))]
    lines, scratch = [], []
    for k, port in enumerate(form.head.outputs):
        lines.append(f"  %s{k} = alloca [{max(port.size, 1)} x {element}], align 64")
        scratch.append(f"ptr %s{k}")
    lines.append(f"  call void @head({', '.join([*inputs, *scratch])})")
    table = scratch[0]
    if form.paths:
        table = "ptr %table"
        write_row_factors(module, "factors", form.paths, Lanes(lanes, element), target)
        lines.append(f"  %table = alloca [{form.body.inputs[0].size} x {element}], align 64")
        lines.append(f"  call void @factors({scratch[0]}, {table})")
    matrices = iter(scratch[1:])
    zero_rows = [
        [frozenset(i for i in range(n) if all(row[i] for row in zeros[x : x + lanes])) for x in starts]
        for zeros in zeros_of(form)
    ]
    shared = shared_rows(form.body, [rows for of_matrix in zero_rows for rows in of_matrix])
    for k, unit in enumerate(form.units):
        source = next(matrices) if unit is None else f"ptr {_units(module, unit, n, m, element)}"
        for start, of_register in zip(starts, zero_rows[k], strict=True):
            rows = shared[of_register]
            if rows not in bodies:
                bodies[rows] = f"column{len(bodies)}"
                body = without_rows(form.body, rows)
                _write_body(module, bodies[rows], body, m, Lanes(lanes, element), target)
            at = f"{k}.{start}"
            lines.append(f"  %x{at} = getelementptr {element}, {source}, i64 {start}")
            lines.append(f"  %y{at} = getelementptr {element}, ptr %o{k}, i64 {start}")
            lines.append(f"  call void @{bodies[rows]}({table}, ptr %x{at}, ptr %y{at})")
    arguments = [*inputs, *(f"ptr %o{k}" for k in range(len(form.units)))]
    define(module, name, arguments, "noinline nounwind #0", lines)


def shared_rows(
    body: Function, sets: Iterable[frozenset[int]], most: float = _MORE_OPERATIONS
) -> dict[frozenset[int], frozenset[int]]:
    """Which columns share code: for rows that are zero those that the code leaves out, all of them or fewer.

    Much code takes long to compile, and longer to fetch than some superfluous operations take.

    Args:
        body: The body.
        sets: The rows that are zero in each register of columns.
        most: How many times as many operations code may have as that which leaves out all of the rows.

    Returns:
        The rows that are left out, by those that are zero.
    """
    operations = _operations_of(body)
    costs = {rows: operations(rows) for rows in sets}
    groups: list[tuple[frozenset[int], list[frozenset[int]]]] = []
    for rows in sorted(costs, key=lambda x: (-costs[x], sorted(x))):
        for number, (common, members) in enumerate(groups):
            if operations(common & rows) <= most * costs[rows]:
                groups[number] = common & rows, [*members, rows]
                break
        else:
            groups.append((rows, [rows]))
    return {rows: common for common, members in groups for rows in members}


def _operations_of(body: Function) -> Callable[[frozenset[int]], int]:
    """A function: about how many operations a body has where some rows of its column are zero."""
    g, size = body.graph, body.inputs[0].size
    live = g.live(body.results)
    steps = [(g.op[k] in _PRODUCTS, k, *g.args[k][:1], g.args[k][-1]) for k in live if g.args[k]]
    column = g.inputs[size:]

    @cache
    def count(rows: frozenset[int]) -> int:
        is_zero, superfluous = bytearray(len(g.op)), 0
        for row in rows:
            is_zero[column[row]] = 1
        for is_product, k, a, b in steps:
            if is_zero[a] or is_zero[b]:  # a term that is zero, or the other term of a sum
                is_zero[k] = is_product or (is_zero[a] and is_zero[b])
                superfluous += 1
        return len(steps) - superfluous

    return count


def without_rows(body: Function, rows: frozenset[int]) -> Function:
    """The body on columns whose entries in some rows are zero.

    Args:
        body: The body.
        rows: The rows.

    Returns:
        A function of the same arguments.
    """
    if not rows:
        return body

    def narrowed(table: Any, column: Any) -> Any:
        return body(table, np.array([0.0 if k in rows else x for k, x in enumerate(column)], dtype=object))

    return trace(narrowed, name=body.name, table=body.inputs[0].shape, column=body.inputs[1].shape)


def _units(module: Module, unit: float, n: int, m: int, element: DType) -> str:
    """The name of a constant, a multiple of the unit matrix."""
    name, layout = f"@units.{int(unit < 0)}", Lanes(1, element)
    number, zero = layout.constant(unit), layout.constant(0.0)
    entries = (f"{element} {number if i == j else zero}" for i in range(n) for j in range(m))
    module.declare(f"{name} = private constant [{n * m} x {element}] [{', '.join(entries)}], align 64")
    return name


def _write_body(module: Module, name: str, f: Function, m: int, layout: Lanes, target: Target) -> None:
    """`void name(ptr table, ptr column, ptr result)` for as many columns as there are lanes, of rows of m numbers.

    A number of the table is loaded where it is used, each time: as an operand it costs nothing, in a register it would
    take the place of another.
    """
    g, element = f.graph, layout.dtype
    w = Writer(module, g, layout, "", target.arithmetic)
    size = f.inputs[0].size
    table = {node: k for k, node in enumerate(g.inputs[:size])}
    column = {node: k for k, node in enumerate(g.inputs[size:])}
    rows: dict[int, list[int]] = {}
    for k, node in enumerate(f.results):
        rows.setdefault(node, []).append(k)

    def fetch(node: int) -> None:
        if node in table:
            w.names[node] = w.in_all_lanes(element, _load(w, "table", table[node], element, element))
        elif node in column and node not in w.names:
            w.names[node] = _load(w, "column", column[node] * m, layout.real, element)

    for node in g.live(f.results):
        if g.op[node] != Op.INPUT:
            for a in g.args[node]:
                fetch(a)
            w.node(node)
        for k in rows.get(node, ()):
            fetch(node)
            place = w.fresh("p")
            w.write(f"{place} = getelementptr {element}, ptr %result, i64 {k * m}")
            w.write(f"store {layout.real} {w.names[node]}, ptr {place}, align {BYTES[element]}")
    arguments = "ptr noalias %table, ptr noalias %column, ptr noalias %result"
    head = f"define internal void @{name}({arguments}) noinline nounwind #0 {{"
    module.definitions[name] = "\n".join([head, "entry:", *w.lines, "  ret void", "}", ""])


def _load(w: Writer, array: str, index: int, kind: str, element: DType) -> str:
    place, value = w.fresh("p"), w.fresh("x")
    w.write(f"{place} = getelementptr {element}, ptr %{array}, i64 {index}")
    w.write(f"{value} = load {kind}, ptr {place}, align {BYTES[element]}")
    return value
