"""One step of differential inverse kinematics beside pink and mink, from Python, in one run: medians and ratios.

    python benchmarks/differential_ik.py [--quick]

Needs `pin-pink`, `mink`, `daqp` and `example-robot-data`. All three get the same URDF (MuJoCo's without shapes), the same
tasks, costs, limits, damping and targets, and the velocities are compared before anything is timed. A step is what a
control loop does at every tick: take a new configuration, tell the velocity. pink and mink hold their targets, ours are
told at every step. The peers solve with daqp, the fastest solver installed for them (another: --solver).
One core; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import mink
import mujoco
import numpy as np
import pinocchio as pin
from _timing import medians, shown, table
from lxml import etree

from ulna.algorithms import integrate, random
from ulna.ik.differential import (
    ComTask,
    DifferentialIK,
    FrameTask,
    PositionLimit,
    PostureTask,
    VelocityLimit,
)
from ulna.loading import load_model
from ulna.model import FreeFlyer, Model, lock_joints, with_root_joint
from ulna.robots import example_robot_data as data

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pink
    from pink import limits as pink_limits
    from pink import tasks as pink_tasks

DT, DAMPING, GAIN, LEVENBERG = 0.01, 1e-6, 0.9, 1.0
ROBOTS = {
    "Panda": ("panda", ("panda_hand",)),
    "UR5": ("ur5", ("wrist_3_link",)),
    "G1, both hands": ("g1", ("left_wrist_yaw_link", "right_wrist_yaw_link")),
}


def mujoco_model(path: Any, floating: bool, locked: Sequence[str]) -> mujoco.MjModel:
    """The robot of a URDF without its shapes; `locked` joints become fixed."""
    root = etree.parse(str(path)).getroot()
    for shape in root.xpath("//visual | //collision | //transmission | //gazebo"):
        shape.getparent().remove(shape)
    for joint in root.xpath("joint"):
        if joint.get("name") in locked:
            joint.set("type", "fixed")
    for link in root.xpath("link[not(inertial)]"):
        link.append(etree.fromstring(
            '<inertial><mass value="1e-6"/><inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial>'
        ))  # fmt: skip
    options = '<mujoco><compiler fusestatic="false" balanceinertia="true" strippath="true" discardvisual="true"/></mujoco>'
    root.append(etree.fromstring(options))
    spec = mujoco.MjSpec.from_string(etree.tostring(root, encoding="unicode"))
    if floating:
        spec.worldbody.first_body().add_freejoint()
    return spec.compile()


class Robot:
    """One robot in the three libraries."""

    def __init__(self, name: str, frames: Sequence[str]) -> None:
        path, _ = data.files(name)
        floating = data.DESCRIPTIONS[name].floating
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = load_model(path)
            theirs = pin.buildModelFromUrdf(str(path), *([pin.JointModelFreeFlyer()] if floating else []))
        locked = [joint for joint in model.joint_names if "finger" in joint]
        if locked:
            model = lock_joints(model, locked)
            theirs = pin.buildReducedModel(
                theirs, [theirs.getJointId(j) for j in locked], pin.neutral(theirs)
            )
        self.model: Model = with_root_joint(model, FreeFlyer()) if floating else model
        self.pin, self.mujoco, self.frames = theirs, mujoco_model(path, floating, locked), frames
        self.floating = floating


class Case:
    """The same problem in the three libraries: `ours`, `pink` and `mink` are one step each."""

    def __init__(self, robot: Robot, where: str, kinds: Sequence[str], solver: str) -> None:
        self.robot, model, rng = robot, robot.model, np.random.default_rng(3)
        q = random(model, rng)
        step = 0.02 if where == "inside" else 0.5
        if where == "at limits":
            for i in np.flatnonzero(np.isfinite(model.lower_position))[::2]:
                q[i] = model.lower_position[i] + 1e-4
        aim = integrate(
            model, q, step * DT * rng.choice([-1.0, 1.0], model.nv) * np.minimum(model.velocity_limit, 10.0)
        )
        if where == "at limits":
            aim = integrate(model, q, np.full(model.nv, -0.2))
        self.q, self.aim = q, aim
        self.solver = solver
        self._ours(kinds)
        self._pink(kinds)
        self._mink(kinds)

    def _ours(self, kinds: Sequence[str]) -> None:
        frames: list[Any] = [FrameTask(frame, 1.0, 0.5, damping=LEVENBERG) for frame in self.robot.frames]
        rest: list[Any] = [PostureTask(1e-2)] if "posture" in kinds else []
        rest += [ComTask(0.1, damping=LEVENBERG)] if "com" in kinds else []
        tasks, exact = (rest, frames) if "exact" in kinds else (frames + rest, [])
        limits = [VelocityLimit(), PositionLimit(GAIN)]
        self.ik = DifferentialIK(self.robot.model, tasks, limits, constraints=exact, damping=DAMPING)
        told = self.ik.targets_at(self.aim)
        self.targets = tuple(np.ascontiguousarray(told[name]) for name in self.ik.inputs)

    def _pink(self, kinds: Sequence[str]) -> None:
        model = self.robot.pin
        self.of_pink = pink.Configuration(model, model.createData(), pin.neutral(model), copy_data=False)
        self.pink_tasks: list[Any] = [
            pink_tasks.FrameTask(f, 1.0, 0.5, lm_damping=LEVENBERG) for f in self.robot.frames
        ]
        self.pink_tasks += [pink_tasks.PostureTask(1e-2)] if "posture" in kinds else []
        self.pink_tasks += [pink_tasks.ComTask(0.1, lm_damping=LEVENBERG)] if "com" in kinds else []
        self.pink_limits = [pink_limits.ConfigurationLimit(model, GAIN), pink_limits.VelocityLimit(model)]
        self.of_pink.update(self.aim)
        for task in self.pink_tasks:
            task.set_target_from_configuration(self.of_pink)
        count = len(self.robot.frames) if "exact" in kinds else 0
        self.pink_exact, self.pink_tasks = self.pink_tasks[:count], self.pink_tasks[count:]

    def _mink(self, kinds: Sequence[str]) -> None:
        model, ours = self.robot.mujoco, self.robot.model
        fastest = {
            joint.name: np.array(joint.limits.velocity)
            for joint in ours.joints
            if joint.nv == 1 and np.isfinite(joint.limits.velocity[0])
        }
        self.of_mink = mink.Configuration(model)
        self.mink_tasks: list[Any] = [
            mink.FrameTask(f, "body", 1.0, 0.5, lm_damping=LEVENBERG) for f in self.robot.frames
        ]
        self.mink_tasks += [mink.PostureTask(model, 1e-2)] if "posture" in kinds else []
        self.mink_tasks += [mink.ComTask(0.1, lm_damping=LEVENBERG)] if "com" in kinds else []
        self.mink_limits = [mink.ConfigurationLimit(model, GAIN), mink.VelocityLimit(model, fastest)]
        self.of_mink.update(self.wxyz(self.aim))
        for task in self.mink_tasks:
            task.set_target_from_configuration(self.of_mink)
        count = len(self.robot.frames) if "exact" in kinds else 0
        self.mink_exact, self.mink_tasks = self.mink_tasks[:count], self.mink_tasks[count:]
        self.q_mink = self.wxyz(self.q)

    def wxyz(self, q: np.ndarray) -> np.ndarray:
        """A configuration as MuJoCo writes it."""
        return np.concatenate([q[:3], q[6:7], q[3:6], q[7:]]) if self.robot.floating else q.copy()

    def ours(self) -> np.ndarray:
        """A step of ours."""
        return self.ik.velocity(self.q, DT, *self.targets)

    def pink(self) -> np.ndarray:
        """A step of pink's."""
        self.of_pink.update(self.q)
        return pink.solve_ik(
            self.of_pink,
            self.pink_tasks,
            DT,
            solver=self.solver,
            damping=DAMPING,
            limits=self.pink_limits,
            constraints=self.pink_exact,
        )

    def mink(self) -> np.ndarray:
        """A step of mink's."""
        self.of_mink.update(self.q_mink)
        return mink.solve_ik(
            self.of_mink,
            self.mink_tasks,
            DT,
            solver=self.solver,
            damping=DAMPING,
            limits=self.mink_limits,
            constraints=self.mink_exact,
        )

    def held(self) -> int:
        """How many joints are held by a limit."""
        problem, v = self.ik.problem(self.q, DT, *self.targets), self.ours()
        return int(((v - problem.lower[: len(v)] < 1e-9) | (problem.upper[: len(v)] - v < 1e-9)).sum())

    def differences(self) -> tuple[float, float]:
        """The largest differences of velocity to pink and to mink, as parts of the largest velocity."""
        ours, scale = self.ours(), float(np.abs(self.ours()).max())
        theirs = self.mink()
        if self.robot.floating:  # MuJoCo's free joint moves in world axes
            w, (x, y, z) = self.q[6], self.q[3:6]
            theirs[:3] = pin.Quaternion(w, x, y, z).toRotationMatrix().T @ theirs[:3]
        return float(np.abs(ours - self.pink()).max()) / scale, float(np.abs(ours - theirs).max()) / scale


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    parser.add_argument("--solver", default="daqp", help="the solver of pink and mink")
    chosen = parser.parse_args()
    rounds = 5 if chosen.quick else 21
    rows, batches = [], []
    for label, (name, frames) in ROBOTS.items():
        robot = Robot(name, frames)
        for what, where, kinds in (
            ("frame", "inside", ()),
            ("frame", "at limits", ()),
            ("frame, posture, com", "at limits", ("posture", "com")),
            ("posture, frame as constraint", "inside", ("posture", "exact")),
        ):
            case = Case(robot, where, kinds, chosen.solver)
            to_pink, to_mink = case.differences()
            a, b, c = medians([case.ours, case.pink, case.mink], repeat=rounds)
            rows.append([
                label, what, str(case.held()), f"{to_pink:.0e}, {to_mink:.0e}", shown(a), shown(b), shown(c), f"{b / a:.0f}, {c / a:.0f}",
            ])  # fmt: skip
        case = Case(robot, "inside", (), chosen.solver)
        count = 200 if chosen.quick else 2000
        Q = integrate(
            robot.model, case.q, 1e-3 * np.random.default_rng(0).standard_normal((count, robot.model.nv))
        )
        single, batch = medians(
            [case.ours, lambda c=case, Q=Q: c.ik.velocity(Q, DT, *c.targets)], repeat=rounds
        )
        batches.append(
            [
                label,
                str(case.ik.operations),
                shown(single),
                shown(batch / count),
                f"{single * count / batch:.1f}",
            ]
        )
    print(f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, pink {pink.__version__}, "
          f"mink {version('mink')}, {platform.machine()}\n")  # fmt: skip
    head = ["robot", "tasks", "joints held", "differs", "ours", "pink", "mink", "ratios"]
    print(table(f"One step; pink and mink with {chosen.solver}", head, rows))
    print(table("Batches", ["robot", "operations", "one call", "in a batch, each", "ratio"], batches))


if __name__ == "__main__":
    main()
