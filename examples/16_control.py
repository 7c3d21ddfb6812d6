"""Control laws in the loop: a tool that springs back, a joint motion that is followed, an arm that avoids its limits.

You should see the tool give way by 12.5 mm under 5 N at 400 N/m, a tracking error that dies away within half a second,
and a reactive controller that arrives with all joints inside their limits.
"""

from __future__ import annotations

import numpy as np

import ulna
from ulna import control
from ulna.sim import simulate


def main() -> None:
    """Simulates a Panda under three control laws."""
    robot = ulna.load("panda")
    q0, zero = np.array(robot.configurations["qr"]), np.zeros(7)

    # A spring at the tool: 400 N/m along every axis, pushed by 5 N.
    law = control.impedance(robot)
    T = robot.fk(q0)
    stiffness, damping = np.repeat([400.0, 30.0], 3), np.repeat([40.0, 4.0], 3)
    rest = np.full(7, 5.0)
    push = np.array([5.0, 0, 0, 0, 0, 0])

    def pushed(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return law(q, v, T, np.zeros(6), stiffness, damping, q0, rest, rest) + robot.jacobian(q).T @ push

    log = simulate(robot, q0, torque=pushed, duration=4.0, dt=1e-3, friction=None)
    moved = robot.fk(log.q[-1])[:3, 3] - T[:3, 3]
    print("impedance: the tool gave way by", np.round(1e3 * moved, 2), "mm")

    # Inverse dynamics in the loop: errors die away as exp(-10 t).
    track = control.computed_torque(robot)
    kp, kd = np.full(7, 100.0), np.full(7, 20.0)

    def drive(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        s, c = 0.4 * np.sin(2.0 * t), 0.8 * np.cos(2.0 * t)
        return track(q, v, q0 + s, zero + c, zero - 4.0 * s, kp, kd)

    log = simulate(robot, q0 + 0.1, zero + 0.8, torque=drive, duration=1.0, dt=1e-3, friction=None)
    error = np.abs(log.q - q0 - 0.4 * np.sin(2.0 * log.t)[:, None]).max(axis=1)
    print("computed torque: error", np.round(error[::250], 4), "rad at every quarter of a second")

    # Velocities that follow a twist as far as limits allow.
    reactive = control.Reactive(robot)
    goal, q = T.copy(), q0
    goal[:3, 3] += 0.1, 0.3, -0.2
    for steps in range(2000):  # noqa: B007
        twist, arrived = control.p_servo(robot.fk(q), goal, 1.0, 0.005, "angle-axis")
        if arrived:
            break
        q = q + 0.01 * reactive(q, twist, 1.0 / np.abs(twist).sum())
    inside = bool(robot.limits.contains(q))
    print(f"reactive: arrived {arrived} after {steps} steps, inside the limits {inside}")


if __name__ == "__main__":
    main()
