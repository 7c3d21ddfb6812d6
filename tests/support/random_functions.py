"""Random functions for laws of the compiler, as Hypothesis strategies, and what to call them with."""

from __future__ import annotations

import functools

import numpy as np
from hypothesis import strategies as st

from ulna.compiler import Function, Port
from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op

UNARY = (Op.NEG, *(row.op for row in TABLE if row.c and row.arity == 1))
EXACT_UNARY = (Op.NEG, Op.ABS, Op.SQRT, Op.FLOOR)
BINARY = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX, Op.ATAN2)
EXACT_BINARY = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX)
COMPARE, COMBINE = (Op.LT, Op.LE, Op.EQ), (Op.AND, Op.OR)
SMALL = ((), (1,), (2,), (3,), (2, 2))
WIDE = (*SMALL, (5,), (7,), (9,), (3, 5), (17,), (2, 1, 9))
"""Shapes of ports; rows of the wide ones are written in chunks of several widths."""
CONSTANTS = (0.0, -0.0, 1.0, -1.0, 0.5, 2.0, -3.25, 1e-8, 1e5)


@st.composite
def functions(
    draw, exact: bool = False, smooth: bool = False, loops: bool = True, wide: bool = False, lanes: int = 1
) -> Function:
    """A random function of up to 3 ports with up to 2 outputs.

    Args:
        exact: Only operations that IEEE 754 rounds correctly.
        smooth: Only operations with derivatives everywhere.
        loops: Whether there may be loops.
        wide: Whether ports may have up to 18 numbers; else 4 for inputs, 3 for outputs.
        lanes: Above 1, one sample is evaluated in so many lanes, which differ by their number.
    """
    shapes = draw(st.lists(st.sampled_from(WIDE if wide else SMALL), min_size=1, max_size=3))
    ports = [Port(f"p{k}", s) for k, s in enumerate(shapes)]
    g = Graph(relaxed=not exact)
    numbers = [g.input() for p in ports for _ in range(p.size)]
    if lanes > 1:
        numbers.append(g.lane(lanes))
    fill(draw, g, numbers, exact, smooth, loops and not smooth, draw(st.integers(1, 25)))
    if lanes > 1:  # all lanes must agree on the results
        numbers = [g.node(Op.LEAST, number) for number in numbers]
    last = 30 if wide else 8
    width = st.sampled_from(WIDE[1:]) if wide else st.integers(1, 3).map(lambda n: (n,))
    outputs = [Port(f"out{k}", draw(width)) for k in range(draw(st.integers(1, 2)))]
    results = tuple(draw(st.sampled_from(numbers[-last:])) for p in outputs for _ in range(p.size))
    return Function("random", g, tuple(ports), tuple(outputs), results, single=False, lanes=lanes)


def fill(draw, g: Graph, numbers: list[int], exact: bool, smooth: bool, loops: bool, count: int) -> None:
    """Adds random nodes to the graph; `numbers` grows."""
    unary = EXACT_UNARY if exact else (Op.NEG, Op.SIN, Op.COS) if smooth else UNARY
    binary = EXACT_BINARY if exact else (Op.ADD, Op.SUB, Op.MUL) if smooth else BINARY
    conditions: list[int] = []
    number = st.one_of(st.sampled_from(numbers), st.sampled_from(CONSTANTS).map(lambda c: ("c", c)))

    def one() -> int:
        value = draw(number)
        return g.constant(value[1]) if isinstance(value, tuple) else value

    for _ in range(count):
        kind = draw(st.sampled_from(["unary", "binary", "binary", "compare", "combine", "select", "loop"]))
        if kind == "unary":
            numbers.append(g.node(draw(st.sampled_from(unary)), one()))
        elif kind == "compare" and not smooth:
            conditions.append(g.node(draw(st.sampled_from(COMPARE)), one(), one()))
        elif kind == "combine" and conditions:
            pair = [draw(st.sampled_from(conditions)) for _ in range(2)]
            conditions.append(g.node(draw(st.sampled_from(COMBINE)), *pair))
            if draw(st.booleans()):
                conditions.append(g.node(Op.NOT, conditions[-1]))
        elif kind == "select" and conditions:
            numbers.append(g.node(Op.SELECT, draw(st.sampled_from(conditions)), one(), one()))
        elif kind == "loop" and loops and draw(st.booleans()):
            numbers += loop(draw, g, one, exact)
        else:
            numbers.append(g.node(draw(st.sampled_from(binary)), one(), one()))


def loop(draw, g: Graph, one, exact: bool) -> list[int]:
    """A loop that counts up to a bound, with a random body and captured values."""
    inner = Graph(relaxed=g.relaxed, parent=g)
    size = draw(st.integers(2, 3))
    numbers = [inner.input() for _ in range(size)]
    numbers += [inner.capture(g, one()) for _ in range(draw(st.integers(0, 2)))]
    counter, bound = numbers[0], inner.constant(draw(st.sampled_from([-1.0, 0.5, 3.0, 6.0])))
    fill(draw, inner, numbers, exact, False, False, draw(st.integers(1, 5)))
    goes_on = inner.node(
        Op.AND, inner.node(Op.LT, counter, bound), inner.node(Op.LE, numbers[-1], numbers[-1])
    )
    counted = inner.node(Op.ADD, counter, inner.constant(1.0))
    following = (counted, *(draw(st.sampled_from(numbers)) for _ in range(size - 1)))
    body = Loop(inner, size, goes_on, following, draw(st.integers(0, 9)))
    start = [one() for _ in range(size)]
    return g.loop(body, start + inner.captured)


@functools.cache
def samples(size: int, rows: int, special: bool) -> np.ndarray:
    rng = np.random.default_rng(size * 100 + rows)
    values = rng.normal(size=(rows, size)) * rng.choice([0.1, 1.0, 10.0], size=(rows, size))
    if special:
        odd = rng.choice(
            [0.0, -0.0, 1.0, -1.0, 2.0, 1e-300, 1e300, np.inf, -np.inf, np.nan], size=(rows, size)
        )
        values = np.where(rng.random((rows, size)) < 0.4, odd, values)
    return values


def inputs(f: Function, rows: int, special: bool = False, dtype: type = np.float64) -> list[np.ndarray]:
    flat = samples(sum(p.size for p in f.inputs), rows, special)
    arrays, start = [], 0
    for p in f.inputs:
        arrays.append(
            np.ascontiguousarray(flat[:, start : start + p.size]).reshape(rows, *p.shape).astype(dtype)
        )
        start += p.size
    return arrays
