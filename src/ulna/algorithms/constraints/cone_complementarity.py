"""Impulses of bilateral, unilateral and frictional constraints: cone complementarity, by projected Gauss-Seidel.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| G, g | Delassus matrix; velocity of the constraints without impulses | (m, m), (m) | | |
| x, y | impulses; velocities with them | (m) | [N s], [m/s] | y = G x + g |
| K_i | the set of the impulses of constraint i | | | see the classes below |
| s_i | shift of a contact's velocity | (3) | [m/s] | (0, 0, mu times its tangential length) |
| | what is sought | | | x_i in K_i, y_i + s_i in K_i*, x_i.(y_i + s_i) = 0 |
| | held: any impulse | | | x_i - y_i G_ii^-1 |
| | unilateral, bounded: entry by entry | | | x_k - y_k / G_kk, not below 0; within the bounds |
| | touching, s counted: normal, then friction | | | n - y_n / G_nn not below 0; t - y_t / r, not above mu n |
| | touching, s left out: in the cone | | | the nearest of K to x_i - y_i / r |

One constraint after the other is solved for as if the others were right, round after round, r being the largest
eigenvalue of the block for t, and its trace for the cone. Without the shift the problem is convex, and contacts that
slide lift off; with it they slide as Coulomb says. Source: Jourdan, Alart & Jean, A Gauss-Seidel like algorithm to
solve frictional contact problems (1998); Acary & Brogliato, Numerical methods for nonsmooth dynamical systems (2008),
section 13.7; Le Lidec et al., Contact models in robotics: a comparative analysis (2024), algorithm 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, final

from ulna import linalg, numeric
from ulna.algorithms.constraints import friction_cone
from ulna.algorithms.constraints.proximal_solver import largest
from ulna.errors import InputError
from ulna.numeric import apply, dot, vector
from ulna.typing import Array


@final
@dataclass(frozen=True)
class Bilateral:
    """Rows that any impulse may hold: anchors and loops."""

    size: int


@final
@dataclass(frozen=True)
class Unilateral:
    """Rows that impulses only push: limits."""

    size: int


@final
@dataclass(frozen=True)
class Bounded:
    """Rows whose impulses are between bounds: dry friction of joints."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @property
    def size(self) -> int:
        """How many rows."""
        return len(self.lower)


@final
@dataclass(frozen=True)
class Frictional:
    """Three rows of a contact, two tangential and the normal one, with a coefficient of friction."""

    friction: float
    size: int = 3


Kind = Bilateral | Unilateral | Bounded | Frictional


class Impulses(NamedTuple):
    """What is found."""

    impulses: Array
    """x, (..., m) [N s]."""
    velocities: Array
    """y, (..., m) [m/s]."""
    rounds: Any
    """How many rounds it took, (...), as a float."""
    infeasibility: Any
    """The largest distance of y_i + s_i from where it should be, (...) [m/s]."""
    complementarity: Any
    """The largest power x_i.(y_i + s_i), (...)."""


def gauss_seidel(
    G: Array,
    g: Array,
    kinds: Sequence[Kind],
    guess: Array | None = None,
    feasible: float = 1e-10,
    complementary: float = 1e-10,
    rounds: int = 1000,
    relaxation: float = 1.0,
    sliding: bool = True,
) -> Impulses:
    """Impulses that solve the complementarity problem.

    Args:
        G: Delassus matrix with what it is damped by, shape (..., m, m) [1/kg], its diagonal above zero.
        g: Velocities without impulses, shape (..., m) [m/s].
        kinds: What each constraint is, in the order of the rows.
        guess: Impulses to start from, shape (..., m) [N s]; None for zero.
        feasible: The infeasibility that is small enough [m/s].
        complementary: The complementarity that is small enough [J].
        rounds: The largest number of rounds.
        relaxation: What part of each correction is made, above 0 and below 2 [-].
        sliding: Whether contacts slide as Coulomb says; else the convex problem is solved.

    Returns:
        The impulses, and how accurate they are.

    Raises:
        InputError: The kinds have not as many rows as G.
    """
    m = G.shape[-1]
    if sum(kind.size for kind in kinds) != m:
        raise InputError(f"The constraints have {sum(kind.size for kind in kinds)} rows and the matrix {m}.")
    blocks, start = [], 0
    for kind in kinds:
        blocks.append(_Block(G, start, kind, relaxation, sliding))
        start += kind.size
    zero = 0.0 * (g + G[..., 0])
    x = [(zero if guess is None else zero + guess)[..., i][()] for i in range(m)]

    def errors(x: Sequence[Any]) -> tuple[Any, Any]:
        y = apply(G, vector(*x)) + g
        of_blocks = [block.errors(vector(*x), y) for block in blocks]
        return largest([f for f, _ in of_blocks]), largest([c for _, c in of_blocks])

    def unsolved(*state: Any) -> Any:
        return numeric.maximum(state[m] - feasible, state[m + 1] - complementary) > 0.0

    def one(*state: Any) -> tuple[Any, ...]:
        x = list(state[:m])
        for block in blocks:
            block.correct(x, g)
        return (*x, *errors(x), state[m + 2] + 1.0)

    *x, infeasible, power, count = numeric.loop(unsolved, one, (*x, *errors(x), 0.0 * x[0]), rounds)
    impulses = vector(*x)
    return Impulses(impulses, apply(G, impulses) + g, count, infeasible, power)


