"""What loops keep for the sweep back: the cheapest choice, and gradients that are those of finite differences."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import ulna
from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.kept_values import values_to_keep
from ulna.compiler.language.ops import Op

COSTS = {Op.SIN: 14, Op.DIV: 6, Op.ADD: 1, Op.MUL: 1}
CHEAPEST, DEAREST = 6, 40
"""The prices of a value that is kept, from the first to the last that is tried."""


def random_graph(rng, count):
    """A few inputs, then operations on random nodes; what a sweep would compute from some of them."""
    g = Graph()
    nodes = [g.input() for _ in range(3)]
    while len(nodes) < count:
        op = rng.choice([Op.SIN, Op.DIV, Op.ADD, Op.MUL], p=[0.2, 0.2, 0.3, 0.3])
        made = g.node(int(op), *(int(rng.choice(nodes)) for _ in range(1 if op == Op.SIN else 2)))
        if made not in nodes and g.op[made] != Op.CONST:
            nodes.append(made)
    values = nodes[3:]
    outputs = [g.node(Op.MUL, g.input(), int(node)) for node in rng.choice(values, size=4, replace=False)]
    return g, values, outputs


def expense(g, values, outputs, kept, price):
    """What the outputs cost from what is kept."""
    needed, waiting = set(), [a for y in outputs for a in g.args[y]]
    while waiting:
        node = waiting.pop()
        if node not in needed:
            needed.add(node)
            waiting += () if node in kept else g.args[node]
    return price * len(kept) + sum(COSTS[Op(g.op[x])] for x in needed if x in values and x not in kept)


@pytest.mark.parametrize("seed", range(20))
def test_no_other_choice_is_cheaper(seed):
    g, values, outputs = random_graph(np.random.default_rng(seed), 13)
    kept = values_to_keep(g, values, outputs, len(values))
    best = min(
        expense(g, values, outputs, chosen, CHEAPEST)
        for size in range(len(values) + 1)
        for chosen in combinations(values, size)
    )
    assert expense(g, values, outputs, kept, CHEAPEST) == best


@pytest.mark.parametrize("op", [Op.EXP, Op.LOG, Op.TAN, Op.ERF])
def test_functions_are_kept_as_sines_are(op):
    g = Graph()
    value = g.node(op, g.input())
    outputs = [g.node(Op.MUL, g.input(), value)]
    assert values_to_keep(g, [value], outputs, 1) == [value]


@pytest.mark.parametrize("seed", range(5))
def test_as_many_are_kept_as_there_is_room_for(seed):
    g, values, outputs = random_graph(np.random.default_rng(seed), 60)
    counts = [len(values_to_keep(g, values, outputs, most)) for most in range(12)]
    assert counts[0] == 0 and all(count <= most for most, count in enumerate(counts))
    assert counts == sorted(counts)


def test_of_values_alike_as_many_are_kept_as_there_is_room_for():
    g = Graph()
    alike = [[g.input() for _ in range(3)] for _ in range(16)]
    quotients = [[g.node(Op.DIV, x, y), g.node(Op.DIV, x, z)] for x, y, z in alike]
    sums = [g.node(Op.ADD, *pair) for pair in quotients]
    outputs = [g.node(Op.MUL, g.input(), node) for node in sums]
    values = [*(node for pair in quotients for node in pair), *sums]
    for most, kept in (
        (16, 16),
        (15, 10),
        (9, 4),
        (3, 0),
    ):  # the price of a part of the values is raised at once
        assert values_to_keep(g, values, outputs, most) == sums[:kept]


def steps_of(robot, name, count):
    """A scalar function of where `count` steps of a robot under constant torques lead."""
    f, n = robot.function(name), robot.nv

    def cost(q, v, tau):
        def step(k, *x):
            a = 0.01 * f(np.array(x[:n]), np.array(x[n:]), tau)
            v = np.array(x[n:]) + 0.01 * a
            return (k + 1.0, *(np.array(x[:n]) + 0.01 * v), *v)

        _, *x = nm.loop(lambda k, *x: k < float(count), step, (0.0, *q, *v), count)
        return np.sum(np.sin(np.array(x)))

    return trace(cost, q=(n,), v=(n,), tau=(n,))


@pytest.mark.parametrize("name", ["inverse_dynamics", "forward_dynamics"])
def test_gradients_of_steps_of_a_robot(name):
    robot = ulna.load("panda")
    f = steps_of(robot, name, 6)
    gradient = f.value_and_gradient("tau")
    rng = np.random.default_rng(0)
    q, v, tau = rng.normal(size=(3, 9, robot.nv))
    moves = 1e-5 * np.eye(robot.nv)
    kernel = compile(f)
    expected = np.stack([(kernel(q, v, tau + e) - kernel(q, v, tau - e)) / 2e-5 for e in moves], axis=-1)
    for derived in (gradient, compile(gradient)):
        value, slope = derived(q, v, tau)
        np.testing.assert_allclose(value, kernel(q, v, tau), rtol=1e-12)
        np.testing.assert_allclose(slope, expected, rtol=1e-6, atol=1e-9)
    one = compile(gradient)(q[0], v[0], tau[0])[1]
    np.testing.assert_allclose(one, expected[0], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", ["inverse_dynamics", "forward_dynamics"])
def test_sines_are_computed_once(name):
    f = steps_of(ulna.load("panda"), name, 50)
    derived = f.value_and_gradient("tau")
    outside = 2 * f.inputs[0].size  # those of the sum, and their derivatives
    assert f.operation_counts["sin"] + f.operation_counts["cos"] > outside // 2
    assert derived.operation_counts["sin"] == f.operation_counts["sin"]
    assert derived.operations < 3.0 * f.operations


def test_lanes_that_stop_early_read_what_is_theirs():
    def f(x, n):
        return nm.loop(
            lambda i, y: i < n, lambda i, y: (i + 1.0, x * np.sin(y) + np.exp(-y * y)), (0.0, x), 20
        )[1]

    x, n = np.linspace(0.3, 1.7, 11), np.array([0, 3, 1, 7, 20, 0, 5, 9, 4, 11, 6.0])
    gradient = trace(f, x=(), n=()).value_and_gradient()
    for derived in (gradient, compile(gradient)):
        for k in range(11):
            y, slope = x[k], 1.0
            for _ in range(int(n[k])):
                rest = np.exp(-y * y)
                y, slope = (
                    x[k] * np.sin(y) + rest,
                    np.sin(y) + (x[k] * np.cos(y) - 2.0 * y * rest) * slope,
                )
            np.testing.assert_allclose([each[k] for each in derived(x, n)], [y, slope], rtol=1e-12)


def test_long_records_of_many_directions_fit_on_the_stack():
    """The Jacobian of a gradient records a loop for each of ten directions: 12,000 numbers in each lane."""

    def f(x):
        def step(k, *y):
            return (k + 1.0, *(0.9 * a + 0.1 * b for a, b in zip(y, (*y[1:], y[0] * y[1]), strict=True)))

        _, *y = nm.loop(lambda k, *y: k < 1100.0, step, (0.0, *x), 1100)
        return sum(a * a for a in y)

    traced = trace(f, x=(10,))
    second = traced.value_and_gradient().jacobian()
    assert second.tape_size > 100_000
    x = np.random.default_rng(0).uniform(0.0, 1.0, size=(9, 10))
    vector = np.eye(10)[3]
    expected = compile(traced.hvp())(x, vector)
    got = compile(second)(x)[1][..., 3]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())
