"""The peephole rules against plain NumPy, bit for bit, on all pairs of small terms and odd numbers."""

from __future__ import annotations

import itertools
import pickle
from typing import Any

import numpy as np
import pytest
from trace_tools import SPECIAL, grid, same_bits

from support.random_functions import BINARY, UNARY
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.interpreter import interpret
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.simplify import PLAIN_FROM, simplify

CONSTANTS = (*SPECIAL, 2.0, -8.0, 2.0**-1022, 2.0**1023, 3.0)
X, Y = ("x",), ("y",)

Term = tuple[Any, ...]  # ("x",), ("y",), (number,), (truth value,) or (op, *terms)

NUMBERS: list[Term] = [
    X,
    Y,
    *((c,) for c in CONSTANTS),
    *((op, X) for op in UNARY),
    *((op, X, Y) for op in BINARY),
    (Op.NEG, Y),
    (Op.SUB, Y, X),
    (Op.NEG, (Op.ADD, X, Y)),
    (Op.MUL, X, (0.0,)),
    (Op.MUL, X, (3.0,)),
]
CONDITIONS: list[Term] = [
    (True,),
    (False,),
    *((op, a, b) for op in (Op.LT, Op.LE, Op.EQ) for a in (X, Y) for b in (X, Y)),
    (Op.NOT, (Op.LT, X, Y)),
    (Op.NOT, (Op.EQ, X, Y)),
    (Op.LT, X, (0.0,)),
    (Op.LE, (-0.0,), X),
]


def evaluate(term: Term, x: Any, y: Any) -> Any:
    """The meaning of a term, straight from NumPy."""
    if term in (X, Y):
        return x if term == X else y
    if len(term) == 1:
        return term[0]
    with np.errstate(all="ignore"):
        return TABLE[term[0]].numpy(*(evaluate(t, x, y) for t in term[1:]))  # type: ignore[misc]


def build(g: Graph, term: Term) -> int:
    if term in (X, Y):
        return g.inputs[term == Y]
    if len(term) == 1:
        return g.truth(term[0]) if isinstance(term[0], bool) else g.constant(term[0])
    return g.node(term[0], *(build(g, t) for t in term[1:]))


def new_graph(relaxed: bool) -> Graph:
    g = Graph(relaxed=relaxed)
    g.input()
    g.input()
    return g


def all_terms() -> list[Term]:
    terms: list[Term] = [(op, t) for op in UNARY for t in NUMBERS]
    terms += [(op, s, t) for op in BINARY for s, t in itertools.product(NUMBERS, NUMBERS)]
    return terms


def all_conditions() -> list[Term]:
    terms: list[Term] = [(op, s, t) for op in (Op.AND, Op.OR) for s in CONDITIONS for t in CONDITIONS]
    terms += [(op, s, t) for op in (Op.LT, Op.LE, Op.EQ) for s in NUMBERS for t in NUMBERS[:6]]
    terms += [(Op.NOT, t) for t in CONDITIONS]
    terms += [(Op.SELECT, c, a, b) for c in CONDITIONS for a in NUMBERS[:8] for b in NUMBERS[:8]]
    return terms


def shown(term: Term) -> str:
    return repr(term[0]) if len(term) == 1 else f"{term[0].name}({', '.join(map(shown, term[1:]))})"


@pytest.mark.parametrize("terms", [all_terms, all_conditions])
def test_exact_rules_hold_bit_for_bit(terms):
    x, y = grid(2)
    wrong = []
    for number, term in enumerate(terms()):
        if number % 50 == 0:  # a small graph is quick to walk, and its nodes are still shared
            g = new_graph(relaxed=False)
        expected = evaluate(term, x, y)
        (got,) = interpret(g, [x, y], [build(g, term)])
        good = same_bits(got, expected)
        if term[0] in (Op.MIN, Op.MAX):  # of zeros of either sign NumPy returns any
            good = good | (np.asarray(got) == expected)
        if not good.all():
            at = int(np.argmin(np.broadcast_to(good, x.shape)))
            wrong.append(f"{shown(term)} at x={x[at]}, y={y[at]}")
    assert wrong == []


