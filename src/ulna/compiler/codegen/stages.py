"""Writes a function in its form of stages: see `ulna.compiler.forms.stages`.

A table has a row for each number of a column, so that the same number of as many columns as there are lanes is one
load. Rows are padded to a multiple of the lanes with zeros, so that no lane computes with what is left in memory.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes, local_array
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.mirror import write_mirror
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.products import write_products
from ulna.compiler.codegen.row_factors import write_row_factors
from ulna.compiler.codegen.rows import store
from ulna.compiler.codegen.scans import write_scan
from ulna.compiler.codegen.scheduling import Step, Store, parts, scratch_places
from ulna.compiler.codegen.straight_line import define, write_steps
from ulna.compiler.codegen.sweeps import SweepContext, tables_of, write_sweep
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.scans import Scan
from ulna.compiler.forms.stages import Factors, Pairs, Products, Stage, StagedForm, Sweep, names_of
from ulna.compiler.language.function import Function
from ulna.compiler.language.ops import Op


def write_stages(module: Module, name: str, form: StagedForm, target: Target, element: DType) -> None:
    """`void name(ptr in, ..., ptr out, ...)`.

    Args:
        module: Where the definitions go.
        name: The name of the function.
        form: The form.
        target: The processor.
        element: Type of the array elements, "double" or "float".
    """
    _StagesWriter(module, name, form, target, element).write()


def array_places(form: StagedForm, sizes: Mapping[str, int]) -> tuple[dict[str, int], int]:
    """Where the arrays of a form lie; what is not read any more gives its place to others.

    Args:
        form: The form.
        sizes: The size of each array; the form's outputs, where they are among them, keep their places to the end.

    Returns:
        The place of each array, and the size of all.
    """
    first = {f"i{k}": -1 for k in range(len(form.inputs))}
    last: dict[str, int] = {}
    for number, stage in enumerate(form.stages):
        for key in names_of(stage):
            first.setdefault(key, number)
            last[key] = number
    last |= {f"o{k}": len(form.stages) for k in range(len(form.outputs))}
    places: dict[str, int] = {}
    for key, size in sorted(sizes.items(), key=lambda item: first.get(item[0], 0)):
        taken = sorted((places[k], sizes[k]) for k in places if last.get(k, -1) >= first.get(key, 0))
        place = 0
        for start, length in taken:
            if place + size <= start:
                break
            place = max(place, start + length)
        places[key] = place
    return places, max((places[k] + sizes[k] for k in places), default=0)


def parts_without_inputs(f: Function, pack: int) -> list[list[Step]]:
    """The steps of the parts of straight-line code that loads inputs where they are first used.

    Args:
        f: The function.
        pack: How many sines are taken at once.

    Returns:
        The steps of each part.
    """
    g = f.graph
    return [
        [step for step in steps if not isinstance(step, int) or g.op[step] != Op.INPUT]
        for steps in parts(f, 1, pack)
    ]


class _StagesWriter:
    """The state of writing a form: the calls of its stages so far."""

    def __init__(self, module: Module, name: str, form: StagedForm, target: Target, element: DType) -> None:
        self.module, self.name, self.form, self.target = module, name, form, target
        self.layout = Lanes(target.lanes(element), element)
        self.shapes = {f"i{k}": port.shape for k, port in enumerate(form.inputs)}
        self.shapes |= {f"o{k}": port.shape for k, port in enumerate(form.outputs)}
        self.shapes |= {**form.arrays, **{key: part.shape for key, part in form.parts.items()}}
        self.shapes |= {key: rows.shape for key, rows in form.constants.items()}
        self.calls: list[str] = []
        self._count = 0

    def write(self) -> None:
        """All stages, and the function that calls them."""
        form, element = self.form, self.layout.dtype
        ports = [*(f"i{k}" for k in range(len(form.inputs))), *(f"o{k}" for k in range(len(form.outputs)))]
        places, size = self._memory()
        lines = [f"  %arrays = alloca [{max(size, 1)} x {element}], align 64"]
        for key, place in places.items():
            lines.append(f"  %{key} = getelementptr {element}, ptr %arrays, i64 {place}")
        for key, part in form.parts.items():
            lines.append(f"  %{key} = getelementptr {element}, ptr %{part.output}, i64 {part.start}")
        for key, rows in form.constants.items():
            self._write_constant(key, rows)
        for number, stage in enumerate(form.stages):
            inner = f"{self.name}.{number}"
            if isinstance(stage, Factors):
                write_row_factors(self.module, inner, stage.paths, self.layout, self.target)
                self.calls.append(f"  call void @{inner}(ptr %{stage.reads}, ptr %{stage.writes})")
            elif isinstance(stage, Pairs):
                self._pairs(inner, stage)
            elif isinstance(stage, Products):
                write_products(self.module, inner, stage, self.layout, self.target, self.row_length)
                given = [self._at(key, 0) for key in (*stage.own, *stage.other, stage.write)]
                self.calls.append(f"  call void @{inner}({', '.join(given)})")
            elif isinstance(stage, Sweep):
                self._sweep(inner, stage)
            elif isinstance(stage, Scan):
                self._scan(inner, stage)
            elif stage.kind == "lanes":
                self._lanes(inner, stage)
            else:
                self._straight(inner, stage)
        arguments = [f"ptr %{port}" for port in ports]
        define(self.module, self.name, arguments, "noinline nounwind #0", [*lines, *self.calls])

    def _memory(self) -> tuple[dict[str, int], int]:
        form, lanes = self.form, self.layout.lanes
        sizes: dict[str, int] = {}
        for key, shape in form.arrays.items():
            row = self._padded(shape[1]) if key in form.tables else shape[1] if shape[1:] else 1
            sizes[key] = -(-shape[0] * row // lanes) * lanes
        return array_places(form, sizes)

    def _write_constant(self, key: str, rows: Sequence[Sequence[float]]) -> None:
        one, element = Lanes(1, self.layout.dtype), self.layout.dtype
        padded = ([*map(float, row), *[0.0] * (self._padded(len(row)) - len(row))] for row in rows)
        numbers = [f"{element} {one.constant(rounded(x, element))}" for row in padded for x in row]
        text = f"[{len(numbers)} x {element}] [{', '.join(numbers)}]"
        self.module.declare(f"@{self.name}.{key} = private constant {text}, align 64")

    def _array(self, key: str) -> str:
        return f"@{self.name}.{key}" if key in self.form.constants else f"%{key}"

    def _padded(self, columns: int) -> int:
        """A number of columns, rounded up to whole registers."""
        return -(-columns // self.layout.lanes) * self.layout.lanes

    def is_shared(self, key: str) -> bool:
        """Whether an array is a vector, whose numbers are the same for all columns."""
        return len(self.shapes[key]) == 1

    def row_length(self, key: str) -> int:
        """How far the rows of an array lie apart."""
        if self.is_shared(key):
            return 1
        if key in self.form.parts:
            return self.form.parts[key].row_length
        is_table = key in self.form.tables or key in self.form.constants
        return self._padded(self.shapes[key][1]) if is_table else self.form.columns

    def _at(self, key: str, offset: int) -> str:
        """An address in an array, as an argument."""
        if not offset:
            return f"ptr {self._array(key)}"
        self._count += 1
        name, element = f"%a{self._count}", self.layout.dtype
        self.calls.append(f"  {name} = getelementptr {element}, ptr {self._array(key)}, i64 {offset}")
        return f"ptr {name}"

    def place(self, key: str, shape: Sequence[int], k: int) -> int:
        """Where an entry of an array lies.

        Args:
            key: The array.
            shape: Its shape.
            k: The number of the entry.

        Returns:
            The place.
        """
        if len(shape) < 2 or (key not in self.form.tables and key not in self.form.parts):
            return k
        row, column = divmod(k, shape[1])
        return row * self.row_length(key) + column

    def _straight(self, name: str, stage: Stage) -> None:
        f, element = stage.body, self.layout.dtype
        inputs: dict[int, tuple[str, int]] = {}
        nodes = iter(f.graph.inputs)
        for number, (key, port) in enumerate(zip(stage.reads, f.inputs, strict=True)):
            for k in range(port.size):
                inputs[next(nodes)] = f"i{number}", self.place(key, port.shape, k)
        rows = range(self.shapes[stage.writes[0]][0] if stage.kind == "rows" else 1)
        zeros = self._clear_written(stage, rows)

        def fetch(to: Writer, index: int) -> bool:
            if index in inputs:
                array, offset = inputs[index]
                place = to.fresh("p")
                to.write(f"{place} = getelementptr {element}, ptr %{array}, i64 {offset}")
                to.assign(index, f"load {element}, ptr {place}")
            return index in inputs

        def put(to: Writer, step: Store) -> None:
            key, port = stage.writes[step.port], step.port
            if key not in self.form.tables or step.start not in zeros[port]:
                place = self.place(key, f.outputs[port].shape, step.start)
                store(to, f"o{port}", place, [to.names[v] for v in step.values])

        pieces = parts_without_inputs(f, self.target.packed_sines)
        slots = scratch_places(f.graph, pieces)
        names = [*(f"i{k}" for k in range(len(stage.reads))), *(f"o{k}" for k in range(len(stage.writes)))]
        apart = "" if set(stage.reads) & set(stage.writes) else " noalias"
        arguments = [*(f"ptr{apart} %{x}" for x in names), "ptr noalias %scratch"]
        keys, scratch = (*stage.reads, *stage.writes), f"{name}.scratch"
        size = max(slots.values(), default=0) + 1
        self.calls += local_array(scratch, element, size, self.target.stack_space)
        for number, steps in enumerate(pieces):
            w = Writer(self.module, f.graph, Lanes(1, element), "", self.target.arithmetic)
            write_steps(w, steps, slots, fetch, put)
            define(self.module, f"{name}.{number}", arguments, "noinline nounwind", w.lines)
        for row in rows:
            places = (self._at(key, row * self.row_length(key)) for key in keys)
            given = ", ".join([*places, f"ptr %{scratch}"])
            self.calls += [f"  call void @{name}.{number}({given})" for number in range(len(pieces))]

    def _clear_written(self, stage: Stage, rows: range) -> list[set[int]]:
        """Clears the tables that a stage writes and does not read; for each output the entries that are always zero."""
        zeros = _zero_entries(stage.body)
        for port, key in enumerate(stage.writes):
            if key in self.form.tables and key not in stage.reads:
                width = self.shapes[key][1]
                self._clear_table(key, {row * width + k for row in rows for k in zeros[port]})
        return zeros

    def _clear_table(self, key: str, zeros: set[int]) -> None:
        """Zeros in the padding of a table, and where entries are zero whatever the inputs, a register at a time."""
        rows, n = self.form.arrays[key]
        for row in range(rows):
            for start in range(0, self._padded(n), self.layout.lanes):
                end = start + self.layout.lanes
                if end > n or any(row * n + k in zeros for k in range(start, end)):
                    self._clear([key], row * self._padded(n) + start)

    def _lanes(self, name: str, stage: Stage) -> None:
        f = stage.body
        keys = [*stage.reads, *stage.writes]
        names = [*(f"i{k}" for k in range(len(stage.reads))), *(f"o{k}" for k in range(len(stage.writes)))]
        w = _ColumnWriter(self, f, stage.reads, whole=stage.whole)
        places = [
            (f"o{number}", row * self.row_length(key))
            for number, (key, port) in enumerate(zip(stage.writes, f.outputs, strict=True))
            for row in range(port.size)
        ]
        for value, number in w.results(f):
            w.store(value, *places[number])
        define(self.module, name, [f"ptr noalias %{x}" for x in names], "noinline nounwind #0", w.lines)
        for start in self._starts(stage.writes, stage.columns):
            given = [self._at(key, 0 if self.is_shared(key) or key in stage.whole else start) for key in keys]
            self.calls.append(f"  call void @{name}({', '.join(given)})")

    def _sweep(self, name: str, stage: Sweep) -> None:
        """Two registers of a matrix at once, where it has as many columns: they wait for each other's results less."""
        n, lanes = self.form.columns, 1
        if stage.matrix:
            lanes = self.layout.lanes * (2 if n >= 2 * self.layout.lanes else 1)
        layout = Lanes(lanes, self.layout.dtype)
        write_sweep(SweepContext(self.module, self.target, layout, n, self.row_length), name, stage)
        tables = [self._at(key, 0) for key in tables_of(stage).values()]
        for start in (*range(0, n - lanes, lanes), n - lanes) if stage.matrix else (0,):
            ends = [self._at(key, start) if key else "ptr null" for key in (stage.source, stage.matrix)]
            self.calls.append(f"  call void @{name}({', '.join([*tables, *ends, f'i64 {start}'])})")
        if stage.is_symmetric:
            write_mirror(self.module, f"{name}.mirror", self.layout, self.target, n)
            self.calls.append(f"  call void @{name}.mirror({self._at(stage.matrix, 0)})")

    def _scan(self, name: str, stage: Scan) -> None:
        for key in stage.tables:
            if key in self.form.tables:
                self._clear_table(key, set())
        write_scan(self.module, name, stage, self.layout, self.target, self.row_length)
        given = [self._at(key, first) for key, first in stage.vectors]
        given += [self._at(key, 0) for key in stage.writes]
        self.calls.append(f"  call void @{name}({', '.join(given)})")

    def _starts(self, writes: Sequence[str], n: int) -> list[int]:
        """The first of n columns of the registers; the last ones are computed twice where rows are not padded."""
        lanes = self.layout.lanes
        if all(key in self.form.tables for key in writes):
            return list(range(0, n, lanes))
        return [*range(0, n - lanes, lanes), n - lanes]

    def _pairs(self, name: str, stage: Pairs) -> None:
        """First the entries above, which write whole registers, then those below; rows that are copied at last."""
        n, lanes = self.form.columns, self.layout.lanes
        for tag in ("above", "below", "over"):
            self._write_pair(f"{name}.{tag}", stage, tag)
        rows = [i for i in range(n) if i not in stage.copies]
        for start in self._starts(stage.writes, n):
            entries: dict[str, list[tuple[int, int]]] = {"above": [], "below": [], "over": []}
            for i in rows:
                below, above = (
                    sum(1 << k for k, x in enumerate(mask[start : start + lanes]) if x)
                    for mask in stage.masks(i)
                )
                if not above and not below and not stage.is_half:
                    self._clear(stage.writes, i * n + start)
                if above:
                    entries["above"].append((i, above))
                if below:
                    entries["over" if above else "below"].append((i, below))
            for tag, places in entries.items():
                if places:
                    self._call_pairs(f"{name}.{tag}", stage, tag, start, places)
        for i, k in stage.copies.items():
            for key, source in zip(stage.writes, stage.other[0][-len(stage.writes) :], strict=True):
                for start in self._starts(stage.writes, n):
                    self._copy(key, i * n + start, source, k * self.row_length(source) + start)
        for key, diagonal in zip(stage.writes, stage.diagonals, strict=True):
            for i, number in enumerate(diagonal or ()):
                if number != 0.0:
                    self._add(key, i * n + i, number)

    def _call_pairs(
        self, name: str, stage: Pairs, tag: str, start: int, places: Sequence[tuple[int, int]]
    ) -> None:
        """Calls the loop over the rows that have entries in a register of columns."""
        k = int(tag == "above")
        numbers = [x for place in places for x in place]
        table = f"@{name}.{start}.rows"
        kind = f"[{len(numbers)} x i32]"
        self.module.declare(f"{table} = private constant {kind} [{', '.join(f'i32 {x}' for x in numbers)}]")
        given = [self._at(key, 0) for key in stage.own[k]]
        given += [self._at(key, start) for key in (*stage.other[k], *stage.writes)]
        self.calls.append(f"  call void @{name}({', '.join(given)}, ptr {table}, i64 {len(places)})")

    def _clear(self, keys: Sequence[str], offset: int) -> None:
        """Writes a register of zeros to some arrays."""
        for key in keys:
            place = self._at(key, offset)
            zero = f"store {self.layout.real} zeroinitializer, {place}"
            self.calls.append(f"  {zero}, align {BYTES[self.layout.dtype]}")

    def _copy(self, key: str, offset: int, source: str, place: int) -> None:
        """Copies a register of numbers."""
        real, align = self.layout.real, BYTES[self.layout.dtype]
        there, here = self._at(source, place), self._at(key, offset)
        self._count += 1
        self.calls += [
            f"  %c{self._count} = load {real}, {there}, align {align}",
            f"  store {real} %c{self._count}, {here}, align {align}",
        ]

    def _add(self, key: str, offset: int, number: float) -> None:
        """Adds a number to an entry of an array."""
        place, element = self._at(key, offset), self.layout.dtype
        x, y = f"%x{self._count}", f"%y{self._count}"
        literal = Lanes(1, element).constant(rounded(number, element))
        self.calls += [
            f"  {x} = load {element}, {place}",
            f"  {y} = fadd {element} {x}, {literal}",
            f"  store {element} {y}, {place}",
        ]

    def _write_pair(self, name: str, stage: Pairs, tag: str) -> None:
        """The loop that writes a register of columns of some rows of every matrix.

        Args:
            name: Its name.
            stage: The stage.
            tag: "above" and "below" write zeros where there is no entry; "over" leaves there what is.
        """
        n, align = self.form.columns, BYTES[self.layout.dtype]
        real, truth, lanes = self.layout.real, self.layout.truth, self.layout.lanes
        k = int(tag == "above")
        f, own = (stage.below, stage.above)[k], stage.own[k]
        w = _ColumnWriter(self, f, (*own, *stage.other[k]), len(own))
        w.fetch_lanes()
        outputs = [f"o{j}" for j in range(len(stage.writes))]
        w.jump("rows")
        w.open_block("rows")
        w.write("%at = phi i64 [ 0, %entry ], [ %next, %rows ]")
        w.write("%entry.p = getelementptr [2 x i32], ptr %table, i64 %at")
        w.write("%row32 = load i32, ptr %entry.p", "%row = zext i32 %row32 to i64")
        w.item("bits", "%entry.p", 1, "i32")
        w.write(f"%few = trunc i32 %bits to i{lanes}" if lanes < 32 else "%few = add i32 %bits, 0")
        w.write(f"%mask = bitcast i{lanes} %few to {truth}", f"%line = mul i64 %row, {n}")
        values = {number: value for value, number in w.results(f)}
        for number, port in enumerate(outputs):
            w.write(f"%{port}.p = getelementptr {self.layout.dtype}, ptr %{port}, i64 %line")
            other = "zeroinitializer"
            if tag == "over":
                other = w.let(f"{port}.old", f"load {real}, ptr %{port}.p, align {align}")
            chosen = w.let(f"{port}.new", f"select {truth} %mask, {real} {values[number]}, {real} {other}")
            w.write(f"store {real} {chosen}, ptr %{port}.p, align {align}")
        w.write("%next = add i64 %at, 1", "%more = icmp ult i64 %next, %count")
        w.branch("%more", "rows", "done")
        w.open_block("done")
        ports = [*(f"i{j}" for j in range(len(f.inputs))), *outputs, "table"]
        arguments = [*(f"ptr noalias %{port}" for port in ports), "i64 %count"]
        define(self.module, name, arguments, "noinline nounwind #0", w.lines)


