"""Loops over columns of tables that hold a register, one lane for each sample, where one sample has a number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ulna.compiler.codegen.ir_text import BYTES, Lanes
from ulna.compiler.codegen.late_inputs import LateInputsWriter
from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function


class Source(NamedTuple):
    """Where an input of a function of columns lies.

    Attributes:
        pointer: The name of the address of its column, without its sign.
        apart: How far the entries of a column lie apart [numbers].
        is_number: Whether there is one number for all samples, not one in each lane.
    """

    pointer: str
    apart: int
    is_number: bool = False


class ColumnReader(LateInputsWriter):
    """Writes a function of columns, whose entries are loaded where they are first used.

    Args:
        module: Where declarations go.
        f: The function.
        layout: The lanes.
        target: The processor.
        sources: Where its inputs lie.
    """

    def __init__(
        self, module: Module, f: Function, layout: Lanes, target: Target, sources: Sequence[Source]
    ) -> None:
        super().__init__(module, f.graph, layout, "", target.arithmetic)
        self._live = set(f.graph.live(f.results))
        nodes = iter(f.graph.inputs)
        self._places: dict[int, tuple[Source, int]] = {}
        self._nodes: dict[Source, tuple[int, ...]] = {}
        for source, port in zip(sources, f.inputs, strict=True):
            self._nodes[source] = tuple(next(nodes) for _ in range(port.size))
            self._places |= {node: (source, row) for row, node in enumerate(self._nodes[source])}

    def fetch_all(self, sources: Sequence[Source]) -> None:
        """Loads the entries of some inputs that are needed.

        Args:
            sources: Where the inputs lie.
        """
        for source in sources:
            for node in self._nodes[source]:
                if node in self._live:
                    self.fetch(node)

    def fetch(self, node: int) -> None:
        """Loads an entry: a register, or one number into all lanes."""
        if node in self.names or node not in self._places:
            return
        source, row = self._places[node]
        if not source.is_number:
            self.names[node] = get(self, source.pointer, row * source.apart)
            return
        element, place = self.layout.dtype, self.fresh("p")
        self.write(f"{place} = getelementptr {element}, ptr %{source.pointer}, i64 {row * source.apart}")
        value = self.fresh("x")
        self.write(f"{value} = load {element}, ptr {place}, align {BYTES[element]}")
        self.names[node] = self.in_all_lanes(element, value)


def get(to: Writer, array: str, place: int | str) -> str:
    """Loads a register.

    Args:
        to: Where the instructions are written.
        array: The name of an array of registers, without its sign.
        place: The number of the register.

    Returns:
        The name of the value.
    """
    pointer, value = to.fresh("p"), to.fresh("x")
    to.write(f"{pointer} = getelementptr {to.layout.real}, ptr %{array}, i64 {place}")
    to.write(f"{value} = load {to.layout.real}, ptr {pointer}")
    return value


def put(to: Writer, array: str, place: int | str, value: str) -> None:
    """Stores a register.

    Args:
        to: Where the instructions are written.
        array: The name of an array of registers, without its sign.
        place: The number of the register.
        value: What is stored there.
    """
    pointer = to.fresh("p")
    to.write(f"{pointer} = getelementptr {to.layout.real}, ptr %{array}, i64 {place}")
    to.write(f"store {to.layout.real} {value}, ptr {pointer}")


def begin_loop(to: Writer, name: str) -> None:
    """Begins a loop; its counter has its name.

    Args:
        to: Where the instructions are written.
        name: The name of the loop.
    """
    before = to.current_block
    to.jump(f"{name}.begin")
    to.open_block(f"{name}.begin")
    to.let(name, f"phi i64 [ 0, %{before} ], [ %{name}.next, %{name}.end ]")


def end_loop(to: Writer, name: str, count: str) -> None:
    """Ends a loop.

    Args:
        to: Where the instructions are written.
        name: Its name.
        count: How often it repeats, at least once.
    """
    to.jump(f"{name}.end")
    to.open_block(f"{name}.end")
    to.let(f"{name}.next", f"add i64 %{name}, 1")
    more = to.let(f"{name}.more", f"icmp ult i64 %{name}.next, {count}")
    to.branch(more, f"{name}.begin", f"{name}.done")
    to.open_block(f"{name}.done")


def item(to: Writer, name: str, base: str, index: int | str) -> str:
    """Loads a number of a table of 32-bit integers.

    Args:
        to: Where the instructions are written.
        name: The name of the value, without its sign.
        base: The address of the table.
        index: The number of the item.

    Returns:
        The name of the value, of 64 bits.
    """
    place = to.let(f"{name}.at", f"getelementptr i32, ptr {base}, i64 {index}")
    short = to.let(f"{name}.short", f"load i32, ptr {place}")
    return to.let(name, f"zext i32 {short} to i64")
