"""Evaluates a graph: the one traversal, and what the operations mean for NumPy, for another graph and for SymPy.

The meaning for NumPy is the reference that the compiled code is tested against.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from ulna import numeric
from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.errors import TraceError


class Meaning(Protocol):
    """What the nodes of a graph stand for in one kind of evaluation."""

    def constant(self, value: float | bool) -> Any:
        """A number or truth value of the graph."""
        ...

    def lane(self, count: int) -> Any:
        """The number of the lane, 0 to `count` - 1."""
        ...

    def loop(self, loop: Loop, args: Sequence[Any]) -> Sequence[Any]:
        """The results of a loop on its state and captured values."""
        ...

    def operation(self, op: int, args: Sequence[Any]) -> Any:
        """The result of any other operation."""
        ...


def evaluate(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int], meaning: Meaning) -> list[Any]:
    """The values of the nodes `outputs`, where input number k is `inputs[k]`, in the given meaning."""
    values: dict[int, Any] = {}
    for index in graph.live(outputs):
        op, args, data = graph.op[index], graph.args[index], graph.data[index]
        match op:
            case Op.INPUT:
                values[index] = inputs[data]
            case Op.CONST | Op.BOOL:
                values[index] = meaning.constant(data)
            case Op.LANE:
                values[index] = meaning.lane(data)
            case Op.LOOP:
                values[index] = meaning.loop(data, [values[a] for a in args])
            case Op.ITEM:
                values[index] = values[args[0]][data]
            case _:
                values[index] = meaning.operation(op, [values[a] for a in args])
    return [values[o] for o in outputs]


def interpret(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int]) -> list[Any]:
    """The values of the nodes `outputs` where input number k is `inputs[k]`, numbers or arrays of one shape."""
    with np.errstate(all="ignore"):
        return evaluate(graph, inputs, outputs, _Numbers())


def copy_into(target: Graph, source: Graph, nodes: Sequence[int], inputs: Sequence[int]) -> list[int]:
    """Rebuilds `nodes` of `source` in `target`, with the nodes `inputs` of `target` as its inputs."""
    return evaluate(source, inputs, nodes, _Nodes(target))


def evaluate_symbols(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int]) -> list[Any]:
    """The values of the nodes `outputs` on symbols of another package, such as SymPy's."""
    return evaluate(graph, inputs, outputs, _Symbols(type(inputs[0]).__name__ if inputs else "symbols"))


class _Numbers:
    """Floats, or NumPy arrays of one shape."""

    def constant(self, value: float | bool) -> Any:
        return value

    def lane(self, count: int) -> Any:
        return np.arange(float(count))

    def loop(self, loop: Loop, args: Sequence[Any]) -> list[Any]:
        """Every element iterates until its own condition fails, and then keeps its state."""
        shape = np.broadcast_shapes(*(np.shape(v) for v in args))
        state = [np.broadcast_to(v, shape).astype(float) for v in args[: loop.size]]
        captured = args[loop.size :]
        active = np.ones(shape, dtype=bool)
        for _ in range(loop.limit):
            holds, *following = interpret(loop.graph, [*state, *captured], [loop.condition, *loop.following])
            active = active & holds
            if not active.any():
                break
            state = [np.where(active, new, old) for new, old in zip(following, state, strict=True)]
        return state

    def operation(self, op: int, args: Sequence[Any]) -> Any:
        function = TABLE[op].numpy
        assert function is not None
        return function(*args)


class _Nodes:
    """Nodes of another graph."""

    def __init__(self, target: Graph) -> None:
        self.target = target

    def constant(self, value: float | bool) -> int:
        return self.target.truth(value) if isinstance(value, bool) else self.target.constant(value)

    def lane(self, count: int) -> int:
        return self.target.lane(count)

    def loop(self, loop: Loop, args: Sequence[int]) -> list[int]:
        return self.target.loop(loop, args)

    def operation(self, op: int, args: Sequence[int]) -> int:
        return self.target.node(op, *args)


class _Symbols:
    """Objects of another package that have Python's operators, such as SymPy's expressions."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def constant(self, value: float | bool) -> Any:
        return value

    def lane(self, count: int) -> Any:
        raise TraceError(f"A function that uses the number of its lane cannot be evaluated on {self.kind}.")

    def loop(self, loop: Loop, args: Sequence[Any]) -> Sequence[Any]:
        raise TraceError(f"A function that has a loop cannot be evaluated on {self.kind}.")

    def operation(self, op: int, args: Sequence[Any]) -> Any:
        row = TABLE[op]
        assert row.numpy is not None
        if not numeric.is_symbolic(*args):
            return row.numpy(*args)
        if callable(row.symbols):
            return row.symbols(*args)
        name = row.numpy.__name__
        if op != Op.EQ and hasattr(args[0], name):
            return getattr(args[0], name)(*args[1:])
        import sympy

        return getattr(sympy, row.symbols)(*args)
