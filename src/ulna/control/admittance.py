"""Admittance: a stiff robot that yields to measured forces as a mass on a spring would.

| symbol | meaning | shape, unit |
|---|---|---|
| x | displacement of the goal: position, and rotation vector, in the goal's axes | (6,) [m, rad] |
| V | its rate | (6,) [m/s, rad/s] |
| F | force and moment measured at the frame, in the goal's axes | (6,) [N, N m] |
| M, D, K | mass, damping and stiffness along the goal's axes | (6,) |
| | M V' + D V + K x = F, solved semi-implicitly: V+ = (M V + dt (F - K x)) / (M + dt D + dt^2 K), x+ = x + dt V+ | |

Source: Siciliano et al. 2009, section 9.2.2. The step is stable for any dt. The robot is then led to T_goal exp(x) by
whatever follows positions: inverse kinematics, resolved rate, its own controller.
"""

from __future__ import annotations

from functools import cache
from typing import Any, final

from ulna.checks.attributes import FixedAttributes
from ulna.compiler import compile
from ulna.errors import InputError
from ulna.numeric import less, minimum, vector, where
from ulna.spatial import SE3, so3_exp
from ulna.typing import Array, ArrayLike


@final
class Admittance(FixedAttributes):
    """How a goal yields to a force; see `admittance`."""

    def __init__(self) -> None:
        six = (6,)
        shapes = dict.fromkeys(("x", "rate", "force", "mass", "damping", "stiffness"), six)
        self._kernel = compile(_step, checked=True, T_goal=(4, 4), **shapes, dt=())

    @property
    def operations(self) -> int:
        """How many scalar operations a step takes."""
        return self._kernel.operations

    def __call__(
        self,
        T_goal: ArrayLike,
        x: ArrayLike,
        rate: ArrayLike,
        force: ArrayLike,
        mass: ArrayLike,
        damping: ArrayLike,
        stiffness: ArrayLike,
        dt: ArrayLike,
    ) -> tuple[Array, Array, Array]:
        """The pose to follow after a step in which a force acts.

        Args:
            T_goal: The goal, T_world_goal, shape (..., 4, 4) [m].
            x: How far the goal has yielded, shape (..., 6) [m, rad].
            rate: Its rate, shape (..., 6) [m/s, rad/s].
            force: The measured wrench, shape (..., 6) [N, N m].
            mass: Mass along each axis, shape (..., 6) [kg, kg m^2].
            damping: Damping along each axis, shape (..., 6) [N s/m, N m s/rad].
            stiffness: Stiffness along each axis, shape (..., 6) [N/m, N m/rad].
            dt: Duration of the step, shape (...) [s].

        Returns:
            The pose to follow, shape (..., 4, 4) [m], and `x` and `rate` after the step, each of shape (..., 6).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be one.
            InputError: If a mass, damping, stiffness or step is negative, or all are zero along an axis.
        """
        pose, displacement, new_rate, least = self._kernel(
            T_goal, x, rate, force, mass, damping, stiffness, dt
        )
        if not (least > 0.0 if least.ndim == 0 else (least > 0.0).all()):
            raise InputError(
                "`mass`, `damping`, `stiffness` and `dt` must not be negative, and along each axis one of mass, "
                "dt * damping and dt^2 * stiffness must be above 0: nothing would hold the goal against a force."
            )
        return pose, displacement, new_rate


@cache
def admittance() -> Admittance:
    """How a goal yields to a force, the same for every robot.

    `law(T_goal, x, rate, force, mass, damping, stiffness, dt)` returns the pose to be led to (4, 4), and `x` and `rate`
    (6,) after a step of `dt` [s]. Begin with zeros.
    """
    return Admittance()


def _step(
    T_goal: Array,
    x: Array,
    rate: Array,
    force: Array,
    mass: Array,
    damping: Array,
    stiffness: Array,
    dt: Any,
) -> tuple[Array, Array, Array, Any]:
    """The step, and a number that is above 0 when mass, damping, stiffness and dt make sense."""
    effective_mass = mass + dt * damping + dt * dt * stiffness
    new_rate = (mass * rate + dt * (force - stiffness * x)) / effective_mass
    displacement = x + dt * new_rate
    goal = SE3(T_goal[:3, :3], T_goal[:3, 3])
    pose = goal @ SE3(so3_exp(displacement[3:]), vector(*displacement[:3]))
    least: Any = effective_mass[0]
    for number in effective_mass[1:]:
        least = minimum(least, number)
    for number in (*mass, *damping, *stiffness, dt):
        least = where(less(number, 0.0), -1.0, least)
    return pose.matrix(), displacement, new_rate, least
