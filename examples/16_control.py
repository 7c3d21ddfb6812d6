"""Control laws in the loop: springs at joints and tool, motions that are followed, an arm that avoids its limits.

You should see joints at rest at their goal, the tool give way by 12.5 mm under 5 N at 400 N/m, tracking errors that
die away, a goal that gives way by 30 mm, a tool led by velocities, and a reactive controller that arrives within its
limits.
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

    # A spring at each joint, gravity taken off.
    spring = control.joint_pd(robot)
    soft, calm = np.full(7, 80.0), np.array([30.0, 30, 20, 15, 3, 3, 1])

    def pulled(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return spring(q, v, q0, zero, soft, calm)

    log = simulate(robot, q0 + 0.2, torque=pulled, duration=4.0, dt=1e-3)
    print("joint springs: at rest", f"{np.abs(log.q[-1] - q0).max():.0e}", "rad from the goal")

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

    # The same for the tool: it falls to its goal like a mass of one kilogram on a spring.
    fall = control.operational_space(robot)
    there = T.copy()
    there[:3, 3] += 0.05, 0.1, -0.05
    kp_tool, kd_tool, none = np.full(6, 64.0), np.full(6, 16.0), np.zeros(6)

    def falling(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return fall(q, v, there, none, none, kp_tool, kd_tool, q0, rest, rest)

    log = simulate(robot, q0, torque=falling, duration=1.0, dt=1e-3, friction=None)
    away = np.linalg.norm(robot.fk(log.q[::250])[:, :3, 3] - there[:3, 3], axis=1)
    print("operational space:", np.round(1e3 * away, 1), "mm away at every quarter of a second")

    # A goal that gives way to a measured push of 3 N, as a spring of 100 N/m would.
    give = control.admittance()
    x, rate = none, none
    for _ in range(3000):
        push_3 = np.array([3.0, 0, 0, 0, 0, 0])
        led, x, rate = give(T, x, rate, push_3, np.full(6, 2.0), np.full(6, 40.0), np.full(6, 100.0), 1e-3)
    print("admittance: the goal gave way by", np.round(1e3 * np.linalg.norm(led[:3, 3] - T[:3, 3]), 1), "mm")

    # Velocities for a twist of the tool.
    resolve = control.resolved_rate(robot)
    q = q0
    for _ in range(300):
        twist, _ = control.p_servo(robot.fk(q), there, 2.0, method="angle-axis")
        q = q + 0.01 * resolve(q, twist, 0.01, zero)
    print(
        "resolved rate:", f"{1e3 * np.linalg.norm(robot.fk(q)[:3, 3] - there[:3, 3]):.1f} mm away after 3 s"
    )

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
