"""Writes the body of a form of columns for as many samples as there are lanes, column by column.

Neighbouring columns whose entries are zero in the same rows share code, in which these rows are left out. The matrices
that columns are taken from lie column after column; one row of zeros around one number is all columns of a unit matrix.
The columns of one output at a time go to a matrix of registers, which is then transposed and written row by row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby

from ulna.compiler.codegen.columns import without_rows
from ulna.compiler.codegen.ir_text import BYTES, Lanes
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.row_table import write_rows
from ulna.compiler.codegen.rows import rows_of, store, transposed
from ulna.compiler.codegen.sample_loops import ColumnReader, Source, begin_loop, end_loop, get, put
from ulna.compiler.codegen.scheduling import chunks
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.columns import ColumnForm, zeros_of
from ulna.compiler.language.function import Function
from ulna.compiler.language.graph import Graph

_FEWEST = 3
"""Columns that have code of their own."""

Stored = Sequence[Sequence[int] | None]
"""For each output the places of the entries that are written; None for all."""
Groups = Sequence[tuple[range, frozenset[int]]]
"""Neighbouring columns, and the rows that are zero in all of them."""


def column_groups(zeros: Sequence[Sequence[bool]]) -> Groups:
    """Neighbouring columns that are zero in the same rows.

    Args:
        zeros: For each column and row whether the entry is zero whatever the inputs.

    Returns:
        The groups. Where fewer than a handful of neighbours are alike, they are taken with those before them.
    """
    sets = [frozenset(i for i, is_zero in enumerate(column) if is_zero) for column in zeros]
    groups: list[tuple[range, frozenset[int]]] = []
    for rows, numbers in groupby(range(len(sets)), key=sets.__getitem__):
        columns, before = list(numbers), groups[-1:]
        if before and min(len(columns), len(before[0][0])) < _FEWEST:
            (others, zero_rows) = groups.pop()
            columns, rows_of_both = [*others, *columns], rows & zero_rows
        else:
            rows_of_both = rows
        groups.append((range(columns[0], columns[-1] + 1), rows_of_both))
    return groups


class SampleColumns:
    """The columns of a form.

    Args:
        form: The form.
        target: The processor.
        layout: The lanes.

    Attributes:
        groups: Those of each output whose matrix is one of the head's; None for the others.
        size: How many registers it needs beside the head's outputs.
    """

    def __init__(self, form: ColumnForm, target: Target, layout: Lanes) -> None:
        self.form, self.target, self.layout = form, target, layout
        self.rows, self.columns = form.shape
        self._length = form.body.inputs[1].size
        self._zeros = zeros_of(form)
        self.groups: list[Groups | None] = [
            column_groups(zeros) if unit is None else None
            for unit, zeros in zip(form.units, self._zeros, strict=True)
        ]
        self.size = self.rows * self.columns + 2 * self._length

    def cleared(self, matrix: int) -> list[int]:
        """The entries of one of the head's matrices that are read, and are zero whatever the inputs.

        Args:
            matrix: Its number among the head's outputs that are matrices.

        Returns:
            Their places in the matrix, whose columns lie one after the other.
        """
        output = [k for k, groups in enumerate(self.groups) if groups is not None][matrix]
        groups, zeros = self.groups[output] or (), self._zeros[output]
        return [
            j * self._length + i
            for columns, rows in groups
            for j in columns
            for i in range(self._length)
            if zeros[j][i] and i not in rows
        ]

    def write(self, module: Module, heads: Sequence[str], memory: str, stored: Stored) -> list[str]:
        """Writes all functions.

        Args:
            module: Where the definitions go.
            heads: The addresses of the head's outputs, whose numbers are registers, as arguments.
            memory: The address of as many registers as this needs, as an argument.
            stored: Which entries of each output are written.

        Returns:
            The calls that compute and write all outputs, for `block`.
        """
        bodies: dict[frozenset[int], str] = {}
        for groups in self.groups:
            for _, rows in groups or ():
                if rows not in bodies:
                    bodies[rows] = name = f"samples.column{len(bodies)}"
                    self._write_body(module, name, without_rows(self.form.body, rows))
        if not bodies:
            bodies[frozenset()] = "samples.column0"
            self._write_body(module, "samples.column0", self.form.body)
        if None in stored:
            self._write_put(module)
        matrices, real = iter(heads[1:]), self.layout.real
        calls = [f"  %unit = getelementptr {real}, {memory}, i64 {self.rows * self.columns}"]
        for k, unit in enumerate(self.form.units):
            step = self._length if unit is None else -1
            source = next(matrices) if unit is None else "ptr %unit"
            if unit is not None:
                calls.append(self._fill_unit(module, unit))
            for number, (columns, name) in enumerate(self._parts(k, bodies)):
                start = columns.start * step + (0 if unit is None else self._length)
                here, there = f"%column{k}.{number}", f"%result{k}.{number}"
                calls.append(f"  {here} = getelementptr {real}, {source}, i64 {start}")
                calls.append(f"  {there} = getelementptr {real}, {memory}, i64 {columns.start}")
                given = f"{heads[0]}, ptr {here}, ptr {there}, i64 {step}, i64 {len(columns)}"
                calls.append(f"  call void @{name}({given})")
            calls.append(f"  call void @{self._put(module, k, stored[k])}(ptr %o{k}, i64 %o{k}s, {memory})")
        return calls

    def _parts(self, k: int, bodies: Mapping[frozenset[int], str]) -> list[tuple[range, str]]:
        """Which code computes which columns of an output."""
        groups = self.groups[k]
        if groups is not None:
            return [(columns, bodies[rows]) for columns, rows in groups]

        def fewest(j: int) -> str:
            fits = [rows for rows in bodies if all(self._zeros[k][j][i] for i in rows)]
            return bodies[max(fits, key=len)]

        found: list[tuple[range, str]] = []
        for name, numbers in groupby(range(self.columns), key=fewest):
            columns = list(numbers)
            found.append((range(columns[0], columns[-1] + 1), name))
        return found

    def _write_body(self, module: Module, name: str, f: Function) -> None:
        """`void name(ptr table, ptr column, ptr result, i64 step, i64 count)` for columns that lie `step` apart."""
        sources = [Source("table", 1), Source("column.k", 1)]
        w = ColumnReader(module, f, self.layout, self.target, sources)
        begin_loop(w, "k")
        place = w.let("place", "mul i64 %k, %step")
        w.let("column.k", f"getelementptr {self.layout.real}, ptr %column, i64 {place}")
        w.let("result.k", f"getelementptr {self.layout.real}, ptr %result, i64 %k")
        for value, row in w.results(f):
            put(w, "result.k", row * self.columns, value)
        end_loop(w, "k", "%count")
        pointers = [f"ptr noalias %{x}" for x in ("table", "column", "result")]
        arguments = [*pointers, "i64 %step", "i64 %count"]
        define(module, name, arguments, "noinline nounwind #0", w.lines)

    def _fill_unit(self, module: Module, unit: float) -> str:
        """The call that writes a number between zeros."""
        if "samples.unit" not in module.definitions:
            w = self._writer(module)
            begin_loop(w, "at")
            is_number = w.let("is_number", f"icmp eq i64 %at, {self._length}")
            zero = Lanes(1, self.layout.dtype).constant(0.0)
            kind = self.layout.dtype
            chosen = w.let("chosen", f"select i1 {is_number}, {kind} %number, {kind} {zero}")
            put(w, "row", "%at", w.in_all_lanes(kind, chosen))
            end_loop(w, "at", str(2 * self._length))
            arguments = [f"{kind} %number", "ptr noalias %row"]
            define(module, "samples.unit", arguments, "noinline nounwind #0", w.lines)
        number = Lanes(1, self.layout.dtype).constant(unit)
        return f"  call void @samples.unit({self.layout.dtype} {number}, ptr %unit)"

    def _put(self, module: Module, k: int, stored: Sequence[int] | None) -> str:
        """The name of the function that writes an output."""
        if stored is None:
            return "samples.put"
        w, name = self._writer(module), f"samples.put{k}"
        write_rows(w, f"o{k}", stored, None)
        arguments = [f"ptr %o{k}", f"i64 %o{k}s", "ptr noalias %scratch"]
        define(module, name, arguments, "noinline nounwind #0", w.lines)
        return name

    def _write_put(self, module: Module) -> None:
        """`void samples.put(ptr o, i64 os, ptr matrix)` writes an output."""
        w, layout = self._writer(module), self.layout
        size = self.rows * self.columns
        whole = size // layout.lanes * layout.lanes
        targets = rows_of(w, "o")
        begin_loop(w, "chunk")
        start = w.let("start", f"mul i64 %chunk, {layout.lanes}")
        w.let("matrix.k", f"getelementptr {layout.real}, ptr %matrix, i64 {start}")
        values = [get(w, "matrix.k", c) for c in range(layout.lanes)]
        for target, value in zip(targets, transposed(w, values), strict=True):
            pointer = w.fresh("p")
            w.write(f"{pointer} = getelementptr {layout.dtype}, ptr {target}, i64 {start}")
            w.write(f"store {layout.real} {value}, ptr {pointer}, align {BYTES[layout.dtype]}")
        end_loop(w, "chunk", str(whole // layout.lanes))
        for first, width in chunks(layout.lanes, size):
            if first >= whole:
                store(w, "o", first, [get(w, "matrix", first + c) for c in range(width)])
        arguments = ["ptr %o", "i64 %os", "ptr noalias %matrix"]
        define(module, "samples.put", arguments, "noinline nounwind #0", w.lines)

    def _writer(self, module: Module) -> Writer:
        return Writer(module, Graph(), self.layout, "", self.target.arithmetic)
