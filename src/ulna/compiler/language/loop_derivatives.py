"""Derivatives of loops: loops that repeat the iterations with the states that were recorded.

The loop keeps the state before each iteration. A tangent repeats the iterations in order, cotangents repeat them
backwards; each round evaluates the body's derivative at the recorded state. How often a loop iterates counts as
constant. A record that would be too long is cut: the loop becomes a loop of shorter loops, whose iterations are
computed once more [Griewank & Walther 2008, section 12.1].
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from math import isqrt

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.interpreter import copy_into
from ulna.compiler.language.ops import Op
from ulna.errors import TraceError

_RECORD = 4096
"""How many numbers the record of a loop holds on the stack, for each lane."""

Sweep = Callable[..., list[int]]


def copied(target: Graph, source: Graph, nodes: Sequence[int], inputs: Sequence[int]) -> list[int]:
    """Rebuilds nodes of a graph as `copy_into` does, with loops as loops of shorter ones where a record needs it.

    Args:
        target: The graph to write to.
        source: The graph to copy from.
        nodes: Nodes of `source`.
        inputs: For each input of `source` the node of `target` that takes its place.

    Returns:
        The nodes of `target` that equal `nodes`.
    """
    return copy_into(target, source, nodes, inputs, _in_rounds)


def _longest(numbers: int) -> int:
    """How many iterations fit in a record of so many numbers each."""
    return max(_RECORD // numbers, 2)


def _in_rounds(target: Graph, loop: Loop, args: list[int]) -> list[int]:
    """Adds a loop; where it is too long for a record but not for three nested ones, as a loop of loops."""
    # As many numbers as its cotangents have, which are recorded for second derivatives.
    longest = _longest(len(args))
    if loop.reads or loop.is_recorded or not longest < loop.limit <= longest**3:
        return target.loop(loop, args)
    rounds = min(longest, isqrt(loop.limit - 1) + 1)
    length, rest = divmod(loop.limit, rounds)
    body = Graph(relaxed=target.relaxed, parent=target)
    inputs = [body.input() for _ in args]
    following = body.loop(replace(loop, limit=length), inputs)
    (condition,) = copy_into(body, loop.graph, [loop.condition], inputs)
    items = target.loop(Loop(body, loop.size, condition, tuple(following), rounds), args)
    return target.loop(replace(loop, limit=rest), [*items, *args[loop.size :]]) if rest else items


def forward_loop(
    g: Graph, index: int, tangents: Mapping[int, int], others: Mapping[int, Mapping[int, int]], sweep: Sweep
) -> dict[int, int]:
    """Adds the loop of the tangents of a loop's state.

    Args:
        g: The graph, which takes the new loop.
        index: The LOOP node.
        tangents: Nodes of the tangents of nodes that have one.
        others: For loops before this one, the tangents of their states by number.
        sweep: The forward sweep: graph, tangents by node, outputs; returns nodes of the tangents of the outputs.

    Returns:
        The nodes of the tangents of the final state, by number of the state.
    """
    loop = g.data[index]
    state, captured, read = _arguments(loop, g.args[index])
    read_moving = [sorted(others.get(owner, ())) for owner in read]
    inputs, starts = loop.graph.inputs, _record_starts(g, loop, read)
    fixed = {inputs[loop.size + k] for k, node in enumerate(captured) if node in tangents}
    fixed |= {inputs[first + k] for first, numbers in zip(starts, read_moving, strict=True) for k in numbers}
    moving = _moving(loop, [k for k, node in enumerate(state) if node in tangents], fixed)
    if not moving:
        return {}
    inner = Graph(relaxed=g.relaxed, parent=g)
    changes = [inner.input() for _ in moving]
    outside = [inner.input() for _ in captured]
    moved = {k: inner.input() for k, node in enumerate(captured) if node in tangents}
    before = [inner.input() for _ in state]
    records = [[inner.input() for _ in range(g.data[owner].size)] for owner in read]
    known = dict(zip((before[k] for k in moving), changes, strict=True)) | {
        outside[k]: t for k, t in moved.items()
    }
    for record, numbers in zip(records, read_moving, strict=True):
        known |= {record[k]: inner.input() for k in numbers}
    sources = [*before, *outside, *(node for record in records for node in record)]
    nodes = copied(inner, loop.graph, [loop.following[k] for k in moving], sources)
    following = sweep(inner, known, nodes)
    owners = [
        next(iter(others[owner].values()))
        for owner, numbers in zip(read, read_moving, strict=True)
        if numbers
    ]
    reads = [index, *read, *(g.args[item][0] for item in owners)]
    begin = [tangents.get(state[k], g.constant(0.0)) for k in moving]
    args = [*begin, *captured, *(tangents[captured[k]] for k in moved)]
    return dict(zip(moving, _add(g, inner, following, loop, args, reads, loop.is_backward), strict=True))


def reverse_loop(
    g: Graph, index: int, cotangents: Mapping[int, int], reached: Iterable[int], sweep: Sweep
) -> list[tuple[int, int]]:
    """Adds the loop of the cotangents of a loop's arguments.

    Args:
        g: The graph, which takes the new loop.
        index: The LOOP node.
        cotangents: Nodes of the cotangents of the final state, by number of the state.
        reached: The nodes that depend on what the derivative is taken by.
        sweep: The reverse sweep: graph, pairs of a node and its cotangent, inputs; returns nodes of the cotangents of
            the inputs.

    Returns:
        Arguments of the loop, and the nodes of what they add to their cotangents.

    Raises:
        TraceError: If the loop repeats another: it belongs to a derivative.
    """
    loop, reached = g.data[index], set(reached)
    if loop.reads:
        raise TraceError(
            "Reverse derivatives of derivatives through a loop are not offered. Take the second derivative forward: "
            "hessian, hvp, or jvp of vjp."
        )
    state, captured, _ = _arguments(loop, g.args[index])
    chosen = [k for k, node in enumerate(captured) if node in reached]
    fixed = {loop.graph.inputs[loop.size + k] for k in chosen}
    moving = _moving(loop, [k for k, node in enumerate(state) if node in reached], fixed)
    inner = Graph(relaxed=g.relaxed, parent=g)
    bars, sums = [inner.input() for _ in moving], [inner.input() for _ in chosen]
    outside, before = [inner.input() for _ in captured], [inner.input() for _ in state]
    nodes = copied(inner, loop.graph, [loop.following[k] for k in moving], [*before, *outside])
    wanted = [*(before[k] for k in moving), *(outside[k] for k in chosen)]
    swept = sweep(inner, list(zip(nodes, bars, strict=True)), wanted)
    totals = [inner.node(Op.ADD, a, b) for a, b in zip(sums, swept[len(moving) :], strict=True)]
    zero = g.constant(0.0)
    args = [*(cotangents.get(k, zero) for k in moving), *(zero for _ in chosen), *captured]
    items = _add(g, inner, [*swept[: len(moving)], *totals], loop, args, [index], not loop.is_backward)
    return list(zip([*(state[k] for k in moving), *(captured[k] for k in chosen)], items, strict=True))


def _arguments(loop: Loop, args: Sequence[int]) -> tuple[Sequence[int], Sequence[int], Sequence[int]]:
    """The arguments of a loop: its initial state, what it captures, the loops it reads."""
    plain = len(args) - loop.reads
    return args[: loop.size], args[loop.size : plain], args[plain:]


def _record_starts(g: Graph, loop: Loop, read: Sequence[int]) -> list[int]:
    """For each loop that is read, the number of the input that its record begins at."""
    sizes = [g.data[owner].size for owner in read]
    return [len(loop.graph.inputs) - sum(sizes[k:]) for k in range(len(sizes))]


def _moving(loop: Loop, begin: Iterable[int], fixed: Iterable[int]) -> list[int]:
    """The numbers of the state that depend on those of `begin` or on the inputs `fixed`, after any iteration."""
    g, moving = loop.graph, set(begin)
    order = g.live(loop.following)
    while True:
        reached = set(fixed) | {g.inputs[k] for k in moving}
        for index in order:
            if any(a in reached for a in g.args[index]):
                reached.add(index)
        more = moving | {k for k, node in enumerate(loop.following) if node in reached}
        if more == moving:
            return sorted(moving)
        moving = more


def _add(
    g: Graph,
    inner: Graph,
    following: Sequence[int],
    loop: Loop,
    args: Sequence[int],
    reads: Sequence[int],
    is_backward: bool,
) -> list[int]:
    """Adds a loop that repeats the iterations of `loop`, and has the records of `reads` kept."""
    for owner in reads:
        read = g.data[owner]
        if read.limit > _longest(read.size):
            most = _longest(len(read.graph.inputs)) ** 3
            raise TraceError(
                f"Derivatives through a loop of up to {read.limit} iterations over {read.size} numbers are not "
                "offered: the states of all iterations would have to be kept. Give the loop the smallest `limit` that "
                f"suffices (at most {most}), or differentiate what the loop solves (implicit function "
                "theorem)."
            )
        g.data[owner] = replace(read, is_recorded=True)
    made = Loop(
        inner,
        len(following),
        inner.truth(True),
        tuple(following),
        loop.limit,
        is_backward=is_backward,
        reads=len(reads),
    )
    return g.loop(made, [*args, *reads])