class _Block:
    """The rows of one constraint."""

    def __init__(self, G: Array, start: int, kind: Kind, relaxation: float, sliding: bool) -> None:
        self.G, self.kind, self.sliding, self.relaxation = G, kind, sliding, relaxation
        self.rows = range(start, start + kind.size)
        block = G[..., start : start + kind.size, start : start + kind.size]
        self.steps = [relaxation / block[..., i, i][()] for i in range(kind.size)]
        if isinstance(kind, Bilateral):
            self.inverse = linalg.inverse(block)
        elif isinstance(kind, Frictional):
            a, b, c = (block[..., i, j][()] for i, j in ((0, 0), (0, 1), (1, 1)))
            half = 0.5 * (a - c)
            self.tangential_step = relaxation / (0.5 * (a + c) + numeric.sqrt(half * half + b * b))
            self.block_step = relaxation / (a + c + block[..., 2, 2][()])

    def velocity(self, x: Sequence[Any], g: Array, i: int) -> Any:
        """y_i."""
        return sum((self.G[..., i, j][()] * x[j] for j in range(len(x))), g[..., i][()])

    def correct(self, x: list[Any], g: Array) -> None:
        """Solves for the impulses of this constraint, in place."""
        kind, rows = self.kind, self.rows
        if isinstance(kind, Bilateral):
            change = apply(self.inverse, vector(*(self.velocity(x, g, i) for i in rows)))
            for k, i in enumerate(rows):
                x[i] = x[i] - self.relaxation * change[..., k][()]
        elif not isinstance(kind, Frictional):
            for k, i in enumerate(rows):
                x[i] = self._bounded(k, x[i] - self.steps[k] * self.velocity(x, g, i))
        elif self.sliding:
            a, b, n = rows
            x[n] = numeric.maximum(x[n] - self.steps[2] * self.velocity(x, g, n), 0.0)
            along = [x[i] - self.tangential_step * self.velocity(x, g, i) for i in (a, b)]
            projected = friction_cone.project_radially(vector(*along, x[n]), kind.friction)
            x[a], x[b] = projected[..., 0][()], projected[..., 1][()]
        else:
            moved = vector(*(x[i] - self.block_step * self.velocity(x, g, i) for i in rows))
            projected = friction_cone.project(moved, kind.friction)
            for k, i in enumerate(rows):
                x[i] = projected[..., k][()]

    def _bounded(self, k: int, value: Any) -> Any:
        if isinstance(self.kind, Bounded):
            return numeric.clip(value, self.kind.lower[k], self.kind.upper[k])
        return numeric.maximum(value, 0.0)

    def errors(self, x: Array, y: Array) -> tuple[Any, Any]:
        """How far the velocities are infeasible, and the power that should be zero."""
        kind, rows = self.kind, list(self.rows)
        x, y = x[..., rows], y[..., rows]
        if isinstance(kind, Bilateral):
            return largest([y[..., k][()] for k in range(kind.size)]), 0.0 * x[..., 0][()]
        if isinstance(kind, Frictional):
            shifted = y + friction_cone.sliding_shift(y, kind.friction) if self.sliding else y
            off = shifted - friction_cone.project_dual(shifted, kind.friction)
            return numeric.sqrt(dot(off, off)), abs(dot(x, shifted))
        if isinstance(kind, Unilateral):
            entries = [(x[..., k][()], y[..., k][()]) for k in range(kind.size)]
            return largest([numeric.minimum(v, 0.0) for _, v in entries]), largest(
                [f * v for f, v in entries]
            )
        bounds = zip(kind.lower, kind.upper, strict=True)
        gaps = []
        for k, (low, high) in enumerate(bounds):
            f, v = x[..., k][()], y[..., k][()]
            gaps.append((f - low) * numeric.maximum(v, 0.0) + (high - f) * numeric.maximum(-v, 0.0))
        return 0.0 * x[..., 0][()], largest(gaps)
