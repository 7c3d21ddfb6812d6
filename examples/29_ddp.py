"""Optimal control by DDP: the Panda reaches a pose with little torque, and an acrobot swings up with one motor.

You should see two searches that converge, the tool within millimetres of its goal, and the acrobot upright.
"""

import numpy as np

import ulna
from ulna import control
from ulna.model import Revolute


def reach() -> None:
    robot = ulna.load("panda")
    q = robot.configurations["ready"]
    goal = robot.fk(q) @ np.array(ulna.SE3.trans(0.1, 0.25, -0.15))
    stage = control.stage(robot, lambda q, v, u: np.concatenate([0.1 * v, 0.01 * u]), dt=0.01)

    def miss(q, v, T_goal):  # residuals: half of their squares is the cost
        T = robot.fk(q)
        turned = [T[:3, k] - T_goal[:3, k] for k in range(3)]
        return np.concatenate(
            [100.0 * (T[:3, 3] - T_goal[:3, 3]), *(30.0 * column for column in turned), 10.0 * v]
        )

    end = stage.terminal(miss, T_goal=(4, 4))
    hold = np.tile(robot.gravity_forces(q), (100, 1))
    solution = control.ddp(stage, end, np.concatenate([q, 0 * q]), hold, terminal_parameters=(goal,))
    away = np.linalg.norm(robot.fk(solution.states[-1, :7])[:3, 3] - goal[:3, 3])
    print("Panda:", solution)
    print(f"  {1e3 * away:.1f} mm from the goal, largest torque {abs(solution.controls).max():.0f} N m")


def acrobot() -> ulna.Robot:
    """Two rods that hang; only the elbow has a motor (Spong 1995)."""
    b = ulna.ModelBuilder("acrobot")
    b.add_link("base")
    for name in ("upper", "lower"):
        b.add_link(name, ulna.Inertia.from_com(1.0, (0.0, 0.0, -0.5), np.diag([1 / 12, 1 / 12, 1e-3])))
    b.add_joint("shoulder", Revolute([0, 1, 0]), "base", "upper", damping=0.05)
    b.add_joint("elbow", Revolute([0, 1, 0]), "upper", "lower", ulna.SE3.trans(0, 0, -1.0), damping=0.05)
    return ulna.Robot(b.build())


def swing_up() -> None:
    robot = acrobot()
    stage = control.stage(
        robot, lambda q, v, u: np.concatenate([0.03 * u, 0.01 * v]), dt=0.02, actuated=["elbow"]
    )
    top = np.array([np.pi, 0.0])
    end = stage.terminal(lambda q, v: 30.0 * np.concatenate([q - top, 0.5 * v]))
    start = 0.5 * np.sin(np.arange(200) / 8.0)[:, None]
    solution = control.ddp(stage, end, np.zeros(4), start, iterations=500)
    print("Acrobot:", solution)
    print("  ends at", solution.states[-1].round(2), f"largest torque {abs(solution.controls).max():.1f} N m")


def main() -> None:
    reach()
    swing_up()


if __name__ == "__main__":
    main()
