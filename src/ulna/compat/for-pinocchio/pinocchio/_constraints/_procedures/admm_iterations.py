"""Iterations of the alternating directions (ADMM) with a proximal term, as a procedure for problems of any size.

| symbol | meaning | shape | unit |
|---|---|---|---|
| G, g | Delassus matrix with compliance; velocities of the constraints without impulses | (m, m), (m,) | |
| x, y | impulses that solve the linear equations; the nearest impulses that the constraints may have | (m,) | [N s] |
| z | velocities with them, shifted by s | (m,) | [m/s] |
| s | De Saxce's shift of contacts: mu times the tangential velocity, along the normal | (m,) | [m/s] |
| X, Z | x and z that an iteration starts from: those of the last one, or extrapolated from several | (m,) | |
| r, p | weights of y = x, and of the proximal term: tau rho and tau_prox mu_prox of the settings | | [1/kg] |

    y = P(X - Z / r),   s = shift of Z,   (G + (p + r) I) x = Z + r y + p X - g - s,   z = Z - r (x - y)

The second iteration starts where the first one did: only later ones start from the last result. The primal residual is
the largest entry of x - y, the dual one that of x - X times the larger weight; rho grows where the first is much
larger, and shrinks where the second is. Source: Boyd et al., Distributed optimization by ADMM (2011), section 3;
Carpentier, Le Lidec & Montaut, From compliant to rigid contact simulation (2024), for the spectral rule of rho;
Stellato et al., OSQP (2020), section 5.2, for the other one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pinocchio._constraints._procedures.anderson import History, accelerate, clear, remember
from pinocchio._constraints._procedures.lanczos_steps import decompose, eigenvalue
from pinocchio._constraints._procedures.solver_rows import (
    CONVERGED_OUT,
    DUAL_OUT,
    HAS_IMPULSES_OUT,
    HAS_VELOCITIES_OUT,
    INT,
    ITERATIONS_OUT,
    LANES,
    POWER_OUT,
    PRIMAL_OUT,
    Given,
    Rows,
    distance,
    off_dual,
    power,
    project,
    put,
    read,
    read_guess,
    row_times,
    shift,
    size_of,
)
from pinocchio._constraints._procedures.square_root_free import Factors, factorize, solve
from ulna.compiler.procedures import Array1, Array2, f64, procedure

RHO, MU, PRIMAL, DUAL, POWER, COUNT, WAITED, SIZE_X, SIZE_Y, SIZE_Z, BEFORE, ENDED, LARGEST, WEIGHT = range(
    14
)
LEAST, EXPONENT = 14, 15
NOW = range(16)
"""Entries of `Iterates.now`; BEFORE is the primal residual of the last extrapolation, WEIGHT that of the factors,
LARGEST and LEAST are the eigenvalues of the rule SPECTRAL, EXPONENT is its power."""
X_AT, Y_AT, Z_AT, S_AT = 1, 2, 3, 4
"""Which of the vectors of `Iterates`, from g on, are x, y, z and s."""
RECORDED = 9
"""So many numbers are recorded of an iteration."""


FIXED = range(24)
TAU, TAU_PROX, DUAL_MOMENTUM, RHO_MOMENTUM, RHO_MIN, RHO_MAX, LEAST_CHANGE, RATIO, ABSOLUTE, RELATIVE = FIXED[
    :10
]
LEAST_POWER, FACTOR, RULE, AUTOMATIC, SLIDING, WAIT, MOST, PROXIMAL, SPECTRAL, FACTOR_EXPONENT = FIXED[10:20]
FIRST_RHO, FIRST_EXPONENT, IS_WARM, ITERATIONS = FIXED[20:]
"""Entries of `fixed`: the settings, FACTOR being by what SPECTRAL and LINEAR multiply rho; RULE 0 keeps it, 1
multiplies it, 2 is that of OSQP; PROXIMAL is the proximal weight, FACTOR_EXPONENT the exponent of which SPECTRAL makes
its factor. Then rho at first, or -1 for one between the eigenvalues, the power of the rule SPECTRAL at first, whether
both are those of the solution before, and how many iterations are made at most, which `span` follows."""
RHO_OUT, MU_OUT, EXPONENT_OUT, COUNT_OUT = 7, 8, 9, 10
HEAD = 11
"""Entries of `Given.out` after those that all results have, and how many there are before the vectors; z and s follow
those vectors that all have."""
IN_VAIN, SOLVED, NOT_APART = 0, 1, 2
"""What `admm_search` returns; NOT_APART: the rule SPECTRAL has no factor for equal eigenvalues."""


class Basis(NamedTuple):
    """Storage for the largest eigenvalue.

    Attributes:
        Q: (k, width), see `lanczos_steps.decompose`.
        diagonal: (k,).
        below: (k - 1,).
    """

    Q: Array2[f64]
    diagonal: Array1[f64]
    below: Array1[f64]


class Iterates(NamedTuple):
    """A problem and its iterates; vectors and rows of G are filled up to lanes with zeros.

    Attributes:
        G: (m, width).
        g, x, y, z, s: (width,), see the module.
        X, Z: What the next iteration starts from, if its result is not extrapolated (width,).
        from_x, from_y, from_z: What the present iteration started from (width,).
        work, right: (width,).
        now: Numbers, see the constants.
        records: Of each iteration what `ADMMSolverStats` holds (iterations, 9).
    """

    G: Array2[f64]
    g: Array1[f64]
    x: Array1[f64]
    y: Array1[f64]
    z: Array1[f64]
    s: Array1[f64]
    X: Array1[f64]
    Z: Array1[f64]
    from_x: Array1[f64]
    from_y: Array1[f64]
    from_z: Array1[f64]
    work: Array1[f64]
    right: Array1[f64]
    now: Array1[f64]
    records: Array2[f64]


@procedure
def _copy(source, target, W):
    for n in range(0, len(source), W):
        target[n : n + W] = source[n : n + W]


@procedure
def _nearest(rows, at, X, Z, weight, W):
    """y, from X and Z; returns the primal residual of X."""
    for n in range(0, len(X), W):
        at.work[n : n + W] = X[n : n + W] - Z[n : n + W] / weight
    project(rows, at.work, at.y)
    _copy(X, at.from_x, W)
    _copy(Z, at.from_z, W)
    return distance(X, at.y, W)


@procedure
def _start(rows, at, history, k, weight, W):
    """What iteration k starts from, and y."""
    capacity = len(history.x)
    if k > 1:
        if capacity > 0:
            remember(history, at.x, at.z, at.from_z)
        _copy(at.x, at.X, W)
        _copy(at.z, at.Z, W)
        if capacity > 1 and history.count[0] == capacity:
            accelerate(history, at.X, at.Z, len(at.G), W)
    _copy(at.y, at.from_y, W)
    off = _nearest(rows, at, at.X, at.Z, weight, W)
    if capacity > 1 and k > 1 and off >= at.now[BEFORE] and history.count[0] == capacity:
        clear(history)
        off = _nearest(rows, at, at.x, at.z, weight, W)
    at.now[BEFORE] = off


@procedure
def _solve_equations(rows, at, factors, fixed, weight, W):
    """s, x and z."""
    near, momentum = at.now[MU] * fixed[TAU_PROX], fixed[DUAL_MOMENTUM]
    if fixed[SLIDING] > 0.0:
        shift(rows, at.from_z, at.s)
    for n in range(0, len(at.x), W):
        to = at.y[n : n + W] * weight + at.from_x[n : n + W] * near
        to = to + at.from_z[n : n + W] - (at.g[n : n + W] + at.s[n : n + W])
        at.right[n : n + W] = to
        at.x[n : n + W] = to
    solve(factors, at.x, W)
    for n in range(0, len(at.x), W):
        moved = at.from_z[n : n + W] - (at.x[n : n + W] - at.y[n : n + W]) * weight
        at.z[n : n + W] = at.from_z[n : n + W] * momentum + moved * (1.0 - momentum)


@procedure
def _measure(rows, at, fixed, W):
    """The residuals; whether they, or the changes of all iterates, are small enough."""
    dx, dy, dz = distance(at.x, at.from_x, W), distance(at.y, at.from_y, W), distance(at.z, at.from_z, W)
    at.now[PRIMAL] = distance(at.x, at.y, W)
    at.now[DUAL] = max(at.now[MU] * fixed[TAU_PROX], at.now[RHO] * fixed[TAU]) * dx
    at.now[POWER] = power(rows, at.z, at.y)
    x, y, z = size_of(at.x, W), size_of(at.y, W), size_of(at.z, W)
    is_solved = (
        at.now[POWER] <= fixed[LEAST_POWER]
        and at.now[DUAL] <= fixed[ABSOLUTE] + fixed[RELATIVE] * max(size_of(at.g, W), z)
        and at.now[PRIMAL] <= fixed[ABSOLUTE] + fixed[RELATIVE] * max(x, y)
    )
    is_at_rest = (
        dx <= fixed[RELATIVE] * max(x, at.now[SIZE_X])
        and dy <= fixed[RELATIVE] * max(y, at.now[SIZE_Y])
        and dz <= fixed[RELATIVE] * max(z, at.now[SIZE_Z])
    )
    at.now[SIZE_X] = x
    at.now[SIZE_Y] = y
    at.now[SIZE_Z] = z
    return is_solved or is_at_rest


@procedure
def _wanted_rho(now, fixed):
    """rho by the rule of the settings, within its bounds."""
    rho, primal, dual = now[RHO], now[PRIMAL], now[DUAL]
    if fixed[RULE] > 0.0:
        grows = primal > fixed[RATIO] * dual
        if grows or dual > fixed[RATIO] * primal:
            if fixed[RULE] > 1.0:
                rho = rho * np.sqrt(primal / (dual + 1e-8))
            else:
                rho = rho * fixed[FACTOR] if grows else rho / fixed[FACTOR]
    rho = max(min(rho, fixed[RHO_MAX]), fixed[RHO_MIN])
    kept = fixed[RHO_MOMENTUM]
    if kept >= 1.0:
        return now[RHO]
    if kept > 0.0 and rho != now[RHO]:
        rho = np.exp(kept * np.log(now[RHO]) + (1.0 - kept) * np.log(rho))
        rho = max(min(rho, fixed[RHO_MAX]), fixed[RHO_MIN])
    return rho


@procedure
def _factorize(at, factors, fixed, W):
    """Factorizes G with the present weights."""
    at.now[WEIGHT] = fixed[TAU_PROX] * at.now[MU] + fixed[TAU] * at.now[RHO]
    at.now[COUNT] += 1.0
    factorize(factors, at.G, at.now[WEIGHT], W)


@procedure
def _update(at, factors, fixed, W):
    """Changes rho, where that is allowed, and factorizes anew."""
    if at.now[COUNT] >= fixed[MOST] or at.now[WAITED] < fixed[WAIT]:
        return
    rho, least = _wanted_rho(at.now, fixed), fixed[LEAST_CHANGE]
    if rho != at.now[RHO] and (rho >= least * at.now[RHO] or at.now[RHO] >= least * rho):
        at.now[RHO] = rho
        if fixed[AUTOMATIC] > 0.0:
            at.now[MU] = rho
        at.now[WAITED] = 0.0
        if fixed[TAU_PROX] * at.now[MU] + fixed[TAU] * rho != at.now[WEIGHT]:
            _factorize(at, factors, fixed, W)


@procedure
def _find_velocities(at, velocities, W):
    """The velocities G y + g."""
    for i in range(len(at.G)):
        velocities[i] = row_times(at.G, i, at.y, 0, W) + at.g[i]


@procedure
def _add_shift(rows, velocities, shifts, fixed):
    """Adds De Saxce's shift to velocities where contacts slide, and leaves it in `shifts`."""
    if fixed[SLIDING] > 0.0:
        shift(rows, velocities, shifts)
        for i in range(len(velocities)):
            velocities[i] += shifts[i]


