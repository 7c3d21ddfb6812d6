"""Writes the stages that walk along the segments of a chain: see `ulna.compiler.forms.scans`.

Each lane has a segment of neighbouring columns, as many as others or one less, of which the first ones are: these walk
one column further, on padding. So whatever the first lanes compute of that column is overwritten by the lane after.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes, local_array
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.rows import transposed
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.scans import Scan, ScanPass, States
from ulna.compiler.language.function import Function
from ulna.compiler.language.graph import Graph


def write_scan(
    module: Module,
    name: str,
    stage: Scan,
    layout: Lanes,
    target: Target,
    row_length: Callable[[str], int],
) -> None:
    """`void name(ptr vector, ..., ptr table, ..., ptr whole, ...)`; results may lie where the vectors do.

    Args:
        module: Where definitions go.
        name: The name of the function.
        stage: The stage; pointers to vectors are to the number of the first column.
        layout: The lanes of a register.
        target: The processor.
        row_length: How far the rows of a table lie apart.
    """
    _ScanWriter(module, name, stage, layout, target).write(row_length)


class _ScanWriter:
    """The state of writing a stage.

    Args:
        module: Where definitions go.
        name: The name of the function.
        stage: The stage.
        layout: The lanes of a register; with few columns fewer are used, so that a segment has as many columns.
        target: The processor.
    """

    def __init__(self, module: Module, name: str, stage: Scan, layout: Lanes, target: Target) -> None:
        self.module, self.name, self.stage, self.target = module, name, stage, target
        lanes, columns = layout.lanes, stage.columns
        while lanes > 1 and -(-columns // lanes) < lanes:
            lanes //= 2
        self.layout = Lanes(lanes, layout.dtype)
        self.length = -(-columns // lanes)
        self.row_length = self.length | 1
        """How far rows of registers lie apart; even numbers would make many rows share few sets of a cache."""
        short = lanes * self.length - columns
        self.starts = [k * (self.length - 1) + max(0, k - short) for k in range(lanes)]
        self.short = short
        self.lines: list[str] = []
        self.block = "entry"
        self.places, self.size = _places(stage)
        self.values: dict[str, list[str]] = {}
        """The registers of states before segments, and of what follows from last states."""

    def write(self, row_length: Callable[[str], int]) -> None:
        """The function.

        Args:
            row_length: How far the rows of a table lie apart.
        """
        stage, real, space = self.stage, self.layout.real, self.target.stack_space
        self._declare_known()
        self.lines += local_array("kept", real, self.size * self.row_length, space)
        for number, step in enumerate(stage.passes):
            self._walk(number, step)
        for k, key in enumerate(stage.wholes):
            self._store_whole(f"w{k}", self.values[key])
        for k, key in enumerate(stage.tables):
            place, to = self.places[key] * self.row_length, 1 if key in stage.flat else row_length(key)
            self._copy(f"{self.name}.t{k}", stage.rows[key], to)
            self.lines.append(f"  %from{k} = getelementptr {real}, ptr %kept, i64 {place}")
            self.lines.append(f"  call void @{self.name}.t{k}(ptr %from{k}, ptr %t{k})")
        arguments = [f"ptr %v{k}" for k in range(len(stage.vectors))]
        arguments += [f"ptr %t{k}" for k in range(len(stage.tables))]
        arguments += [f"ptr %w{k}" for k in range(len(stage.wholes))]
        define(self.module, self.name, arguments, "noinline nounwind #0", self.lines)

    def _declare_known(self) -> None:
        """What is known of the columns, in the order in which it is read: of a column of each segment, row by row."""
        stage, one = self.stage, Lanes(1, self.layout.dtype)
        for number, (name, table) in enumerate(stage.known.items()):
            texts = []
            for place in range(self.length):
                for row, padding in zip(table, stage.padding[name], strict=True):
                    for lane, start in enumerate(self.starts):
                        is_padded = lane < self.short and place == self.length - 1
                        x = padding if is_padded else float(row[start + place])
                        texts.append(f"{self.layout.dtype} {one.constant(_rounded(x, self.layout.dtype))}")
            text = f"[{len(texts)} x {self.layout.dtype}] [{', '.join(texts)}]"
            self.module.declare(f"@{self.name}.known{number} = private constant {text}, align 64")

    def _walk(self, number: int, step: ScanPass) -> None:
        """The loop along the segments, and what follows from the states at their ends."""
        real, tag, states = self.layout.real, f"s{number}.", step.states
        size = len(states.identity) if states else 0
        w = _NamedInputs(self, step.body, tag)
        place = w.begin(self.block, step.is_inward)
        inputs = iter(step.body.graph.inputs)
        w.names |= {next(inputs): f"%{tag}state{k}" for k in range(size)}
        for name in step.reads:
            self._read(w, name, inputs)
        kept = [self.places[name] + row for name, rows in step.rows.items() for row in range(rows)]
        following: dict[int, str] = {}
        for value, result in w.results(step.body):
            following[result] = value
            if result >= size:
                w.write(
                    f"store {real} {value}, ptr {w.entry('%kept', kept[result - size] * self.row_length)}"
                )
        for k in range(size):
            first = self._started(step, k)
            text = f"phi {real} [ {first}, %{self.block} ], [ {following[k]}, %{tag}loop ]"
            w.lines.insert(place, f"  %{tag}state{k} = {text}")
        w.end(step.is_inward)
        self.lines += w.lines
        self.block = f"{tag}done"
        if states:
            self._join(tag, step, states, [following[k] for k in range(size)])

    def _read(self, w: _NamedInputs, name: str, inputs: Iterator[int]) -> None:
        """How the numbers of an array are found in a loop."""
        known, vectors = list(self.stage.known), [key for key, _ in self.stage.vectors]
        if name in self.values:
            w.names |= {next(inputs): value for value in self.values[name]}
        elif name in known:
            rows, number = len(self.stage.known[name]), known.index(name)
            for row in range(rows):
                w.loads[next(inputs)] = partial(w.loaded, f"@{self.name}.known{number}", row, rows)
        elif name in vectors:
            w.loads[next(inputs)] = partial(w.gathered, f"%v{vectors.index(name)}")
        else:
            for row in range(self.stage.rows[name]):
                place = (self.places[name] + row) * self.row_length
                w.loads[next(inputs)] = partial(w.loaded, "%kept", place)

    def _started(self, step: ScanPass, k: int) -> str:
        """The literal of a number of the states with which the segments begin."""
        assert step.states is not None
        element, one, lanes = self.layout.dtype, Lanes(1, self.layout.dtype), self.layout.lanes
        begin, unit = step.states.start[k], step.states.identity[k]
        first, other = (one.constant(_rounded(x, element)) for x in (begin, unit))
        if lanes == 1:
            return first
        outermost = lanes - 1 if step.is_inward else 0
        return f"<{', '.join(f'{element} {first if lane == outermost else other}' for lane in range(lanes))}>"

    def _join(self, tag: str, step: ScanPass, states: States, ends: Sequence[str]) -> None:
        """The states before segments, and what follows from the state after all columns."""
        distance, joined, lanes, sign = 1, list(ends), self.layout.lanes, -1 if step.is_inward else 1
        while distance < lanes:
            before = [
                self._shifted(x, sign * distance, unit)
                for x, unit in zip(joined, states.identity, strict=True)
            ]
            joined = self._evaluated(f"{tag}j{distance}.", states.join, [*before, *joined])
            distance *= 2
        self.values[step.before] = [
            self._shifted(x, sign, unit) for x, unit in zip(joined, states.identity, strict=True)
        ]
        if step.end is not None:
            outermost = 0 if step.is_inward else lanes - 1
            last = [self._shuffled(x, x, [outermost] * lanes) for x in joined]
            self.values[step.whole] = self._evaluated(f"{tag}e.", step.end, last)

    def _shifted(self, x: str, distance: int, unit: float) -> str:
        """The number of the lane before by a distance, or after where it is negative; where there is none, the unit."""
        lanes = self.layout.lanes
        if lanes == 1:
            return self.layout.constant(unit)
        places = [k - distance if 0 <= k - distance < lanes else lanes + k for k in range(lanes)]
        return self._shuffled(x, self.layout.constant(unit), places)

    def _shuffled(self, x: str, y: str, places: Sequence[int]) -> str:
        if self.layout.lanes == 1:
            return x
        name, real = f"%w{len(self.lines)}.", self.layout.real
        mask = ", ".join(f"i32 {k}" for k in places)
        self.lines.append(f"  {name} = shufflevector {real} {x}, {real} {y}, <{len(places)} x i32> <{mask}>")
        return name

    def _evaluated(self, prefix: str, f: Function, inputs: Sequence[str]) -> list[str]:
        """A function in all lanes."""
        w = _NamedInputs(self, f, prefix)
        w.names |= dict(zip(f.graph.inputs, inputs, strict=True))
        values = {number: value for value, number in w.results(f)}
        self.lines += w.lines
        return [values[k] for k in range(len(values))]

    def _store_whole(self, array: str, whole: Sequence[str]) -> None:
        element, real = self.layout.dtype, self.layout.real
        for k, value in enumerate(whole):
            number = value
            if self.layout.lanes > 1:
                number = f"%{array}.number{k}"
                self.lines.append(f"  {number} = extractelement {real} {value}, i64 0")
            self.lines.append(f"  %{array}.{k} = getelementptr {element}, ptr %{array}, i64 {k}")
            self.lines.append(f"  store {element} {number}, ptr %{array}.{k}")

    def _copy(self, name: str, rows: int, row_length: int) -> None:
        """`void name(ptr from, ptr to)`: the rows of a table in order of columns, by blocks that are transposed."""
        lanes, length = self.layout.lanes, self.length
        w = Writer(self.module, Graph(), self.layout, "", self.target.arithmetic)
        element, real = self.layout.dtype, self.layout.real
        w.jump("rows")
        w.open_block("rows")
        w.write("%row = phi i64 [ 0, %entry ], [ %row.next, %ended ]")
        w.let("source.k", f"mul i64 %row, {self.row_length}")
        w.let("source", f"getelementptr {real}, ptr %from, i64 %source.k")
        w.let("line.k", f"mul i64 %row, {row_length}")
        w.let("line", f"getelementptr {element}, ptr %to, i64 %line.k")
        w.let("row.next", "add i64 %row, 1")
        w.let("row.more", f"icmp ult i64 %row.next, {rows}")

        def block(tag: str, first: str) -> None:
            source = w.let(f"{tag}.from", f"getelementptr {real}, ptr %source, i64 {first}")
            place = w.let(f"{tag}.to", f"getelementptr {element}, ptr %line, i64 {first}")
            values = []
            for k in range(lanes):
                at = w.let(f"{tag}.from{k}", f"getelementptr {real}, ptr {source}, i64 {k}")
                values.append(w.let(f"{tag}.x{k}", f"load {real}, ptr {at}"))
            for k, value in enumerate(transposed(w, values) if lanes > 1 else values):
                at = w.let(f"{tag}.to{k}", f"getelementptr {element}, ptr {place}, i64 {self.starts[k]}")
                w.write(f"store {real} {value}, ptr {at}, align {BYTES[element]}")

        block("last", str(length - lanes))
        if length > lanes:
            w.jump("blocks")
            w.open_block("blocks")
            w.write("%k = phi i64 [ 0, %rows ], [ %k.next, %blocks ]")
            block("other", "%k")
            w.let("k.next", f"add i64 %k, {lanes}")
            w.let("k.more", f"icmp ult i64 %k.next, {length - lanes}")
            w.branch("%k.more", "blocks", "ended")
        else:
            w.jump("ended")
        w.open_block("ended")
        w.branch("%row.more", "rows", "done")
        w.open_block("done")
        define(self.module, name, ["ptr noalias %from", "ptr noalias %to"], "noinline nounwind #0", w.lines)


class _NamedInputs(LateInputsWriter):
    """Writes a function of which some inputs have names, perhaps in a loop along the segments.

    Args:
        of: The stage.
        f: The function.
        prefix: What names begin with.
    """

    def __init__(self, of: _ScanWriter, f: Function, prefix: str) -> None:
        super().__init__(of.module, f.graph, of.layout, prefix, of.target.arithmetic)
        self.of = of
        self.loads: dict[int, Callable[[], str]] = {}
        """For inputs without a name how they are loaded."""

    def fetch(self, node: int) -> None:
        """Loads an input that has no name yet."""
        if node not in self.names and node in self.loads:
            self.names[node] = self.loads[node]()

    def begin(self, before: str, is_inward: bool) -> int:
        """Begins the loop; `%PREFIXat` is the number of columns of each segment before.

        Args:
            before: The block before.
            is_inward: Whether the last columns come first.

        Returns:
            The number of the line where numbers that are handed on are to be declared.
        """
        tag, first = self.prefix, self.of.length - 1 if is_inward else 0
        self.jump(f"{tag}loop")
        self.open_block(f"{tag}loop")
        self.write(f"%{tag}at = phi i64 [ {first}, %{before} ], [ %{tag}next, %{tag}loop ]")
        return len(self.lines)

    def end(self, is_inward: bool) -> None:
        """Ends the loop.

        Args:
            is_inward: As for `begin`.
        """
        tag = self.prefix
        self.let(f"{tag}next", f"{'sub' if is_inward else 'add'} i64 %{tag}at, 1")
        ends = f"icmp ne i64 %{tag}at, 0" if is_inward else f"icmp ult i64 %{tag}next, {self.of.length}"
        self.branch(self.let(f"{tag}more", ends), f"{tag}loop", f"{tag}done")
        self.open_block(f"{tag}done")

    def entry(self, array: str, place: int, step: int = 1) -> str:
        """The address of a register of the present columns.

        Args:
            array: The name of the array's address.
            place: How many registers are before that of the first columns.
            step: How far registers of neighbouring columns lie apart.

        Returns:
            The address.
        """
        line, address, real = self.fresh("l"), self.fresh("p"), self.layout.real
        at = f"%{self.prefix}at"
        if step != 1:
            at = self.fresh("k")
            self.write(f"{at} = mul i64 %{self.prefix}at, {step}")
        self.write(f"{line} = getelementptr {real}, ptr {array}, i64 {at}")
        self.write(f"{address} = getelementptr {real}, ptr {line}, i64 {place}")
        return address

    def loaded(self, array: str, place: int, step: int = 1) -> str:
        """A register of an array; the arguments are those of `entry`."""
        value = self.fresh("x")
        self.write(f"{value} = load {self.layout.real}, ptr {self.entry(array, place, step)}")
        return value

    def gathered(self, vector: str) -> str:
        """A number of each segment.

        Args:
            vector: The address of the number of the first column.

        Returns:
            The name of a register.
        """
        element, real = self.layout.dtype, self.layout.real
        here, value = self.fresh("h"), "poison"
        self.write(f"{here} = getelementptr {element}, ptr {vector}, i64 %{self.prefix}at")
        for lane, start in enumerate(self.of.starts):
            place, number = self.fresh("p"), self.fresh("n")
            self.write(f"{place} = getelementptr {element}, ptr {here}, i64 {start}")
            self.write(f"{number} = load {element}, ptr {place}")
            if self.layout.lanes == 1:
                return number
            after = self.fresh("g")
            self.write(f"{after} = insertelement {real} {value}, {element} {number}, i32 {lane}")
            value = after
        return value


def _places(stage: Scan) -> tuple[dict[str, int], int]:
    """The first row of registers of each array that walks compute, and how many rows there are.

    What is not read any more gives its rows to what later walks compute. A walk loads columns where they are first
    used, perhaps after it has stored others: so what it reads keeps its rows until it ends.
    """
    last = {name: number for number, step in enumerate(stage.passes) for name in (*step.writes, *step.reads)}
    last |= dict.fromkeys(stage.tables, len(stage.passes))
    places: dict[str, int] = {}
    size = 0
    for number, step in enumerate(stage.passes):
        for name, rows in step.rows.items():
            taken = sorted((places[x], stage.rows[x]) for x in places if last[x] >= number)
            place = 0
            for start, length in taken:
                if place + rows <= start:
                    break
                place = max(place, start + length)
            places[name], size = place, max(size, place + rows)
    return places, max(size, 1)


def _rounded(x: float, element: DType) -> float:
    """A number as the type holds it."""
    return float(np.float32(x)) if element == "float" else float(x)
