"""Rounds of projected Gauss-Seidel, as a procedure for problems of any size.

| symbol | meaning | shape | unit |
|---|---|---|---|
| G, g | Delassus matrix; velocities of the constraints without impulses | (m, m), (m,) | [1/kg], [m/s] |
| x, y | impulses; velocities of each constraint right after its impulses were corrected | (m,) | [N s], [m/s] |
| w | over-relaxation | | [-] |

A round corrects one constraint after the other, with y = G x + g of its rows from the present impulses. A row that is
held, pushed or bounded: x_k <- x_k - w y_k / G_kk within its bounds, and y of the constraint follows at once. A
contact: the normal impulse so, not below zero, then both tangential ones with the smaller of their diagonal entries,
shortened to mu times the normal impulse. Source: Le Lidec et al., Contact models in robotics: a comparative analysis
(2024), algorithm 2; Jourdan, Alart & Jean, A Gauss-Seidel like algorithm to solve frictional contact problems (1998).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pinocchio._constraints._procedures.solver_rows import (
    CONTACT,
    CONVERGED_OUT,
    DUAL_OUT,
    HAS_IMPULSES_OUT,
    HAS_VELOCITIES_OUT,
    HEAD,
    HELD,
    INT,
    ITERATIONS_OUT,
    LANES,
    POWER_OUT,
    PRIMAL_OUT,
    PUSHED,
    Given,
    Rows,
    distance,
    into_dual_cone,
    larger,
    off_dual,
    power_of_row,
    put,
    read,
    read_guess,
    row_times,
    shift,
    size_of,
    within,
)
from ulna.compiler.procedures import Array1, Array2, f64, procedure

_LEAST = 1e-12
"""Diagonal entries count as at least this."""


FEASIBLE, COMPLEMENTARY, AT_REST, RELAXATION, SLIDING, ROUNDS = FIXED = range(6)
"""Entries of `fixed`: tolerances of dual feasibility, of complementarity, and of the relative change of impulses; the
over-relaxation; whether recorded velocities are shifted; how many rounds are made at most, which `span` follows."""


class Problem(NamedTuple):
    """A problem and its iterates; vectors and rows of G are filled up to lanes with zeros.

    Attributes:
        G: Delassus matrix (m, width).
        g: Velocities without impulses (width,).
        x: Impulses (width,).
        y: Velocities (width,).
        before: Impulses before the round (width,).
        work, shifted: (width,).
    """

    G: Array2[f64]
    g: Array1[f64]
    x: Array1[f64]
    y: Array1[f64]
    before: Array1[f64]
    work: Array1[f64]
    shifted: Array1[f64]


class Outcome(NamedTuple):
    """What rounds leave behind.

    Attributes:
        numbers: Dual feasibility, complementarity, and whether it has converged (3,).
        records: Of each round dual feasibility, complementarity, and the former of the final velocities (rounds, 3).
    """

    numbers: Array1[f64]
    records: Array2[f64]


@procedure
def _correct_rows(rows, problem, start, end, kind, relaxation):
    """Corrects a constraint whose rows are held, pushed or bounded, row by row."""
    for i in range(start, end):
        step = relaxation / max(problem.G[i, i], _LEAST)
        value = problem.x[i] - step * problem.y[i]
        if kind != HELD:
            value = within(rows, i, value)
        change = value - problem.x[i]
        problem.x[i] = value
        for k in range(start, end):
            problem.y[k] += problem.G[k, i] * change


@procedure
def _correct_contact(G, x, y, i, mu, relaxation):
    """Corrects a contact: the normal impulse, then the tangential ones."""
    n = i + 2
    value = x[n] - relaxation / max(G[n, n], _LEAST) * y[n]
    value = max(value, 0.0)
    change = value - x[n]
    x[n] = value
    for k in range(i, i + 3):
        y[k] += G[k, n] * change
    step = relaxation / max(min(G[i, i], G[i + 1, i + 1]), _LEAST)
    a, b = x[i] - step * y[i], x[i + 1] - step * y[i + 1]
    length = np.sqrt(a * a + b * b)
    if length > mu * x[n]:
        a, b = a * (mu * x[n] / length), b * (mu * x[n] / length)
    da, db = a - x[i], b - x[i + 1]
    x[i] = a
    x[i + 1] = b
    for k in range(i, i + 3):
        y[k] += G[k, i] * da + G[k, i + 1] * db


@procedure
def _residuals(rows, c, x, y):
    """How far the velocities of a constraint are from where they should be, and the power that should be none."""
    i, kind = rows.starts[c], rows.kinds[c]
    off, most = 0.0, 0.0
    if kind == CONTACT:
        mu = rows.upper[i]
        n = y[i + 2] + mu * np.sqrt(y[i] * y[i] + y[i + 1] * y[i + 1])
        p, q, r = into_dual_cone(y[i], y[i + 1], n, mu)
        off = np.sqrt((p - y[i]) * (p - y[i]) + (q - y[i + 1]) * (q - y[i + 1]) + (r - n) * (r - n))
        most = abs(x[i] * y[i] + x[i + 1] * y[i + 1] + x[i + 2] * n)
    elif kind == HELD:
        for k in range(i, rows.starts[c + 1]):
            off = larger(off, abs(y[k]))
            most += x[k] * y[k]
    else:
        for k in range(i, rows.starts[c + 1]):
            most = larger(most, power_of_row(rows, kind, k, y[k], x[k]))
            if kind == PUSHED:
                off = larger(off, larger(0.0, -y[k]))
    return off, most


@procedure
def _round(rows, problem, numbers, relaxation, W):
    """Corrects all constraints, and measures each right after."""
    numbers[0] = 0.0
    numbers[1] = 0.0
    for c in range(len(rows.kinds)):
        start, end, kind = rows.starts[c], rows.starts[c + 1], rows.kinds[c]
        for i in range(start, end):
            problem.y[i] = row_times(problem.G, i, problem.x, 0, W) + problem.g[i]
        if kind == CONTACT:
            _correct_contact(problem.G, problem.x, problem.y, start, rows.upper[start], relaxation)
        else:
            _correct_rows(rows, problem, start, end, kind, relaxation)
        off, most = _residuals(rows, c, problem.x, problem.y)
        numbers[0] = larger(numbers[0], off)
        numbers[1] = larger(numbers[1], most)


@procedure
def _off_in_the_end(rows, problem, sliding, W):
    """How far the velocities that follow from all impulses are from where they should be."""
    for i in range(len(problem.G)):
        problem.work[i] = row_times(problem.G, i, problem.x, 0, W) + problem.g[i]
    if sliding:
        shift(rows, problem.work, problem.shifted)
        for i in range(len(problem.G)):
            problem.work[i] += problem.shifted[i]
    return off_dual(rows, problem.work)


@procedure
def _rounds(rows, problem, outcome, fixed, count, W):
    """Makes rounds until one is good enough, `count` at most; returns how many were not."""
    for k in range(count):
        before = size_of(problem.x, W)
        for n in range(0, len(problem.x), W):
            problem.before[n : n + W] = problem.x[n : n + W]
        _round(rows, problem, outcome.numbers, fixed[RELAXATION], W)
        change = distance(problem.x, problem.before, W)
        if len(outcome.records) > 0:
            outcome.records[k, 0] = outcome.numbers[0]
            outcome.records[k, 1] = outcome.numbers[1]
            outcome.records[k, 2] = _off_in_the_end(rows, problem, fixed[SLIDING] > 0.0, W)
        is_solved = outcome.numbers[0] <= fixed[FEASIBLE] and outcome.numbers[1] <= fixed[COMPLEMENTARY]
        if is_solved or change <= fixed[AT_REST] * max(size_of(problem.x, W), before):
            outcome.numbers[2] = 1.0
            return k
    return count


@procedure(constants={"W": LANES})
def gauss_seidel_search(
    given: Given,
    rows: Rows,
    problem: Problem,
    outcome: Outcome,
    fixed: Array1[f64],
    span: Array1[INT],
    W: int,
) -> bool:
    """Makes the rounds from `span[0]` to the one before `span[1]`, or to one that is good enough; writes the solution.

    The problem is read where the first is 0, but for G where `span[2]` says so. Returns whether a round is good enough.
    """
    m, first = len(given.g), span[0]
    if first == 0:
        read(given, problem.G, problem.g, span[2] > 0, True)
        read_guess(given, HEAD, 0, problem.x)
        outcome.numbers[2] = 0.0
    done = first + _rounds(rows, problem, outcome, fixed, span[1] - first, W)
    given.out[HAS_IMPULSES_OUT] = 0.0
    given.out[HAS_VELOCITIES_OUT] = 0.0
    given.out[PRIMAL_OUT] = 0.0
    given.out[DUAL_OUT] = outcome.numbers[0]
    given.out[POWER_OUT] = outcome.numbers[1]
    given.out[ITERATIONS_OUT] = float(done)
    given.out[CONVERGED_OUT] = outcome.numbers[2]
    put(given.out, HEAD, problem.x, m)
    put(given.out, HEAD + m, problem.y, m)
    return outcome.numbers[2] > 0.0
