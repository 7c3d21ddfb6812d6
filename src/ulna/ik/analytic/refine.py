"""Newton's method, damped far from the goal, on many configurations at once through a robot's compiled kernels.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | position error; axis times chord 2 sin(theta / 2) of the rotation; world axes | (6,) | Luh, Walker & Paul 1980 |
| J | Jacobian at the origin of the frame, world axes, of the arm's coordinates | (6, n) | |
| mu | damping: a share of the squared error, so that it vanishes at the goal | 1 | Sugihara 2011, eq. 18 |
| dq | J^T (J J^T + mu I)^-1 e | (n,), rad and m | Nakamura & Hanafusa 1986, eq. 16 |
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.typing import Floats

_MIN_DAMPING = 1e-14  # damping that keeps singular configurations from dividing by zero
_SHARE = 0.05
_MAX_STEP = 0.5  # largest step of a joint [rad or m]


def refined(
    fk: Any, jacobian: Any, q: Floats, T: Floats, columns: tuple[list[int], list[int]], iterations: int
) -> Floats:
    """Configurations (m, nq) led towards the goals T (m, 4, 4); each keeps the nearest it came to.

    Args:
        fk: The kernel of the frame's pose.
        jacobian: That of its Jacobian, "local_world_aligned".
        q: Configurations to start from, (m, nq) [rad or m].
        T: Goals, (m, 4, 4).
        columns: Places in q, and in v, of the coordinates that may move.
        iterations: How many steps at most.

    Returns:
        The nearest configurations, (m, nq) [rad or m].
    """
    at_q, at_v = columns
    q = q.copy()
    best, least = q.copy(), np.full(len(q), np.inf)
    going = np.arange(len(q))
    for step in range(iterations + 1):
        now, goal = q[going], T[going]
        e = _errors(fk(now), goal)
        size = np.square(e).sum(axis=-1)
        better = size < least[going]
        least[going[better]], best[going[better]] = size[better], now[better]
        on = size > 1e-28
        going, now, e, size = going[on], now[on], e[on], size[on]
        if step == iterations or not len(going):
            break
        J = jacobian(now)[..., at_v]
        Jt = np.swapaxes(J, -1, -2)
        damped = J @ Jt + (_MIN_DAMPING + _SHARE * np.minimum(size, 1.0))[:, None, None] * np.eye(6)
        dq = (Jt @ np.linalg.solve(damped, e[..., None]))[..., 0]
        dq *= np.minimum(1.0, _MAX_STEP / np.maximum(np.abs(dq).max(axis=-1, keepdims=True), 1e-300))
        q[going[:, None], at_q] += dq
    return best


def _errors(pose: Floats, goal: Floats) -> Floats:
    """Errors (m, 6) from poses to goals (m, 4, 4); the cross products of the axes point along the rotation."""
    S = goal[:, :3, :3] @ np.swapaxes(pose[:, :3, :3], -1, -2)
    s = 0.5 * np.stack([S[:, 2, 1] - S[:, 1, 2], S[:, 0, 2] - S[:, 2, 0], S[:, 1, 0] - S[:, 0, 1]], axis=-1)
    half = np.sqrt(np.maximum(0.25 * (1.0 + np.trace(S, axis1=-2, axis2=-1)), 1e-9))  # cos(theta / 2)
    return np.concatenate([goal[:, :3, 3] - pose[:, :3, 3], s / half[:, None]], axis=-1)