@procedure
def _record(rows, at, history, factors, fixed, k, W):
    """Records an iteration, before rho changes."""
    for i in range(len(at.G)):
        at.work[i] = row_times(at.G, i, at.x, 0, W) + at.now[WEIGHT] * at.x[i]
    at.records[k, 7] = distance(at.work, at.right, W)
    solve(factors, at.work, W)
    at.records[k, 8] = distance(at.work, at.x, W)
    _find_velocities(at, at.work, W)
    _add_shift(rows, at.work, at.right, fixed)
    at.records[k, 2] = off_dual(rows, at.work)
    at.records[k, 0] = at.now[PRIMAL]
    at.records[k, 1] = at.now[DUAL]
    at.records[k, 3] = at.now[POWER]
    at.records[k, 4] = at.now[RHO]
    at.records[k, 5] = at.now[MU]
    at.records[k, 6] = float(history.count[0])


@procedure
def _iterations(rows, at, history, factors, fixed, first, last, W):
    """Makes the iterations from `first` to the one before `last`, or to one that is good enough, which it returns.

    Where none was, it returns `last`.
    """
    if first == 0:
        _factorize(at, factors, fixed, W)
    for k in range(first, last):
        weight = fixed[TAU] * at.now[RHO]
        _start(rows, at, history, k, weight, W)
        _solve_equations(rows, at, factors, fixed, weight, W)
        is_good = _measure(rows, at, fixed, W)
        if len(at.records) > 0:
            _record(rows, at, history, factors, fixed, k - first, W)
        if is_good:
            at.now[ENDED] = 1.0
            return k
        _update(at, factors, fixed, W)
        at.now[WAITED] += 1.0
    return last


