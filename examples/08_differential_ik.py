"""Follow a moving target with differential IK: a circle that dips below a table, at a thousand steps a second.

You should see the hand within about a millimetre of the circle where that is above the table, and never below the
table, which is at 0.5 m; and how long the 6000 steps take.
"""

import time

import numpy as np

import ulna
from ulna.ik import (
    AccelerationLimit,
    DifferentialIK,
    FrameTask,
    PlaneLimit,
    PositionLimit,
    PostureTask,
    VelocityLimit,
)

HAND, TABLE, DT = "panda_hand", 0.5, 1e-3


def main() -> None:
    robot = ulna.load("panda")
    ik = DifferentialIK(
        robot,
        tasks=[FrameTask(HAND, 1.0, 0.3, axes="world"), PostureTask(1e-3, target="ready")],
        limits=[
            AccelerationLimit(15.0),
            VelocityLimit(),
            PositionLimit(margin=0.02),
            PlaneLimit(HAND, normal=(0.0, 0.0, 1.0), height=TABLE, gain=0.05),
        ],
    )
    print(ik)
    q, v = robot.configurations["ready"].copy(), np.zeros(robot.nv)
    start = robot.fk(q, HAND)
    targets = np.repeat(start[None], 6000, axis=0)
    angle = np.linspace(0.0, 4.0 * np.pi, 6000)
    radius = 0.12 * np.minimum(1.0, angle / np.pi) ** 2
    targets[:, 1, 3] += radius * np.sin(angle)
    targets[:, 2, 3] += radius * np.cos(angle)

    path = []
    begin = time.perf_counter()
    for target in targets:
        v = ik.velocity(q, DT, target, v)
        q = robot.integrate(q, v * DT)
        path.append(q)
    seconds = time.perf_counter() - begin

    hand = robot.fk(np.array(path), HAND)[:, :3, 3]
    above = targets[:, 2, 3] > TABLE + 0.01
    distance = np.linalg.norm(hand - targets[:, :3, 3], axis=1)
    print(f"{above.mean():.0%} of the circle is above the table; there the hand is within", end=" ")
    print(f"{1e3 * distance[above].max():.2f} mm")
    print(f"lowest point of the circle {targets[:, 2, 3].min():.3f} m, of the hand {hand[:, 2].min():.4f} m")
    print(f"{len(path)} steps in {seconds:.2f} s")
    assert hand[:, 2].min() > TABLE - 1e-4


if __name__ == "__main__":
    main()
