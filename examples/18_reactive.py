"""Reactive control among obstacles: past a ball that stands, away from one that comes, and no link against another.

You should see that without rows of obstacles the arm goes 67 mm deep into the ball, and with them passes it at 20 mm;
that it leans away from a ball thrown slowly at it, and comes back; and that it folds without touching itself.

Needs: pip install '.[collision,qp]' in Ulna's folder
"""

from __future__ import annotations

import numpy as np

import ulna
from ulna import control
from ulna.collision import World
from ulna.geometry import Sphere
from ulna.ik import DifferentialIK, FrameTask, LinearLimit, PositionLimit, PostureTask, VelocityLimit

DT = 0.02


def main() -> None:
    """Runs a Panda through three encounters."""
    robot = ulna.load("panda")
    pass_by(robot)
    give_way(robot)
    fold(robot)


def pass_by(robot: ulna.Robot) -> None:
    """The tool is to go sideways, and a ball is in the way."""
    start = robot.fk(robot.configurations["qr"])
    goal = start.copy()
    start[1, 3], goal[1, 3] = -0.3, 0.3
    world = World().add("ball", Sphere(0.05), 0.5 * (start + goal)[:3, 3] + [0.0, 0.0, 0.08])
    reactive = control.Reactive(robot)
    for aware in (False, True):
        q, least, arrived = robot.ik(start, robot.configurations["qr"]).q, np.inf, False
        while not arrived:
            twist, arrived = control.p_servo(robot.fk(q), goal, 1.0, 0.01, "angle-axis")
            rows = control.obstacle_rows(robot, q, world, influence=0.25, stop=0.02) if aware else None
            q = q + DT * reactive(q, twist, 1.0 / np.abs(twist).sum(), rows)
            least = min(least, float(robot.distance(q, world)))
        print(f"{'aware of' if aware else 'blind to'} the ball: arrived, nearest {1e3 * least:.1f} mm")


def give_way(robot: ulna.Robot) -> None:
    """The tool is to stay, and a ball comes along slowly."""
    q = np.array(robot.configurations["qr"])
    T, reactive = robot.fk(q), control.Reactive(robot)
    world = World().add("ball", Sphere(0.06), moving=True)
    least, most = np.inf, 0.0
    for t in np.arange(0.0, 12.0, DT):
        ball = ulna.SE3.trans(T[0, 3], -0.6 + 0.15 * t, T[2, 3] + 0.05)
        twist, _ = control.p_servo(robot.fk(q), T, 1.0, 0.001, "angle-axis")
        rows = control.obstacle_rows(
            robot,
            q,
            world,
            moving={"ball": ball},
            twists={"ball": [0.0, 0.15, 0.0, 0.0, 0.0, 0.0]},
            stop=0.03,
        )
        q = q + DT * reactive(q, twist, 10.0, rows)
        least = min(least, float(robot.distance(q, world, moving={"ball": ball})))
        most = max(most, float(np.linalg.norm(robot.fk(q)[:3, 3] - T[:3, 3])))
    left = float(np.linalg.norm(robot.fk(q)[:3, 3] - T[:3, 3]))
    print(
        f"gave way by {1e3 * most:.0f} mm, nearest {1e3 * least:.1f} mm, now {1e3 * left:.1f} mm from its place"
    )


def fold(robot: ulna.Robot) -> None:
    """The tool is drawn to a place beside the base, which it could only reach through the arm."""
    q = np.array(robot.configurations["qr"])
    goal = robot.fk(q)
    goal[:3, 3] = 0.0, 0.1, 0.3
    limits = [VelocityLimit(), PositionLimit(), LinearLimit(20, name="near")]
    ik = DifferentialIK(robot, [FrameTask(robot.tool, gain=0.05), PostureTask(1e-3, target=q)], limits)
    for _ in range(250):
        q = ik.step(q, 0.01, goal, *control.obstacle_rows(robot, q, own=(0.1, 0.02), count=20))
    print("folded:", robot.distance(q))


if __name__ == "__main__":
    main()