@procedure
def _first_iterates(rows, at, factors, fixed, has_impulses, has_velocities, W):
    """x, y, z and s from what is given, impulses in x, velocities in z: one follows from the other."""
    for i in range(len(at.s)):
        at.s[i] = 0.0
    if has_velocities:
        _add_shift(rows, at.z, at.s, fixed)
        if not has_impulses:
            factorize(factors, at.G, at.now[MU], W)
            for i in range(len(at.x)):
                at.x[i] = at.z[i] - at.g[i] - at.s[i]
            solve(factors, at.x, W)
    for i in range(len(at.y)):
        at.y[i] = 0.0
    if has_impulses or has_velocities:
        project(rows, at.x, at.y)
    if not has_velocities:
        _find_velocities(at, at.z, W)
        _add_shift(rows, at.z, at.s, fixed)


@procedure
def _raised(base, exponent):
    """A power of a number above zero."""
    return np.exp(exponent * np.log(base)) if exponent != 0.0 else 1.0


@procedure
def _spectral(largest, least, exponent):
    """A weight between the least and the greatest eigenvalue: sqrt(L l) (L / l)^exponent."""
    return np.sqrt(largest * least) * _raised(largest / least, exponent)


@procedure
def _first_rho(at, fixed, rho, exponent):
    """Sets rho, below 0 for one between the eigenvalues, and mu where it follows rho."""
    if rho < 0.0:
        largest = at.now[LARGEST]  # nan counts as 1
        rho = _spectral(largest if abs(largest) >= 0.0 else 1.0, at.now[LEAST], exponent)
    at.now[RHO] = max(min(rho, fixed[RHO_MAX]), fixed[RHO_MIN])
    at.now[EXPONENT] = exponent
    if fixed[AUTOMATIC] > 0.0:
        at.now[MU] = at.now[RHO]


