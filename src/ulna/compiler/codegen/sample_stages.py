"""Writes a function in its form of stages for as many samples as there are lanes: one in each lane.

Where one sample has a number, memory holds a register with that number of every sample. Straight-line code is that of
one sample; columns, and the entries of matrices, are computed one after the other by loops. So the code stays short,
no lane is idle, and only entries that are not zero are computed. Inputs are transposed first, results last.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes, local_array
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.row_table import write_rows
from ulna.compiler.codegen.rows import load
from ulna.compiler.codegen.sample_columns import SampleColumns, Stored
from ulna.compiler.codegen.sample_loops import ColumnReader, Source, begin_loop, end_loop, get, item, put
from ulna.compiler.codegen.scheduling import Store, scratch_places
from ulna.compiler.codegen.stages import array_places, parts_without_inputs, rounded
from ulna.compiler.codegen.straight_line import define, write_steps
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.columns import ColumnForm, row_places
from ulna.compiler.forms.packed import PackedForm
from ulna.compiler.forms.scans import Scan
from ulna.compiler.forms.stages import (
    AnyStage,
    Factors,
    Pairs,
    Products,
    Stage,
    StagedForm,
    Sweep,
)
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ports import SecondForm

_MAX_MEMORY = (
    500_000  # of all arrays, which lie on the stack; with more, one sample after the other is faster [byte]
)


def suits_sample_stages(form: SecondForm, target: Target, element: DType) -> bool:
    """Whether a form is to be computed with a sample in each lane.

    Args:
        form: The form.
        target: The processor.
        element: Type of the array elements, "double" or "float".

    Returns:
        Whether it has stages without sweeps, products and scans, with tables of equally many columns where all rows are
        computed alike, whose arrays are not too large for the stack and the second cache, and outputs in one part.
    """
    form = form.whole if isinstance(form, PackedForm) else form
    head = form.head if isinstance(form, ColumnForm) else form
    if not isinstance(head, StagedForm) or head.parts:
        return False
    if any(isinstance(x, Sweep | Products | Scan) or _changes_width(x, head) for x in head.stages):
        return False
    writer = _SampleStagesWriter(Module(), form, head, target, element)
    return writer.size * BYTES[element] * writer.layout.lanes <= _MAX_MEMORY


def _changes_width(stage: AnyStage, form: StagedForm) -> bool:
    """Whether the rows that a stage computes have other columns than those of most tables."""
    if not isinstance(stage, Stage) or stage.kind != "rows":
        return False
    return any(port.size != form.columns for port in (*stage.body.inputs, *stage.body.outputs))


def write_sample_stages(module: Module, form: SecondForm, target: Target, element: DType) -> None:
    """`void block(ptr in, i64 stride, ..., ptr out, i64 stride, ...)`: lane j has the rows j * stride [byte].

    Args:
        module: Where the definitions go.
        form: A form that suits.
        target: The processor.
        element: Type of the array elements, "double" or "float".
    """
    places = form.places if isinstance(form, PackedForm) else (None,) * len(form.outputs)
    form = form.whole if isinstance(form, PackedForm) else form
    head = form.head if isinstance(form, ColumnForm) else form
    assert isinstance(head, StagedForm)
    _SampleStagesWriter(module, form, head, target, element).write(places)


class _SampleStagesWriter:
    """The state of writing a form: the calls of its stages so far.

    Attributes:
        size: How many registers all arrays hold.
        zero: The place of one that holds zeros.
    """

    def __init__(
        self, module: Module, form: SecondForm, head: StagedForm, target: Target, element: DType
    ) -> None:
        self.whole, self.form, self.module, self.target = form, head, module, target
        self.layout = Lanes(target.lanes(element), element)
        self.shapes = {f"i{k}": port.shape for k, port in enumerate(head.inputs)}
        self.shapes |= {**head.arrays, **{f"o{k}": port.shape for k, port in enumerate(head.outputs)}}
        self.entries: dict[str, dict[int, int]] = {}
        for stage in head.stages:
            if isinstance(stage, Pairs):
                self.entries |= {name: self._entries(name, stage) for name in stage.writes}
        self.places, self.zero = array_places(head, {name: self._size(name) for name in self.shapes})
        self.solved = SampleColumns(form, target, self.layout) if isinstance(form, ColumnForm) else None
        self.size = self.zero + 1 + (self.solved.size if self.solved is not None else 0)
        zero = f"  store {self.layout.real} zeroinitializer, ptr %zero"
        at = f"  %zero = getelementptr {self.layout.real}, ptr %arrays, i64 {self.zero}"
        self.calls = [at, zero]
        self._count = 0

    def write(self, stored: Stored) -> None:
        """All stages, and the function that calls them.

        Args:
            stored: For each output which of its entries are written, and None for all.
        """
        element = self.layout.dtype
        for key, rows in self.form.constants.items():
            one = Lanes(1, element)
            numbers = [f"{element} {one.constant(rounded(x, element))}" for row in rows for x in row]
            text = f"[{len(numbers)} x {element}] [{', '.join(numbers)}]"
            self.module.declare(f"@samples.{key} = private constant {text}, align 64")
        self._read_inputs()
        for number, stage in enumerate(self.form.stages):
            name = f"samples.{number}"
            if isinstance(stage, Factors):
                self._factors(name, stage)
            elif isinstance(stage, Pairs):
                self._pairs(name, stage)
            elif isinstance(stage, Sweep | Products | Scan):
                raise AssertionError(
                    "stages with sweeps, products or scans are not written for samples in lanes"
                )
            elif stage.kind == "lanes":
                self._columns(name, stage)
            else:
                self._straight(name, stage)
        if self.solved is not None:
            heads = [self._address(f"o{k}") for k in range(len(self.form.outputs))]
            self.calls += self.solved.write(self.module, heads, self._at(self.zero + 1), stored)
        else:
            self._write_outputs(stored)
        memory = local_array("arrays", self.layout.real, self.size, self.target.stack_space)
        define(self.module, "block", self._ports(), "noinline nounwind #0", [*memory, *self.calls])

    def _ports(self) -> list[str]:
        names = [f"i{k}" for k in range(len(self.whole.inputs))]
        names += [f"o{k}" for k in range(len(self.whole.outputs))]
        return [f"ptr %{name}, i64 %{name}s" for name in names]

    def _entries(self, name: str, stage: Pairs) -> dict[int, int]:
        """Where in the array of a matrix its entries lie that are not zero."""
        n = self.form.columns
        pattern = [[x or y for x, y in zip(*stage.masks(i), strict=True)] for i in range(n)]
        numbers = [i * n + j for i, row in enumerate(pattern) for j, is_set in enumerate(row) if is_set]
        if self._has_columns(name):
            return {k: k % n * n + k // n for k in numbers}
        return {k: place for place, k in enumerate(numbers)}

    def _has_columns(self, name: str) -> bool:
        """Whether a matrix lies column after column, zeros included, since its columns are read."""
        return isinstance(self.whole, ColumnForm) and name.startswith("o")

    def _size(self, name: str) -> int:
        if name in self.entries and not self._has_columns(name):
            return len(self.entries[name])
        size = 1
        for length in self.shapes[name]:
            size *= length
        return size

    def _place(self, name: str, k: int) -> int:
        """The place of entry k of an array."""
        if name not in self.entries:
            return self.places[name] + k
        return self.places[name] + self.entries[name][k] if k in self.entries[name] else self.zero

    def _at(self, place: int) -> str:
        """An address, as an argument."""
        self._count += 1
        self.calls.append(f"  %a{self._count} = getelementptr {self.layout.real}, ptr %arrays, i64 {place}")
        return f"ptr %a{self._count}"

    def _address(self, name: str) -> str:
        """The address of an array, as an argument."""
        return f"ptr @samples.{name}" if name in self.form.constants else self._at(self.places[name])

    def _writer(self, graph: Graph | None = None) -> Writer:
        return Writer(self.module, graph or Graph(), self.layout, "", self.target.arithmetic)

    def _define(self, name: str, arguments: Sequence[str], w: Writer) -> None:
        define(self.module, name, arguments, "noinline nounwind #0", w.lines)

    def _read_inputs(self) -> None:
        w, arguments = self._writer(), [*self._ports(), "ptr %arrays"]
        for k, port in enumerate(self.form.inputs):
            for j, value in load(w, f"i{k}", port.size, range(port.size)):
                put(w, "arrays", self.places[f"i{k}"] + j, value)
        self._define("samples.read", arguments, w)
        self.calls.append(f"  call void @samples.read({', '.join(arguments)})")

    def _write_outputs(self, stored: Stored) -> None:
        w, arguments = self._writer(), [*self._ports(), "ptr %scratch"]
        for k, (port, chosen) in enumerate(zip(self.form.outputs, stored, strict=True)):
            entries = range(port.size) if chosen is None else chosen
            write_rows(w, f"o{k}", [self._place(f"o{k}", j) for j in entries], self.zero)
        self._define("samples.write", arguments, w)
        self.calls.append(f"  call void @samples.write({', '.join([*self._ports(), 'ptr %arrays'])})")

    def _straight(self, name: str, stage: Stage) -> None:
        """As for one sample, with lanes for numbers."""
        f, nodes = stage.body, iter(stage.body.graph.inputs)
        inputs: dict[int, int] = {}
        for key, port in zip(stage.reads, f.inputs, strict=True):
            inputs |= {next(nodes): self._place(key, k) for k in range(port.size)}

        def fetch(to: Writer, index: int) -> bool:
            if index in inputs:
                to.names[index] = get(to, "arrays", inputs[index])
            return index in inputs

        def store(to: Writer, step: Store) -> None:
            for k, node in enumerate(step.values, step.start):
                put(to, "arrays", self._place(stage.writes[step.port], k), to.names[node])

        pieces = parts_without_inputs(f, 1)
        slots = scratch_places(f.graph, pieces)
        scratch = f"{name}.scratch"
        size = max(slots.values(), default=0) + 1
        self.calls += local_array(scratch, self.layout.real, size, self.target.stack_space)
        for number, steps in enumerate(pieces):
            w = self._writer(f.graph)
            write_steps(w, steps, slots, fetch, store)
            self._define(f"{name}.{number}", ["ptr %arrays", "ptr noalias %scratch"], w)
        for row in range(self.shapes[stage.writes[0]][0] if stage.kind == "rows" else 1):
            given = f"{self._at(row * self.form.columns)}, ptr %{scratch}"
            self.calls += [f"  call void @{name}.{number}({given})" for number in range(len(pieces))]

    def _source(self, pointer: str, key: str, is_whole: bool = False) -> Source:
        if key in self.form.constants:
            return Source(pointer, self.form.constants[key].shape[1], True)
        return Source(pointer, 1 if is_whole or self._is_shared(key) else self.shapes[key][1])

    def _is_shared(self, key: str) -> bool:
        """Whether an array is a vector, whose numbers are the same for all columns."""
        return key not in self.form.constants and len(self.shapes[key]) == 1

    def _go_to_column(self, w: Writer, pointer: str, key: str, column: str, is_whole: bool = False) -> None:
        """Names the address of a column of an array."""
        kind = self.layout.dtype if key in self.form.constants else self.layout.real
        number = "0" if is_whole or self._is_shared(key) else column
        w.let(f"{pointer}.k", f"getelementptr {kind}, ptr %{pointer}, i64 {number}")

    def _columns(self, name: str, stage: Stage) -> None:
        """A loop over columns."""
        f, keys, count = stage.body, [*stage.reads, *stage.writes], stage.columns
        pointers = [*(f"i{k}" for k in range(len(stage.reads))), *(f"o{k}" for k in range(len(stage.writes)))]
        sources = [
            self._source(f"{x}.k", key, key in stage.whole)
            for x, key in zip(pointers, stage.reads, strict=False)
        ]
        w = ColumnReader(self.module, f, self.layout, self.target, sources)
        begin_loop(w, "column")
        for pointer, key in zip(pointers, keys, strict=True):
            self._go_to_column(w, pointer, key, "%column", key in stage.whole)
        places = [
            (f"o{number}.k", row * count) for number, port in enumerate(f.outputs) for row in range(port.size)
        ]
        for value, number in w.results(f):
            put(w, *places[number], value)
        end_loop(w, "column", str(count))
        self._define(name, [f"ptr noalias %{pointer}" for pointer in pointers], w)
        self.calls.append(f"  call void @{name}({', '.join([*map(self._address, keys)])})")

    def _pairs(self, name: str, stage: Pairs) -> None:
        """Entries below, then above, row by row; rows that are copied; what is added to diagonals."""
        n = self.form.columns
        for key in stage.writes:
            if self.solved is not None and self._has_columns(key):
                unset = self.solved.cleared(int(key[1:]) - 1)
                self._move(f"{name}.{key}.zeros", [(self.zero, self.places[key] + k) for k in unset])
        for k, tag in enumerate(("below", "above")):
            rows = [(i, stage.masks(i)[k]) for i in range(n) if i not in stage.copies]
            chosen = [(i, j) for i, mask in rows for j in range(n) if mask[j]]
            if chosen:
                self._write_pair(f"{name}.{tag}", stage, k)
                self._call_pairs(f"{name}.{tag}", stage, k, chosen)
        sources = stage.other[0][-len(stage.writes) :]
        self._move(
            f"{name}.copies",
            [
                (self.places[source] + row * n + j, self._place(key, i * n + j))
                for i, row in stage.copies.items()
                for key, source in zip(stage.writes, sources, strict=True)
                for j in range(n)
            ],
        )
        self._add_diagonals(f"{name}.diagonals", stage)

    def _add_diagonals(self, name: str, stage: Pairs) -> None:
        w, n = self._writer(), self.form.columns
        for key, diagonal in zip(stage.writes, stage.diagonals, strict=True):
            for i, number in enumerate(diagonal or ()):
                if number != 0.0:
                    place = self._place(key, i * n + i)
                    literal = self.layout.constant(rounded(number, self.layout.dtype))
                    put(w, "arrays", place, w.binary("fadd", get(w, "arrays", place), literal))
        if w.lines:
            self._define(name, ["ptr %arrays"], w)
            self.calls.append(f"  call void @{name}(ptr %arrays)")

    def _move(self, name: str, moves: Sequence[tuple[int, int]]) -> None:
        """Copies registers from place to place, by a loop over a table."""
        if not moves:
            return
        if "samples.move" not in self.module.definitions:
            w = self._writer()
            begin_loop(w, "at")
            row = w.let("row", "getelementptr [2 x i32], ptr %table, i64 %at")
            source, place = item(w, "source", row, 0), item(w, "place", row, 1)
            put(w, "arrays", place, get(w, "arrays", source))
            end_loop(w, "at", "%count")
            self._define("samples.move", ["ptr %arrays", "ptr noalias %table", "i64 %count"], w)
        table = self._table(name, [x for move in moves for x in move])
        self.calls.append(f"  call void @samples.move(ptr %arrays, {table}, i64 {len(moves)})")

    def _table(self, name: str, numbers: Sequence[int]) -> str:
        """A constant table of integers, as an argument."""
        text = ", ".join(f"i32 {x}" for x in numbers)
        self.module.declare(f"@{name} = private constant [{len(numbers)} x i32] [{text}]")
        return f"ptr @{name}"

    def _call_pairs(self, name: str, stage: Pairs, k: int, chosen: Sequence[tuple[int, int]]) -> None:
        """Calls the loops over rows, each with its range of entries, and over entries: a column and a place."""
        rows: list[int] = []
        entries: list[int] = []
        for i, group in groupby(chosen, key=lambda pair: pair[0]):
            columns = [j for _, j in group]
            rows += [i, len(entries) // 2, len(entries) // 2 + len(columns)]
            for j in columns:
                entries += [j, self.entries[stage.writes[0]][i * self.form.columns + j]]
        given = [*map(self._address, (*stage.own[k], *stage.other[k], *stage.writes))]
        given += [self._table(f"{name}.rows", rows), self._table(f"{name}.entries", entries)]
        self.calls.append(f"  call void @{name}({', '.join(given)}, i64 {len(rows) // 3})")

    def _write_pair(self, name: str, stage: Pairs, k: int) -> None:
        """A loop over rows, and one over the columns in which a row has entries."""
        f, own, other = (stage.below, stage.above)[k], stage.own[k], stage.other[k]
        inputs = [(f"i{j}", key) for j, key in enumerate((*own, *other))]
        outputs = [f"o{j}" for j in range(len(stage.writes))]
        sources = [self._source(f"{x}.k", key) for x, key in inputs]
        w = ColumnReader(self.module, f, self.layout, self.target, sources)
        begin_loop(w, "row")
        row = w.let("range", "getelementptr [3 x i32], ptr %rows, i64 %row")
        own_column, first, last = (item(w, word, row, j) for j, word in enumerate(("i", "first", "last")))
        for pointer, key in inputs[: len(own)]:
            self._go_to_column(w, pointer, key, own_column)
        w.fetch_all(sources[: len(own)])
        w.jump("entry.at")
        w.open_block("entry.at")
        w.let("at", f"phi i64 [ {first}, %row.begin ], [ %at.next, %entry.at ]")
        entry = w.let("both", "getelementptr [2 x i32], ptr %entries, i64 %at")
        column, place = item(w, "j", entry, 0), item(w, "place", entry, 1)
        for pointer, key in inputs[len(own) :]:
            self._go_to_column(w, pointer, key, column)
        for value, number in w.results(f):
            put(w, outputs[number], place, value)
        w.let("at.next", "add i64 %at, 1")
        w.branch(w.let("at.more", f"icmp ult i64 %at.next, {last}"), "entry.at", "row.last")
        w.open_block("row.last")
        end_loop(w, "row", "%count")
        pointers = [*(x for x, _ in inputs), *outputs, "rows", "entries"]
        self._define(name, [*(f"ptr noalias %{x}" for x in pointers), "i64 %count"], w)

    def _factors(self, name: str, stage: Factors) -> None:
        """The factors of a matrix, row by row from the last; see `row_factors.py`."""
        starts, size = row_places(stage.paths)
        w = self._writer()
        for word, key in (("table", stage.writes), ("rows", stage.reads)):
            w.let(word, f"getelementptr {self.layout.real}, ptr %arrays, i64 {self.places[key]}")
        for i in reversed(range(len(stage.paths))):
            length, start = len(stage.paths[i]), starts[i]
            row = [get(w, "rows", start + c) for c in range(length + 1)]
            below = [starts[k] for k, path in enumerate(stage.paths) if i in path]
            if below:
                row = self._less_descendants(w, f"{name}.below{i}", i, row, below[::-1])
            inverse = w.binary("fdiv", self.layout.constant(1.0), row[-1])
            put(w, "table", size + i, inverse)
            for c, x in enumerate(row):
                put(w, "rows", start + c, x)
                put(w, "table", start + c, w.binary("fmul", x, inverse))
        self._define(name, ["ptr %arrays"], w)
        self.calls.append(f"  call void @{name}(ptr %arrays)")

    def _less_descendants(
        self, w: Writer, table: str, i: int, row: Sequence[str], below: Sequence[int]
    ) -> list[str]:
        """A row less multiples of the rows that begin at certain places, by a loop over these."""
        places, before, real = self._table(table, below), w.current_block, self.layout.real
        name = f"row{i}"
        w.jump(f"{name}.begin")
        w.open_block(f"{name}.begin")
        w.let(name, f"phi i64 [ 0, %{before} ], [ %{name}.next, %{name}.end ]")
        old = [
            w.let(f"{name}.old{c}", f"phi {real} [ {x}, %{before} ], [ %{name}.new{c}, %{name}.end ]")
            for c, x in enumerate(row)
        ]
        place = item(w, f"{name}.place", places.removeprefix("ptr "), f"%{name}")
        w.let(f"{name}.rows", f"getelementptr {real}, ptr %rows, i64 {place}")
        w.let(f"{name}.table", f"getelementptr {real}, ptr %table, i64 {place}")
        factor = get(w, f"{name}.rows", len(row) - 1)
        for c, x in enumerate(old):
            product = w.binary("fmul", factor, get(w, f"{name}.table", c))
            w.let(f"{name}.new{c}", f"fsub{w.contract} {real} {x}, {product}")
        end_loop(w, name, str(len(below)))
        return [f"%{name}.new{c}" for c in range(len(row))]
