"""A robot that is pushed, held by a law of torques, and recorded: what a simulator in the browser shows, without one.

You should see the arm give way and come back, and one row of the recording for each step.
With `viewer = ulna.Viewer()` it runs in your browser in real time, with a time line to pause and scrub.
"""

import numpy as np

import ulna


def main() -> None:
    robot = ulna.load("panda", visuals="simple")
    viewer = ulna.Viewer(page=False)
    arm = viewer.add(robot, q="qr")
    home = arm.q
    sim = viewer.simulate(control="torque")

    def hold(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        push = np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0, 0.0]) * (t < 0.2)
        return robot.gravity_forces(q) - robot.mass_matrix(q) @ (100.0 * (q - home) + 20.0 * qd) + push

    arm.body.tau = hold
    sim.run(1.5, 0.01)
    away = np.abs(arm.body.recording.q - home).max(axis=1)
    print(
        f"{sim.steps} steps; furthest away {np.rad2deg(away.max()):.2f} deg, at the end {np.rad2deg(away[-1]):.3f} deg"
    )
    print("recorded:", {name: arm.body.recording[name].shape for name in arm.body.recording.names})
    assert away.max() > 0.02 > 10 * away[-1]
    # viewer.film("push.mp4") writes what happened at its true speed, viewer.html("push.html") a page that plays it


if __name__ == "__main__":
    main()
