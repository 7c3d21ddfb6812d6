"""Evaluates a graph on symbols of other packages, such as SymPy's expressions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna import numeric
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.interpreter import evaluate
from ulna.compiler.language.ops import TABLE, Op
from ulna.errors import TraceError


def evaluate_symbols(graph: Graph, inputs: Sequence[Any], outputs: Sequence[int]) -> list[Any]:
    """The values of the nodes `outputs` on objects of another package, such as SymPy's expressions.

    Args:
        graph: The graph.
        inputs: The values of the inputs.
        outputs: The nodes to evaluate.

    Returns:
        The values in the order of `outputs`.
    """

    def reject(*_: Any) -> Any:
        raise TraceError(
            f"A function that has a loop cannot be evaluated on {type(inputs[0]).__name__}; expected numbers."
        )

    return evaluate(graph, inputs, outputs, operation=_by_symbols, loop=reject, lane=reject)


def _by_symbols(op: int, args: Sequence[Any]) -> Any:
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
