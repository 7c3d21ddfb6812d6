"""Derivatives of loops: loops that repeat the iterations at the states on a tape.

The loop stores the state before each iteration on its tape. Tangents repeat the iterations in order, cotangents repeat
them backwards; each iteration evaluates the derivative of the body at a state of the tape. The tape of cotangents has
other values of the iteration as well, where a load is cheaper than computing them again. The number of iterations
counts as constant. A loop whose tape would be too long becomes a loop of shorter loops, with checkpoints between them
from which their iterations are computed again [Griewank & Walther 2008, section 12.1].
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial, reduce
from math import isqrt
from typing import Any

from ulna.compiler.language.cotangents import either
from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.interpreter import copy_into
from ulna.compiler.language.kept_values import values_to_keep
from ulna.compiler.language.ops import Op
from ulna.compiler.language.scalar import Condition, index_in
from ulna.errors import TraceError

SHORT_TAPE = 4096
"""The largest number of numbers on the tape of a loop, for each lane, where there may be many tapes (on the stack)."""
LONG_TAPE = 28672
"""The same where there are few, and with other values of the iterations."""

Cotangent = tuple[Any, Condition | None]
Sweep = Callable[..., list[int]]


def copied(
    target: Graph, source: Graph, nodes: Sequence[int], inputs: Sequence[int], tape: int = SHORT_TAPE
) -> list[int]:
    """Rebuilds nodes of a graph as `copy_into` does, with checkpoints in loops whose tape would be too long.

    Args:
        target: The graph to write to.
        source: The graph to copy from.
        nodes: Nodes of `source`.
        inputs: For each input of `source` the node of `target` that takes its place.
        tape: The largest number of numbers on the tape of a loop.

    Returns:
        The nodes of `target` that equal `nodes`.
    """
    return copy_into(target, source, nodes, inputs, partial(_with_checkpoints, tape=tape))


def _max_iterations(numbers: int, tape: int = LONG_TAPE) -> int:
    """The number of iterations that fit on a tape, with so many numbers for each."""
    return max(tape // numbers, 2)


def _with_checkpoints(target: Graph, loop: Loop, args: list[int], tape: int) -> list[int]:
    """Adds a loop, as a loop of loops if it is too long for a tape, but not for those of three nested loops."""
    # As many numbers as its cotangents have, which are on a tape for second derivatives.
    longest = _max_iterations(len(args), tape)
    if loop.reads or loop.is_taped or not longest < loop.limit <= longest**3:
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
    g: Graph, index: int, tangents: Mapping[int, int], of_loops: Mapping[int, Mapping[int, int]], sweep: Sweep
) -> dict[int, int]:
    """Adds the loop of the tangents of a loop's state.

    Args:
        g: The graph, which takes the new loop.
        index: The LOOP node.
        tangents: Nodes of the tangents of nodes that have one.
        of_loops: For loops before this one, the tangents of their states by number.
        sweep: The forward sweep: graph, tangents by node, outputs; returns nodes of the tangents of the outputs.

    Returns:
        The nodes of the tangents of the final state, by number of the state.
    """
    loop = g.data[index].plain or g.data[index]  # `plain` reads only states from tapes: it has derivatives
    state, captured, read = _arguments(loop, g.args[index])
    active_reads = [sorted(of_loops.get(owner, ())) for owner in read]
    is_plain = g.data[index].plain is not None
    lengths = [g.data[owner].size if is_plain else len(g.data[owner].following) for owner in read]
    inputs = loop.graph.inputs
    starts = [len(inputs) - sum(lengths[k:]) for k in range(len(lengths))]
    active_inputs = {inputs[loop.size + k] for k, node in enumerate(captured) if node in tangents}
    for first, numbers in zip(starts, active_reads, strict=True):
        active_inputs |= {inputs[first + k] for k in numbers}
    active = _active_states(loop, [k for k, node in enumerate(state) if node in tangents], active_inputs)
    if not active:
        return {}
    inner = Graph(relaxed=g.relaxed, parent=g)
    state_tangents = [inner.input() for _ in active]
    outside = [inner.input() for _ in captured]
    captured_tangents = {k: inner.input() for k, node in enumerate(captured) if node in tangents}
    before, *tapes = (_tape(g, owner, inner) for owner in (index, *read))
    known = dict(zip((before[k] for k in active), state_tangents, strict=True)) | {
        outside[k]: t for k, t in captured_tangents.items()
    }
    for tape, numbers in zip(tapes, active_reads, strict=True):
        known |= {tape[k]: inner.input() for k in numbers}
    states = (tape[:length] for tape, length in zip(tapes, lengths, strict=True))
    sources = [*before[: loop.size], *outside, *(node for tape in states for node in tape)]
    nodes = copied(inner, loop.graph, [loop.following[k] for k in active], sources)
    following = sweep(inner, known, nodes)
    owners = [
        next(iter(of_loops[owner].values()))
        for owner, numbers in zip(read, active_reads, strict=True)
        if numbers
    ]
    reads = [index, *read, *(g.args[item][0] for item in owners)]
    begin = [tangents.get(state[k], g.constant(0.0)) for k in active]
    args = [*begin, *captured, *(tangents[captured[k]] for k in captured_tangents)]
    made = _loop(inner, following, loop, len(reads), loop.is_backward)
    return dict(zip(active, _add(g, made, args, reads), strict=True))


def reverse_loop(
    g: Graph, index: int, cotangents: Mapping[int, Cotangent], reached: Iterable[int], sweep: Sweep
) -> list[tuple[int, int, Condition | None]]:
    """Adds the loop of the cotangents of a loop's arguments.

    Args:
        g: The graph, which takes the new loop.
        index: The LOOP node.
        cotangents: Cotangents of the final state, by number of the state, and where they count (None: everywhere).
        reached: The nodes that depend on what the derivative is taken by.
        sweep: The reverse sweep: graph, triples of a node, its cotangent and where it counts, inputs; returns nodes
            of the cotangents of the inputs.

    Returns:
        Arguments of the loop, the nodes of what they add to their cotangents, and where these count.

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
    active_inputs = {loop.graph.inputs[loop.size + k] for k in chosen}
    depends = _active_states(loop, [k for k, node in enumerate(state) if node in reached], active_inputs)
    counts = _where_states_count(loop, {k: condition for k, (_, condition) in cotangents.items()})
    active = [k for k in depends if k in counts]
    conditions = list({_key(counts[k]): counts[k] for k in active}.values())
    inner = Graph(relaxed=g.relaxed, parent=g)
    state_cotangents = [inner.input() for _ in active]
    captured_cotangents = [inner.input() for _ in chosen]  # those of the iterations so far
    outside = [inner.input() for _ in captured]
    masks = [c.index for c in conditions if c is not None] if len(conditions) > 1 else []
    masks_inside = {index: Condition(inner, inner.input()) for index in masks}
    before = [inner.input() for _ in state]
    source = loop.graph.live([loop.following[k] for k in active])
    values = dict(zip(source, copied(inner, loop.graph, source, [*before, *outside]), strict=True))
    nodes = [values[loop.following[k]] for k in active]
    where = [masks_inside.get(_key(counts[k])) for k in active]
    wanted = [*(before[k] for k in active), *(outside[k] for k in chosen)]
    swept = sweep(inner, list(zip(nodes, state_cotangents, where, strict=True)), wanted)
    sums = zip(captured_cotangents, swept[len(active) :], strict=True)
    following = [*swept[: len(active)], *(inner.node(Op.ADD, a, b) for a, b in sums)]
    zero = g.constant(0.0)
    begin = [_total(g, *cotangents[k]) if k in cotangents else zero for k in active]
    made = _backward(g, index, inner, values, following)
    items = _add(g, made, [*begin, *(zero for _ in chosen), *captured, *masks], [index])
    anywhere = reduce(either, conditions) if conditions else None
    where_items = [*(counts[k] for k in active), *(anywhere for _ in chosen)]
    nodes = [*(state[k] for k in active), *(captured[k] for k in chosen)]
    return list(zip(nodes, items, where_items, strict=True))


