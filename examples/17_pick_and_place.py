"""Pick and place: a UR5 carries a ball and then a box over a wall, in the viewer or as a film.

You should see for each part where the direct way would touch the wall, how long reaching, lifting, carrying and
lowering take, and how near to its place it is put down; then that every leg is free and within the limits.

    python examples/17_pick_and_place.py --show            # in the viewer
    python examples/17_pick_and_place.py --film pick.mp4    # as a film, or .gif

Needs: pip install '.[collision]' in Ulna's folder, for --show '.[viewer]', for --film '.[film]'
"""

from __future__ import annotations

import argparse
from typing import NamedTuple

import numpy as np

import ulna
from ulna import trajectory
from ulna.collision import World
from ulna.geometry import Box, Cylinder, Geometry, Shape, Sphere
from ulna.model import ModelBuilder
from ulna.spatial import SE3, Inertia

DOWN = SE3.from_rpy((np.pi, 0.0, 0.0))  # the tool's z axis points to the table
UP = SE3.trans(0.0, 0.0, -0.12)  # from the contact back along the tool's axis
SPEED, ACCELERATION = 1.5, 5.0  # rad/s, rad/s^2; torques are the model's


class Part(NamedTuple):
    """Something to carry: where it stands, where it shall stand, and where on it the tool touches."""

    name: str
    shape: Shape
    mass: float  # kg
    start: SE3
    goal: SE3
    grasps: tuple[SE3, ...]  # T_part_tool, one as good as the other
    mask: str  # what counts of them: a ball may be turned about the tool's axis
    color: tuple[float, float, float]


class Leg(NamedTuple):
    """One motion, and what the tool holds meanwhile: a part, and its place in the tool."""

    move: trajectory.Trajectory
    held: str | None = None
    T_tool_part: SE3 | None = None


BALL = Part(
    "ball",
    Sphere(0.05),
    0.3,
    SE3.trans(0.5, 0.1, 0.2),
    SE3.trans(0.5, -0.3, 0.05),
    (SE3.trans(0.0, 0.0, 0.05) @ DOWN,),
    "position+z",
    (0.9, 0.25, 0.2),
)
BOX = Part(
    "box",
    Box((0.06, 0.12, 0.08)),
    0.5,
    SE3.from_rpy((0.0, 0.0, 0.5), (0.3, 0.35, 0.04)),
    SE3.from_rpy((0.0, 0.0, 0.0), (0.3, -0.35, 0.04)),
    tuple(SE3.trans(0.0, 0.0, 0.04) @ SE3.from_rpy((0.0, 0.0, k * np.pi / 2)) @ DOWN for k in range(4)),
    "pose",
    (0.95, 0.7, 0.2),
)
FURNITURE: dict[str, tuple[Shape, SE3, tuple[float, float, float]]] = {
    "table": (Box((1.2, 1.4, 0.04)), SE3.trans(0.3, 0.0, -0.02), (0.75, 0.62, 0.48)),
    "stand": (Cylinder(0.04, 0.15), SE3.trans(0.5, 0.1, 0.075), (0.5, 0.55, 0.6)),
    "wall": (Box((0.5, 0.02, 0.3)), SE3.trans(0.5, -0.1, 0.15), (0.55, 0.65, 0.6)),
}


def main(show: bool = False, film: str | None = None) -> None:
    """Plans both tasks, tells about them, and shows them."""
    robot = ulna.load("ur5")
    q, placed = np.array(robot.configurations["ready"]), {BALL.name: BALL.start, BOX.name: BOX.start}
    legs: list[Leg] = []
    for part in (BALL, BOX):
        some = carry(robot, part, q, placed)
        legs += some
        q = some[-1].move(some[-1].move.duration)
        lowered = some[-2]
        assert lowered.T_tool_part is not None
        put = SE3.from_matrix(robot.fk(lowered.move(lowered.move.duration))) @ lowered.T_tool_part
        placed[part.name] = put
        off = np.linalg.norm(put.translation - part.goal.translation)
        times = ", ".join(f"{leg.move.duration:.2f}" for leg in some)
        print(f"{part.name}: legs of {times} s, put down {1e6 * off:.2g} um from its place")
    print(f"{sum(leg.move.duration for leg in legs):.1f} s in all, every leg free and within the limits")
    if show or film:
        present(robot, legs, show, film)


def world_of(placed: dict[str, SE3], part: Part, held: bool = False) -> World:
    """The table with everything on it; the part in question may touch the tool, and what it stands on."""
    world = World()
    for name, (shape, pose, _) in FURNITURE.items():
        touches = ["base_link"] if name == "table" else []
        touches += [part.name] if held and name != "wall" else []
        world = world.add(name, shape, pose, touches=touches)
    for other in (BALL, BOX):
        if other is not part:
            world = world.add(other.name, other.shape, placed[other.name])
        elif not held:
            world = world.add(part.name, part.shape, placed[part.name], touches=["wrist_3_link"])
    return world


