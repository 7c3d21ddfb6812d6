"""Your own function of the configuration, compiled with its gradient: a hand that should look at a point.

You should see a few steps of gradient descent turn the Panda's hand towards the target.
"""

import numpy as np

import ulna


def main() -> None:
    robot = ulna.load("panda")

    def looking_away(q: np.ndarray, target: np.ndarray) -> np.ndarray:
        """One minus the cosine between the hand's z axis and the direction to the target."""
        T = robot.fk(q)
        d = target - T[:3, 3]
        return 1.0 - (T[:3, 2] @ d) / np.sqrt(d @ d)

    cost = ulna.compile(looking_away, robot, target=(3,))
    gradient = cost.jacobian()
    print(cost, "and its gradient takes", gradient.operations, "operations")

    q, target = robot.configurations["qr"].copy(), np.array([0.8, 0.5, 0.3])
    for step in range(60):
        if step % 15 == 0:
            print(f"  step {step:2d}: {np.degrees(np.arccos(1.0 - cost(q, target))):6.2f} degrees away")
        q = robot.limits.clip(q - 0.1 * gradient(q, target))
    assert cost(q, target) < 1e-3


if __name__ == "__main__":
    main()
