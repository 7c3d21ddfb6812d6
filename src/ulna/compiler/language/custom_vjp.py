"""Values with a reverse derivative in closed form, which is shorter than the sweep over their nodes.

A reverse sweep that comes to such values takes their cotangents, calls their rule, and does not enter the nodes between
the values and the arguments they were computed from. As `jax.custom_vjp`, but a rule counts only where it gives what
the sweep would: where the values depend on the arguments of the rule alone.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import reduce
from math import prod
from typing import Any

import numpy as np

from ulna.compiler.language.cotangents import Cotangents, either
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op
from ulna.compiler.language.scalar import Scalar, Value, index_in, innermost, tracing
from ulna.compiler.language.vjp_rule import VjpRule, of_live_values
from ulna.numeric.arrays import object_vector


def with_vjp(values: Any, arguments: Sequence[Any], vjp: Any) -> Any:
    """Records a reverse derivative of traced values.

    Args:
        values: An array of what was computed, traced or not.
        arguments: Arrays of all that it was computed from.
        vjp: See `VjpRule`; it must be picklable.

    Returns:
        `values`.
    """
    arrays = [np.asarray(x, dtype=object) for x in arguments]
    inputs = [x for array in arrays for x in array.flat]
    outputs = list(np.asarray(values, dtype=object).flat)
    if any(isinstance(x, Value) for x in outputs):
        graph = innermost(*inputs, *outputs)
        nodes = [index_in(graph, x) for x in (*inputs, *outputs)]
        shapes = tuple(array.shape for array in arrays)
        graph.rules.append(VjpRule(tuple(nodes[: len(inputs)]), tuple(nodes[len(inputs) :]), shapes, vjp))
    return values


def rules_by_first_value(g: Graph, order: Sequence[int]) -> dict[int, VjpRule]:
    """The rules that count in a reverse sweep, by the value that it comes to last.

    Args:
        g: The graph.
        order: The nodes of the sweep.

    Returns:
        Rules by nodes, no two of which have a value in common.
    """
    found: dict[int, VjpRule] = {}
    taken: set[int] = set()
    for rule in of_live_values(g.rules, order):
        if taken.isdisjoint(rule.outputs) and _counts(g, rule):
            taken.update(rule.outputs)
            found[min(rule.outputs)] = rule
    return found


def _counts(g: Graph, rule: VjpRule) -> bool:
    """Whether the values are different nodes after all arguments, and depend on nothing else."""
    arguments, first = set(rule.inputs), min(rule.outputs)
    if len(set(rule.outputs)) < len(rule.outputs) or first <= max(arguments):
        return False
    seen, waiting = set(rule.outputs), list(rule.outputs)
    while waiting:
        index = waiting.pop()
        if g.op[index] in (Op.INPUT, Op.LANE):
            return False
        for a in g.args[index]:
            if a not in seen and a not in arguments:
                seen.add(a)
                waiting.append(a)
    return not any(g.op[index] == Op.CONST for index in rule.outputs)


def add_by_rule(g: Graph, rule: VjpRule, cotangents: Cotangents, reached: Collection[int]) -> None:
    """Adds to the cotangents of arguments what those of the values give.

    Args:
        g: The graph, which takes new nodes.
        rule: A rule that counts.
        cotangents: Cotangents, those of the values complete.
        reached: The nodes that need cotangents.
    """
    given = [y for y in rule.outputs if y in cotangents]
    ends = np.cumsum([prod(shape) for shape in rule.shapes])[:-1]
    parts = np.split(np.array(rule.inputs), ends)
    is_wanted = [any(x in reached for x in part) for part in parts]
    if not given or not any(is_wanted):
        return
    where = reduce(either, [cotangents[y][1] for y in given])
    arguments = [
        object_vector([Scalar(g, int(x)) for x in part]).reshape(shape)
        for part, shape in zip(parts, rule.shapes, strict=True)
    ]
    values = object_vector([Scalar(g, y) for y in rule.outputs])
    bars = object_vector([Scalar(g, cotangents.total(y)) for y in rule.outputs])
    with tracing(g):
        found = rule.vjp(arguments, values, bars, is_wanted)
    for part, bar, wanted in zip(parts, found, is_wanted, strict=True):
        if wanted:
            for x, value in zip(part, np.asarray(bar, dtype=object).flat, strict=True):
                if x in reached:
                    cotangents.add(int(x), Scalar(g, index_in(g, value)), where)
