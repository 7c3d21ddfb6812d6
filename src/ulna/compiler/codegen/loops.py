"""Writes the loops of a graph: those that iterate until no lane's condition holds, and those that repeat others."""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import truth
from ulna.compiler.codegen.loop_parts import Rows, write_in_parts
from ulna.compiler.codegen.step_writer import StepWriter, Tape
from ulna.compiler.language.graph import Loop


def write_loop(w: StepWriter, index: int, loop: Loop, args: Sequence[int]) -> None:
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
    captured = zip(loop.graph.inputs[loop.size :], outside, strict=False)
    inner.captured_conditions = {node for node, a in captured if w.is_condition(a)}
    inner.current_block = head
    taped = _begin_round(w, inner, tag, loop, args, after)
    if loop.is_taped:
        _store_state(w, inner, tag, index, loop, args)
    # Condition and body are one region: lanes that are done compute along and are masked out.
    kept = loop.following[loop.size :]
    row = ""
    if kept:
        row = inner.let(f"{tag}.kept", _place(inner, f"%{tag}.tape", f"%{tag}.first", loop.size))
    write_in_parts(inner, tag, [loop.condition, *loop.following[: loop.size]], Rows(taped, kept, row))
    for k, node in enumerate(loop.following[: loop.size]):
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


def _phis(w: StepWriter, tag: str, loop: Loop, begin: Sequence[str], before: str, end: str) -> list[str]:
    """What changes from one iteration to the next, in blocks `before` and `end` of the loop's head."""
    layout = w.layout

    def phi(name: str, kind: str, first: str, next_: str) -> str:
        return f"%{tag}.{name} = phi {kind} [ {first}, %{before} ], [ {next_}, %{end} ]"

    lines = [phi("n", "i64", "0", f"%{tag}.n1")]
    if not loop.reads:
        lines.append(phi("alive", layout.truth, truth(layout, True), f"%{tag}.active"))
        if loop.is_taped:
            lines.append(phi("count", layout.real, layout.constant(0.0), f"%{tag}.count1"))
    return lines + [phi(f"x{k}", layout.real, value, f"%{tag}.y{k}") for k, value in enumerate(begin)]


def _begin_round(
    w: StepWriter, inner: StepWriter, tag: str, loop: Loop, args: Sequence[int], after: str
) -> dict[int, tuple[str, int]]:
    """Ends the head of the loop and begins its body, with the lanes in which it is active; where taped nodes lie."""
    body = f"{tag}.body"
    if not loop.reads:
        inner.nodes(loop.graph.live([loop.condition]))
        _continue_while(inner, tag, loop, body, after)
        inner.open_block(body)
        return {}
    read = [w.tapes[a] for a in args[len(args) - loop.reads :]]
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
    nodes = iter(loop.graph.inputs[len(loop.graph.inputs) - sum(tape.size for tape in read) :])
    places: dict[int, tuple[str, int]] = {}
    for number, tape in enumerate(read):
        first = inner.let(f"{tag}.r{number}", f"mul i64 %{tag}.k, {tape.size}")
        row = inner.let(f"{tag}.row{number}", f"getelementptr {real}, ptr {tape.array}, i64 {first}")
        places |= {next(nodes): (row, k) for k in range(tape.size)}
    return places


def _store_state(
    w: StepWriter, inner: StepWriter, tag: str, index: int, loop: Loop, args: Sequence[int]
) -> None:
    """Stores the state before the iteration."""
    layout = inner.layout
    array = w.array(f"{tag}.tape", loop.limit * len(loop.following))
    if loop.reads:
        source = w.tapes[args[len(args) - loop.reads]]
        w.tapes[index] = Tape(array, len(loop.following), source.rounds, source.counts)
        number = f"%{tag}.k"
    else:
        w.tapes[index] = Tape(array, len(loop.following), f"%{tag}.n", f"%{tag}.count")
        number = f"%{tag}.n"
        more = inner.let(f"{tag}.more1", f"fadd {layout.real} %{tag}.count, {layout.constant(1.0)}")
        inner.let(
            f"{tag}.count1",
            f"select {layout.truth} %{tag}.active, {layout.real} {more}, {layout.real} %{tag}.count",
        )
    first = inner.let(f"{tag}.first", f"mul i64 {number}, {len(loop.following)}")
    _store(inner, array, first, [f"%{tag}.x{k}" for k in range(loop.size)])


def _store(w: StepWriter, array: str, first: str, values: Sequence[str]) -> None:
    """Stores numbers at the beginning of the tape that begins at `first`."""
    for k, value in enumerate(values):
        address = w.fresh("place")
        w.write(f"{address} = {_place(w, array, first, k)}")
        w.write(f"store {w.layout.real} {value}, ptr {address}")


def _place(w: StepWriter, array: str, first: str, k: int) -> str:
    """The right side of the instruction that computes the address of number `k` of the tape at `first`."""
    at = w.fresh("at")
    w.write(f"{at} = add i64 {first}, {k}")
    return f"getelementptr {w.layout.real}, ptr {array}, i64 {at}"


def _continue_while(w: StepWriter, tag: str, loop: Loop, body: str, after: str) -> None:
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
