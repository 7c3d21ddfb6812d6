"""The sets that impulses of constraints belong to, row by row, and what solvers ask of them: procedures.

| kind | impulses | dual |
|---|---|---|
| HELD | any | zero |
| CONTACT | Coulomb's cone: tangential part at most mu times the normal one | its dual |
| PUSHED | not below zero | the same |
| BOUNDED | between bounds | any |

Source: Parikh & Boyd, Proximal algorithms (2014), section 6.3.2; de Saxce & Feng, The bipotential method (1998).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, f64, greatest_of, procedure, sum_of

HELD, CONTACT, PUSHED, BOUNDED = 0, 1, 2, 3
LANES = 8
"""Vectors and rows of matrices are filled up with zeros to a multiple of this."""


INT = np.int64


class Rows(NamedTuple):
    """The constraints of a problem of m rows.

    Attributes:
        kinds: Of each constraint (c,).
        starts: The first row of each constraint, and m last (c + 1,).
        lower: Bounds of impulses (m,).
        upper: Bounds of impulses (m,); of the first row of a contact its coefficient of friction.
    """

    kinds: Array1[INT]
    starts: Array1[INT]
    lower: Array1[f64]
    upper: Array1[f64]


class Given(NamedTuple):
    """A problem as it is given, and what its solution is written into.

    Attributes:
        G: Delassus matrix (m, m).
        compliance: What is added to its diagonal (m,).
        damping: The same (m,).
        g: Velocities without impulses (m,).
        out: Numbers, then vectors of m entries, as `ConstraintSolverResult` has them.
    """

    G: Array2[f64]
    compliance: Array1[f64]
    damping: Array1[f64]
    g: Array1[f64]
    out: Array1[f64]


PRIMAL_OUT, DUAL_OUT, POWER_OUT, ITERATIONS_OUT, CONVERGED_OUT, HAS_IMPULSES_OUT, HAS_VELOCITIES_OUT = range(
    7
)
HEAD = 7
"""Entries of `Given.out` that all results begin with: the residuals, how many iterations, whether it has converged,
and whether it has impulses and velocities to start from; and how many these are. Vectors follow, in this order: the
impulses, the velocities, and both to start from."""


@procedure
def read(given, G, g, has_matrix, damped):
    """Reads a problem into a matrix, where this has it not yet, and a vector; with `damped` the damping counts."""
    for i in range(len(given.g)):
        g[i] = given.g[i]
        if not has_matrix:
            for k in range(len(given.g)):
                G[i, k] = given.G[i, k]
        added = given.compliance[i]
        if damped:
            added += given.damping[i]
        G[i, i] += added


@procedure
def read_guess(given, head, k, x):
    """Reads impulses (k = 0) or velocities (k = 1) to start from, or zeros where there are none; whether there are."""
    m = len(given.g)
    has_guess = given.out[HAS_IMPULSES_OUT + k] > 0.0
    for i in range(m):
        x[i] = given.out[head + (2 + k) * m + i] if has_guess else 0.0
    return has_guess


@procedure
def put(out, start, vector, m):
    """Writes the first m entries of a vector into entries from `start` on."""
    for i in range(m):
        out[start + i] = vector[i]


@procedure
def into_cone(a, b, n, mu):
    """The nearest force of the friction cone."""
    length = np.sqrt(a * a + b * b)
    if mu * length <= -n:
        return 0.0, 0.0, 0.0
    if length <= mu * n:
        return a, b, n
    r = 1.0 / np.sqrt(mu * mu + 1.0)
    p, q = mu / length * a * r, mu / length * b * r
    along = a * p + b * q + n * r
    return along * p, along * q, along * r


@procedure
def into_dual_cone(a, b, n, mu):
    """The nearest vector of the dual of the friction cone."""
    length = np.sqrt(a * a + b * b)
    if length <= -mu * n:
        return 0.0, 0.0, 0.0
    if mu * length <= n:
        return a, b, n
    whole = np.sqrt(length * length + mu * length * (mu * length))
    p, q, r = a / whole, b / whole, mu * length / whole
    along = a * p + b * q + n * r
    return along * p, along * q, along * r


@procedure
def put_three(out, i, a, b, c):
    """Writes three entries from entry i on."""
    out[i] = a
    out[i + 1] = b
    out[i + 2] = c


@procedure
def project(rows, x, out):
    """The nearest impulses of the sets."""
    for c in range(len(rows.kinds)):
        i, kind = rows.starts[c], rows.kinds[c]
        if kind == CONTACT:
            p, q, r = into_cone(x[i], x[i + 1], x[i + 2], rows.upper[i])
            put_three(out, i, p, q, r)
        else:
            for k in range(i, rows.starts[c + 1]):
                out[k] = x[k] if kind == HELD else within(rows, k, x[k])


@procedure
def within(rows, k, value):
    """A number within the bounds of a row; nan stays."""
    if value < rows.lower[k]:
        return rows.lower[k]
    if value > rows.upper[k]:
        return rows.upper[k]
    return value


@procedure
def shift(rows, v, out):
    """De Saxce's shift of the velocities of contacts; zero for all others."""
    for c in range(len(rows.kinds)):
        i = rows.starts[c]
        for k in range(i, rows.starts[c + 1]):
            out[k] = 0.0
        if rows.kinds[c] == CONTACT:
            out[i + 2] = rows.upper[i] * np.sqrt(v[i] * v[i] + v[i + 1] * v[i + 1])


