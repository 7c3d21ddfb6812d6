"""One step of differential inverse kinematics against pink: the same tasks, costs and limits give the same velocity."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    pink = pytest.importorskip("pink")
    from pink import limits as pink_limits
    from pink import tasks as pink_tasks

from support.pinocchio_models import Twin  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna.errors import ModelWarning  # noqa: E402
from ulna.formats.urdf import model_from_urdf  # noqa: E402
from ulna.ik.differential import (  # noqa: E402
    ComTask,
    DampingTask,
    DifferentialIK,
    FrameTask,
    JointCouplingTask,
    LinearTask,
    ManipulabilityTask,
    PositionLimit,
    PostureTask,
    RelativeFrameTask,
    VelocityLimit,
)
from ulna.model import FreeFlyer, lock_joints, with_root_joint  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.typing import Floats  # noqa: E402

if example_robot_data.share_folder() is None:
    pytest.skip("example-robot-data is not installed", allow_module_level=True)

DT = 0.02
DAMPING = 1e-6
ROBOTS = {
    "ur5": ("tool0", "forearm_link"),
    "panda": ("panda_hand", "panda_link3"),
    "g1": ("left_rubber_hand", "right_rubber_hand"),
    "talos": ("gripper_left_base_link", "gripper_right_base_link"),
}
"""Two frames of each robot; humanoids stand on a free flyer."""

KINDS = ("frame", "stiff", "relative", "com", "damped", "linear", "coupled", "manipulability", "crowded")


@cache
def twin(name: str) -> Twin:
    path, _ = example_robot_data.files(name)
    floating = example_robot_data.DESCRIPTIONS[name].floating
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        model = model_from_urdf(path, mimic=False)
    if floating:
        model = with_root_joint(model, FreeFlyer())
    theirs = pin.buildModelFromUrdf(str(path), *([pin.JointModelFreeFlyer()] if floating else []))
    fingers = [joint for joint in model.joint_names if "finger" in joint]
    if fingers:
        model = lock_joints(model, fingers)
        theirs = pin.buildReducedModel(theirs, [theirs.getJointId(f) for f in fingers], pin.neutral(theirs))
    return Twin(model, theirs, ())


class Case:
    """The same tasks for both, at a place near some limits, with targets not far away."""

    def __init__(self, name: str, kind: str) -> None:
        self.twin, (tip, side) = twin(name), ROBOTS[name]
        model, rng = self.twin.model, np.random.default_rng([list(ROBOTS).index(name), KINDS.index(kind)])
        self.q = alg.random(model, rng)
        beside = rng.random(model.nq) < 0.3
        beside[: 7 if model.nq > model.nv else 0] = False
        beside &= np.isfinite(model.lower_position)
        self.q[beside] = model.lower_position[beside] + 1e-3
        away = alg.integrate(model, self.q, 0.1 * rng.standard_normal(model.nv))
        self.configuration = pink.Configuration(
            self.twin.pin, self.twin.pin.createData(), self.twin.q(self.q)
        )
        aim = pink.Configuration(self.twin.pin, self.twin.pin.createData(), self.twin.q(away))

        ours, theirs = [FrameTask(tip, 1.0, 0.5)], [pink_tasks.FrameTask(tip, 1.0, 0.5)]
        if kind in ("stiff", "crowded"):
            ours[0] = FrameTask(tip, [1.0, 2.0, 3.0], [0.1, 0.0, 0.4], gain=0.7, damping=0.05)
            theirs[0] = pink_tasks.FrameTask(tip, [1.0, 2.0, 3.0], [0.1, 0.0, 0.4], lm_damping=0.05, gain=0.7)
        if kind in ("relative", "crowded"):
            ours.append(RelativeFrameTask(tip, side, 0.8, [0.3, 0.2, 0.1]))
            theirs.append(pink_tasks.RelativeFrameTask(tip, side, 0.8, [0.3, 0.2, 0.1]))
        if kind in ("com", "crowded"):
            ours.append(ComTask([1.0, 1.0, 0.2], gain=0.5))
            theirs.append(pink_tasks.ComTask([1.0, 1.0, 0.2], gain=0.5))
        if kind in ("damped", "crowded"):
            ours.append(DampingTask(0.1))
            theirs.append(pink_tasks.DampingTask(0.1))
        if kind in ("linear", "crowded"):
            A, b = rng.standard_normal((2, model.nv)), rng.standard_normal(2)
            ours.append(LinearTask(A, cost=0.4, target=b))
            at = pin.neutral(self.twin.pin)
            theirs.append(pink_tasks.LinearHolonomicTask(A[:, self.twin.order], b, at, cost=0.4))
        if kind in ("coupled", "crowded"):
            names = [joint.name for joint in model.joints[-3:]]
            ours.append(JointCouplingTask({names[0]: 1.0, names[2]: -0.5}, cost=2.0))
            joints = [names[0], names[2]], [1.0, -0.5]
            theirs.append(pink_tasks.JointCouplingTask(*joints, cost=2.0, configuration=self.configuration))
        if kind == "manipulability" and model.nq == model.nv:
            ours.append(ManipulabilityTask(tip, rate=0.05, cost=3.0))
            theirs.append(
                pink_tasks.ManipulabilityTask(
                    tip,
                    self.twin.pin,
                    cost=3.0,
                    manipulability_rate=0.05,
                    reference_frame=pin.ReferenceFrame.WORLD,
                )
            )
        ours.append(PostureTask(1e-2, gain=0.3))
        theirs.append(pink_tasks.PostureTask(1e-2, gain=0.3))
        for task in theirs:
            if hasattr(task, "set_target_from_configuration"):
                task.set_target_from_configuration(aim)
        self.theirs = theirs
        ours = [task if task.damping == 0.05 else replace(task, damping=0.0) for task in ours]
        self.ik = DifferentialIK(model, ours, [VelocityLimit(), PositionLimit(gain=0.5)], damping=DAMPING)
        self.targets = self.ik.targets_at(away)
        if "linear" in self.targets:
            self.targets["linear"] = b

    def pink(self, **options) -> Floats:
        """The velocity as pink has it, in Ulna's order."""
        model = self.twin.pin
        bounds = [pink_limits.ConfigurationLimit(model, 0.5), pink_limits.VelocityLimit(model)]
        v = pink.solve_ik(
            self.configuration,
            self.theirs,
            DT,
            solver="daqp",
            damping=DAMPING,
            limits=bounds,
            primal_tol=1e-12,
            **options,
        )
        return v[np.argsort(self.twin.order)]


