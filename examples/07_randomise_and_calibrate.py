"""Numbers of the model as inputs: ten thousand different Pandas in one call, and a UR5 calibrated from measured poses.

You should see how far the accelerations of 10,000 Pandas with other masses scatter, computed by one kernel; then a UR5
whose joints stand half a millimetre and a thirtieth of a degree off: 60 noisy measurements of its tool bring the error
at places that were not measured from two millimetres below the noise, and 30 of the 42 numbers can be told apart.
"""

from __future__ import annotations

import time

import numpy as np

import ulna
from ulna.numeric import vector


def main(count: int = 10_000) -> None:
    """Runs both."""
    rng = np.random.default_rng(0)
    randomise(rng, count)
    calibrate(rng)


def randomise(rng: np.random.Generator, count: int) -> None:
    """The same torques on Pandas whose bodies are up to 20 % heavier or lighter."""
    robot = ulna.load("panda")
    accelerations = robot.kernel("forward_dynamics", parameters=("inertia",))
    scale = rng.uniform(0.8, 1.2, (count, len(robot.joint_names), 1))  # a body that is scaled is still a body
    inertia = (robot.parameters["inertia"].reshape(-1, 10) * scale).reshape(count, -1)
    q, v = robot.configurations["qr"], np.zeros(robot.nv)
    hold = robot.gravity_forces(q)
    accelerations(q, v, hold, inertia[:1000])  # the first batch compiles the loop over batches
    start = time.perf_counter()
    a = accelerations(q, v, hold, inertia)  # (count, 7): one state, many robots
    seconds = time.perf_counter() - start
    print(
        f"{count} Pandas, each with its own masses, in {1e3 * seconds:.1f} ms; what holds the nominal one lets them"
    )
    print("accelerate by [rad/s^2], standard deviation:", np.round(a.std(axis=0), 2))


def calibrate(rng: np.random.Generator, measured: int = 60, noise: float = 5e-5) -> None:
    """Finds how far joints and tool are off, by Gauss and Newton."""
    robot = ulna.load("ur5")
    robot = robot.with_tool(robot.tool, ulna.SE3.identity(), "probe")
    fk = robot.function("fk", parameters=("placement", "tool"))

    def miss(q, seen, placement, tool):
        """Where the tool would be, less where it was seen: position [m] and rotation [rad]."""
        T = fk(q, placement, tool)
        R = seen[:3, :3].T @ T[:3, :3]
        turned = [0.5 * (R[i, j] - R[j, i]) for i, j in ((2, 1), (0, 2), (1, 0))]
        return vector(*(T[:3, 3] - seen[:3, 3]), *turned)

    shapes = {"seen": (4, 4), "placement": (6, 6), "tool": (6,)}
    residual = ulna.compile(miss, robot, **shapes)
    slopes = [residual.jacobian("placement"), residual.jacobian("tool")]

    truth = rng.normal(0.0, 5e-4, 42)  # half a millimetre, a thirtieth of a degree
    true_robot = robot.with_parameters({"placement": truth[:36].reshape(6, 6), "tool": truth[36:]})
    q = robot.random_configuration(measured + 200, seed=1)
    seen = true_robot.fk(q)
    known, fresh = slice(0, measured), slice(measured, None)
    seen[known] = seen[known] @ ulna.SE3.exp(rng.normal(0.0, noise, (measured, 6))).matrix()

    x, J, rank = np.zeros(42), np.zeros((0, 42)), 0
    for _ in range(4):
        arrays = (q[known], seen[known], x[:36].reshape(6, 6), x[36:])
        J = np.concatenate([slope(*arrays).reshape(6 * measured, -1) for slope in slopes], axis=1)
        # A shift of a joint along its axis is one of the next joint, too: of all steps that fit, the smallest is taken.
        step, _, rank, _ = np.linalg.lstsq(J, -residual(*arrays).reshape(-1), rcond=1e-8)
        x += step
    for name, guess in (("as drawn", np.zeros(42)), ("calibrated", x)):
        error = residual(q[fresh], seen[fresh], guess[:36].reshape(6, 6), guess[36:])
        position, angle = (1e3 * np.linalg.norm(e, axis=1).mean() for e in (error[:, :3], error[:, 3:]))
        print(f"{name}: {position:.3f} mm and {angle:.3f} mrad off at places that were not measured")
    apart = np.linalg.svd(J)[2][:rank]  # the combinations that the measurements see
    before, after = (1e3 * np.sqrt(np.mean((apart @ e) ** 2)) for e in (truth, x - truth))
    print(
        f"{rank} of 42 numbers can be told apart; they were {before:.3f} off (mm, mrad) and are {after:.3f} off"
    )


if __name__ == "__main__":
    main()