class _ColumnWriter(LateInputsWriter):
    """Writes a function of columns in SIMD lanes; inputs are loaded where they are first used.

    Args:
        of: The form.
        f: The function.
        reads: The arrays that its inputs are columns of.
        own: How many of them are the same column in all lanes, which is that of the number %row.
        whole: The tables of which all lanes get the whole.
    """

    def __init__(
        self,
        of: _StagesWriter,
        f: Function,
        reads: Sequence[str],
        own: int = 0,
        whole: frozenset[str] = frozenset(),
    ) -> None:
        super().__init__(of.module, f.graph, of.layout, "", of.target.arithmetic)
        self._places: dict[int, tuple[str, int, bool]] = {}
        self._in_rows = own > 0
        self._live = set(f.graph.live(f.results))
        nodes = iter(f.graph.inputs)
        for number, (key, port) in enumerate(zip(reads, f.inputs, strict=True)):
            for row in range(port.size):
                is_own = number < own or of.is_shared(key) or key in whole
                place = of.place(key, port.shape, row) if key in whole else row * of.row_length(key)
                self._places[next(nodes)] = f"i{number}", place, is_own

    def fetch_lanes(self) -> None:
        """Loads what differs between lanes."""
        for node, (_, _, is_own) in self._places.items():
            if not is_own and node in self._live:
                self.fetch(node)

    def store(self, value: str, array: str, offset: int) -> None:
        """Stores lanes."""
        place, element = self.fresh("p"), self.layout.dtype
        self.write(f"{place} = getelementptr {element}, ptr %{array}, i64 {offset}")
        self.write(f"store {self.layout.real} {value}, ptr {place}, align {BYTES[element]}")

    def fetch(self, node: int) -> None:
        """Loads lanes, or one number into all of them."""
        if node in self.names or node not in self._places:
            return
        array, offset, is_own = self._places[node]
        place, value, element = self.fresh("p"), self.fresh("x"), self.layout.dtype
        self.write(f"{place} = getelementptr {element}, ptr %{array}, i64 {offset}")
        if is_own:
            if self._in_rows:
                here, place = place, self.fresh("p")
                self.write(f"{place} = getelementptr {element}, ptr {here}, i64 %row")
            self.write(f"{value} = load {element}, ptr {place}, align {BYTES[element]}")
            self.names[node] = self.in_all_lanes(element, value)
        else:
            self.write(f"{value} = load {self.layout.real}, ptr {place}, align {BYTES[element]}")
            self.names[node] = value


def _zero_entries(f: Function) -> list[set[int]]:
    """For each output the entries that are zero whatever the inputs."""
    found, start, g = [], 0, f.graph
    for port in f.outputs:
        nodes = enumerate(f.results[start : start + port.size])
        found.append({k for k, node in nodes if g.op[node] == Op.CONST and g.data[node] == 0.0})
        start += port.size
    return found


def rounded(x: float, element: DType) -> float:
    """A number as the type holds it.

    Args:
        x: The number.
        element: "double" or "float".

    Returns:
        The nearest number of that type.
    """
    return float(np.float32(x)) if element == "float" else float(x)
