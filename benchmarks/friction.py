"""A Puma 560 falling under its own weight with friction in its joints: Ulna beside the Robotics Toolbox, in one run.

    python benchmarks/friction.py [--full]

Needs `roboticstoolbox-python` and `scipy`. Both take masses, motors, gears and friction from the Toolbox's model. Dry
friction is a step in the torque; an adaptive solver that meets it at rest takes tiny steps. The Toolbox is given 0.01 s
of motion, or with --full the 0.1 s of its own example (12 s of computing); Ulna always 0.1 s, so that its figures are
for ten times the motion without --full.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import roboticstoolbox as rtb
from _timing import table

from ulna.algorithms import Friction
from ulna.model import Drive, Model, ModelBuilder, Revolute, with_drives
from ulna.robot import Robot
from ulna.sim import simulate
from ulna.spatial import SE3, Inertia


def puma() -> tuple[Robot, Friction, rtb.DHRobot]:
    """The robot in both libraries, and the friction of its drives."""
    peer = rtb.models.DH.Puma560()
    builder = ModelBuilder("puma560").add_link("link0")
    for k, link in enumerate(peer.links):
        beyond = SE3.trans(0.0, 0.0, link.d) @ SE3.trans(link.a, 0.0, 0.0) @ SE3.rx(link.alpha)
        builder.add_link(f"link{k + 1}", Inertia.from_com(link.m, np.ravel(link.r), np.asarray(link.I)))
        builder.add_joint(f"joint{k + 1}", Revolute((0, 0, 1)), f"link{k}", f"link{k + 1}", offset=beyond)
    bare: Model = builder.build()
    drives = {
        f"joint{k + 1}": Drive(link.Jm, abs(link.B), link.Tc[0], -link.Tc[1], gear=link.G)
        for k, link in enumerate(peer.links)
    }
    model = with_drives(bare, drives)
    return Robot(model), Friction.of_drives(model, drives), peer


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="0.1 s of motion for the Toolbox, too")
    span = 0.1 if parser.parse_args().full else 0.01
    robot, law, peer = puma()
    q = np.array(peer.qn)
    ways: dict[str, dict[str, object]] = {
        "euler, dry friction exact, 1 ms": {"method": "euler", "dt": 1e-3},
        "euler, dry friction exact, 0.1 ms": {"method": "euler", "dt": 1e-4},
        "rk4, smooth within 0.01 rad/s, 0.1 ms": {"method": "rk4", "dt": 1e-4},
        "adaptive (LSODA), smooth within 0.01 rad/s": {
            "method": "adaptive",
            "dt": 1e-2,
            "rtol": 1e-6,
            "atol": 1e-8,
        },
    }
    rows, ends = [], []
    for what, options in ways.items():
        run = lambda options=options: simulate(robot, q, duration=0.1, friction=law, **options)  # noqa: E731
        run()
        start = time.perf_counter()
        recording = run()
        took = time.perf_counter() - start
        ends.append(recording["q"][-1])
        rows.append([f"Ulna: {what}", "0.1 s", f"{took * 1e3:.2f} ms", f"{took / 0.1:.3g}"])
    start = time.perf_counter()
    out = peer.fdyn(span, q)
    took = time.perf_counter() - start
    label = f"Robotics Toolbox: fdyn, RK45, {len(out.t):,} steps"
    rows.append([label, f"{span:g} s", f"{took * 1e3:.0f} ms", f"{took / span:.3g}"])
    print(table("A Puma 560 with friction", ["way", "motion", "computing", "seconds per second"], rows))
    same = simulate(robot, q, duration=span, friction=law, dt=1e-5)["q"][-1]
    print(f"greatest difference of joint angles after {span:g} s: {np.abs(same - out.q[-1]).max():.2e} rad")
    print(f"between Ulna's ways after 0.1 s: {np.ptp(ends, axis=0).max():.2e} rad")


if __name__ == "__main__":
    main()
