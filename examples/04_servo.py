"""Servo the tool to a goal: error in the tool's frame, Jacobian, pseudo-inverse, step.

You should see the Panda arrive after 431 steps of 10 ms, as the Robotics Toolbox does.
"""

import numpy as np

import ulna


def main() -> None:
    robot = ulna.load("panda")
    q = robot.configurations["qr"].copy()
    goal = robot.fk(q) @ ulna.SE3.trans(0.2, 0.2, 0.35).matrix()
    dt, steps, arrived = 0.01, 0, False
    while not arrived:
        v, arrived = ulna.p_servo(robot.fk(q), goal, gain=1.0, threshold=0.01)
        qd = np.linalg.pinv(robot.jacobian(q, reference="local")) @ v
        q = robot.limits.clip(q + qd * dt)
        steps += 1
    print(f"arrived after {steps} steps at", robot.fk(q)[:3, 3].round(4), "m")
    assert steps == 431


if __name__ == "__main__":
    main()
