"""The backward sweep of differential dynamic programming over all knots, in one native call.

| symbol | meaning | shape |
|---|---|---|
| F = [fx fu] | derivatives of the dynamics | (ndx, ndx + nu) |
| g, H | gradient and Hessian of a stage's cost by state and control | (ndx + nu,), (ndx + nu, ndx + nu) |
| v, V | gradient and Hessian of the cost from the next knot on | (ndx,), (ndx, ndx) |
| q = g + F' v, Q = H + F' V F | the same from this knot on, by state and control; parts Qx, Qu, Qxx, Qux, Quu | |
| k, K | control law: k = -(Quu + mu)^-1 Qu, K = -(Quu + mu)^-1 Qux | (nu,), (nu, ndx) |

Then v = Qx + (Qux - mu K)' k and V = Qxx + (Qux - mu K)' K (Tassa, Erez & Todorov 2012, equations 5, 10 and 11, where
(Quu + mu) k = -Qu was used). Where controls have limits, k is the minimum of k' (Quu + mu) k / 2 + Qu' k within them
(`box_minimum`), and rows of K are zero for the controls that it holds at a limit: both equations hold unchanged (Tassa,
Mansard & Todorov 2014, section III). Rows are padded to whole registers of 8 numbers; of symmetric matrices the upper
triangle is computed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, Array3, f64, procedure
from ulna.control.box_minimum import FREE, POINT, ROWS, factorised, find_minimum, is_outside
from ulna.control.stages import StageDerivatives, TerminalDerivatives
from ulna.typing import Floats

_LANES = 8


class Gains(NamedTuple):
    """The control laws of all knots, and the predicted decrease of the cost.

    Attributes:
        k: (N, nu).
        K: (N, nu, ndx).
        first: The change of the cost to first order.
        second: What is added to second order.
    """

    k: Floats
    K: Floats
    first: float
    second: float

    @property
    def decrease(self) -> float:
        """By how much a whole step would decrease the cost."""
        return -(self.first + self.second)


def backward(
    knots: StageDerivatives, end: TerminalDerivatives, mu: float = 0.0, changes: Floats | None = None
) -> Gains | None:
    """The control laws that minimise the quadratic model of the cost, from the last knot to the first.

    Args:
        knots: Derivatives of N stages, (N, ...) each.
        end: Derivatives of the last cost.
        mu: What is added to the diagonal of Quu [any].
        changes: The least and greatest k of each knot, (2, N, nu); the first are not above, and the second not below
            zero. None for no limits.

    Returns:
        The control laws, or None where Quu + mu is not positive definite.
    """
    count, n, m = knots.fu.shape
    width = -(-(n + m) // _LANES) * _LANES
    F, H, g = np.zeros((count, n, width)), np.zeros((count, n + m, width)), np.zeros((count, width))
    F[:, :, :n], F[:, :, n : n + m] = knots.fx, knots.fu
    H[:, :n, :n], H[:, n:, :n], H[:, n:, n : n + m] = knots.lxx, knots.lux, knots.luu
    g[:, :n], g[:, n : n + m] = knots.lx, knots.lu
    V, v, gains = np.zeros((n, width)), np.array(end.lx), np.empty((count, m, width))
    V[:, :n] = end.lxx
    work, Q, q, factor = np.empty((n, width)), np.empty((n + m, width)), np.empty(width), np.empty((m, m))
    numbers, limits = np.array([mu, 0.0, 0.0]), np.empty((2, 0, m)) if changes is None else changes
    box = np.empty((ROWS, m))
    if not _sweep(F, H, g, V, v, work, Q, q, factor, gains, numbers, limits, box):
        return None
    return Gains(gains[:, :, n].copy(), gains[:, :, :n].copy(), float(numbers[1]), float(numbers[2]))


@procedure(constants={"W": _LANES}, contract=True)
def _sweep(
    F: Array3[f64],
    H: Array3[f64],
    g: Array2[f64],
    V: Array2[f64],
    v: Array1[f64],
    work: Array2[f64],
    Q: Array2[f64],
    q: Array1[f64],
    factor: Array2[f64],
    gains: Array3[f64],
    numbers: Array1[f64],
    limits: Array3[f64],
    box: Array2[f64],
    W: int,
) -> bool:
    """All knots; `numbers` are mu and the two changes of cost. Column n of `gains` is k, those before it are K.

    Rows of `box` belong to the search within limits.
    """
    for t in range(F.shape[0] - 1, -1, -1):
        _model(t, F, H, g, V, v, work, Q, q, W)
        for i in range(factor.shape[0]):
            box[FREE, i] = 1.0
        if not factorised(F.shape[1], Q, factor, box, numbers[0]):
            return False
        _solve(t, F.shape[1], Q, q, factor, box, gains, W)
        if limits.shape[1] > 0 and is_outside(t, F.shape[1], gains, limits):
            find_minimum(t, F.shape[1], Q, q, factor, box, gains, limits, numbers[0])
            _solve(t, F.shape[1], Q, q, factor, box, gains, W)
            for i in range(factor.shape[0]):
                gains[t, i, F.shape[1]] = box[POINT, i]
        _update(t, F.shape[1], V, v, Q, q, gains, numbers, W)
    return True


@procedure(contract=True)
def _model(t, F, H, g, V, v, work, Q, q, W):
    """The gradient q and the Hessian Q; of its rows by the state, what is right of the diagonal."""
    n, width = F.shape[1], F.shape[2]
    for i in range(n):
        for p in range(0, width, W):
            total = F[t, 0, p : p + W] * V[i, 0]
            for k in range(1, n):
                total = total + F[t, k, p : p + W] * V[i, k]
            work[i, p : p + W] = total
    for i in range(Q.shape[0]):
        start = 0
        if i < n:
            start = i // W * W
        for p in range(start, width, W):
            total = H[t, i, p : p + W]
            for k in range(n):
                total = total + work[k, p : p + W] * F[t, k, i]
            Q[i, p : p + W] = total
    for p in range(0, width, W):
        slope = g[t, p : p + W]
        for k in range(n):
            slope = slope + F[t, k, p : p + W] * v[k]
        q[p : p + W] = slope


@procedure(contract=True)
def _solve(t, n, Q, q, factor, box, gains, W):
    """The control law of knot t, zero for controls that are not free; columns after that of k are not used."""
    m, width = factor.shape[0], Q.shape[1]
    for i in range(m):
        for p in range(0, width, W):
            gains[t, i, p : p + W] = -Q[n + i, p : p + W] * box[FREE, i]
        gains[t, i, n] = -q[n + i] * box[FREE, i]
        for k in range(i):
            for p in range(0, width, W):
                gains[t, i, p : p + W] = gains[t, i, p : p + W] - gains[t, k, p : p + W] * factor[i, k]
    for i in range(m - 1, -1, -1):
        for p in range(0, width, W):
            total = gains[t, i, p : p + W] / factor[i, i]
            for k in range(i + 1, m):
                total = total - gains[t, k, p : p + W] * factor[k, i]
            gains[t, i, p : p + W] = total


@procedure(contract=True)
def _update(t, n, V, v, Q, q, gains, numbers, W):
    """Gradient and Hessian of the cost from knot t on, and the changes of cost."""
    mu, m = numbers[0], gains.shape[1]
    for j in range(m):
        bend = 0.0
        for i in range(m):
            bend = bend + Q[n + j, n + i] * gains[t, i, n]
        numbers[1] = numbers[1] + gains[t, j, n] * q[n + j]
        numbers[2] = numbers[2] + 0.5 * gains[t, j, n] * bend
    for i in range(n):
        slope = q[i]
        for j in range(m):
            slope = slope + (Q[n + j, i] - mu * gains[t, j, i]) * gains[t, j, n]
        v[i] = slope
        for p in range(i // W * W, n, W):
            total = Q[i, p : p + W]
            for j in range(m):
                total = total + gains[t, j, p : p + W] * (Q[n + j, i] - mu * gains[t, j, i])
            V[i, p : p + W] = total
    for i in range(n):
        for j in range(i):
            V[i, j] = V[j, i]
