"""Picks a can, carries it past a wall, and puts it down: five plans, each proved free, also for what the hand holds.

While the can is lifted and put down it may touch the table; on the way between it may not.
You should see five certified paths, how near arm and can come to anything on the way, and the can at its new place.

    python examples/21_carry.py                # plans and prints
    python examples/21_carry.py --film a.mp4   # writes a film of the motion

Needs: pip install '.[collision]' in Ulna's folder, for --film '.[film]'
"""

import argparse

import numpy as np

import ulna
from ulna.collision import World
from ulna.geometry import Box, Cylinder
from ulna.planning import Plan, Region

FINGERS = ["panda_leftfinger", "panda_rightfinger"]
GRASP = ulna.SE3.from_translation([0.0, 0.0, 0.16])  # T_hand_can: the can's axis along the hand's
LIFT = np.array([0.0, 0.0, 0.04])
START, END = np.array([0.5, -0.3, 0.071]), np.array([0.45, 0.35, 0.071])


def world_with_can() -> World:
    """A table with a wall, and the can."""
    return (
        World()
        .add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
        .add("wall", Box((0.4, 0.03, 0.3)), (0.55, 0.0, 0.15))
        .add("can", Cylinder(0.03, 0.14), START, touches=FINGERS)
    )


def hand_at(place: np.ndarray) -> Region:
    """Where the hand may be to hold a can at a place: pointing down, turned as it likes."""
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = place
    return Region(ulna.SE3.from_matrix(T) @ GRASP.inverse(), turns="z")


def planned(robot: ulna.Robot, q0: np.ndarray, goal: object, world: World) -> Plan:
    """A path, or the reason why there is none."""
    path = robot.plan(q0, goal, world, frame="panda_hand" if isinstance(goal, Region) else None)
    if not path:
        raise SystemExit(path.reason)
    motion = path.trajectory(acceleration=5.0)
    distances = robot.distance(motion.sample(n=200).q, world).distance
    print(f"{path}\n   {motion.duration:.2f} s, nearest {1e3 * distances.min():.1f} mm")
    assert path.is_certified and distances.min() > 0.0
    return path


def main(film: str | None = None) -> None:
    """Plans the three motions, and films them."""
    robot = ulna.load("panda")
    world = world_with_can()
    reach = planned(robot, robot.configurations["ready"], hand_at(START), world)

    grasp = np.linalg.inv(robot.fk(reach.points[-1], "panda_hand")) @ world["can"].pose.matrix()
    held = world.attach("can", "panda_hand", grasp, touches=FINGERS)
    resting = world.attach("can", "panda_hand", grasp, touches=[*FINGERS, "table"])
    lift = planned(robot, reach.points[-1], hand_at(START + LIFT), resting)
    carry = planned(robot, lift.points[-1], hand_at(END + LIFT), held)
    lower = planned(robot, carry.points[-1], hand_at(END), resting)

    T = robot.fk(lower.points[-1], "panda_hand") @ grasp
    placed = held.detach("can", T, touches=FINGERS)
    back = planned(robot, lower.points[-1], robot.configurations["ready"], placed)
    print("the can stands at", T[:3, 3].round(4))
    assert np.abs(T[:2, 3] - END[:2]).max() < 1e-3
    if film:
        write_film(robot, [(reach, world), (lift, held), (carry, held), (lower, held), (back, placed)], film)


def write_film(robot: ulna.Robot, legs: list[tuple[Plan, World]], path: str) -> None:
    """Shows each motion in its world, one after the other."""
    from ulna.viewer import Camera

    viewer = ulna.Viewer(page=False)
    viewer.camera = Camera(position=(1.9, -1.2, 1.2), target=(0.4, 0.0, 0.25))
    arm = viewer.add(robot, q="ready")
    motions = [leg.trajectory(acceleration=5.0) for leg, _ in legs]
    ends = np.cumsum([m.duration for m in motions])
    shown = {-1: {}}

    def move(t: float) -> None:
        k = min(int(np.searchsorted(ends, t)), len(legs) - 1)
        if k not in shown:
            for handle in shown.popitem()[1].values():
                handle.remove()
            shown[k] = viewer.world(legs[k][1], arm)
        arm.q = motions[k](max(t - (ends[k] - motions[k].duration), 0.0))

    move(0.0)
    viewer.film(path, move=move, duration=float(ends[-1]), fps=15, width=640, height=400, samples=1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--film", help="writes a film there")
    main(parser.parse_args().film)
