"""Feet on the ground and a closed linkage: constrained dynamics, contact forces, a touch-down.

You should see a quadruped's weight shared by its four feet, what a landing takes, a robot that is pushed and keeps its
feet where they are, and a four-bar linkage that swings for three seconds and keeps its loop closed and its energy.

    python examples/06_contacts.py
"""

from __future__ import annotations

import numpy as np

import ulna
from ulna.model import FreeFlyer, ModelBuilder, PointContact, PointLoop, Revolute
from ulna.sim import simulate
from ulna.spatial import SE3, Inertia


def quadruped() -> ulna.Robot:
    """A trunk of 8 kg on four legs with three joints each."""
    builder = ModelBuilder("quadruped").add_link("trunk", Inertia.from_box(8.0, (0.5, 0.25, 0.1)))
    builder.root_joint(FreeFlyer())
    for x, end in ((0.2, "front"), (-0.2, "hind")):
        for y, side in ((0.12, "left"), (-0.12, "right")):
            leg = f"{end}_{side}"
            builder.add_link(f"{leg}_hip", Inertia.from_box(0.3, (0.06, 0.06, 0.06)))
            builder.add_joint(f"{leg}_roll", Revolute((1, 0, 0)), "trunk", f"{leg}_hip", SE3.trans(x, y, 0.0))
            for name, parent, axis_at in (("thigh", "hip", 0.0), ("shank", "thigh", -0.2)):
                rod = Inertia.from_com(0.2, (0.0, 0.0, -0.1), np.diag([7e-4, 7e-4, 1e-5]))
                builder.add_link(f"{leg}_{name}", rod)
                place = SE3.trans(0.0, 0.0, axis_at)
                builder.add_joint(
                    f"{leg}_{name}_joint", Revolute((0, 1, 0)), f"{leg}_{parent}", f"{leg}_{name}", place
                )
            builder.add_frame(f"{leg}_foot", f"{leg}_shank", SE3.trans(0.0, 0.0, -0.2))
    return ulna.Robot(builder.build())


def linkage() -> ulna.Robot:
    """Three bars of 1 kg/m in a plane: crank and coupler, and a rocker beside them."""
    builder = ModelBuilder("linkage").add_link("ground")
    places = {"crank": ("ground", 0.0, 0.0, 0.4), "coupler": ("crank", 0.0, -0.4, 0.9)}
    places["rocker"] = ("ground", 0.8, 0.0, 0.7)
    for name, (parent, x, z, length) in places.items():
        bar = Inertia.from_com(length, (0.0, 0.0, -length / 2), np.diag([1.0, 1.0, 0.01]) * length**3 / 12)
        builder.add_link(name, bar)
        builder.add_joint(f"{name}_joint", Revolute((0, 1, 0)), parent, name, SE3.trans(x, 0.0, z))
        builder.add_frame(f"{name}_end", name, SE3.trans(0.0, 0.0, -length))
    return ulna.Robot(builder.build())


def stand() -> None:
    """The weight on the feet, a landing, and a second of standing."""
    robot = quadruped()
    q = np.concatenate([[0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0], np.tile([0.0, 0.5, -1.0], 4)])
    feet = [PointContact(name) for name in robot.frame_names if name.endswith("_foot")]

    J = robot.constraints.jacobian(q, feet)  # (12, 18)
    weight = robot.gravity_forces(q)
    share = np.linalg.lstsq(J.T[:6], weight[:6], rcond=None)[0]  # feet carry what no joint drives
    tau = weight - J.T @ share
    tau[:6] = 0.0
    motion = robot.constraints.forward_dynamics(q, np.zeros(18), tau, feet)
    print(f"weight {robot.total_mass() * 9.81:.2f} N, on the feet {np.round(motion.forces[2::3], 2)} N")
    print(f"fastest acceleration {np.abs(motion.a).max():.1e}, residual {motion.residual:.1e} m/s^2")

    falling = np.zeros(18)
    falling[2] = -1.0  # 1 m/s downward
    landing = robot.constraints.impulse_dynamics(q, falling, feet)
    after = robot.centroidal.velocity(q, landing.v)[2]
    print(f"a landing at 1 m/s on soft knees takes {landing.impulses[2::3].sum():.2f} N s", end=", ")
    print(f"and the trunk goes on at {-after:.2f} m/s")

    def hold(t: float, at: np.ndarray, v: np.ndarray) -> np.ndarray:
        pull = -40.0 * robot.difference(q, at) - 2.0 * v
        pull[:6] = [0.0, 30.0 * (t < 0.2), 0.0, 0.0, 0.0, 0.0]  # a push from the side
        return tau + pull

    run = simulate(robot, q, torque=hold, duration=1.0, dt=2e-3, constraints=feet)
    drift = robot.constraints.error(run["q"][-1], feet, robot.constraints.anchors(q, feet))
    sway = 1e3 * np.ptp(run["q"][:, 1])
    print(f"pushed, the trunk sways by {sway:.1f} mm, and the feet slide by {np.abs(drift).max():.1e} m")


def swing() -> None:
    """A linkage that falls and swings."""
    robot = linkage()
    loop = [PointLoop("coupler_end", "rocker_end")]
    q = np.array([1.2, -2.0, 0.8])
    for _ in range(20):  # Newton's method closes the loop
        J = robot.constraints.jacobian(q, loop)
        q = q - np.linalg.pinv(J, rcond=1e-9) @ robot.constraints.error(q, loop)
    run = simulate(robot, q, duration=3.0, dt=1e-3, method="rk4", constraints=loop, every=10)
    gap = np.abs(robot.constraints.error(run["q"], loop)).max()
    energy = robot.mechanical_energy(run["q"], run["v"])
    print(f"linkage: crank swings through {np.ptp(run['q'][:, 0]):.2f} rad, gap {gap:.1e} m", end=", ")
    print(f"energy {energy[0]:.3f} J within {np.ptp(energy):.1e} J")


def main() -> None:
    """Prints what is said above."""
    stand()
    swing()


if __name__ == "__main__":
    main()
