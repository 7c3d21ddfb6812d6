"""Writes the loops of a graph: those that iterate until no lane's condition holds, and those that repeat others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from ulna.compiler.codegen.ir_text import Lanes, truth
from ulna.compiler.language.graph import Graph, Loop
from ulna.data_classes import dataclass


@dataclass(frozen=True)
class Record:
    """Where the states of a loop are kept, and what its iterations were.

    Attributes:
        array: The address of the states, those of one iteration after the other.
        size: How many numbers a state has.
        rounds: The name of the number of iterations of the lane that has most.
        counts: The name of the number of iterations in each lane, a floating-point number.
    """

    array: str
    size: int
    rounds: str
    counts: str


class Writer(Protocol):
    """What is used of a writer of nodes."""

    module: Any
    layout: Lanes
    prefix: str
    names: dict[int, str]
    records: dict[int, Record]
    lines: list[str]
    current_block: str

    def inside(self, tag: str, graph: Graph) -> Writer:
        """A writer for the body of a loop."""
        ...

    def array(self, name: str, count: int) -> str:
        """A local array of the function."""
        ...

    def nodes(self, order: Sequence[int]) -> None:
        """Writes nodes."""
        ...

    def assign(self, index: int, text: str) -> None:
        """Appends the instruction whose result is a node."""
        ...

    def in_all_lanes(self, element: str, value: str) -> str:
        """A vector that holds a value in every lane."""
        ...

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use."""
        ...

    def write(self, *instructions: str) -> None:
        """Appends instructions as they are."""
        ...

    def let(self, name: str, instruction: str) -> str:
        """Appends an instruction with a result."""
        ...

    def branch(self, condition: str, label: str, otherwise: str) -> None:
        """Continues at one of two blocks."""
        ...

    def open_block(self, label: str) -> None:
        """Begins a basic block."""
        ...


def write_loop(w: Writer, index: int, loop: Loop, args: Sequence[int]) -> None:
    """Iterates; a lane that is done keeps its state.

    Args:
        w: The writer of the graph around the loop.
        index: The LOOP node; its ITEM nodes read the final state.
        loop: Condition and body.
        args: Nodes of the initial state, then of the values that the loop captures, then of the loops that it reads.
    """
    tag, layout = f"{w.prefix}L{index}", w.layout
    before, head, after = w.current_block, f"{tag}.head", f"{tag}.after"
    inner = w.inside(tag, loop.graph)
    state = [f"%{tag}.x{k}" for k in range(loop.size)]
    w.write(f"br label %{head}")
    w.open_block(head)
    place = len(w.lines)  # of the phis, which name the block that the back edge comes from
    w.lines.append("")
    outside = args[loop.size : len(args) - loop.reads]
    for node, name in zip(loop.graph.inputs, [*state, *(w.names[a] for a in outside)], strict=False):
        inner.names[node] = name
    inner.current_block = head
    _begin_round(w, inner, tag, loop, args, after)
    if loop.is_recorded:
        _keep(w, inner, tag, index, loop, args)
    # Condition and body are one region: lanes that are done compute along and are masked out.
    inner.nodes(loop.graph.live([loop.condition, *loop.following]))
    for k, node in enumerate(loop.following):
        inner.write(
            f"%{tag}.y{k} = select {layout.truth} %{tag}.active, {layout.real} {inner.names[node]}, "
            f"{layout.real} {state[k]}"
        )
    inner.write(f"%{tag}.n1 = add i64 %{tag}.n, 1")
    inner.write(f"br label %{head}")
    end = inner.current_block
    w.lines += inner.lines
    begin = [w.names[a] for a in args[: loop.size]]
    w.lines[place] = "\n".join("  " + line for line in _phis(w, tag, loop, begin, before, end))
    w.open_block(after)
    w.names[index] = " ".join(state)


def _phis(w: Writer, tag: str, loop: Loop, begin: Sequence[str], before: str, end: str) -> list[str]:
    """What changes from one iteration to the next, in blocks `before` and `end` of the loop's head."""
    layout = w.layout

    def phi(name: str, kind: str, first: str, next_: str) -> str:
        return f"%{tag}.{name} = phi {kind} [ {first}, %{before} ], [ {next_}, %{end} ]"

    lines = [phi("n", "i64", "0", f"%{tag}.n1")]
    if not loop.reads:
        lines.append(phi("alive", layout.truth, truth(layout, True), f"%{tag}.active"))
        if loop.is_recorded:
            lines.append(phi("count", layout.real, layout.constant(0.0), f"%{tag}.count1"))
    return lines + [phi(f"x{k}", layout.real, value, f"%{tag}.y{k}") for k, value in enumerate(begin)]


