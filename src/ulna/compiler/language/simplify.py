"""Peephole rules, applied as each node is made, so that no pass over the graph is ever needed.

Exact rules hold for every double, bit for bit. Relaxed rules hold up to the sign of zero where every value on the
way is finite (0 / x -> 0 also where x is 0); a graph made with `relaxed=False` does not use them. Each rule looks at
most one node deep and returns an existing node or a strictly simpler one, so rewriting ends by construction.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from math import copysign, frexp
from typing import Any, Protocol

import numpy as np

from ulna.compiler.language.ops import TABLE, Op


class Graph(Protocol):
    """What a rule needs of a graph: the nodes' operations, arguments and data, and how to make nodes."""

    op: list[int]
    args: list[tuple[int, ...]]
    data: list[Any]
    relaxed: bool
    lanes: int

    def node(self, op: int, *args: int) -> int:
        """The node of `op` on `args`, simplified."""
        ...

    def constant(self, value: float) -> int:
        """The node of a number."""
        ...

    def truth(self, value: bool) -> int:
        """The node of a constant condition."""
        ...


# Plain numbers: in Python 3.11 members of an enumeration take longer to look up and to compare.
_CONST, _NEG, _ADD, _SUB, _MUL = int(Op.CONST), int(Op.NEG), int(Op.ADD), int(Op.SUB), int(Op.MUL)
_CONSTANT = frozenset({_CONST, int(Op.BOOL)})
PLAIN_FROM = _NEG + 1  # no rule applies to sums and products of operations of this number or larger ones
_FLOAT_FUNCTIONS: dict[int, Callable[..., float]] = {
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
}


def simplify(g: Graph, op: int, args: tuple[int, ...]) -> int | None:
    """A node that equals `op` on `args` and is simpler, or None.

    Args:
        g: The graph, which takes new nodes.
        op: A member of `Op`.
        args: Nodes of the operands.

    Returns:
        The simpler node, or None where no rule applies.
    """
    kinds = g.op
    for a in args:
        if kinds[a] not in _CONSTANT:
            rule = _RULES.get(op)
            return rule(g, *args) if rule is not None else None
    return _folded(g, op, args)


def _folded(g: Graph, op: int, args: tuple[int, ...]) -> int:
    """Constants in, constant out; computed by the interpreter's own NumPy functions."""
    if op in _FLOAT_FUNCTIONS:  # a number of Python is a double as well, and need not be wrapped
        return g.constant(_FLOAT_FUNCTIONS[op](*(g.data[a] for a in args)))
    if op == Op.SELECT:
        return args[1] if g.data[args[0]] else args[2]
    function = TABLE[op].numpy
    assert function is not None
    with np.errstate(all="ignore"):
        value = function(*(g.data[a] for a in args))
    return g.truth(bool(value)) if TABLE[op].is_condition else g.constant(float(value))


def _neg(g: Graph, a: int) -> int | None:
    if g.op[a] == Op.NEG:
        return g.args[a][0]
    if g.relaxed and g.op[a] == Op.SUB:  # at equality -(a-b) is -0.0 and b-a is 0.0
        return g.node(Op.SUB, g.args[a][1], g.args[a][0])
    return None


def _add(g: Graph, a: int, b: int) -> int | None:
    kinds = g.op
    for x, y in ((a, b), (b, a)):
        kind = kinds[y]
        if kind == _CONST:
            if g.data[y] == 0.0 and (g.relaxed or copysign(1.0, g.data[y]) < 0):
                return x
        elif kind == _NEG:
            return g.node(_SUB, x, g.args[y][0])
    return None


def _sub(g: Graph, a: int, b: int) -> int | None:
    kind_a, kind_b = g.op[a], g.op[b]
    if kind_b == _CONST:
        if g.data[b] == 0.0 and (g.relaxed or copysign(1.0, g.data[b]) > 0):
            return a
    elif kind_b == _NEG:
        return g.node(_ADD, a, g.args[b][0])
    if kind_a == _CONST:
        is_neutral = g.data[a] == 0.0 and (g.relaxed or copysign(1.0, g.data[a]) < 0)
        return g.node(_NEG, b) if is_neutral else None
    if g.relaxed:
        if a == b:
            return g.constant(0.0)
        if kind_a == _NEG:
            return g.node(_NEG, g.node(_ADD, g.args[a][0], b))
    return None


