"""Derivatives, code and formulas of a model of Ulna's Pinocchio package, as people use pinocchio.casadi for.

You should see the gradient of a cost of one's own beside finite differences, the same for a thousand states at once,
and the torque of gravity on the elbow of a UR5 as a formula, in C, and evaluated.

In a script that imports pinocchio under `ulna run`, `ulna.Robot(model.ulna())` is the robot of a model.
"""

from __future__ import annotations

import numpy as np
import sympy

import ulna
from ulna import algorithms


def main() -> None:
    """Compiles a cost with its derivative, and writes one torque as a formula."""
    robot = ulna.load("ur5")

    def cost(q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        missing = robot.inverse_dynamics(q, v, np.zeros(robot.nv)) - tau
        place = robot.fk(q)[..., :3, 3]
        return missing @ missing + place @ place

    f = ulna.compile(cost, robot, tau=(6,))
    gradient = f.jacobian("q")
    q, v, tau = np.array([0.1, -1.2, 1.7, -0.5, -0.4, 0.2]), np.full(6, 0.1), np.zeros(6)
    steps = 1e-6 * np.eye(6)
    differences = (f(q + steps, v, tau) - f(q - steps, v, tau)) / 2e-6  # six states at once
    print("gradient           ", np.round(gradient(q, v, tau), 4))
    print("finite differences ", np.round(differences, 4))
    many = np.random.default_rng(0).uniform(-1.0, 1.0, (1000, 6))
    print("of 1000 states     ", gradient(many, v, tau).shape, f"{gradient.operations} operations each")

    angles = np.array(sympy.symbols("q1:7"))  # the same algorithm, on symbols
    torque = sympy.trigsimp(algorithms.gravity_forces(robot.model, angles)[2])
    print("elbow, a formula   ", torque.evalf(4))
    print("elbow, in C        ", sympy.ccode(torque)[:50], "...")
    evaluated = float(torque.subs(dict(zip(angles, q, strict=True))))
    print("elbow, evaluated   ", round(evaluated, 9), "by the kernel", round(robot.gravity_forces(q)[2], 9))


if __name__ == "__main__":
    main()