def carry(robot: ulna.Robot, part: Part, q: np.ndarray, placed: dict[str, SE3]) -> list[Leg]:
    """Reach, lower, lift, carry, lower, and leave."""
    world, around = world_of(placed, part), world_of(placed, part, held=True)
    above = nearest(robot, [part.start @ grasp @ UP for grasp in part.grasps], q, world, part.mask)
    down = lower(robot, above, world)
    grasped = down(down.duration)
    T_tool_part = SE3.from_matrix(robot.fk(grasped)).inverse() @ part.start

    # The part is a body of the robot now: it must not touch anything either, and its mass takes torque.
    body = ModelBuilder(part.name)
    solid = Geometry(part.name, part.shape)
    inertia = Inertia.from_com(part.mass, np.zeros(3), 1e-3 * np.eye(3))
    body.add_link(part.name, collisions=(solid,), inertia=inertia)
    laden = robot.attach(ulna.Robot(body.build()), placement=T_tool_part, tool=robot.tool)
    target = part.goal @ T_tool_part.inverse()
    over = nearest(laden, [target @ UP], above, around, part.mask)
    lowered = lower(laden, over, around)
    return [
        Leg(go(robot, q, above, world)),
        Leg(down),
        Leg(down.reversed(), part.name, T_tool_part),
        Leg(go(laden, above, over, around), part.name, T_tool_part),
        Leg(lowered, part.name, T_tool_part),
        Leg(checked(robot, lowered.reversed(), world.move(part.name, part.goal))),
    ]


def nearest(robot: ulna.Robot, goals: list[SE3], q0: np.ndarray, world: World, mask: str) -> np.ndarray:
    """The nearest configuration that puts the tool at one of the goals and touches nothing."""
    found = [robot.ik_free(T.matrix(), world, q0, mask=mask, margin=0.005) for T in goals]
    free = [solution.q for solution in found if solution]
    if not free:
        raise SystemExit(f"The goal cannot be reached: {found[0].reason}.")
    return min(free, key=lambda q: float(robot.configuration_space.distance(q0, q)))


def lower(robot: ulna.Robot, q: np.ndarray, world: World) -> trajectory.Trajectory:
    """Straight along the tool's axis, down to the contact."""
    T = SE3.from_matrix(robot.fk(q))
    line = trajectory.pose_line(T, T @ UP.inverse(), velocity=(0.25, 1.0), acceleration=(0.8, 4.0))
    return checked(robot, trajectory.follow(line, lambda goal, near: robot.ik(goal, q0=near), q), world)


def go(robot: ulna.Robot, q0: np.ndarray, q1: np.ndarray, world: World) -> trajectory.Trajectory:
    """As fast as the arm can, straight if that is free, else over a point above the middle."""
    points = [q0, q1]
    contact = robot.collision.first_contact(q0, q1, world, margin=0.01)
    if np.isfinite(contact):
        x, y, _ = robot.fk(points)[:, :3, 3].mean(axis=0)
        over = SE3.trans(x, y, 0.55) @ DOWN
        points.insert(1, nearest(robot, [over], 0.5 * (q0 + q1), world, "position+z"))
        print(f"  the direct way would touch after {contact:.0%} of it; over the top instead")
    return checked(
        robot, trajectory.time_optimal(points, robot, velocity=SPEED, acceleration=ACCELERATION), world
    )


def checked(robot: ulna.Robot, move: trajectory.Trajectory, world: World) -> trajectory.Trajectory:
    """The motion, if nothing touches on it and it keeps the limits."""
    _, q, _, _ = move.sample(n=101)
    contact = robot.collision.first_contact(q[:-1], q[1:], world)
    if np.isfinite(contact).any():
        raise SystemExit(f"Something touches at {np.isfinite(contact).argmax()} % of the motion.")
    trajectory.check(robot, move.slowed(1.02)).require()
    return move


def present(robot: ulna.Robot, legs: list[Leg], show: bool, film: str | None) -> None:
    """Plays the legs in the viewer, or writes them as a film."""
    from ulna.viewer import Camera

    viewer = ulna.Viewer(page=show)
    viewer.camera = Camera(position=(2.2, -0.5, 1.2), target=(0.3, 0.0, 0.25))
    arm = viewer.add(robot, q="ready")
    for name, (shape, pose, color) in FURNITURE.items():
        viewer.add(shape, name=name, pose=pose, color=color)
    parts = {p.name: viewer.add(p.shape, name=p.name, pose=p.start, color=p.color) for p in (BALL, BOX)}
    ends = np.cumsum([leg.move.duration for leg in legs])

    def move(t: float) -> None:
        at = min(int(np.searchsorted(ends, t, side="right")), len(legs) - 1)
        for part in (BALL, BOX):
            parts[part.name].pose = part.start
        for k, leg in enumerate(legs[: at + 1]):  # where a part was left, and where it is held
            q = leg.move(t - ends[k] + leg.move.duration)
            if leg.held is not None and leg.T_tool_part is not None:
                parts[leg.held].pose = robot.fk(q) @ leg.T_tool_part.matrix()
        arm.q = q

    if film:
        print(
            "wrote",
            viewer.film(film, move=move, duration=float(ends[-1]), fps=15, width=640, height=400, samples=1),
        )
    if show:
        import time

        start = time.perf_counter()
        while (t := time.perf_counter() - start) < ends[-1]:
            move(t)
            time.sleep(0.01)
        move(float(ends[-1]))
        viewer.hold()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--show", action="store_true", help="play it in the viewer")
    parser.add_argument("--film", help="write a film to this file, .mp4 or .gif")
    main(**vars(parser.parse_args()))