@procedure
def larger(a, b):
    """The larger number; nan where one is nan."""
    if a >= b:
        return a
    return b if b > a else a + b


@procedure
def off_dual(rows, v):
    """The largest entry of what velocities lack to lie in the duals of the sets."""
    off = 0.0
    for c in range(len(rows.kinds)):
        i, kind = rows.starts[c], rows.kinds[c]
        if kind == CONTACT:
            p, q, r = into_dual_cone(v[i], v[i + 1], v[i + 2], rows.upper[i])
            off = larger(larger(larger(off, abs(v[i] - p)), abs(v[i + 1] - q)), abs(v[i + 2] - r))
        else:
            for k in range(i, rows.starts[c + 1]):
                if kind == HELD:
                    off = larger(off, abs(v[k]))
                elif kind == PUSHED:
                    off = larger(off, larger(0.0, -v[k]))
    return off


@procedure
def power_of_row(rows, kind, k, v, x):
    """The power that the impulse and the velocity of a row that is pushed or bounded should not have."""
    if kind == PUSHED:
        return abs(x * v)
    ahead = larger(0.0, v)
    return larger(ahead * (x - rows.lower[k]), (ahead - v) * (rows.upper[k] - x))


@procedure
def power(rows, v, x):
    """The largest power of a contact or a row that should have none; rows that are held do not count."""
    most = 0.0
    for c in range(len(rows.kinds)):
        i, kind = rows.starts[c], rows.kinds[c]
        if kind == CONTACT:
            most = larger(most, abs(x[i] * v[i] + x[i + 1] * v[i + 1] + x[i + 2] * v[i + 2]))
        elif kind != HELD:
            for k in range(i, rows.starts[c + 1]):
                most = larger(most, power_of_row(rows, kind, k, v[k], x[k]))
    return most


@procedure
def size_of(x, W):
    """The largest absolute value of a vector that is filled up to lanes; nan where an entry is not finite."""
    most, total = abs(x[0:W]), x[0:W]
    for n in range(W, len(x), W):
        most = np.maximum(most, abs(x[n : n + W]))
        total = total + x[n : n + W]
    return greatest_of(most) + 0.0 * sum_of(total)


@procedure
def distance(x, y, W):
    """The largest absolute value of a difference of such vectors; nan where it is not finite."""
    total = x[0:W] - y[0:W]
    most = abs(total)
    for n in range(W, len(x), W):
        most = np.maximum(most, abs(x[n : n + W] - y[n : n + W]))
        total = total + (x[n : n + W] - y[n : n + W])
    return greatest_of(most) + 0.0 * sum_of(total)


@procedure
def row_times(G, i, x, first, W):
    """Row i of a matrix, whose rows are filled up to lanes with zeros as `x` is, times x from entry `first` on."""
    total = G[i, first : first + W] * x[first : first + W]
    for n in range(first + W, len(x), W):
        total = total + G[i, n : n + W] * x[n : n + W]
    return sum_of(total)
