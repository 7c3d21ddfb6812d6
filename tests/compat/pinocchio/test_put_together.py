"""Reduced and appended models are Pinocchio's to the last frame: order, parents, placements, inertias, postures, solids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both, printed
from ulna.robots.example_robot_data import share_folder

FILES = (
    "ur_description/urdf/ur5_robot.urdf",
    "solo_description/robots/solo12.urdf",
    "double_pendulum_description/urdf/double_pendulum.urdf",
)


def test_reduced_and_appended_models_are_the_same(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    own, wanted = both(
        Path(__file__).parent / "asked_put_together.py",
        tmp_path,
        *(str(share / "robots" / file) for file in FILES),
    )
    assert own.keys() == wanted.keys()
    wrong = [
        (model, part)
        for model in wanted
        for part in wanted[model]
        if not _same(own[model][part], wanted[model][part])
    ]
    assert not wrong


def _same(own: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return len(own) == len(wanted) and all(_same(a, b) for a, b in zip(own, wanted, strict=True))
    return own == wanted if isinstance(wanted, str) else bool(np.isclose(own, wanted, rtol=1e-9, atol=1e-12))


APPENDED = """
import numpy as np, pinocchio as pin
a, b = pin.buildSampleModelManipulator(), pin.Model()
one = b.addJoint(0, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0.0, 0.1, 0.2])), "one")
two = b.addJoint(one, pin.JointModelPX(), pin.SE3(np.eye(3), np.array([0.3, 0.0, 0.2])), "two")
beside = b.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "beside")
for joint, name in ((0, "table"), (one, "one body"), (two, "two body"), (beside, "beside body")):
    b.appendBodyToJoint(joint, pin.Inertia(1.5, np.array([0.1, 0.0, 0.2]), np.eye(3)), pin.SE3.Identity())
    b.addFrame(pin.Frame(name, joint, 0, pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])), pin.FrameType.BODY))
b.upperPositionLimit[:] = np.arange(9.0)
b.damping = np.arange(8.0) + 1.0
b.referenceConfigurations["half"] = pin.neutral(b) + 0.5
def shown(x):
    return (np.round(x, 7) + 0.0).tolist()
def show(m):
    print(m.nq, m.nv, m.nbodies, m.nvExtended, list(m.names), list(m.parents), list(m.idx_qs), list(m.idx_vs), m.gravity)
    for M, I in zip(m.jointPlacements, m.inertias):
        print(shown(M.homogeneous), shown(I.matrix()))
    for f in m.frames:
        print(f.name, f.type, f.parentJoint, f.parentFrame, shown(f.placement.homogeneous), shown(f.inertia.matrix()))
    print(m.upperPositionLimit, m.damping, m.lowerPositionLimit)
    for entry in m.referenceConfigurations:
        print(entry.key(), entry.data())
    d = m.createData()
    q, v = pin.neutral(m) + 0.0, np.linspace(-1, 1, m.nv)
    print(shown(pin.rnea(m, d, q, v, v)), shown(pin.crba(m, d, q)))
M = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))
for at in (a.nframes - 1, 4, 0):
    show(pin.appendModel(a, b, at, M))
    a.jointPlacements[2].translation[0] += 0.25  # the same joints, with other numbers
    b.inertias[1].mass += 1.0
    show(pin.appendModel(a, b, at, M))
"""


def test_models_are_appended_as_there_whatever_their_numbers() -> None:
    pytest.importorskip("pinocchio")
    own, theirs = printed(APPENDED)
    assert len(own.splitlines()) > 200 and own.splitlines() == theirs.splitlines()


def test_appended_frames_of_a_name_that_is_taken_are_left_out() -> None:
    with using("pinocchio"):
        import pinocchio as pin

        a, b = pin.buildSampleModelManipulator(), pin.Model()
        name = a.frames[a.nframes - 1].name
        b.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "one")
        b.armature = np.array([2.0])
        assert pin.appendModel(a, b, 1, pin.SE3.Identity()).armature.sum() == 2.0  # Pinocchio forgets them
        b.addFrame(pin.Frame(name, 0, 0, pin.SE3.Random(), a.frames[a.nframes - 1].type))
        for _ in range(2):
            with pytest.warns(Warning, match="already, which is another one"):
                assert pin.appendModel(a, b, 1, pin.SE3.Identity()).nframes == a.nframes
        with pytest.raises(Exception, match="There is a joint named 'shoulder1_joint' already"):
            pin.appendModel(a, a, 1, pin.SE3.Identity())
