"""Forward and reverse derivatives, from graph to graph, with the partials of the table of operations.

Both sweeps work on a copy of the function's graph, so shared subexpressions of value and derivative are computed
once. A `where` passes the derivative of the branch that is taken; the other branch must still have a finite value,
as its partials may meet 0 * inf. Reference: Griewank and Walther 2008, chapters 3.1 and 3.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna.errors import TraceError, UnknownName
from ulna.trace.function import Function, Port, copy_into
from ulna.trace.graph import Graph
from ulna.trace.ops import TABLE, Op
from ulna.trace.scalar import Condition, Scalar, index_in


def jvp(f: Function) -> Function:
    """Tangents of the outputs from the inputs and their tangents, `d_<name>` for each input."""
    g, primals, results = _copy(f)
    tangents = [g.input() for _ in primals]
    d = _forward(g, dict(zip(primals, tangents, strict=True)), results)
    ports = (*f.inputs, *(Port("d_" + p.name, p.shape) for p in f.inputs))
    return Function(f"{f.name}_jvp", g, ports, f.outputs, tuple(d), f.single)


def vjp(f: Function) -> Function:
    """Cotangents of the inputs from the inputs and the cotangents of the outputs, `bar_<name>` for each."""
    g, primals, results = _copy(f)
    seeds = [g.input() for _ in results]
    bars = _reverse(g, list(zip(results, seeds, strict=True)), primals)
    ports = (*f.inputs, *(Port("bar_" + p.name, p.shape) for p in f.outputs))
    outputs = tuple(Port("bar_" + p.name, p.shape) for p in f.inputs)
    return Function(f"{f.name}_vjp", g, ports, outputs, tuple(bars), len(f.inputs) == 1)


def jacobian(f: Function, wrt: str | int = 0) -> Function:
    """Derivative of every output by one input, shape output + input.

    Takes as many forward sweeps as the input has numbers, or reverse sweeps as the outputs have, whichever is fewer;
    equal parts of the sweeps are shared by the graph.
    """
    names = [p.name for p in f.inputs]
    if isinstance(wrt, str):
        if wrt not in names:
            raise UnknownName("input", wrt, names)
        wrt = names.index(wrt)
    elif not 0 <= wrt < len(names):
        raise UnknownName("input", wrt, names)
    port = f.inputs[wrt]
    first = sum(p.size for p in f.inputs[:wrt])
    g, primals, results = _copy(f)
    chosen = primals[first : first + port.size]
    if port.size <= len(results):
        columns = [_forward(g, {x: g.constant(1.0)}, results) for x in chosen]
        entries = [columns[k][row] for row in range(len(results)) for k in range(port.size)]
    else:
        entries = [bar for y in results for bar in _reverse(g, [(y, g.constant(1.0))], chosen)]
    outputs = tuple(Port(f"d{p.name}_d{port.name}", p.shape + port.shape) for p in f.outputs)
    return Function(f"{f.name}_jacobian", g, f.inputs, outputs, tuple(entries), f.single)


def _copy(f: Function) -> tuple[Graph, list[int], list[int]]:
    g = Graph(relaxed=f.graph.relaxed)
    primals = [g.input() for p in f.inputs for _ in range(p.size)]
    return g, primals, copy_into(g, f.graph, f.results, primals)


def _forward(g: Graph, tangents: dict[int, int], outputs: Sequence[int]) -> list[int]:
    """Tangents of `outputs` where node x has tangent `tangents[x]` and every other input has none."""
    d: dict[int, Scalar] = {x: Scalar(g, t) for x, t in tangents.items()}
    for index in g.live(outputs):
        if index in d or g.op[index] in (Op.INPUT, Op.CONST, Op.BOOL):
            continue
        moving = [a for a in g.args[index] if a in d]
        if not moving:
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


def _reverse(g: Graph, seeds: Sequence[tuple[int, int]], inputs: Sequence[int]) -> list[int]:
    """Cotangents of `inputs` where output y has cotangent `seed`."""
    bar: dict[int, Any] = {}

    def accumulate(index: int, value: Any) -> None:
        bar[index] = bar[index] + value if index in bar else value

    order = g.live([y for y, _ in seeds])
    for y, seed in seeds:
        accumulate(y, Scalar(g, seed))
    reached = set(inputs)
    for index in order:  # only nodes that depend on the inputs carry a cotangent
        if any(a in reached for a in g.args[index]):
            reached.add(index)
    for index in reversed(order):
        if index not in bar or index not in reached or index in inputs:
            continue
        if g.op[index] == Op.SELECT:
            c, a, b = g.args[index]
            condition = Condition(g, c)
            if a in reached:
                accumulate(a, condition._where_(bar[index], 0.0))
            if b in reached:
                accumulate(b, condition._where_(0.0, bar[index]))
            continue
        for position, a in enumerate(g.args[index]):
            if a in reached:
                partial = _partial(g, index, position)
                if partial is not None:
                    accumulate(a, bar[index] * partial)
    return [index_in(g, bar.get(x, 0.0)) for x in inputs]


def _partial(g: Graph, index: int, position: int) -> Any:
    row = TABLE[g.op[index]]
    if row.op in (Op.LOOP, Op.ITEM):
        raise TraceError(
            "Derivatives through a loop are not offered. Differentiate what the loop solves (implicit function "
            "theorem), or unroll it with a Python `for`."
        )
    rule = row.partials[position]
    return None if rule is None else rule(*(Scalar(g, a) for a in g.args[index]), Scalar(g, index))