@procedure
def _note_first(at, W):
    """Notes the first iterates as those of the iteration before."""
    _copy(at.x, at.X, W)
    _copy(at.z, at.Z, W)
    at.now[SIZE_X] = size_of(at.x, W)
    at.now[SIZE_Y] = size_of(at.y, W)
    at.now[SIZE_Z] = size_of(at.z, W)
    at.now[BEFORE] = np.inf
    at.now[PRIMAL] = 0.0
    at.now[WAITED] = 0.0
    at.now[ENDED] = 0.0
    at.now[WEIGHT] = at.now[MU]


@procedure
def _begin(given, rows, at, history, factors, basis, fixed, has_matrix, W):
    """Reads the problem, and prepares the iterations.

    Returns SOLVED where what they start from is a solution within the absolute tolerances.
    """
    read(given, at.G, at.g, has_matrix, False)
    has_impulses = read_guess(given, HEAD, 0, at.x)
    has_velocities = read_guess(given, HEAD, 1, at.z)
    least = np.inf
    for i in range(len(at.G)):
        least = min(least, given.compliance[i])
    at.now[LEAST] = fixed[PROXIMAL]
    if len(at.G) > 0:
        at.now[LEAST] += least
    rho, exponent = fixed[FIRST_RHO], fixed[FIRST_EXPONENT]
    if fixed[IS_WARM] > 0.0 and abs(given.out[RHO_OUT]) >= 0.0:
        rho, exponent = given.out[RHO_OUT], given.out[EXPONENT_OUT]
    at.now[MU] = fixed[PROXIMAL]
    at.now[COUNT] = 1.0
    if fixed[SPECTRAL] > 0.0 or rho < 0.0:
        decompose(at.G, at.now[MU], basis.Q, basis.diagonal, basis.below, at.work, W)
        at.now[LARGEST] = eigenvalue(basis.diagonal, basis.below, len(basis.diagonal) - 1, 1e-8)
        if len(at.G) == 1:
            at.now[LARGEST] = at.G[0, 0]
    _first_iterates(rows, at, factors, fixed, has_impulses, has_velocities, W)
    clear(history)
    _note_first(at, W)
    _find_velocities(at, at.work, W)
    _add_shift(rows, at.work, at.s, fixed)
    at.now[DUAL] = off_dual(rows, at.work)
    at.now[POWER] = power(rows, at.work, at.y)
    _first_rho(at, fixed, rho, exponent)
    if at.now[POWER] <= fixed[LEAST_POWER] and at.now[DUAL] <= fixed[ABSOLUTE]:
        _copy(at.work, at.z, W)
        at.now[ENDED] = 1.0
        return SOLVED
    if fixed[SPECTRAL] > 0.0:
        largest, least = at.now[LARGEST], at.now[LEAST]
        if not largest > least:
            return NOT_APART
        fixed[FACTOR] = _raised(largest / least, fixed[FACTOR_EXPONENT])
    return IN_VAIN