def _mul(g: Graph, a: int, b: int) -> int | None:
    kinds = g.op
    for x, y in ((a, b), (b, a)):
        kind = kinds[y]
        if kind == _CONST:
            c = g.data[y]
            if c == 0.0 and g.relaxed:
                return y if copysign(1.0, c) > 0 else g.constant(0.0)
            if c == 1.0:
                return x
            if c == -1.0:
                return g.node(_NEG, x)
            if kinds[x] == _NEG:
                return g.node(_MUL, g.args[x][0], g.constant(-c))
        elif kind == _NEG and kinds[x] != _CONST:
            return g.node(_NEG, g.node(_MUL, x, g.args[y][0]))
    return None


def _div(g: Graph, a: int, b: int) -> int | None:
    if g.op[b] == Op.CONST:
        c = g.data[b]
        if c == 1.0:
            return a
        if c == -1.0:
            return g.node(Op.NEG, a)
        mantissa, exponent = frexp(c)
        if abs(mantissa) == 0.5 and -1000 < exponent < 1000:  # 1/c is exact
            return g.node(Op.MUL, a, g.constant(1.0 / c))
    if g.op[b] == Op.NEG:
        return g.node(Op.NEG, g.node(Op.DIV, a, g.args[b][0]))
    if g.op[a] == Op.NEG:
        return g.node(Op.NEG, g.node(Op.DIV, g.args[a][0], b))
    if g.relaxed and g.op[a] == Op.CONST and g.data[a] == 0.0:
        return g.constant(0.0)
    return None


def _odd(op: int):
    """Rule of an odd function: f(-x) = -f(x)."""

    def rule(g: Graph, a: int) -> int | None:
        return g.node(Op.NEG, g.node(op, g.args[a][0])) if g.op[a] == Op.NEG else None

    return rule


def _even(op: int):
    """Rule of an even function: f(-x) = f(x) and f(|x|) = f(x)."""

    def rule(g: Graph, a: int) -> int | None:
        return g.node(op, g.args[a][0]) if g.op[a] in (Op.NEG, Op.ABS) else None

    return rule


def _abs(g: Graph, a: int) -> int | None:
    if g.op[a] == Op.ABS or g.op[a] == Op.SQRT:
        return a if g.op[a] == Op.ABS or g.relaxed else None
    return g.node(Op.ABS, g.args[a][0]) if g.op[a] == Op.NEG else None


def _idempotent(g: Graph, a: int, b: int) -> int | None:
    return a if a == b else None


def _junction(neutral: bool):
    """Rule of "and", whose neutral value is True, and of "or", where it is False."""

    def rule(g: Graph, a: int, b: int) -> int | None:
        for x, y in ((a, b), (b, a)):
            if g.op[y] == Op.BOOL:
                return x if g.data[y] is neutral else y
            if g.op[y] == Op.NOT and g.args[y][0] == x:
                return g.truth(not neutral)
        return _idempotent(g, a, b)

    return rule


def _select(g: Graph, c: int, a: int, b: int) -> int | None:
    if g.op[c] == Op.BOOL:
        return a if g.data[c] else b
    if a == b:
        return a
    return g.node(Op.SELECT, g.args[c][0], b, a) if g.op[c] == Op.NOT else None


def _over_lanes(g: Graph, a: int) -> int | None:
    """A reduction over a single lane is the value itself."""
    return a if g.lanes == 1 else None


_RULES: dict[int, Callable[..., int | None]] = {
    Op.NEG: _neg,
    Op.ABS: _abs,
    Op.SIN: _odd(Op.SIN),
    Op.TAN: _odd(Op.TAN),
    Op.ASIN: _odd(Op.ASIN),
    Op.COS: _even(Op.COS),
    Op.ADD: _add,
    Op.SUB: _sub,
    Op.MUL: _mul,
    Op.DIV: _div,
    Op.MIN: _idempotent,
    Op.MAX: _idempotent,
    Op.LT: lambda g, a, b: g.truth(False) if a == b else None,  # also for nan
    Op.AND: _junction(neutral=True),
    Op.OR: _junction(neutral=False),
    Op.NOT: lambda g, a: g.args[a][0] if g.op[a] == Op.NOT else None,
    Op.SELECT: _select,
    Op.ANY: _over_lanes,
    Op.LEAST: _over_lanes,
}
