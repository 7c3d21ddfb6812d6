"""Trajectories: from way-points to the fastest motion a robot's speeds, accelerations and torques allow, checked.

You should see a smooth motion through five way-points that breaks limits, named one by one; then the same path made
time-optimal, within limits; and the tool along a straight line, followed by the joints to a tenth of a millimetre.
"""

import numpy as np

import ulna
from ulna import trajectory


def main() -> None:
    robot = ulna.load("panda")
    home = robot.configurations["qr"]
    rng = np.random.default_rng(4)
    points = home + 0.8 * np.concatenate([np.zeros((1, 7)), rng.uniform(-1, 1, (4, 7))]) * [
        1,
        1,
        1,
        0.5,
        1,
        0.5,
        1,
    ]

    smooth = trajectory.minimum_jerk(points, duration=1.5)
    print(smooth)
    report = trajectory.check(robot, smooth, acceleration=10.0)
    print(report, "\n")
    assert not report

    best = trajectory.time_optimal(points, robot, acceleration=10.0)
    print(best, "takes", round(best.duration, 3), "s and uses", best.use)
    report = trajectory.check(robot, best, acceleration=10.0)
    print(report, "\n")
    assert report

    start = ulna.SE3.from_matrix(robot.fk(home))
    line = trajectory.pose_line(
        start,
        start @ ulna.SE3.trans(0.1, 0.2, -0.1),
        velocity=(0.25, 1.0),
        acceleration=(1.0, 4.0),
        jerk=(10.0, 40.0),
    )
    joints = trajectory.follow(line, lambda T, q: robot.ik(T, q0=q), home)
    there_and_back = joints + joints.reversed()
    t, q, v, a = there_and_back.sample(rate=250)
    error = np.abs(robot.fk(joints(t[: len(t) // 2])) - line(t[: len(t) // 2])).max()
    print(there_and_back, f"leaves the line by {1e6 * error:.1f} um")
    print(f"{len(t)} samples; peak torque {np.abs(robot.inverse_dynamics(q, v, a)).max():.1f} N m")
    assert error < 1e-4


if __name__ == "__main__":
    main()