def _begin_round(w: Writer, inner: Writer, tag: str, loop: Loop, args: Sequence[int], after: str) -> None:
    """Ends the head of the loop and begins its body, with the lanes in which it is active."""
    body = f"{tag}.body"
    if not loop.reads:
        inner.nodes(loop.graph.live([loop.condition]))
        _continue_while(inner, tag, loop, body, after)
        inner.open_block(body)
        return
    read = [w.records[a] for a in args[len(args) - loop.reads :]]
    inner.branch(inner.let(f"{tag}.go", f"icmp ult i64 %{tag}.n, {read[0].rounds}"), body, after)
    inner.open_block(body)
    if loop.is_backward:
        last = inner.let(f"{tag}.last", f"sub i64 {read[0].rounds}, 1")
        inner.let(f"{tag}.k", f"sub i64 {last}, %{tag}.n")
    else:
        inner.let(f"{tag}.k", f"add i64 %{tag}.n, 0")
    real, kind = inner.layout.real, inner.layout.dtype
    number = inner.let(f"{tag}.number", f"uitofp i64 %{tag}.k to {kind}")
    if inner.layout.lanes > 1:
        number = inner.in_all_lanes(kind, number)
    inner.let(f"{tag}.active", f"fcmp ogt {real} {read[0].counts}, {number}")
    live = set(loop.graph.live(loop.following))
    nodes = iter(loop.graph.inputs[len(loop.graph.inputs) - sum(record.size for record in read) :])
    for number, record in enumerate(read):
        first = inner.let(f"{tag}.r{number}", f"mul i64 %{tag}.k, {record.size}")
        for k in range(record.size):
            node = next(nodes)
            if node in live:
                at = _address(inner, record.array, first, k)
                inner.assign(node, f"load {real}, ptr {at}")


def _keep(w: Writer, inner: Writer, tag: str, index: int, loop: Loop, args: Sequence[int]) -> None:
    """Stores the state before the iteration."""
    layout = inner.layout
    array = w.array(f"{tag}.record", loop.limit * loop.size)
    if loop.reads:
        source = w.records[args[len(args) - loop.reads]]
        w.records[index] = Record(array, loop.size, source.rounds, source.counts)
        number = f"%{tag}.k"
    else:
        w.records[index] = Record(array, loop.size, f"%{tag}.n", f"%{tag}.count")
        number = f"%{tag}.n"
        more = inner.let(f"{tag}.more1", f"fadd {layout.real} %{tag}.count, {layout.constant(1.0)}")
        inner.let(
            f"{tag}.count1",
            f"select {layout.truth} %{tag}.active, {layout.real} {more}, {layout.real} %{tag}.count",
        )
    first = inner.let(f"{tag}.first", f"mul i64 {number}, {loop.size}")
    for k in range(loop.size):
        at = _address(inner, array, first, k)
        inner.write(f"store {layout.real} %{tag}.x{k}, ptr {at}")


def _address(w: Writer, array: str, first: str, k: int) -> str:
    """The address of number `k` of a state that begins at `first`."""
    at, address = w.fresh("at"), w.fresh("place")
    w.write(f"{at} = add i64 {first}, {k}")
    w.write(f"{address} = getelementptr {w.layout.real}, ptr {array}, i64 {at}")
    return address


def _continue_while(w: Writer, tag: str, loop: Loop, body: str, after: str) -> None:
    """Continues with the body while a lane is active and the limit is not reached."""
    layout = w.layout
    active = w.let(f"{tag}.active", f"and {layout.truth} %{tag}.alive, {w.names[loop.condition]}")
    anyone = active
    if layout.lanes > 1:
        reduction = f"@llvm.vector.reduce.or.v{layout.lanes}i1({layout.truth}"
        w.module.declare(f"declare i1 {reduction})")
        anyone = w.let(f"{tag}.any", f"call i1 {reduction} {active})")
    w.let(f"{tag}.more", f"icmp ult i64 %{tag}.n, {loop.limit}")
    w.branch(w.let(f"{tag}.go", f"and i1 {anyone}, %{tag}.more"), body, after)
