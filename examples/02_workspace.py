"""A million configurations: how far does the hand reach, and where does it move well?

You should see the reach of the Panda and how manipulability depends on it, in about a second.
"""

import itertools
import time

import numpy as np

import ulna


def main(count: int = 1_000_000) -> None:
    robot = ulna.load("panda")
    Q = robot.random_configuration(count, seed=0)
    start = time.perf_counter()
    p = robot.fk(Q, threads=2)[:, :3, 3]
    m = robot.manipulability(Q, axes="trans")
    seconds = time.perf_counter() - start
    reach = np.linalg.norm(p - [0.0, 0.0, 0.333], axis=1)  # from the shoulder [m]
    print(
        f"{count:,} poses and measures in {seconds:.2f} s; the hand reaches {reach.max():.3f} m from the shoulder"
    )
    edges = np.linspace(0.0, reach.max(), 9)
    for low, high in itertools.pairwise(edges):
        inside = (reach >= low) & (reach < high)
        if inside.any():
            print(f"  {low:.2f} .. {high:.2f} m: mean manipulability {m[inside].mean():.3f}")


if __name__ == "__main__":
    main()
