"""Collision: is a pose free, how near is it, when does a motion touch, and a million answers a second.

You should see the arm over a table with a box: the nearest pair with its distance, how many poses are free by
exact shapes and by covering spheres (which never say free where the shapes touch), and when a straight motion
through the box first touches it.

Needs: pip install '.[collision]' in Ulna's folder
"""

from __future__ import annotations

import numpy as np

import ulna
from ulna.collision import World
from ulna.geometry import Box, Sphere


def main() -> None:
    robot = ulna.load("panda")
    world = (
        World()
        .add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
        .add("box", Box((0.1, 0.4, 0.6)), (0.45, 0.0, 0.3))
        .add("ball", Sphere(0.08), (0.3, -0.5, 0.5), moving=True)
    )
    ready = robot.configurations["ready"]
    found = robot.distance(ready, world)
    print("Nearest in the pose 'ready':", found)
    print("  from", found.points[0].round(3), "to", found.points[1].round(3))
    print("  its gradient by the joints:", robot.collision.distance_gradient(ready, world).round(3))

    ball = ulna.SE3.from_translation(robot.fk(ready)[:3, 3])
    print("Ball at the tool: touching =", robot.collides(ready, world, moving={"ball": ball}))

    q = robot.random_configuration(2000, seed=0)
    exact, spheres = robot.collides(q, world), robot.collides(q, world, method="spheres")
    print(f"Free of 2000 random poses: {(~exact).sum()} by exact shapes, {(~spheres).sum()} by spheres,")
    print(f"  of which touch in truth: {(exact & ~spheres).sum()}")

    low = [0.0, 0.4, 0.0, -2.0, 0.0, 2.4, 0.8]
    left, right = np.array([low, low])
    left[0], right[0] = 1.2, -0.8
    print("Both ends free:", not robot.collides([left, right], world).any())
    time = robot.collision.first_contact(left, right, world)
    print(f"The way between them first touches at {time:.3f} of it")


if __name__ == "__main__":
    main()
