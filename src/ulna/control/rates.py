"""Resolved-rate control: joint velocities that give a frame a twist.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| V | twist wanted of the frame | (6,) [m/s, rad/s] | |
| J | Jacobian of the frame | (6, nv) | |
| lambda | damping | 1 | |
| v | J^T (J J^T + lambda^2 I)^-1 V + (I - J^+ J) v_0 | (nv,) | Whitney 1969; Wampler 1986; Siciliano 2009, eq. 3.54 |
"""

from __future__ import annotations

from typing import Any

from ulna import algorithms
from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.checks.values import checked_robot, flag
from ulna.control.bounds import within_speed
from ulna.control.gains import law_with_gains
from ulna.kernels import frame_of
from ulna.linalg import solve_damped
from ulna.robot import Robot
from ulna.typing import Array


def resolved_rate(
    robot: Robot,
    frame: str | None = None,
    reference: Reference = "local_world_aligned",
    *,
    bounded: bool = True,
) -> Any:
    """Joint velocities for a twist of a frame: a kernel.

    `law(q, twist, damping, v_rest)` returns (nv,) [rad/s or m/s]. `damping` is a number: 0 for the pseudoinverse, which
    leads to any speed near a singular configuration, 0.01 to 0.1 for low speeds there. `v_rest` (nv,) is a preferred
    joint velocity, of which the part in the null space of J is added; zeros for the least velocity.

    Args:
        robot: The robot.
        frame: Name; None for the tool.
        reference: How the twist is written: "local_world_aligned", "local" or "world".
        bounded: Whether all joints are slowed alike until none exceeds its velocity limit.

    Returns:
        The kernel `law`; it refuses a negative damping.

    Raises:
        UnknownName: If there is no such frame or reference.
    """
    check_reference(reference)
    model, one = checked_robot(robot).model, frame_of(robot.model, frame)
    bounded = flag("bounded", bounded)

    def law(q: Array, twist: Array, damping: Any, v_rest: Array) -> Array:
        J = algorithms.frame_jacobian(model, q, one, reference)
        # The tiny part keeps an arm of fewer than six joints, and an exactly singular one, from dividing by zero.
        wanted = twist - J @ v_rest
        v = v_rest + solve_damped(J, wanted, damping * damping + 1e-14)
        return within_speed(model, v) if bounded else v

    return law_with_gains(law, robot, ("damping",), twist=(6,), damping=(), v_rest=(robot.nv,))
