"""The velocity after a step of time with dry friction: joints stick exactly, or slide against the full friction.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| u | velocity after the step if there were no friction | (nv) | [rad/s] or [m/s] | |
| h | duration of the step | () | [s] | |
| G | inverse mass matrix | (nv, nv) | | v = u + G l |
| l | impulse of friction | (nv) | [N m s] or [N s] | l = -h (B v + f) |
| f | dry friction | (nv) | [N m] or [N] | Tc+ where v > 0, -Tc- where v < 0, between where v = 0 |
| v | velocity after the step | (nv) | [rad/s] or [m/s] | |

Both laws are implicit in the velocity at the end of the step, so that no step is too long for them and nothing chatters
at rest. The impulses are those of greatest dissipation, a box-constrained problem solved joint by joint in turns until
nothing changes (projected Gauss-Seidel). Source: Moreau, Numerical aspects of the sweeping process (1999), section 5;
Featherstone, section 11.6, for the like problem of contacts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.typing import Array

ROUNDS = 500
"""Turns at most; a chain of joints takes a few dozen."""


def velocity_after_friction(G: Array, u: Array, start: Array, h: Any, friction: Friction) -> Array:
    """The velocity after a time step in which friction acts on the joints.

    Args:
        G: Inverse mass matrix, shape (..., nv, nv) [1/kg, 1/(kg m), 1/(kg m^2)].
        u: Velocity after the step without friction, shape (..., nv) [rad/s, m/s].
        start: Velocity before the step, shape (..., nv) [rad/s, m/s], at which static friction is determined.
        h: Duration of the step, shape (...) [s].
        friction: The friction of the joints; its width plays no part.

    Returns:
        Velocity, shape (..., nv) [rad/s, m/s].
    """
    nv = u.shape[-1]
    viscous, *_ = friction.numbers(nv)
    still = np.zeros(nv)
    dry = [np.asarray(x, dtype=float) + still for x in friction.dry_bounds(still)]
    rubbing = [k for k in range(nv) if viscous[k] or dry[0][k] or dry[1][k]]
    if not rubbing:
        return u
    forward, backward = (_each(bound, u) for bound in friction.dry_bounds(start))
    largest_impulses = [(h * _at(forward, k), h * _at(backward, k)) for k in range(nv)]
    mobility = [_at(G, k, k) for k in range(nv)]
    scale: Any = 0.0
    for k in rubbing:
        scale = scale + abs(_at(u, k)) + mobility[k] * (largest_impulses[k][0] + largest_impulses[k][1])
    count = len(rubbing)

    def sweep(*state: Any) -> tuple[Any, ...]:
        v, impulses = list(state[:nv]), list(state[nv : nv + count])
        change: Any = 0.0
        for place, k in enumerate(rubbing):
            free = v[k] - mobility[k] * impulses[place]
            stopping = numeric.clip(-free / mobility[k], -largest_impulses[k][0], largest_impulses[k][1])
            final = (free + mobility[k] * stopping) / (1.0 + h * float(viscous[k]) * mobility[k])
            further = (final - v[k]) / mobility[k]
            impulses[place] = impulses[place] + further
            change = change + abs(final - v[k])
            for row in range(nv):
                v[row] = v[row] + _at(G, row, k) * further
            v[k] = final
        return (*v, *impulses, change)

    nothing = 0.0 * _at(u, 0)
    begin = (*(_at(u, k) for k in range(nv)), *[nothing] * count, nothing + np.inf)
    end = numeric.loop(lambda *state: state[-1] > 1e-13 * scale, sweep, begin, ROUNDS)
    v = list(end[:nv])
    for place, k in enumerate(rubbing):
        # what would hold it at rest: well within its bounds, or well beyond them when it slides
        need = end[nv + place] - v[k] / mobility[k]
        v[k] = _zero_between(v[k], need, largest_impulses[k])
    return numeric.vector(*v)


def _zero_between(v: Any, impulse: Any, largest: tuple[Any, Any]) -> Any:
    """Zero where the impulse is between the largest backward and the largest forward, else v."""
    reduced = numeric.where(numeric.less(impulse, largest[1]), 0.0, v)
    return numeric.where(numeric.less(-largest[0], impulse), reduced, v)


def _each(bound: Any, v: Array) -> Array:
    """`bound` as an array like `v`."""
    return bound + 0.0 * v


def _at(array: Array, *place: int) -> Any:
    """An entry of the last axes; a number, not an array without axes, where there is no batch."""
    return array[(..., *place)][()]
