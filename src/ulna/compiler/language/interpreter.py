"""Evaluates a graph: one traversal for numbers, for another graph and for symbols (`methods/symbols.py`).

The evaluation on numbers is the reference that compiled code is tested against.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.vjp_rule import of_live_values


def evaluate(
    graph: Graph,
    inputs: Sequence[Any],
    outputs: Sequence[int],
    *,
    operation: Callable[[int, list[Any]], Any],
    loop: Callable[[Loop, list[Any]], Sequence[Any]],
    lane: Callable[[int], Any],
    constant: Callable[[Any], Any] = lambda value: value,
) -> list[Any]:
    """The values of the nodes `outputs` where input number k is `inputs[k]`.

    Args:
        graph: The graph.
        inputs: The values of the inputs, of any kind.
        outputs: The nodes to evaluate.
        operation: The result of an operation on values.
        loop: The results of a loop on the values of its state and of what it captures.
        lane: The value of the lane's number, given the number of lanes.
        constant: The value of a number or truth value.

    Returns:
        The values in the order of `outputs`.
    """
    values: dict[int, Any] = {}
    for index in graph.live(outputs):
        op, args, data = graph.op[index], graph.args[index], graph.data[index]
        if op == Op.INPUT:
            values[index] = inputs[data]
        elif op in (Op.CONST, Op.BOOL):
            values[index] = constant(data)
        elif op == Op.LANE:
            values[index] = lane(data)
        elif op == Op.LOOP:
            values[index] = loop(data, [values[a] for a in args])
        elif op == Op.ITEM:
            values[index] = values[args[0]][data]
        else:
            values[index] = operation(op, [values[a] for a in args])
    return [values[o] for o in outputs]


def interpret(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int]) -> list[Any]:
    """The values of the nodes `outputs` on floats or arrays of one shape, by NumPy.

    Args:
        graph: The graph.
        inputs: The values of the inputs: numbers or arrays (...), all of one shape.
        outputs: The nodes to evaluate.

    Returns:
        The values in the order of `outputs`, numbers or arrays (...).
    """
    with np.errstate(all="ignore"):
        return evaluate(
            graph, inputs, outputs, operation=_by_numpy, loop=_iterate, lane=lambda n: np.arange(float(n))
        )


def copy_into(
    target: Graph,
    source: Graph,
    nodes: Sequence[int],
    inputs: Sequence[int],
    copy_loop: Callable[[Graph, Loop, list[int]], list[int]] = Graph.loop,
) -> list[int]:
    """Rebuilds `nodes` of `source` in `target`, with the nodes `inputs` of `target` as its inputs.

    Args:
        target: The graph to write to.
        source: The graph to copy from.
        nodes: Nodes of `source`.
        inputs: For each input of `source` the node of `target` that takes its place.
        copy_loop: Adds a loop to the target, given its arguments; returns the nodes of its final state.

    Returns:
        The nodes of `target` that equal `nodes`.
    """

    def constant(value: float | bool) -> int:
        return target.truth(value) if isinstance(value, bool) else target.constant(value)

    def node(op: int, args: Sequence[int]) -> int:
        return target.node(op, *args)

    def loop(data: Loop, args: Sequence[Any]) -> list[int]:
        plain = len(args) - data.reads  # the other values are the states of the loops that it reads
        return copy_loop(target, data, [*args[:plain], *(target.args[items[0]][0] for items in args[plain:])])

    rules = of_live_values(source.rules, source.live(nodes) if source.rules else ())
    wanted = [*nodes, *(x for rule in rules for x in (*rule.inputs, *rule.outputs))]
    made = evaluate(source, inputs, wanted, operation=node, loop=loop, lane=target.lane, constant=constant)
    moved = iter(made[len(nodes) :])
    target.rules += [rule.moved([next(moved) for _ in (*rule.inputs, *rule.outputs)]) for rule in rules]
    return made[: len(nodes)]


def _by_numpy(op: int, args: Sequence[Any]) -> Any:
    function = TABLE[op].numpy
    assert function is not None
    return function(*args)


class _LoopStates(list[Any]):
    """The final state of a loop, and for each iteration which elements took part and what its tape has."""

    tape: Sequence[tuple[Any, Sequence[Any]]] = ()


def _iterate(loop: Loop, values: Sequence[Any]) -> list[Any]:
    """Every element iterates until its own condition fails, and then keeps its state."""
    if loop.reads:
        return _repeat(loop, values[: -loop.reads], values[-loop.reads :])
    shape = np.broadcast_shapes(*(np.shape(v) for v in values))
    state = [np.broadcast_to(v, shape).astype(float) for v in values[: loop.size]]
    captured, tape = values[loop.size :], []
    active = np.ones(shape, dtype=bool)
    for _ in range(loop.limit):
        holds, *following = interpret(loop.graph, [*state, *captured], [loop.condition, *loop.following])
        active = active & holds
        if not active.any():
            break
        if loop.is_taped:
            tape.append((active, [*state, *following[loop.size :]]))
        state = [np.where(active, new, old) for new, old in zip(following, state, strict=False)]
    return _with_tape(state, tape)


def _repeat(loop: Loop, values: Sequence[Any], read: Sequence[_LoopStates]) -> list[Any]:
    """The iterations of the first loop that is read, with the states of all of them."""
    rounds = len(read[0].tape)
    shape = np.broadcast_shapes(*map(np.shape, values), *(np.shape(active) for active, _ in read[0].tape[:1]))
    state = [np.broadcast_to(v, shape).astype(float) for v in values[: loop.size]]
    tape: list[Any] = [None] * rounds
    for k in reversed(range(rounds)) if loop.is_backward else range(rounds):
        active = read[0].tape[k][0]
        tape[k] = active, state
        states = [number for states in read for number in states.tape[k][1]]
        following = interpret(loop.graph, [*state, *values[loop.size :], *states], loop.following)
        state = [np.where(active, new, old) for new, old in zip(following, state, strict=True)]
    return _with_tape(state, tape)


def _with_tape(state: Sequence[Any], tape: Sequence[Any]) -> _LoopStates:
    states = _LoopStates(state)
    states.tape = tape
    return states
