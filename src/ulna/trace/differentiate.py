"""Forward and reverse derivatives, from graph to graph, with the partials of the table of operations.

Both sweeps work on a copy of the function's graph, so shared subexpressions of value and derivative are computed
once. A `where` passes the derivative of the branch that is taken, whatever the other one is.
Reference: Griewank and Walther 2008, chapters 3.1 and 3.2.
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
    ports = (*f.inputs, *_named("d_", f.inputs, f.inputs))
    return Function(f"{f.name}_jvp", g, ports, f.outputs, tuple(d), f.single)


def vjp(f: Function) -> Function:
    """Cotangents of the inputs from the inputs and the cotangents of the outputs, `bar_<name>` for each."""
    g, primals, results = _copy(f)
    seeds = [g.input() for _ in results]
    bars = _reverse(g, list(zip(results, seeds, strict=True)), primals)
    ports = (*f.inputs, *_named("bar_", f.outputs, f.inputs))
    outputs = _named("bar_", f.inputs)
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


def _named(prefix: str, ports: Sequence[Port], beside: Sequence[Port] = ()) -> tuple[Port, ...]:
    """The ports with `prefix` before their names, once more where a port of `beside` has that name."""
    taken, named = {p.name for p in beside}, []
    for port in ports:
        name = prefix + port.name
        while name in taken:
            name = prefix + name
        taken.add(name)
        named.append(Port(name, port.shape))
    return tuple(named)


def _copy(f: Function) -> tuple[Graph, list[int], list[int]]:
    g = Graph(relaxed=f.graph.relaxed)
    primals = [g.input() for p in f.inputs for _ in range(p.size)]
    return g, primals, copy_into(g, f.graph, f.results, primals)


def _forward(g: Graph, tangents: dict[int, int], outputs: Sequence[int]) -> list[int]:
    """Tangents of `outputs` where node x has tangent `tangents[x]` and every other input has none."""
    d: dict[int, Scalar] = {x: Scalar(g, t) for x, t in tangents.items()}
    for index in g.live(outputs):
        if index in d or g.op[index] in (Op.INPUT, Op.CONST, Op.BOOL, Op.LANE):
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
    """Cotangents of `inputs` where output y has cotangent `seed`.

    A cotangent that came through one side of a `where` carries the condition and is set to zero only where it meets
    others: multiplied as zero by the partials of the side not taken it could become nan, which are inf or nan there.
    """
    bar: dict[int, tuple[Any, Condition | None]] = {}

    def held(value: Any, condition: Condition | None) -> Any:
        return value if condition is None else condition._where_(value, 0.0)

    def accumulate(index: int, value: Any, condition: Condition | None) -> None:
        if index not in bar:
            bar[index] = value, condition
            return
        other, its_condition = bar[index]
        if _same(condition, its_condition):
            bar[index] = other + value, condition
            return
        either = None if condition is None or its_condition is None else its_condition | condition
        if either is not None and g.op[either.index] == Op.BOOL:  # c or not c
            either = None
        bar[index] = held(other, its_condition) + held(value, condition), either

    order = g.live([y for y, _ in seeds])
    for y, seed in seeds:
        accumulate(y, Scalar(g, seed), None)
    reached = set(inputs)
    for index in order:  # only nodes that depend on the inputs carry a cotangent
        if any(a in reached for a in g.args[index]):
            reached.add(index)
    for index in reversed(order):
        if index not in bar or index not in reached or g.op[index] == Op.INPUT:
            continue
        value, condition = bar[index]
        if g.op[index] == Op.SELECT:
            c, a, b = g.args[index]
            here = Condition(g, c)
            for x, side in ((a, here), (b, ~here)):
                if x in reached:
                    accumulate(x, value, side if condition is None else condition & side)
            continue
        for position, a in enumerate(g.args[index]):
            if a in reached:
                partial = _partial(g, index, position)
                if partial is not None:
                    accumulate(a, value * partial, condition)
    return [index_in(g, held(*bar[x]) if x in bar else 0.0) for x in inputs]


def _same(a: Condition | None, b: Condition | None) -> bool:
    return a is b if a is None or b is None else a.index == b.index


def _partial(g: Graph, index: int, position: int) -> Any:
    row = TABLE[g.op[index]]
    if row.op in (Op.LOOP, Op.ITEM):
        raise TraceError(
            "Derivatives through a loop are not offered. Differentiate what the loop solves (implicit function "
            "theorem), or unroll it with a Python `for`."
        )
    if row.op in (Op.ANY, Op.LEAST):
        raise TraceError("Derivatives across the lanes of a race are not offered.")
    rule = row.partials[position]
    return None if rule is None else rule(*(Scalar(g, a) for a in g.args[index]), Scalar(g, index))
