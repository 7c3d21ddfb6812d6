"""Forward and reverse sweeps over a graph, with the partial derivatives of the table of operations.

Sweeps add derivatives to a copy of the function's graph, so that equal parts of value and derivatives are one node. A
`where` passes the derivative of the branch that is taken, whatever the other one is.
Reference: Griewank and Walther 2008, chapters 3.1 and 3.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna.compiler.language.cotangents import Cotangents
from ulna.compiler.language.custom_vjp import add_by_rule, rules_by_first_value
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.loop_derivatives import LONG_TAPE, copied, forward_loop, reverse_loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.scalar import Condition, Scalar, index_in
from ulna.errors import TraceError


def copy_of(
    graph: Graph, results: Sequence[int], tape: int = LONG_TAPE
) -> tuple[Graph, list[int], list[int]]:
    """A graph that sweeps may add derivatives to.

    Args:
        graph: The graph of a function; it stays as it is.
        results: The nodes of its results.
        tape: The largest number of numbers on the tape of a loop.

    Returns:
        A copy with all inputs, the nodes of its inputs, and those of `results`.
    """
    g = Graph(relaxed=graph.relaxed, lanes=graph.lanes)
    primals = [g.input() for _ in graph.inputs]
    return g, primals, copied(g, graph, results, primals, tape)


def forward(g: Graph, tangents: dict[int, int], outputs: Sequence[int]) -> list[int]:
    """One sweep that adds the tangents of `outputs` to a graph.

    Args:
        g: The graph, which takes the new nodes.
        tangents: For nodes x their tangents; every other input has none.
        outputs: Nodes.

    Returns:
        The nodes of the tangents of `outputs`.
    """
    d: dict[int, Scalar] = {x: Scalar(g, t) for x, t in tangents.items()}
    loop_tangents: dict[int, dict[int, int]] = {}  # tangents of the states of loops
    for index in g.live(outputs):
        if index in d or g.op[index] in (Op.INPUT, Op.CONST, Op.BOOL, Op.LANE):
            continue
        if g.op[index] == Op.LOOP:
            made = forward_loop(g, index, {x: t.index for x, t in d.items()}, loop_tangents, forward)
            if made:
                loop_tangents[index] = made
            continue
        if g.op[index] == Op.ITEM:
            item = loop_tangents.get(g.args[index][0], {}).get(g.data[index])
            if item is not None:
                d[index] = Scalar(g, item)
            continue
        if not any(a in d for a in g.args[index]):
            continue
        if g.op[index] == Op.SELECT:
            c, a, b = g.args[index]
            da, db = (index_in(g, d.get(x, 0.0)) for x in (a, b))
            d[index] = Scalar(g, g.node(Op.SELECT, c, da, db))
            continue
        total: Any = 0.0
        for position, a in enumerate(g.args[index]):
            if a in d:
                partial = _partial(g, index, position)
                if partial is not None:
                    total = d[a] * partial + total
        if isinstance(total, Scalar):
            d[index] = total
    return [index_in(g, d.get(o, 0.0)) for o in outputs]


def reverse(g: Graph, seeds: Sequence[tuple[Any, ...]], inputs: Sequence[int]) -> list[int]:
    """One sweep that adds the cotangents of `inputs` to a graph.

    Args:
        g: The graph, which takes the new nodes.
        seeds: Pairs of an output and its cotangent, or triples with the condition under which that counts.
        inputs: Nodes.

    Returns:
        The nodes of the cotangents of `inputs`.
    """
    order, cotangents = g.live([y for y, *_ in seeds]), Cotangents(g)
    for y, seed, *condition in seeds:
        cotangents.add(y, Scalar(g, seed), *(condition or [None]))
    reached = set(inputs)
    for index in order:  # only nodes that depend on the inputs carry a cotangent
        if any(a in reached for a in g.args[index]):
            reached.add(index)
    rules = rules_by_first_value(g, order)
    by_rule = {y for rule in rules.values() for y in rule.outputs}
    loop_cotangents: dict[int, dict[int, Any]] = {}  # cotangents of the final states of loops
    for index in reversed(order):
        if index in rules:
            add_by_rule(g, rules[index], cotangents, reached)
        if index in loop_cotangents:
            for a, item, condition in reverse_loop(g, index, loop_cotangents[index], reached, reverse):
                cotangents.add(a, Scalar(g, item), condition)
        if index in by_rule or index not in cotangents or index not in reached or g.op[index] == Op.INPUT:
            continue
        if g.op[index] == Op.ITEM:
            loop_cotangents.setdefault(g.args[index][0], {})[g.data[index]] = cotangents[index]
        else:
            _add_to_arguments(g, index, cotangents, reached)
    return [cotangents.total(x) for x in inputs]


def _add_to_arguments(g: Graph, index: int, cotangents: Cotangents, reached: set[int]) -> None:
    """Adds the cotangent of a node, times its partial derivatives, to those of its arguments."""
    value, condition = cotangents[index]
    if g.op[index] == Op.SELECT:
        c, a, b = g.args[index]
        here = Condition(g, c)
        for x, side in ((a, here), (b, ~here)):
            if x in reached:
                cotangents.add(x, value, side if condition is None else condition & side)
        return
    if g.op[index] == Op.DIV and g.args[index][1] in reached:  # one division for both sides
        a, b = g.args[index]
        share = value / Scalar(g, b)
        if a in reached:
            cotangents.add(a, share, condition)
        cotangents.add(b, -(share * Scalar(g, index)), condition)
        return
    for position, a in enumerate(g.args[index]):
        if a in reached:
            partial = _partial(g, index, position)
            if partial is not None:
                cotangents.add(a, value * partial, condition)


def _partial(g: Graph, index: int, position: int) -> Any:
    row = TABLE[g.op[index]]
    if row.op in (Op.ANY, Op.LEAST):
        raise TraceError("Derivatives of reductions across lanes are not offered.")
    rule = row.partials[position]
    if rule is None:
        return None
    result = Scalar(g, index)
    partial = rule(*(Scalar(g, a) for a in g.args[index]), result)
    if row.op == Op.SQRT and _is_sum_of_squares(g, g.args[index][0]):
        return (result == 0.0)._where_(0.0, partial)  # a norm at zero: the subgradient of least norm
    return partial


def _is_sum_of_squares(g: Graph, index: int) -> bool:
    """Whether a node is the square of another, or a sum of such squares."""
    waiting = [index]
    while waiting:
        op, args = g.op[waiting[-1]], g.args[waiting.pop()]
        if op == Op.ADD:
            waiting += args
        elif op != Op.MUL or args[0] != args[1]:
            return False
    return True