QUICK = {("g1", "crowded"), ("g1", "relative"), ("talos", "com")}
SLOW = {("g1", kind) for kind in ("frame", "stiff", "com", "damped", "linear", "coupled")}
SLOW |= {
    ("talos", "relative"),
    ("talos", "crowded"),
}  # "crowded" has all the tasks; on another humanoid one by one, too
"""Of the humanoids, whose kernels take a second to compile. They have no task of manipulability."""

CASES = [
    pytest.param(name, kind, marks=[pytest.mark.slow] if (name, kind) in SLOW else [])
    for name in ROBOTS
    for kind in KINDS
    if name in ("ur5", "panda") or (name, kind) in QUICK | SLOW
]


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_same_velocity(name: str, kind: str) -> None:
    case = Case(name, kind)
    ours, theirs = case.ik.velocity(case.q, DT, **case.targets), case.pink()
    scale = max(1.0, float(np.abs(theirs).max()))
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-8 * scale)
    bounds = case.ik.problem(case.q, DT, **case.targets)
    assert ((ours > bounds.lower - 1e-12) & (ours < bounds.upper + 1e-12)).all()


def test_limits_take_part() -> None:
    """What is compared above is not only the unconstrained optimum."""
    for name in ("ur5", "panda"):
        case = Case(name, "crowded")
        v, bounds = case.ik.velocity(case.q, DT, **case.targets), case.ik.problem(case.q, DT, **case.targets)
        assert ((v == bounds.lower) | (v == bounds.upper)).any()


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_same_velocity_under_a_constraint(name: str) -> None:
    """A frame task met exactly, beside a posture."""
    case = Case(name, "frame")
    tip = ROBOTS[name][0]
    ours = DifferentialIK(
        case.twin.model,
        [PostureTask(1e-2, gain=0.3)],
        [],
        constraints=[FrameTask(tip, gain=0.1)],
        damping=DAMPING,
    )
    rigid = pink_tasks.FrameTask(tip, 1.0, 1.0, gain=0.1)
    rigid.set_target(case.theirs[0].transform_target_to_world)
    theirs = pink.solve_ik(
        case.configuration,
        case.theirs[1:],
        DT,
        "daqp",
        DAMPING,
        limits=[],
        constraints=[rigid],
        primal_tol=1e-12,
    )
    goals_of_tasks = {name: case.targets[name] for name in ours.inputs}
    v = ours.velocity(case.q, DT, **goals_of_tasks)
    np.testing.assert_allclose(v, theirs[np.argsort(case.twin.order)], atol=1e-7 * np.abs(v).max())