def _backward(
    g: Graph, index: int, inner: Graph, values: Mapping[int, int], following: Sequence[int]
) -> Loop:
    """The loop of the cotangents, with other values on the tape of the loop where these are cheaper to read."""
    loop = g.data[index]
    taped = _tape_values(g, index, inner, values, following)
    made = _loop(inner, following, loop, 1, not loop.is_backward)
    if not taped:
        return made
    reading, following = _as_inputs(inner, following, taped)
    return replace(_loop(reading, following, loop, 1, not loop.is_backward), plain=made)


def _where_states_count(loop: Loop, ends: Mapping[int, Condition | None]) -> dict[int, Condition | None]:
    """Where the cotangents of the states count, after any iteration, given that of final states.

    A state on which none of these depends has no cotangent: as zero, multiplied by partials that are infinite, it could
    become nan.
    """
    g, following = loop.graph, loop.following[: loop.size]
    reads = dict.fromkeys(g.live(following), 0)  # for nodes the states that they depend on, one bit each
    for index in reads:
        for a in g.args[index]:
            reads[index] |= reads[a]
        if g.op[index] == Op.INPUT and g.data[index] < loop.size:
            reads[index] = 1 << g.data[index]
    found: dict[int, dict[int, Condition | None]] = {k: {_key(c): c} for k, c in ends.items()}
    waiting = list(found)
    while waiting:
        k = waiting.pop()
        for j in range(loop.size):
            if reads[following[k]] >> j & 1 and not found[k].keys() <= found.setdefault(j, {}).keys():
                found[j] |= found[k]
                waiting.append(j)
    return {k: reduce(either, conditions.values()) for k, conditions in found.items()}


