"""Instruction scheduling for low register pressure: an order of evaluation in which few values are live at a time."""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.codegen.scheduling import Sines, Step, made, parts, stores, used
from ulna.compiler.language.function import Function
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op


def low_pressure_steps(f: Function) -> list[Step]:
    """The steps that evaluate one sample of `f`: those of the trace or those on demand, which have fewer live values.

    Args:
        f: The function.

    Returns:
        The steps; an input may be among them more than once.
    """
    traced = [step for part in parts(f, 1, 1) for step in part]
    return min(traced, _on_demand(f), key=lambda steps: register_pressure(f.graph, steps))


def register_pressure(graph: Graph, steps: Sequence[Step]) -> int:
    """The greatest number of values that are live at once; constants need no register.

    Args:
        graph: The graph that is evaluated.
        steps: The steps, in the order in which they are written.

    Returns:
        The number of values.
    """
    last = {index: k for k, step in enumerate(steps) for index in used(graph, step)}
    live: set[int] = set()
    most = 0
    for k, step in enumerate(steps):
        live.update(
            index
            for index in made(graph, step)
            if last.get(index, -1) > k and graph.op[index] not in (Op.CONST, Op.BOOL)
        )
        most = max(most, len(live))
        live.difference_update(index for index in used(graph, step) if last[index] == k)
    return most


def _on_demand(f: Function) -> list[Step]:
    """Each node just before it is first used, each result as soon as it is known.

    Of the arguments of a node, the one that needs most registers comes first [Sethi & Ullman 1970, The generation of
    optimal code for arithmetic expressions]; their count for trees is taken for graphs.
    """
    g = f.graph
    registers: dict[int, int] = {}
    first: dict[int, list[int]] = {}
    for index in g.live(f.results):
        first[index] = sorted(g.args[index], key=registers.__getitem__, reverse=True)
        least = 0 if g.op[index] in (Op.CONST, Op.BOOL) else 1
        registers[index] = max([least, *(registers[a] + k for k, a in enumerate(first[index]))])
    done: set[int] = set()
    order: list[Step] = []
    for store in stores(f, 1):
        for value in store.values:
            _demand(g, first, value, done, order)
        order.append(store)
    return order


def _demand(
    g: Graph, arguments: dict[int, list[int]], wanted: int, done: set[int], order: list[Step]
) -> None:
    """Appends what a node still needs, depth first, then the node."""
    waiting = [(wanted, False)]
    while waiting:
        index, is_ready = waiting.pop()
        if index in done:
            continue
        if not is_ready:
            waiting.append((index, True))
            waiting += [(a, False) for a in reversed(arguments[index]) if a not in done]
            continue
        step: Step = Sines(g.args[index]) if g.op[index] in (Op.SIN, Op.COS) else index
        order.append(step)
        done.update(made(g, step))
