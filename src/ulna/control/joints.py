"""Control of joints by torque: a spring to a configuration, and the inverse of the dynamics.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| q*, v*, a* | desired configuration, velocity, acceleration | (nq,), (nv,), (nv,) | |
| e | q* (-) q, the step that leads there | (nv,) [rad or m] | |
| K, D | gains; of torque for a spring, of acceleration for computed torque | (nv,) | |
| joint_pd | tau = K e + D (v* - v) + g(q) | (nv,) [N m or N] | Siciliano et al. 2009, eq. 8.51 |
| computed_torque | tau = M (a* + D (v* - v) + K e) + C v + g - f | (nv,) [N m or N] | eq. 8.56, 8.57 |
| f | torque of friction at v*, if asked for | (nv,) [N m or N] | joint_friction.py |

Each function makes a kernel for one robot: a pure function of the state, which costs well under a microsecond a call
and takes batches. The error is that of the configuration manifold, so that continuous joints take the short way and
floating bases need nothing special; their torques come out too, and whoever cannot drive them leaves them out.
"""

from __future__ import annotations

from typing import Any

from ulna import algorithms
from ulna.algorithms import Friction
from ulna.checks.values import checked_robot, flag
from ulna.control.bounds import within_effort
from ulna.control.gains import law_with_gains
from ulna.quantities.forces import friction_law
from ulna.robot import Robot
from ulna.typing import Array


def joint_pd(robot: Robot, *, bounded: bool = True) -> Any:
    """A spring and a damper at each joint, with gravity compensated: a kernel.

    `law(q, v, q_goal, v_goal, stiffness, damping)` returns torques (nv,) [N m or N]; `stiffness` (nv,) [N m/rad or
    N/m], `damping` (nv,) [N m s/rad or N s/m]. It comes to rest at the goal from wherever it starts, without knowing
    the masses but for gravity (Siciliano et al. 2009, section 8.5.1).

    Args:
        robot: The robot.
        bounded: Whether torques are kept within the effort limits.

    Returns:
        The kernel `law`; it refuses negative gains.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> law = ulna.control.joint_pd(robot)
        >>> law(q, np.zeros(7), q, np.zeros(7), np.full(7, 80.0), np.full(7, 10.0)).round(1)
        array([ 0. , -4. , -0.6, 22. ,  0.6,  2.3,  0. ])
    """
    model, bounded = checked_robot(robot).model, flag("bounded", bounded)

    def law(q: Array, v: Array, q_goal: Array, v_goal: Array, stiffness: Array, damping: Array) -> Array:
        e = algorithms.difference(model, q, q_goal)
        tau = stiffness * e + damping * (v_goal - v) + algorithms.gravity_forces(model, q)
        return within_effort(model, tau) if bounded else tau

    nv = robot.nv
    gains = {"stiffness": (nv,), "damping": (nv,)}
    return law_with_gains(law, robot, tuple(gains), q_goal=(robot.nq,), v_goal=(nv,), **gains)


def computed_torque(robot: Robot, *, bounded: bool = True, friction: bool | Friction = False) -> Any:
    """Inverse dynamics in the loop: each joint follows like a free mass on a spring and a damper: a kernel.

    `law(q, v, q_goal, v_goal, a_goal, kp, kd)` returns torques (nv,) [N m or N]; `kp` (nv,) [1/s^2] and `kd` (nv,)
    [1/s] are gains of acceleration: kd = 2 sqrt(kp) is critically damped at every joint (Siciliano et al. 2009, section
    8.5.2).

    Args:
        robot: The robot.
        bounded: Whether torques are kept within the effort limits.
        friction: Whether joint friction is compensated, that of the model, or a law. It is computed at the desired
            velocity: at the measured one, noise about standstill would switch Coulomb friction.

    Returns:
        The kernel `law`; it refuses negative gains.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> law = ulna.control.computed_torque(robot)
        >>> zero, kp, kd = np.zeros(7), np.full(7, 100.0), np.full(7, 20.0)
        >>> law(q, zero, q, zero, zero, kp, kd).round(1)  # at rest at the goal: gravity
        array([-0. , -4. , -0.6, 22. ,  0.6,  2.3,  0. ])
    """
    model, bounded = checked_robot(robot).model, flag("bounded", bounded)
    resisting = friction_law(model, friction)

    def law(q: Array, v: Array, q_goal: Array, v_goal: Array, a_goal: Array, kp: Array, kd: Array) -> Array:
        a = a_goal + kd * (v_goal - v) + kp * algorithms.difference(model, q, q_goal)
        tau = algorithms.inverse_dynamics(model, q, v, a)
        tau = tau if resisting is None else tau - algorithms.friction_torque(v_goal, resisting)
        return within_effort(model, tau) if bounded else tau

    nv = robot.nv
    gains = {"kp": (nv,), "kd": (nv,)}
    return law_with_gains(law, robot, tuple(gains), q_goal=(robot.nq,), v_goal=(nv,), a_goal=(nv,), **gains)