@pytest.mark.parametrize("terms", [all_terms, all_conditions])
def test_relaxed_rules_hold_for_finite_numbers_up_to_the_sign_of_zero(terms):
    x, y = grid(2, [v for v in SPECIAL if np.isfinite(v)])
    wrong = []
    for number, term in enumerate(terms()):
        if number % 50 == 0:
            g = new_graph(relaxed=True)
        parts = [np.broadcast_to(np.asarray(evaluate(t, x, y), float), x.shape) for t in term[1:]]
        expected = np.asarray(evaluate(term, x, y), float)
        counts = np.isfinite(expected) & np.logical_and.reduce([np.isfinite(p) for p in parts])
        if term[0] == Op.ATAN2:  # takes the sign of a zero for a direction
            counts = counts & np.logical_and.reduce([p != 0.0 for p in parts])
        (got,) = interpret(g, [x, y], [build(g, term)])
        bad = counts & (np.asarray(got, float) != expected)
        if bad.any():
            at = int(np.argmax(np.broadcast_to(bad, x.shape)))
            wrong.append(f"{shown(term)} at x={x[at]}, y={y[at]}")
    assert wrong == []


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        ("exact", {"x-0": 0, "x*1": 0, "x*-1": 1, "--x": 0, "x+(-y)": 1, "x-(-y)": 1, "x/2": 1, "x+0": 1, "x-x": 1,
                   "x*0": 1, "0-x": 1, "-(x-y)": 2, "sin(-x)": 2, "cos(-x)": 1, "x<x": 0}),
        ("relaxed", {"x-0": 0, "x*1": 0, "x*-1": 1, "--x": 0, "x+(-y)": 1, "x-(-y)": 1, "x/2": 1, "x+0": 0, "x-x": 0,
                     "x*0": 0, "0-x": 1, "-(x-y)": 1, "sin(-x)": 2, "cos(-x)": 1, "x<x": 0}),
    ],
)  # fmt: skip
def test_how_many_operations_are_left(rules, expected):
    terms: dict[str, Term] = {
        "x-0": (Op.SUB, X, (0.0,)),
        "x*1": (Op.MUL, X, (1.0,)),
        "x*-1": (Op.MUL, X, (-1.0,)),
        "--x": (Op.NEG, (Op.NEG, X)),
        "x+(-y)": (Op.ADD, X, (Op.NEG, Y)),
        "x-(-y)": (Op.SUB, X, (Op.NEG, Y)),
        "x/2": (Op.DIV, X, (2.0,)),
        "x+0": (Op.ADD, X, (0.0,)),
        "x-x": (Op.SUB, X, X),
        "x*0": (Op.MUL, X, (0.0,)),
        "0-x": (Op.SUB, (0.0,), X),
        "-(x-y)": (Op.NEG, (Op.SUB, X, Y)),
        "sin(-x)": (Op.SIN, (Op.NEG, X)),
        "cos(-x)": (Op.COS, (Op.NEG, X)),
        "x<x": (Op.LT, X, X),
    }
    left = {}
    for name, term in terms.items():
        g = new_graph(relaxed=rules == "relaxed")
        live = g.live([build(g, term)])
        left[name] = sum(TABLE[g.op[i]].cost > 0 for i in live)
    assert left == expected


def test_division_by_a_power_of_two_becomes_a_product():
    g = new_graph(relaxed=False)
    assert g.op[build(g, (Op.DIV, X, (2.0,)))] == Op.MUL
    assert g.op[build(g, (Op.DIV, X, (3.0,)))] == Op.DIV
    assert g.op[build(g, (Op.DIV, X, (2.0**1023,)))] == Op.DIV, "the reciprocal would be denormal"


def test_equal_nodes_are_one_node_and_sums_commute():
    g = new_graph(relaxed=False)
    assert build(g, (Op.ADD, X, Y)) == build(g, (Op.ADD, Y, X))
    assert build(g, (Op.SUB, X, Y)) != build(g, (Op.SUB, Y, X))
    assert build(g, (Op.LT, X, Y)) != build(g, (Op.LT, Y, X))


def test_constants_are_distinguished_by_their_bits():
    g = Graph()
    assert g.constant(0.0) != g.constant(-0.0)
    assert g.constant(1.0) != g.truth(True)
    assert g.constant(float("nan")) == g.constant(float("nan"))


