"""Writes the stages that walk along the columns of a form: see `ulna.compiler.forms.stages.Sweep`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ulna.compiler.codegen.ir_text import BYTES, Lanes, local_array
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.stages import Pass, Sweep


class SweepContext(NamedTuple):
    """What the loops of a stage are written with.

    Attributes:
        module: Where definitions and declarations go.
        target: The processor.
        layout: The lanes of columns of the matrix; one for stages without.
        columns: How many columns the form has.
        row_length: How far the rows of a table lie apart.
    """

    module: Module
    target: Target
    layout: Lanes
    columns: int
    row_length: Callable[[str], int]


def write_sweep(to: SweepContext, name: str, stage: Sweep) -> None:
    """`void name(ptr table, ..., ptr source, ptr target, i64 start)` for a register of columns from `start` on.

    A triangular pass has two loops: rows are first those of the columns in the lanes, then all are ahead of them. Two
    registers of a symmetric matrix have three: what is above the diagonal is copied later.

    Args:
        to: Where it is written.
        name: The name of the function.
        stage: The stage; the tables are those of `tables_of`, source and target point to the first row of the columns.
    """
    n, layout = to.columns, to.layout
    lines = [f"  %middle = add i64 %start, {layout.lanes}"]
    if len(stage.passes) > 1:
        lines += local_array("between", layout.real, n, to.target.stack_space)
    block = "entry"
    for number, step in enumerate(stage.passes):
        arrays = "between" if number else "source", "target" if number == len(stage.passes) - 1 else "between"
        state = [layout.constant(0.0)] * step.body.outputs[0].size
        rows = ("%start", "%middle") if step.is_triangular else ("0", str(n))
        if stage.is_symmetric and layout.lanes * BYTES[layout.dtype] > to.target.register_bytes:
            lines.append(f"  %half = add i64 %start, {layout.lanes // 2}")
            block, state = _first_register(to, stage, step, block, lines)
            rows = ("%half", "%middle")
        loop = _Loop(to, stage, step, f"p{number}.", arrays)
        state = loop.write_rows(block, state, *rows)
        lines += loop.lines
        block = loop.current_block
        if step.is_triangular:
            lines.append(f"  %p{number}.rest = icmp ult i64 %middle, {n}")
            lines.append(f"  br i1 %p{number}.rest, label %p{number}.further, label %p{number}.end")
            lines.append(f"p{number}.further:")
            loop = _Loop(to, stage, step, f"r{number}.", arrays, is_ahead=True)
            loop.write_rows(f"p{number}.further", state, "%middle", str(n))
            lines += [*loop.lines, f"  br label %p{number}.end", f"p{number}.end:"]
            block = f"p{number}.end"
    arguments = [f"ptr noalias %{name}" for name in tables_of(stage)]
    arguments += ["ptr noalias %source", "ptr noalias %target", "i64 %start"]
    define(to.module, name, arguments, "noinline nounwind #0", lines)


def _first_register(
    to: SweepContext, stage: Sweep, step: Pass, block: str, lines: list[str]
) -> tuple[str, list[str]]:
    """The first rows of two registers of a symmetric matrix's columns: in the second one they are above the diagonal.

    Args:
        to: Where it is written.
        stage: The stage; of one pass.
        step: The pass.
        block: The block before.
        lines: The lines of the function, which are continued.

    Returns:
        The block after, and names of the state of both registers, zeros in the second one.
    """
    wide = to.layout
    narrow = Lanes(wide.lanes // 2, wide.dtype)
    loop = _Loop(to._replace(layout=narrow), stage, step, "h.", ("source", "target"))
    zeros = [narrow.constant(0.0)] * step.body.outputs[0].size
    state = loop.write_rows(block, zeros, "%start", "%half")
    lines += loop.lines
    places = ", ".join(f"i32 {k}" for k in range(wide.lanes))
    for k, value in enumerate(state):
        both = f"{narrow.real} {value}, {narrow.real} zeroinitializer, <{wide.lanes} x i32> <{places}>"
        lines.append(f"  %h.wide{k} = shufflevector {both}")
    return loop.current_block, [f"%h.wide{k}" for k in range(len(state))]


def tables_of(stage: Sweep) -> dict[str, str]:
    """The tables of a stage.

    Args:
        stage: The stage.

    Returns:
        For each name in the code that of the table.
    """
    keys = dict.fromkeys(key for step in stage.passes for key in (*step.own, *step.writes))
    return {f"t{k}": key for k, key in enumerate(keys)}


class _Loop(LateInputsWriter):
    """Writes a loop over the columns, which are the rows of the matrix.

    Args:
        to: Where it is written.
        stage: The stage.
        step: The pass.
        prefix: What names begin with.
        arrays: Names of the arrays that entries come from and go to.
        is_ahead: Whether the row is ahead of all columns in the lanes.
    """

    def __init__(
        self,
        to: SweepContext,
        stage: Sweep,
        step: Pass,
        prefix: str,
        arrays: tuple[str, str],
        is_ahead: bool = False,
    ) -> None:
        super().__init__(to.module, step.body.graph, to.layout, prefix, to.target.arithmetic)
        self._to, self._step, self._arrays, self._is_ahead = to, step, arrays, is_ahead
        self._has_matrix, self._row = bool(stage.matrix), f"%{prefix}row"
        self._tables = {key: name for name, key in tables_of(stage).items()}
        self._places: dict[int, tuple[str, int]] = {}

    def write_rows(self, before: str, state: Sequence[str], first: str, end: str) -> list[str]:
        """The rows from `first` on, before `end`; the last ones first in a pass inward.

        Args:
            before: The block before the loop.
            state: Names of the state.
            first: The first row.
            end: The row after the last one.

        Returns:
            Names of the state afterwards.
        """
        tag, step, real = self.prefix, self._step, self.layout.real
        self.jump(f"{tag}loop")
        self.open_block(f"{tag}loop")
        begin, change = (str(self._to.columns - 1), "sub") if step.is_inward else (first, "add")
        self.write(f"{self._row} = phi i64 [ {begin}, %{before} ], [ %{tag}next, %{tag}loop ]")
        place = len(self.lines)
        self._name_inputs()
        results = {number: value for value, number in self.results(step.body)}
        following = [results[k] for k in range(len(state))]
        for k, (value, other) in enumerate(zip(state, following, strict=True)):
            phi = f"  %{tag}x{k} = phi {real} [ {value}, %{before} ], [ {other}, %{tag}loop ]"
            self.lines.insert(place, phi)
        self._store([results[k] for k in range(len(state), len(results))])
        self.let(f"{tag}next", f"{change} i64 {self._row}, 1")
        ends = f"icmp ne i64 {self._row}, {first}" if step.is_inward else f"icmp ult i64 %{tag}next, {end}"
        self.branch(self.let(f"{tag}more", ends), f"{tag}loop", f"{tag}done")
        self.open_block(f"{tag}done")
        return following

    def _name_inputs(self) -> None:
        """The state, the entries of the matrix, and where the tables lie."""
        nodes, own = iter(self._step.body.graph.inputs), iter(self._step.own)
        for port in self._step.body.inputs:
            if port.name == "state":
                for k in range(port.size):
                    self.names[next(nodes)] = f"%{self.prefix}x{k}"
            elif port.name == "entry":
                place = self._entry(self._arrays[0])
                value = f"load {self.layout.real}, ptr {place}, align {BYTES[self.layout.dtype]}"
                self.names[next(nodes)] = self.let(f"{self.prefix}entry", value)
            elif port.name == "ahead":
                self.names[next(nodes)] = self._ahead()
            else:
                key = next(own)
                for k in range(port.size):
                    self._places[next(nodes)] = self._tables[key], k * self._to.row_length(key)

    def _entry(self, array: str) -> str:
        """The address of the register of the present row."""
        name = f"{self.prefix}{array}"
        if array == "between":
            return self.let(f"{name}.p", f"getelementptr {self.layout.real}, ptr %{array}, i64 {self._row}")
        line = self.let(f"{name}.line", f"mul i64 {self._row}, {self._to.columns}")
        return self.let(f"{name}.p", f"getelementptr {self.layout.dtype}, ptr %{array}, i64 {line}")

    def _ahead(self) -> str:
        """The number of the present column less that of each lane."""
        if self._is_ahead:
            return self.layout.constant(1.0)  # any number but zero, so that what is chosen is known to LLVM
        tag, element = self.prefix, self.layout.dtype
        whole = self.let(f"{tag}whole", f"sub i64 {self._row}, %start")
        number = self.let(f"{tag}number", f"sitofp i64 {whole} to {element}")
        every = self.in_all_lanes(element, number)
        return self.let(f"{tag}ahead", f"fsub {self.layout.real} {every}, {self.layout.numbers()}")

    def _store(self, values: Sequence[str]) -> None:
        """Stores what the pass computes of a column."""
        element = self.layout.dtype
        if self._has_matrix:
            place = self._entry(self._arrays[1])
            self.write(f"store {self.layout.real} {values[0]}, ptr {place}, align {BYTES[element]}")
            return
        ports = zip(self._step.writes, self._step.body.outputs[1:], strict=True)
        places = [(key, row * self._to.row_length(key)) for key, port in ports for row in range(port.size)]
        for value, (key, offset) in zip(values, places, strict=True):
            self.write(f"store {element} {value}, ptr {self._own_place(self._tables[key], offset)}")

    def _own_place(self, array: str, offset: int) -> str:
        """The address of a number of the present column."""
        line, place, element = self.fresh("line"), self.fresh("p"), self.layout.dtype
        self.write(f"{line} = getelementptr {element}, ptr %{array}, i64 {offset}")
        self.write(f"{place} = getelementptr {element}, ptr {line}, i64 {self._row}")
        return place

    def fetch(self, node: int) -> None:
        """Loads a number of the present column into all lanes."""
        if node in self.names or node not in self._places:
            return
        place, element = self._own_place(*self._places[node]), self.layout.dtype
        value = self.fresh("own")
        self.write(f"{value} = load {element}, ptr {place}, align {BYTES[element]}")
        self.names[node] = self.in_all_lanes(element, value) if self.layout.lanes > 1 else value
