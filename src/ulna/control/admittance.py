"""Admittance: a stiff robot that gives way to measured forces as a mass on a spring would.

| symbol | meaning | shape, unit |
|---|---|---|
| x | how far the goal has given way: position, and rotation vector, in the goal's axes | (6,) [m, rad] |
| V | its rate | (6,) [m/s, rad/s] |
| F | force and moment measured at the frame, in the goal's axes | (6,) [N, N m] |
| M, D, K | mass, damping and stiffness along the goal's axes | (6,) |
| | M V' + D V + K x = F, solved semi-implicitly: V+ = (M V + dt (F - K x)) / (M + dt D + dt^2 K), x+ = x + dt V+ | |

Source: Siciliano et al. 2009, section 9.2.2. The step is stable for any dt. The robot is then led to T_goal exp(x) by
whatever follows positions: inverse kinematics, resolved rate, its own controller.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from ulna.numeric import vector
from ulna.spatial import SE3, so3_exp
from ulna.trace import compile
from ulna.typing import Array


@cache
def admittance() -> Any:
    """How a goal gives way to a force: a kernel, the same for every robot.

    `law(T_goal, x, rate, force, mass, damping, stiffness, dt)` gives the pose to be led to (4, 4), and `x` and `rate`
    (6,) after a step of `dt` [s]. Begin with zeros.
    """

    def law(
        T_goal: Array,
        x: Array,
        rate: Array,
        force: Array,
        mass: Array,
        damping: Array,
        stiffness: Array,
        dt: Any,
    ) -> tuple[Array, Array, Array]:
        after = (mass * rate + dt * (force - stiffness * x)) / (mass + dt * damping + dt * dt * stiffness)
        there = x + dt * after
        goal = SE3(T_goal[:3, :3], T_goal[:3, 3])
        led = goal @ SE3(so3_exp(there[3:]), vector(*there[:3]))
        return led.matrix(), there, after

    six = (6,)
    return compile(
        law,
        checked=True,
        T_goal=(4, 4),
        x=six,
        rate=six,
        force=six,
        mass=six,
        damping=six,
        stiffness=six,
        dt=(),
    )