def _key(condition: Condition | None) -> int:
    return -1 if condition is None else condition.index


def _total(g: Graph, value: Any, condition: Condition | None) -> int:
    """The node of a cotangent that is zero where it does not count."""
    return index_in(g, value if condition is None else condition._where_(value, 0.0))


def _arguments(loop: Loop, args: Sequence[int]) -> tuple[Sequence[int], Sequence[int], Sequence[int]]:
    """The arguments of a loop: its initial state, what it captures, the loops it reads."""
    plain = len(args) - loop.reads
    return args[: loop.size], args[loop.size : plain], args[plain:]


def _active_states(loop: Loop, begin: Iterable[int], inputs: Iterable[int]) -> list[int]:
    """The numbers of the state that depend on those of `begin` or on `inputs` of the body, after any iteration."""
    g, active, following = loop.graph, set(begin), loop.following[: loop.size]
    order = g.live(following)
    while True:
        reached = set(inputs) | {g.inputs[k] for k in active}
        for index in order:
            if any(a in reached for a in g.args[index]):
                reached.add(index)
        more = active | {k for k, node in enumerate(following) if node in reached}
        if more == active:
            return sorted(active)
        active = more


def _tape(g: Graph, owner: int, inner: Graph) -> list[int]:
    """New inputs of `inner` for what the tape of a loop has for an iteration: its state, then other values."""
    return [inner.input() for _ in g.data[owner].following]


def _tape_values(
    g: Graph, index: int, inner: Graph, values: Mapping[int, int], following: Sequence[int]
) -> list[int]:
    """Puts values of a loop on its tape that `inner`, its derivative, reads; the first derivative chooses them.

    Args:
        g: The graph.
        index: The LOOP node.
        inner: A graph.
        values: For nodes of the loop's body those of `inner` that equal them.
        following: What `inner` computes.

    Returns:
        The nodes of `inner` that are on the tape, in its order.
    """
    loop = g.data[index]
    if not loop.is_taped:
        nodes = {node: k for k, node in values.items() if loop.graph.op[k] != Op.LOOP}
        most = LONG_TAPE // loop.limit - loop.size
        chosen = values_to_keep(inner, nodes, following, most)
        g.data[index] = loop = replace(loop, following=(*loop.following, *(nodes[node] for node in chosen)))
    return [values[k] for k in loop.following[loop.size :]]


def _as_inputs(inner: Graph, following: Sequence[int], taped: Sequence[int]) -> tuple[Graph, list[int]]:
    """A graph that computes the same, with the nodes `taped` as its last inputs; and the nodes of `following`."""
    source = copy(inner)
    source.rules = []  # which would keep what only they need
    for node in taped:
        number = len(source.inputs)
        if source.op[node] not in (Op.INPUT, Op.CONST):
            source.op[node], source.args[node], source.data[node] = Op.INPUT, (), number
        source.inputs.append(node)
    made = Graph(relaxed=inner.relaxed, parent=inner.parent)
    return made, copy_into(made, source, following, [made.input() for _ in source.inputs])


def _loop(inner: Graph, following: Sequence[int], loop: Loop, reads: int, is_backward: bool) -> Loop:
    """A loop that repeats the iterations of `loop`, and computes `following`."""
    condition = inner.truth(True)
    size, limit = len(following), loop.limit
    return Loop(inner, size, condition, tuple(following), limit, is_backward=is_backward, reads=reads)


def _add(g: Graph, made: Loop, args: Sequence[int], reads: Sequence[int]) -> list[int]:
    """Adds a loop that repeats the iterations of others, and has `reads` store their tapes."""
    for owner in reads:
        read = g.data[owner]
        if read.limit > _max_iterations(read.size):
            most = _max_iterations(len(read.graph.inputs)) ** 3
            raise TraceError(
                f"Derivatives through a loop of up to {read.limit} iterations over {read.size} numbers are not "
                "offered: the states of all iterations would have to be kept. Give the loop the smallest `limit` that "
                f"suffices (at most {most}), or differentiate what the loop solves (implicit function "
                "theorem)."
            )
        g.data[owner] = replace(read, is_taped=True)
    return g.loop(made, [*args, *reads])
