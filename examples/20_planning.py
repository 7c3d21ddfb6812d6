"""Plans around a wall, proves that nothing touches on the way, and moves as fast as the limits allow.

You should see a certified path of a few points, a motion of some two seconds with accelerations below 8 rad/s^2,
and how near the arm comes to an obstacle on the way: some millimetres or centimetres.
"""

import numpy as np

import ulna
from ulna.collision import World
from ulna.geometry import Box, Sphere


def down(x: float, y: float, z: float) -> np.ndarray:
    """A pose at a point with the gripper pointing down."""
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = x, y, z
    return T


def main() -> None:
    """Plans, times and measures the motion."""
    robot = ulna.load("panda")
    world = (
        World()
        .add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
        .add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
        .add("ball", Sphere(0.1), (0.3, -0.5, 0.6))
    )
    q0 = robot.ik(down(0.5, -0.25, 0.35), robot.configurations["ready"], seed=1).q
    path = robot.plan(q0, down(0.5, 0.25, 0.35), world)
    if not path:
        raise SystemExit(path.reason)
    print(path)

    motion = path.trajectory(acceleration=8.0)
    samples = motion.sample(n=1000)
    distances = robot.distance(samples.q[::50], world).distance
    print(f"{motion.duration:.2f} s, largest acceleration {np.abs(samples.a).max():.2f} rad/s^2")
    print(f"nearest distance on the way {distances.min() * 1e3:.1f} mm")
    assert path.is_certified and distances.min() > 0.0


if __name__ == "__main__":
    main()
