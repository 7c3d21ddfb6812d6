"""Writes the body of a large loop as functions, one after the other, which LLVM compiles quickly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ulna.compiler.codegen.scheduling import Step, Store, loop_parts, scratch_places
from ulna.compiler.codegen.step_writer import StepWriter
from ulna.compiler.codegen.straight_line import at, define, write_steps
from ulna.compiler.language.ops import Op


class Rows(NamedTuple):
    """Where an iteration reads and writes the tapes of loops.

    Attributes:
        taped: The nodes that are read, with the name of the address of a row, and a place in it.
        kept: The nodes that are stored side by side.
        kept_at: The name of the address where these are stored; empty for none.
    """

    taped: Mapping[int, tuple[str, int]]
    kept: Sequence[int]
    kept_at: str

    def fetch(self, to: StepWriter, index: int) -> bool:
        """Loads a node that is read of a tape.

        Args:
            to: Where the instructions are written.
            index: Any node.

        Returns:
            Whether it is read of a tape.
        """
        if index in self.taped:
            address, k = self.taped[index]
            to.assign(index, f"load {to.layout.real}, {at(to, k, address)}")
        return index in self.taped

    def put(self, to: StepWriter, step: Store) -> None:
        """Stores a node that is kept.

        Args:
            to: Where the instructions are written.
            step: The node, and its place beside the others.
        """
        (node,) = step.values
        to.write(f"store {to.layout.real} {to.names[node]}, {at(to, step.start, self.kept_at)}")

    def addresses(self) -> list[str]:
        """The names of all addresses."""
        read = [address for address, _ in self.taped.values()]
        return [*dict.fromkeys([*read, *([self.kept_at] if self.kept else ())])]


def write_in_parts(to: StepWriter, tag: str, results: Sequence[int], rows: Rows) -> None:
    """Writes what is wanted and not written yet; where that is much, as functions that share a scratch.

    Args:
        to: The writer of the loop's body.
        tag: What names of the loop begin with.
        results: The nodes that are wanted.
        rows: What is read of tapes, and what is kept.
    """
    live, pieces = to.graph.live([*results, *rows.kept]), list[list[Step]]()
    if to.loop_pack:
        known = {*to.names, *rows.taped}
        pieces = loop_parts(to.graph, results, rows.kept, known, to.layout.lanes, to.loop_pack)
    if pieces:
        given = [index for index in live if index in to.names]
        _write_pieces(to, f"{tag}.scratch", results, rows, given, pieces)
        return
    for index in live:
        rows.fetch(to, index)
    to.nodes(live)
    for k, node in enumerate(rows.kept):
        rows.put(to, Store(0, k, (node,)))


def _write_pieces(
    to: StepWriter,
    name: str,
    results: Sequence[int],
    rows: Rows,
    given: Sequence[int],
    pieces: Sequence[Sequence[Step]],
) -> None:
    """Functions of the steps of each piece, and their calls; nodes that are given go into the scratch before."""
    slots = scratch_places(to.graph, [given, *pieces, [Store(0, 0, tuple(results))]])
    scratch = to.array(name, max(slots.values(), default=0) + 1)
    for index in given:
        if index in slots:
            to.write(f"store {to.kind(index)} {to.names[index]}, {at(to, slots[index], scratch)}")
    arguments, wide = [f"ptr {address}" for address in rows.addresses()], to.layout.lanes > 1
    attributes = "noinline nounwind #0" if wide else "noinline nounwind"
    for steps in pieces:
        body, part = to.apart(), f"part{len(to.module.definitions)}"
        write_steps(body, steps, slots, rows.fetch, rows.put)
        define(to.module, part, ["ptr noalias %scratch", *arguments], attributes, body.lines)
        to.write(f"call void @{part}({', '.join([f'ptr {scratch}', *arguments])})")
    for index in dict.fromkeys(results):
        if index in slots and index not in to.names:
            to.assign(index, f"load {to.kind(index)}, {at(to, slots[index], scratch)}")
        elif not rows.fetch(to, index) and to.graph.op[index] in (Op.CONST, Op.BOOL):
            to.node(index)
