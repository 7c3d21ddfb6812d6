"""Writes the stage that computes a matrix from products of a row's column with others: see `forms.stages.Products`.

Rows are written from their beginning to their end, as they lie in memory: a large matrix leaves the caches, and the
processor then writes lines in order. Registers in which a row has no entry are zeros without being computed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ulna.compiler.codegen.ir_text import BYTES, Lanes
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.codegen.sample_loops import begin_loop, end_loop, item
from ulna.compiler.codegen.straight_line import define
from ulna.compiler.codegen.target import Target
from ulna.compiler.forms.stages import Products


def write_products(
    module: Module,
    name: str,
    stage: Products,
    layout: Lanes,
    target: Target,
    row_length: Callable[[str], int],
) -> None:
    """`void name(ptr own table, ..., ptr other table, ..., ptr matrix)`.

    Args:
        module: Where the definitions go.
        name: The name of the function.
        stage: The stage; its matrix has as many columns as there are lanes, or more.
        layout: The lanes of a register of columns.
        target: The processor.
        row_length: How far the rows of a table lie apart [numbers].
    """
    rows, n = stage.pattern.shape
    starts = np.array([*range(0, n - layout.lanes, layout.lanes), n - layout.lanes])
    lanes = np.arange(layout.lanes)
    masks = stage.pattern[:, starts[:, None] + lanes] @ (1 << lanes)
    numbers = ", ".join(f"i32 {mask}" for mask in masks.reshape(-1).tolist())
    module.declare(f"@{name}.masks = private constant [{masks.size} x i32] [{numbers}]")
    w = _EntryWriter(module, stage, layout, target, row_length)
    begin_loop(w, "row")
    w.go_to("row", range(len(stage.own)))
    w.let("line", f"mul i64 %row, {n}")
    w.let("masks", f"mul i64 %row, {len(starts)}")
    w.fetch_own()
    begin_loop(w, "register")
    w.let("whole", f"mul i64 %register, {layout.lanes}")
    w.let("is.last", f"icmp eq i64 %register, {len(starts) - 1}")
    w.let("start", f"select i1 %is.last, i64 {n - layout.lanes}, i64 %whole")
    w.let("place", "add i64 %line, %start")
    w.let("out.k", f"getelementptr {layout.dtype}, ptr %out, i64 %place")
    w.let("which", "add i64 %masks, %register")
    _write_register(w, stage, item(w, "mask", f"@{name}.masks", "%which"))
    end_loop(w, "register", str(len(starts)))
    end_loop(w, "row", str(rows))
    arguments = [f"ptr noalias %i{k}" for k in range(len(stage.body.inputs))]
    define(module, name, [*arguments, "ptr noalias %out"], "noinline nounwind #0", w.lines)


def _write_register(w: _EntryWriter, stage: Products, mask: str) -> None:
    """A register of a row: zeros, or the entries that there are by a mask."""
    layout = w.layout
    align = f"ptr %out.k, align {BYTES[layout.dtype]}"
    w.branch(w.let("is.empty", f"icmp eq i64 {mask}, 0"), "empty", "filled")
    w.open_block("empty")
    w.write(f"store {layout.real} zeroinitializer, {align}")
    w.jump("register.end")
    w.open_block("filled")
    w.go_to("start", range(len(stage.own), len(stage.own) + len(stage.other)))
    ((value, _),) = w.results(stage.body)
    w.write(f"%bits = trunc i64 {mask} to i{layout.lanes}")
    w.write(f"%chosen = bitcast i{layout.lanes} %bits to {layout.truth}")
    w.let("new", f"select {layout.truth} %chosen, {layout.real} {value}, {layout.real} zeroinitializer")
    w.write(f"store {layout.real} %new, {align}")


class _EntryWriter(LateInputsWriter):
    """Writes an entry in SIMD lanes of columns; inputs of the row's column are the same in all lanes."""

    def __init__(
        self,
        module: Module,
        stage: Products,
        layout: Lanes,
        target: Target,
        row_length: Callable[[str], int],
    ) -> None:
        super().__init__(module, stage.body.graph, layout, "", target.arithmetic)
        self._live = set(stage.body.graph.live(stage.body.results))
        self._places: dict[int, tuple[int, int, bool]] = {}
        nodes = iter(stage.body.graph.inputs)
        for k, (key, port) in enumerate(zip((*stage.own, *stage.other), stage.body.inputs, strict=True)):
            for row in range(port.size):
                self._places[next(nodes)] = k, row * row_length(key), k < len(stage.own)

    def go_to(self, column: str, tables: range) -> None:
        """Names the addresses of a column of some tables.

        Args:
            column: The name of its number, without its sign.
            tables: The numbers of the tables.
        """
        for k in tables:
            self.let(f"i{k}.k", f"getelementptr {self.layout.dtype}, ptr %i{k}, i64 %{column}")

    def fetch_own(self) -> None:
        """Loads what all lanes share."""
        for node, (_, _, is_own) in self._places.items():
            if is_own and node in self._live:
                self.fetch(node)

    def fetch(self, node: int) -> None:
        """Loads lanes, or one number into all of them."""
        if node in self.names or node not in self._places:
            return
        table, offset, is_own = self._places[node]
        place, value, element = self.fresh("p"), self.fresh("x"), self.layout.dtype
        kind, align = element if is_own else self.layout.real, BYTES[element]
        self.write(f"{place} = getelementptr {element}, ptr %i{table}.k, i64 {offset}")
        self.write(f"{value} = load {kind}, ptr {place}, align {align}")
        self.names[node] = self.in_all_lanes(element, value) if is_own else value