def test_what_is_beside_zero_is_found_at_once_as_rules_find_it() -> None:
    """The shortcut of relaxed graphs; zeros of the other sign, infinity and nan take the longer way."""
    graph = Graph(relaxed=True)
    x, zero = graph.input(), graph.constant(0.0)
    others = [x, zero, *map(graph.constant, (-0.0, 2.0, np.inf, np.nan))]
    for op in (Op.MUL, Op.ADD, Op.SUB):
        for other in others:
            for args in ((other, zero), (zero, other)):
                quick = graph.node(op, *args)
                by_rules = simplify(graph, op, args)
                assert quick == by_rules, (op, args)
    assert pickle.loads(pickle.dumps(graph)).zero == zero
    exact = Graph(relaxed=False)
    y = exact.input()
    assert exact.node(Op.MUL, y, exact.constant(0.0)) not in (y, exact.constant(0.0))


def test_sums_and_products_of_plain_nodes_are_simple() -> None:
    """Graphs do not ask for a rule there."""
    graph = Graph(relaxed=True)
    x, y, c = graph.input(), graph.input(), graph.constant(2.0)
    plain = [*(graph.node(op, x) for op in UNARY), *(graph.node(op, x, y) for op in BINARY)]
    plain = [node for node in plain if graph.op[node] >= PLAIN_FROM]
    assert len(plain) > 10
    for op in (Op.ADD, Op.MUL):
        for a in plain:
            for b in plain:
                assert simplify(graph, op, (a, b)) is None
                assert graph.args[graph.node(op, a, b)] == (min(a, b), max(a, b))
            assert simplify(graph, Op.MUL, (a, graph.constant(1.0))) == a  # but beside constants there are
            assert graph.node(Op.ADD, a, graph.node(Op.NEG, c)) == graph.node(Op.ADD, graph.constant(-2.0), a)


def test_equal_numbers_of_any_type_are_one_constant() -> None:
    graph = Graph()
    one, large = graph.constant(1.0), graph.constant(2.0**60)
    for value in (1, np.float32(1.0), np.int64(1), True, np.float64(1.0)):
        assert graph.constant(value) == one
    assert graph.constant(2**60 + 1) == large  # as a float
    for _ in range(2):  # the second time they are known
        assert graph.data[graph.constant(0)].hex() == "0x0.0p+0"
        assert graph.data[graph.constant(-0.0)].hex() == "-0x0.0p+0"


def test_rewriting_ends_on_long_chains():
    g = new_graph(relaxed=True)
    node = g.inputs[0]
    for k in range(5000):
        node = g.node(
            (Op.NEG, Op.SUB, Op.ADD, Op.MUL)[k % 4], *((node,) if k % 4 == 0 else (node, g.inputs[1]))
        )
    assert len(g.live([node])) <= 5002


LESS, EQUAL = (Op.LT, X, Y), (Op.EQ, X, Y)


@pytest.mark.parametrize(
    ("term", "simpler"),
    [
        ((Op.AND, LESS, (True,)), LESS),
        ((Op.AND, (False,), LESS), (False,)),
        ((Op.AND, LESS, LESS), LESS),
        ((Op.AND, LESS, (Op.NOT, LESS)), (False,)),
        ((Op.AND, (Op.NOT, LESS), LESS), (False,)),
        ((Op.OR, LESS, (True,)), (True,)),
        ((Op.OR, (False,), LESS), LESS),
        ((Op.OR, LESS, LESS), LESS),
        ((Op.OR, LESS, (Op.NOT, LESS)), (True,)),
        ((Op.OR, (Op.NOT, LESS), LESS), (True,)),
        ((Op.NOT, (Op.NOT, LESS)), LESS),
        ((Op.LT, X, X), (False,)),
        ((Op.SELECT, (True,), X, Y), X),
        ((Op.SELECT, (False,), X, Y), Y),
        ((Op.SELECT, LESS, X, X), X),
        ((Op.SELECT, (Op.NOT, LESS), X, Y), (Op.SELECT, LESS, Y, X)),
        ((Op.MIN, X, X), X),
        ((Op.MAX, Y, Y), Y),
        ((Op.LT, (1.0,), (2.0,)), (True,)),
    ],
)
def test_conditions_and_choices_become_simpler(term: Term, simpler: Term) -> None:
    g = new_graph(relaxed=False)
    assert build(g, term) == build(g, simpler)
    assert build(g, (Op.AND, LESS, EQUAL)) not in (build(g, LESS), build(g, EQUAL), build(g, (False,)))
