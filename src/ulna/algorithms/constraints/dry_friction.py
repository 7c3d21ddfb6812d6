"""The velocity after a step of time with dry friction: joints stick exactly, or slide against the full friction.

A position limit is a friction without bound in one direction: its impulse is as large as it takes to stop the joint.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| u | velocity after the step if there were no friction | (nv) | [rad/s] or [m/s] | |
| h | duration of the step | () | [s] | |
| G | inverse mass matrix | (nv, nv) | | v = u + G t |
| t | impulse of friction | (nv) | [N m s] or [N s] | t = -h (B v + f) |
| f | dry friction | (nv) | [N m] or [N] | Tc+ where v > 0, -Tc- where v < 0, between where v = 0 |
| v | velocity after the step | (nv) | [rad/s] or [m/s] | |

Both laws are implicit in the velocity at the end of the step: they are stable for steps of any length, and joints do
not chatter at rest. The impulses minimise t.G t / 2 + u.t plus the energy of the dampers, between bounds: a quadratic
program. An iteration solves for one joint after the other (projected Gauss-Seidel), which finds the joints that stick
and those that slide; then for all of them together by conjugate gradients, until one would change between sticking and
sliding. The objective falls with every iteration, and the joints that stick in the solution are found after a few.
Source: Moreau, Numerical aspects of the sweeping process (1999), section 5; Featherstone, section 11.6, for the similar
problem of contacts; More & Toraldo, On the solution of large quadratic programming problems with bound constraints
(1991).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, final

import numpy as np

from ulna import numeric
from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.typing import Array

ROUNDS = 500
"""The largest number of iterations; a chain of joints takes between a few and dozens."""

_TOLERANCE = 1e-13  # change of the velocities in an iteration, relative to their scale, that ends the loop
_ACCEPTED = 1e-9  # relative change up to which the last iteration counts as converged


def velocity_after_friction(
    G: Array, u: Array, start: Array, h: Any, friction: Friction, stops: tuple[Array, Array] | None = None
) -> Array:
    """The velocity after a time step in which friction, and position limits, act on the joints.

    Args:
        G: Inverse mass matrix, shape (..., nv, nv) [1/kg, 1/(kg m), 1/(kg m^2)].
        u: Velocity after the step without friction, shape (..., nv) [rad/s, m/s].
        start: Velocity before the step, shape (..., nv) [rad/s, m/s], at which static friction is determined.
        h: Duration of the step, shape (...) [s].
        friction: The friction of the joints; its width plays no part.
        stops: The largest impulses of position limits, forward (of lower limits) and backward (of upper ones), each of
            shape (..., nv) [N m s, N s]: inf where a joint is at a limit, else 0. None for no limits.

    Returns:
        Velocity, shape (..., nv) [rad/s, m/s]; nan where `ROUNDS` iterations do not suffice.
    """
    nv = u.shape[-1]
    step = _TimeStep.of(G, u, start, h, friction, stops)
    joints = step.joints
    if not joints:
        return u.copy()
    scale = _scale(G, u, start, h, friction, joints)
    zero, count = 0.0 * _entry(u, 0), len(joints)

    def iteration(*state: Any) -> tuple[Any, ...]:
        v, t, change = step.gauss_seidel(state[:nv], state[nv : nv + count])
        return (*step.conjugate_gradients(v, t, 0.1 * _TOLERANCE * scale), change)

    begin = (*(_entry(u, k) for k in range(nv)), *[zero] * count, zero + np.inf)
    end = numeric.loop(lambda *state: state[-1] > _TOLERANCE * scale, iteration, begin, ROUNDS)
    v = [numeric.where(end[-1] <= _ACCEPTED * scale, x, np.nan) for x in end[:nv]]
    for i, k in enumerate(joints):
        # the impulse that would stop the joint; if it is between the bounds, the joint sticks
        needed = end[nv + i] - v[k] / step.mobility[i]
        v[k] = _zero_between(v[k], needed, (-step.low[i], step.high[i]))
    return numeric.vector(*v)


@final
@dataclass(frozen=True)
class _TimeStep:
    """A time step for the joints with friction: columns of G, h B, and bounds of the impulses of dry friction."""

    columns: Sequence[Sequence[Any]]
    joints: Sequence[int]
    is_damped: Sequence[bool]
    is_dry: Sequence[bool]
    damping: Sequence[Any]
    low: Sequence[Any]
    high: Sequence[Any]

    @classmethod
    def of(
        cls, G: Array, u: Array, start: Array, h: Any, friction: Friction, stops: tuple[Array, Array] | None
    ) -> _TimeStep:
        """The time step of `velocity_after_friction`; where there are stops, every joint may have one."""
        nv = u.shape[-1]
        viscous, *_ = friction.numbers(nv)
        at_rest = np.zeros(nv)
        dry = [np.asarray(x, dtype=float) + at_rest for x in friction.dry_bounds(at_rest)]
        is_dry = [stops is not None or bool(dry[0][k] or dry[1][k]) for k in range(nv)]
        joints = [k for k in range(nv) if viscous[k] or is_dry[k]]
        forward, backward = ([h * x for x in bound] for bound in _dry_bounds(friction, u, start, joints))
        if stops is not None:
            forward = [x + _entry(stops[1], k) for x, k in zip(forward, joints, strict=True)]
            backward = [x + _entry(stops[0], k) for x, k in zip(backward, joints, strict=True)]
        return cls(
            [[_entry(G, row, k) for k in joints] for row in range(nv)],
            joints,
            [bool(viscous[k]) for k in joints],
            [is_dry[k] for k in joints],
            [h * float(viscous[k]) for k in joints],
            [-x for x in forward],
            backward,
        )

    @property
    def mobility(self) -> list[Any]:
        return [self.columns[k][i] for i, k in enumerate(self.joints)]

    def gauss_seidel(self, v: Sequence[Any], t: Sequence[Any]) -> tuple[list[Any], list[Any], Any]:
        """Velocities, impulses, and the sum of the changes of velocities, after solving for each joint in turn."""
        v, t, change = list(v), list(t), 0.0
        for i, (k, mobility) in enumerate(zip(self.joints, self.mobility, strict=True)):
            free = v[k] - mobility * t[i]
            dry_impulse = numeric.clip(-free / mobility, self.low[i], self.high[i])
            final = (free + mobility * dry_impulse) / (1.0 + self.damping[i] * mobility)
            added = (final - v[k]) / mobility
            t[i] = t[i] + added
            change = change + abs(final - v[k])
            for row, entries in enumerate(self.columns):
                v[row] = v[row] + entries[i] * added
            v[k] = final
        return v, t, change

    def conjugate_gradients(self, v: Sequence[Any], t: Sequence[Any], tolerance: Any) -> list[Any]:
        """Velocities and impulses that lower the objective, while each joint keeps sticking or sliding."""
        nv, count = len(v), len(t)
        low, high, compliance, free = ([*x] for x in zip(*map(self._bounds, range(count), t), strict=True))

        def direction(v: Sequence[Any], t: Sequence[Any]) -> tuple[list[Any], list[Any], Any, Any]:
            """Negative gradient r, z = r / diagonal (Jacobi preconditioner), r.z, and the sum of |r|."""
            r, z = [], []
            for i, k in enumerate(self.joints):
                excess = t[i] - numeric.clip(t[i], self.low[i], self.high[i])
                r.append(-free[i] * (v[k] + compliance[i] * excess))
                z.append(r[i] / (self.columns[k][i] + compliance[i]))
            return r, z, sum(a * b for a, b in zip(r, z, strict=True)), sum(map(abs, r))

        def cg_iteration(*state: Any) -> tuple[Any, ...]:
            v, t, p = state[:nv], state[nv : nv + count], state[nv + count : nv + 2 * count]
            y = [sum(a * b for a, b in zip(row, p, strict=True)) for row in self.columns]
            curvature = sum(p[i] * (y[k] + compliance[i] * p[i]) for i, k in enumerate(self.joints))
            alpha = state[-2] / numeric.where(curvature > 0.0, curvature, np.inf)
            to_bounds = [_length_to_bound(p[i], low[i] - t[i], high[i] - t[i]) for i in range(count)]
            length = reduce(numeric.minimum, to_bounds, alpha)
            v = [a + length * b for a, b in zip(v, y, strict=True)]
            t = [a + length * b for a, b in zip(t, p, strict=True)]
            _, z, product, size = direction(v, t)
            beta = product / numeric.where(state[-2] > 0.0, state[-2], np.inf)
            p = [a + beta * b for a, b in zip(z, p, strict=True)]
            return (*v, *t, *p, product, numeric.where(length < alpha, 0.0, size))

        _, z, product, size = direction(v, t)
        begin = (*v, *t, *z, product, size)
        end = numeric.loop(lambda *state: state[-1] > tolerance, cg_iteration, begin, 2 * count)
        return list(end[: nv + count])

    def _bounds(self, i: int, t: Any) -> tuple[Any, Any, Any, Any]:
        """Bounds of an impulse while its joint sticks or slides one way; 1 / (h B) if it slides; 1 if t may change."""
        low, high = self.low[i], self.high[i]
        above = numeric.less(low, t)
        sticks = above & numeric.less(t, high)
        if not self.is_damped[i]:
            return low, high, 0.0, numeric.where(sticks, 1.0, 0.0)
        compliance = numeric.where(sticks, 0.0, 1.0 / numeric.maximum(self.damping[i], 1e-200))
        if not self.is_dry[i]:
            return -np.inf, np.inf, compliance, 1.0
        lower = numeric.where(sticks, low, numeric.where(above, high, -np.inf))
        return lower, numeric.where(sticks, high, numeric.where(above, np.inf, low)), compliance, 1.0


def _dry_bounds(friction: Friction, u: Array, start: Array, joints: Sequence[int]) -> list[list[Any]]:
    """How large dry friction of those joints can be against forward, and against backward motion."""
    bounds = (_broadcast(bound, u) for bound in friction.dry_bounds(start))
    return [[_entry(bound, k) for k in joints] for bound in bounds]


def _scale(G: Array, u: Array, start: Array, h: Any, friction: Friction, joints: Sequence[int]) -> Any:
    """How large velocities are, and how much dry friction changes them."""
    scale: Any = 0.0
    for k, forward, backward in zip(joints, *_dry_bounds(friction, u, start, joints), strict=True):
        scale = scale + abs(_entry(u, k)) + _entry(G, k, k) * (h * backward + h * forward)
    return scale


def _length_to_bound(p: Any, down: Any, up: Any) -> Any:
    """The largest multiple of p between the bounds `down` <= 0 and `up` >= 0."""
    distance = numeric.where(numeric.less(p, 0.0), down, up)
    moves = abs(p) > 0.0
    return numeric.where(moves, distance / numeric.where(moves, p, 1.0), np.inf)


def _zero_between(v: Any, impulse: Any, largest: tuple[Any, Any]) -> Any:
    """Zero where the impulse is between the largest backward and the largest forward, else v."""
    reduced = numeric.where(numeric.less(impulse, largest[1]), 0.0, v)
    return numeric.where(numeric.less(-largest[0], impulse), reduced, v)


def _broadcast(bound: Any, v: Array) -> Array:
    """`bound` broadcast to the shape and kind of `v`."""
    return bound + 0.0 * v


def _entry(array: Array, *index: int) -> Any:
    """An entry of the last axes; a number, not an array without axes, where there is no batch."""
    return array[(..., *index)][()]
