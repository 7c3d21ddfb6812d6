"""A first look: load a robot, ask where its hand is, and how it moves.

You should see the Panda's table, the pose of its tool, and that the Jacobian predicts a small motion.
"""

import numpy as np

import ulna


def main() -> None:
    robot = ulna.load("panda")
    print(robot)

    q = robot.configurations["qr"]
    T = robot.fk(q)
    print("tool at", T[:3, 3].round(4), "m")

    dq = 1e-4 * np.arange(1.0, 8.0)  # [rad]
    predicted = robot.jacobian(q) @ dq
    moved = robot.fk(q + dq)[:3, 3] - T[:3, 3]
    print("moved    ", moved, "m")
    print("predicted", predicted[:3], "m")
    assert np.allclose(moved, predicted[:3], atol=1e-6)


if __name__ == "__main__":
    main()
