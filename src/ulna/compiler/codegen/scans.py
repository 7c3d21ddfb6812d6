"""Writes the stages that compute the states of a chain in segments: see `ulna.compiler.forms.stages.Scan`.

Each lane has a segment of neighbouring columns, as many as others or one less, of which the first ones are: these walk
one column further, on padding. So whatever the first lanes compute of that column is overwritten by the lane after.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes, local_array
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.rows import transposed
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.stages import Scan
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
    """`void name(ptr vector, ..., ptr table, ..., ptr whole)`; results may lie where the vectors do.

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
        lanes, columns = layout.lanes, stage.numbers.shape[1]
        while lanes > 1 and -(-columns // lanes) < lanes:
            lanes //= 2
        self.layout = Lanes(lanes, layout.dtype)
        self.length = -(-columns // lanes)
        short = lanes * self.length - columns
        self.starts = [k * (self.length - 1) + max(0, k - short) for k in range(lanes)]
        self.short = short
        self.lines: list[str] = []

    def write(self, row_length: Callable[[str], int]) -> None:
        """The function.

        Args:
            row_length: How far the rows of a table lie apart.
        """
        stage, real, space = self.stage, self.layout.real, self.target.stack_space
        self._declare_numbers()
        kept = stage.step.outputs[1].size if stage.place else 0
        rows = sum(port.size for port in stage.place.outputs) if stage.place else 0
        if stage.place:
            self.lines += local_array("kept", real, kept * self.length, space)
            self.lines += local_array("placed", real, rows * self.length, space)
        ends = self._walk(kept)
        inclusive = self._joined(ends)
        last = [self._shuffled(x, x, [self.layout.lanes - 1] * self.layout.lanes) for x in inclusive]
        whole = self._evaluated("e.", stage.end, last)
        self._store_whole(whole)
        if stage.place:
            before = [self._shifted(x, 1, unit) for x, unit in zip(inclusive, stage.identity, strict=True)]
            self._place(stage.place, before, whole, kept)
            row = 0
            for key, port in zip(stage.tables, stage.place.outputs, strict=True):
                self._copy(f"{self.name}.{key}", port.size, row_length(key))
                at = f"%from.{key}"
                self.lines.append(f"  {at} = getelementptr {real}, ptr %placed, i64 {row * self.length}")
                self.lines.append(f"  call void @{self.name}.{key}(ptr {at}, ptr %{key})")
                row += port.size
        arguments = [f"ptr %v{k}" for k in range(len(stage.vectors))]
        arguments += [f"ptr %{key}" for key in stage.tables] + ["ptr %whole"]
        define(self.module, self.name, arguments, "noinline nounwind #0", self.lines)

    def _declare_numbers(self) -> None:
        """What is known of the columns, in the order in which it is read: of a column of each segment, row by row."""
        stage, one = self.stage, Lanes(1, self.layout.dtype)
        texts = []
        for place in range(self.length):
            for row, padding in zip(stage.numbers, stage.padding, strict=True):
                for lane, start in enumerate(self.starts):
                    is_padded = lane < self.short and place == self.length - 1
                    x = padding if is_padded else float(row[start + place])
                    texts.append(f"{self.layout.dtype} {one.constant(_rounded(x, self.layout.dtype))}")
        text = f"[{len(texts)} x {self.layout.dtype}] [{', '.join(texts)}]"
        self.module.declare(f"@{self.name}.numbers = private constant {text}, align 64")

    def _walk(self, kept: int) -> list[str]:
        """The loop along the segments; returns the names of the states at their ends."""
        stage, real, size = self.stage, self.layout.real, len(self.stage.identity)
        rows = stage.numbers.shape[0]
        w = _NamedInputs(self, stage.step, "s.")
        place = w.begin("entry")
        w.let("s.numbers", f"mul i64 %s.at, {rows}")
        if kept:
            w.let("s.kept", f"mul i64 %s.at, {kept}")
        inputs = iter(stage.step.graph.inputs)
        w.names |= {next(inputs): f"%s.state{k}" for k in range(size)}
        for row in range(rows):
            w.loads[next(inputs)] = partial(w.loaded, f"@{self.name}.numbers", "%s.numbers", row)
        for k in range(len(stage.vectors)):
            w.loads[next(inputs)] = partial(w.gathered, f"%v{k}", "%s.at")
        results = {}
        for value, number in w.results(stage.step):
            results[number] = value
            if size <= number < size + kept:
                w.write(f"store {real} {value}, ptr {w.entry('%kept', '%s.kept', number - size)}")
        states = [results[k] for k in range(size)]
        for k, (begin, unit) in enumerate(zip(stage.start, stage.identity, strict=True)):
            text = f"phi {real} [ {self._started(begin, unit)}, %entry ], [ {states[k]}, %s.loop ]"
            w.lines.insert(place, f"  %s.state{k} = {text}")
        w.end()
        self.lines += w.lines
        return states

    def _started(self, start: float, identity: float) -> str:
        """The literal of a number of the states with which the segments begin."""
        element, one = self.layout.dtype, Lanes(1, self.layout.dtype)
        first, other = (one.constant(_rounded(x, element)) for x in (start, identity))
        if self.layout.lanes == 1:
            return first
        return f"<{', '.join(f'{element} {first if k == 0 else other}' for k in range(self.layout.lanes))}>"

    def _joined(self, states: Sequence[str]) -> list[str]:
        """The state at the end of each segment, those before included."""
        distance, states = 1, list(states)
        while distance < self.layout.lanes:
            units = zip(states, self.stage.identity, strict=True)
            before = [self._shifted(x, distance, unit) for x, unit in units]
            states = self._evaluated(f"j{distance}.", self.stage.join, [*before, *states])
            distance *= 2
        return states

    def _shifted(self, x: str, distance: int, unit: float) -> str:
        """The number of the lane before by a distance; where there is none, that of the identity."""
        lanes = self.layout.lanes
        if lanes == 1:
            return self.layout.constant(unit)
        places = [k - distance if k >= distance else lanes + k for k in range(lanes)]
        return self._shuffled(x, self.layout.constant(unit), places)

    def _shuffled(self, x: str, y: str, places: Sequence[int]) -> str:
        if self.layout.lanes == 1:
            return x
        name, real = f"%w{len(self.lines)}", self.layout.real
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

    def _store_whole(self, whole: Sequence[str]) -> None:
        element, real = self.layout.dtype, self.layout.real
        for k, value in enumerate(whole):
            number = value
            if self.layout.lanes > 1:
                number = f"%number{k}"
                self.lines.append(f"  {number} = extractelement {real} {value}, i64 0")
            self.lines.append(f"  %whole{k} = getelementptr {element}, ptr %whole, i64 {k}")
            self.lines.append(f"  store {element} {number}, ptr %whole{k}")

    def _place(self, f: Function, before: Sequence[str], whole: Sequence[str], kept: int) -> None:
        """The loop over all columns of the segments that computes what is placed in tables."""
        w, real = _NamedInputs(self, f, "p."), self.layout.real
        w.begin("s.done")
        w.let("p.kept", f"mul i64 %p.at, {kept}")
        inputs = iter(f.graph.inputs)
        w.names |= {next(inputs): value for value in (*before, *whole)}
        w.loads = {next(inputs): partial(w.loaded, "%kept", "%p.kept", row) for row in range(kept)}
        for value, row in w.results(f):
            w.write(f"store {real} {value}, ptr {w.entry('%placed', '%p.at', row * self.length)}")
        w.end()
        self.lines += w.lines

    def _copy(self, name: str, rows: int, row_length: int) -> None:
        """`void name(ptr from, ptr to)`: the rows of a table in order of columns, by blocks that are transposed."""
        lanes, length = self.layout.lanes, self.length
        w = Writer(self.module, Graph(), self.layout, "", self.target.arithmetic)
        element, real = self.layout.dtype, self.layout.real
        w.jump("rows")
        w.open_block("rows")
        w.write("%row = phi i64 [ 0, %entry ], [ %row.next, %ended ]")
        w.let("source.k", f"mul i64 %row, {length}")
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

    def begin(self, before: str) -> int:
        """Begins the loop; `%PREFIXat` is the number of columns of each segment before.

        Args:
            before: The block before.

        Returns:
            The number of the line where numbers that are handed on are to be declared.
        """
        tag = self.prefix
        self.jump(f"{tag}loop")
        self.open_block(f"{tag}loop")
        self.write(f"%{tag}at = phi i64 [ 0, %{before} ], [ %{tag}next, %{tag}loop ]")
        return len(self.lines)

    def end(self) -> None:
        """Ends the loop."""
        tag = self.prefix
        self.let(f"{tag}next", f"add i64 %{tag}at, 1")
        more = self.let(f"{tag}more", f"icmp ult i64 %{tag}next, {self.of.length}")
        self.branch(more, f"{tag}loop", f"{tag}done")
        self.open_block(f"{tag}done")

    def entry(self, array: str, start: str, row: int) -> str:
        """The address of a register of an array.

        Args:
            array: The name of its address.
            start: The name of the number of the first register that is meant.
            row: How many registers are between.

        Returns:
            The address.
        """
        line, place, real = self.fresh("l"), self.fresh("p"), self.layout.real
        self.write(f"{line} = getelementptr {real}, ptr {array}, i64 {start}")
        self.write(f"{place} = getelementptr {real}, ptr {line}, i64 {row}")
        return place

    def loaded(self, array: str, start: str, row: int) -> str:
        """A register of an array; the arguments are those of `entry`."""
        value = self.fresh("x")
        self.write(f"{value} = load {self.layout.real}, ptr {self.entry(array, start, row)}")
        return value

    def gathered(self, vector: str, at: str) -> str:
        """A number of each segment.

        Args:
            vector: The address of the number of the first column.
            at: The name of the number of columns before in the segment.

        Returns:
            The name of a register.
        """
        element, real = self.layout.dtype, self.layout.real
        here, value = self.fresh("h"), "poison"
        self.write(f"{here} = getelementptr {element}, ptr {vector}, i64 {at}")
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


def _rounded(x: float, element: DType) -> float:
    """A number as the type holds it."""
    return float(np.float32(x)) if element == "float" else float(x)
