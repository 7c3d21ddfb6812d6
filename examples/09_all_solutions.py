"""Every way of an arm to reach a pose: a UR5's eight, a Panda's, by the elbow's place, and what a reason looks like.

You should see eight configurations of a UR5, how far they are from where it stands, and a count of a Panda's ways.
"""

import numpy as np

import ulna


def main() -> None:
    ur5 = ulna.load("ur5")
    here = np.array([0.3, -1.2, 1.4, -0.6, 0.9, 0.2])
    T = ur5.fk(here)
    found = ur5.ik_all(T, q0=here)
    print(f"UR5, {found.method}: {len(found)} ways, all of them: {found.complete}")
    for q, error in zip(found.q, found.position_error, strict=True):
        print(
            "  ", np.round(np.degrees(q), 1), f"{np.linalg.norm(q - here):.2f} rad away, off by {error:.0e} m"
        )

    panda = ulna.load("panda")
    q = panda.random_configuration(seed=4)
    ways = panda.ik_all(panda.fk(q), q0=q, samples=64)
    best = ways.q[np.argmax(panda.manipulability(ways.q))]
    print(f"Panda, {ways.method}: {len(ways)} ways within the limits")
    print("   the one that moves best:", np.round(best, 2))

    far = np.eye(4)
    far[:3, 3] = 3.0
    print("Three metres away:", ur5.ik_all(far).reason)

    poses = ur5.fk(ur5.random_configuration(1000, seed=5))
    many = ur5.ik_all(poses)
    counts = {int(n): int((many.count == n).sum()) for n in np.unique(many.count)}
    print("A thousand random poses, by how many ways they have:", counts)


if __name__ == "__main__":
    main()
