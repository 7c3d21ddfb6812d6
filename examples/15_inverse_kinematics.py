"""Inverse kinematics: one pose, a batch, a line to follow, a direction, and a goal out of reach.

You should see a solution found in half a dozen iterations, 1000 of 1000 poses met, joint steps of about a degree along
a line, and at the end "False" with the reason: how far the tool stays from a goal two metres away.
"""

from __future__ import annotations

import numpy as np

import ulna


def main() -> None:
    """Asks the Panda for configurations."""
    robot = ulna.load("panda")
    q = robot.configurations["qr"]
    T = robot.fk(q)

    # Somewhere else, with the same orientation.
    goal = T.copy()
    goal[:3, 3] += 0.1, 0.2, -0.1
    solution = robot.ik(goal)
    print(solution)
    assert solution.success

    # The nearest way to get there.
    near = robot.ik(goal, q)
    print("moves the joints by", np.round(near.q - q, 3), "rad")

    # A thousand reachable poses.
    goals = robot.fk(robot.random_configuration(1000, seed=0))
    solutions = robot.ik(goals)
    print(solutions, "worst error", solutions.position_error.max(), "m")

    # A line, one centimetre a step: the arm follows without jumps.
    path = []
    for x in np.linspace(0.0, 0.3, 31):
        goal = T.copy()
        goal[1, 3] += x
        q = robot.ik(goal, q).q
        path.append(q)
    print("greatest joint step on the line:", np.abs(np.diff(path, axis=0)).max().round(4), "rad")

    # The tool's direction matters, its turn about itself does not.
    pointing = robot.ik(goal, q, mask="position+z")
    assert pointing.success

    # Out of reach: an honest answer, and the best that can be done.
    goal[:3, 3] = 2.0, 0.0, 0.5
    far = robot.ik(goal, mask="position")
    print(far.success, "-", far.reason)
    assert not far


if __name__ == "__main__":
    main()
