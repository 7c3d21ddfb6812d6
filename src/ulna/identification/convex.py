"""Least squares over bodies that can exist, as a convex problem: an interior-point method on the pseudo-inertias.

| symbol | meaning | shape | equation |
|---|---|---|---|
| u | parameters, each divided by its unit | (n) | ten for each of k bodies, then those of the drives |
| A, z | regressor and torques, reduced by QR | (n, n), (n) | |
| w | weight of the distance to the prior u0 | (n) | |
| f | cost | | abs(A u - z)^2 + sum w (u - u0)^2 |
| P | pseudo-inertias, linear in u | (k, 4, 4) | positive definite |
| d | parameters of the drives | (n - 10 k) | greater than zero |
| phi | what Newton's method minimises for a growing t | | t f - sum log det P - sum log d |

Sources: Wensing, Kim & Slotine, Linear matrix inequalities for physically consistent inertial parameter identification
(2018); Boyd & Vandenberghe, Convex Optimization (2004), section 11.3: the minimiser of phi has a cost of at most
(4 k + n - 10 k) / t above the least one. No step depends on the number of samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ulna.errors import UlnaError
from ulna.identification.physical import nearest_physical, pseudo_inertia
from ulna.typing import Floats

GAP = 1e-8
"""The search ends when its cost is certain to be within this fraction of the least one ..."""

ROUNDING = 1e-13
"""... or within this fraction of the mean squared torque, where the least cost is nearly zero."""

_GROWTH = 20.0
_STEPS = 400
_BASIS = pseudo_inertia(np.eye(10))


@dataclass(frozen=True)
class Progress:
    """How far the search for physically consistent parameters has come.

    Attributes:
        step: Number of Newton steps so far.
        cost: Mean squared weighted residual, and the term of the prior.
        gap: How far the cost is above the least one, at most, once the current step has converged.
    """

    step: int
    cost: float
    gap: float


@dataclass(frozen=True)
class Problem:
    """The quantities of the table above."""

    A: Floats
    z: Floats
    w: Floats
    u0: Floats
    bodies: int

    @property
    def size(self) -> int:
        """How many inequalities there are: the barrier's parameter."""
        return 4 * self.bodies + len(self.u0) - 10 * self.bodies

    def cost(self, u: Floats) -> float:
        """f(u)."""
        residual, change = self.A @ u - self.z, u - self.u0
        return float(residual @ residual + self.w @ (change * change))

    def split(self, u: Floats) -> tuple[Floats, Floats]:
        """Pseudo-inertias (k, 4, 4), and the parameters of the drives."""
        return pseudo_inertia(u[: 10 * self.bodies].reshape(-1, 10)), u[10 * self.bodies :]


def minimised(problem: Problem, progress: Callable[[Progress], object] | None = None) -> tuple[Floats, int]:
    """The parameters of least cost whose bodies are physically consistent and whose drives are not negative.

    Args:
        problem: The problem; its cost must grow in every direction.
        progress: Called after each step.

    Returns:
        u, shape (n,), and the number of Newton steps.

    Raises:
        UlnaError: the search does not end, which would be a bug.
    """
    u = _strictly_feasible_point(problem)
    scale = float(problem.z @ problem.z) + problem.cost(u)
    if problem.size == 0 or scale == 0.0:
        return u, 0
    A2 = problem.A.T @ problem.A
    quadratic = 2.0 * (A2 + np.diag(problem.w))
    gap, step = max(problem.cost(u), ROUNDING * scale), 0
    while True:
        t = problem.size / gap
        for _ in range(50):
            direction, decrement = _newton(problem, u, t, quadratic)
            u = u + _length(problem, u, direction, t, quadratic) * direction
            step += 1
            if progress is not None:
                progress(Progress(step, problem.cost(u), gap))
            if decrement < 1e-2:
                break
        cost = problem.cost(u)
        if gap <= GAP * cost or gap <= ROUNDING * scale:
            return u, step
        if step > _STEPS:
            raise UlnaError(
                f"The search for physically consistent parameters did not end within {_STEPS} steps: cost {cost:.6g}, "
                f"certain to {gap:.3g}. This is a bug in Ulna; please report it."
            )
        gap /= _GROWTH


def _strictly_feasible_point(problem: Problem) -> Floats:
    """A point near the prior at which every inequality holds strictly."""
    bodies = problem.u0[: 10 * problem.bodies].reshape(-1, 10)
    inside = nearest_physical(bodies, least=1e-3).ravel() if problem.bodies else bodies.ravel()
    return np.concatenate([inside, np.maximum(problem.u0[10 * problem.bodies :], 1e-2)])


def _newton(problem: Problem, u: Floats, t: float, quadratic: Floats) -> tuple[Floats, float]:
    """Newton's direction for phi, and half the square of its decrement."""
    P, d = problem.split(u)
    body = 10 * problem.bodies
    gradient = 2.0 * t * (problem.A.T @ (problem.A @ u - problem.z) + problem.w * (u - problem.u0))
    hessian = t * quadratic
    X = np.linalg.inv(P)[:, None] @ _BASIS  # P^-1 dP/du, (k, 10, 4, 4)
    gradient[:body] -= np.trace(X, axis1=-2, axis2=-1).ravel()
    blocks = np.einsum("kiab,kjba->kij", X, X)
    for k, block in enumerate(blocks):
        hessian[10 * k : 10 * k + 10, 10 * k : 10 * k + 10] += block
    gradient[body:] -= 1.0 / d
    drives = np.arange(body, len(u))
    hessian[drives, drives] += 1.0 / d**2
    root = np.sqrt(np.diag(hessian))
    direction = -np.linalg.solve(hessian / np.outer(root, root), gradient / root) / root
    return direction, -0.5 * float(gradient @ direction)


def _length(problem: Problem, u: Floats, direction: Floats, t: float, quadratic: Floats) -> float:
    """How far to go: where phi is least along the direction, found by Newton's method in one variable.

    Along a line f is a parabola and log det P = log det P0 + sum log(1 + s e), with e the eigenvalues of P0^-1 dP.
    """
    P, d = problem.split(u)
    dP, dd = problem.split(direction)
    inverse = np.linalg.inv(np.linalg.cholesky(P))
    e = np.linalg.eigvalsh(inverse @ dP @ np.swapaxes(inverse, -1, -2)).ravel()
    e = np.concatenate([e, dd / d])
    residual = problem.A @ u - problem.z
    slope = 2.0 * t * float(residual @ (problem.A @ direction) + (problem.w * (u - problem.u0)) @ direction)
    bend = t * float(direction @ quadratic @ direction)
    most = 1.0 / -e.min() if e.min() < 0.0 else np.inf
    s = min(1.0, 0.5 * most)
    for _ in range(30):
        first = slope + bend * s - float((e / (1.0 + s * e)).sum())
        second = bend + float(((e / (1.0 + s * e)) ** 2).sum())
        change = -first / second
        s = min(max(s + change, 0.5 * s), 0.5 * (s + most)) if change != 0.0 else s
        if abs(change) < 1e-3 * s:
            break
    return s