@procedure
def _end(given, at, iterations):
    """Writes the last iterate, and the damping that the last factors have."""
    m = len(at.G)
    given.out[HAS_IMPULSES_OUT] = 0.0
    given.out[HAS_VELOCITIES_OUT] = 0.0
    given.out[PRIMAL_OUT] = at.now[PRIMAL]
    given.out[DUAL_OUT] = at.now[DUAL]
    given.out[POWER_OUT] = at.now[POWER]
    given.out[ITERATIONS_OUT] = float(iterations)
    given.out[CONVERGED_OUT] = at.now[ENDED]
    given.out[RHO_OUT] = at.now[RHO]
    given.out[MU_OUT] = at.now[MU]
    given.out[EXPONENT_OUT] = at.now[EXPONENT]
    given.out[COUNT_OUT] = at.now[COUNT]
    put(given.out, HEAD, at.y, m)
    put(given.out, HEAD + 4 * m, at.z, m)
    put(given.out, HEAD + 5 * m, at.s, m)
    for i in range(m):
        given.out[HEAD + m + i] = at.z[i] - at.s[i]
        given.damping[i] = at.now[WEIGHT]


@procedure(constants={"W": LANES})
def admm_search(
    given: Given,
    rows: Rows,
    at: Iterates,
    history: History,
    factors: Factors,
    basis: Basis,
    fixed: Array1[f64],
    span: Array1[INT],
    W: int,
) -> int:
    """Makes the iterations from `span[0]` to the one before `span[1]`, or to one that is good enough; writes all.

    The problem is read where the first is 0, but for G where `span[2]` says so. Returns whether an iteration is good
    enough, or NOT_APART.
    """
    first, done = span[0], span[0]
    state = IN_VAIN
    if first == 0:
        state = _begin(given, rows, at, history, factors, basis, fixed, span[2] > 0, W)
        if state == NOT_APART:
            return NOT_APART
    if state == IN_VAIN:
        done = _iterations(rows, at, history, factors, fixed, first, span[1], W)
        if fixed[SPECTRAL] > 0.0:
            largest, least = at.now[LARGEST], at.now[LEAST]
            at.now[EXPONENT] = np.log(at.now[RHO] / np.sqrt(largest * least)) / np.log(largest / least)
    _end(given, at, done)
    return SOLVED if at.now[ENDED] > 0.0 else IN_VAIN
