"""Forces of contacts whose velocities are given, each on its own: inverse dynamics with friction.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| c | velocity of a contact, divided by the time step | (3) | [m/s^2] | |
| R, mu | compliance, diagonal; damping of the rounds | (3), () | [1/kg] | |
| f | its force, in the friction cone K | (3) | [N] | |
| y | that velocity with what the compliance adds | (3) | [m/s^2] | y = c + R f |
| s | De Saxce correction of a contact that slides | (3) | [m/s^2] | friction_cone.py |
| | what is sought | | | y + s in K*, f.(y + s) = 0 |
| | a round | | | f' nearest in K, in the metric R + mu, to (mu f - c - s) / (R + mu); s of the f before |

Source: Le Lidec et al., Contact models in robotics: a comparative analysis (2024), section on inverse dynamics; the
proximal point algorithm (Parikh & Boyd 2014, section 4.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ulna import numeric
from ulna.algorithms.constraints import friction_cone
from ulna.algorithms.constraints.proximal_solver import largest
from ulna.numeric import dot, vector
from ulna.typing import Array


class ContactForces(NamedTuple):
    """What is found."""

    forces: Array
    """f of all contacts, (..., 3 contacts) [N]."""
    rounds: Any
    """How many rounds it took, (...), as a float."""
    residual: Any
    """The largest abs(f.(y + s)) [N m/s^2] or -y_n [m/s^2], (...); y and s of the forces before the last round."""
    change: Any
    """The largest change of a force in the last round [N], (...)."""
    size: Any
    """The largest entry of the forces of the last two rounds [N], (...)."""


def contact_forces(
    c: Array,
    frictions: Sequence[float],
    compliance: Array,
    guess: Array,
    mu: float,
    accuracies: tuple[float, float],
    rounds: int,
    sliding: bool = True,
) -> ContactForces:
    """The forces of contacts: rounds until the residual or the change of the forces is small enough, either of them.

    Args:
        c: Velocities of the contacts, divided by the time step, shape (..., 3 contacts) [m/s^2], the normal entry of
            each last.
        frictions: The coefficient of friction of each contact [-].
        compliance: The diagonal of R, shape (3 contacts,) [1/kg], not below zero, the tangential ones of a contact
            equal.
        guess: Forces to start from, shape (..., 3 contacts) [N].
        mu: Damping, not below zero [1/kg]; it and the compliance are not both zero.
        accuracies: The residual that is small enough, and the change of forces that is, relative to the largest [-].
        rounds: The largest number of rounds.
        sliding: Whether contacts slide as Coulomb says; else the convex problem is solved.

    Returns:
        The forces, and how accurate they are.
    """
    m = 3 * len(frictions)
    residual_tolerance, change_tolerance = accuracies

    def one_round(*state: Any) -> tuple[Any, ...]:
        forces = vector(*state[:m])
        projected: list[Any] = []
        residuals = []
        for k, friction in enumerate(frictions):
            rows = slice(3 * k, 3 * k + 3)
            R = compliance[rows]
            y = c[..., rows] + R * forces[..., rows]
            shift = friction_cone.sliding_shift(y, friction) if sliding else 0.0 * y
            target = (mu * forces[..., rows] - c[..., rows] - shift) / (R + mu)
            f = friction_cone.project_weighted(target, friction, R + mu)
            projected += [f[..., i][()] for i in range(3)]
            residuals += [dot(y + shift, f), numeric.minimum(y[..., 2][()], 0.0)]
        change = largest([f - state[i] for i, f in enumerate(projected)])
        return (*projected, largest(residuals), change, largest([*state[:m], *projected]), state[m + 3] + 1.0)

    def is_unsolved(*state: Any) -> Any:
        residual, change, size = state[m : m + 3]
        return numeric.minimum(residual - residual_tolerance, change - change_tolerance * size) > 0.0

    start = one_round(*(guess[..., i][()] for i in range(m)), *(0.0 * c[..., 0][()],) * 4)
    *projected, residual, change, size, count = numeric.loop(is_unsolved, one_round, start, rounds - 1)
    return ContactForces(vector(*projected), count, residual, change, size)
