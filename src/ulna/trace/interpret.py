"""Evaluates a graph with NumPy, batched: the judge of every other file of the compiler."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.trace.graph import Graph, Loop
from ulna.trace.ops import TABLE, Op


def interpret(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int]) -> list[Any]:
    """The values of the nodes `outputs` where input number k is `inputs[k]`, numbers or arrays of one shape."""
    values: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for index in graph.live(outputs):
            op, args, data = graph.op[index], graph.args[index], graph.data[index]
            if op == Op.INPUT:
                values[index] = inputs[data]
            elif op in (Op.CONST, Op.BOOL):
                values[index] = data
            elif op == Op.LANE:
                values[index] = np.arange(float(data))
            elif op == Op.LOOP:
                values[index] = _iterate(data, [values[a] for a in args])
            elif op == Op.ITEM:
                values[index] = values[args[0]][data]
            else:
                function = TABLE[op].numpy
                assert function is not None
                values[index] = function(*(values[a] for a in args))
    return [values[o] for o in outputs]


def _iterate(loop: Loop, values: list[Any]) -> list[Any]:
    """Every lane iterates until its own condition fails; a lane that is done keeps its state."""
    shape = np.broadcast_shapes(*(np.shape(v) for v in values))
    state = [np.broadcast_to(v, shape).astype(float) for v in values[: loop.size]]
    captured = values[loop.size :]
    active = np.ones(shape, dtype=bool)
    for _ in range(loop.limit):
        # The condition first, so that the body's result is used only where it holds.
        holds, *following = interpret(loop.graph, [*state, *captured], [loop.condition, *loop.following])
        active = active & holds
        if not active.any():
            break
        state = [np.where(active, new, old) for new, old in zip(following, state, strict=True)]
    return state
