"""Robots with branches: quantities of the whole robot have the joints in the order that scripts have them in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import ModelError

pytest.importorskip("spatialmath")


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        import roboticstoolbox

        yield roboticstoolbox


@pytest.mark.parametrize("name", ["px100", "wx250s"])
def test_fingers_beside_a_turning_wheel(rtb: Any, name: str) -> None:
    robot = getattr(rtb.models.URDF, name)()
    q = np.linspace(0.01, 0.03, robot.n)
    poses = np.array([T.A for T in robot.fkine_all(q)])[1:]
    alone = np.array([robot.fkine(q, end=link).A for link in robot.links])
    assert np.abs(poses - alone).max() < 1e-12
    torque = robot.rne(q, 0 * q, 0 * q)
    wheel = robot.structure.rindex("R")
    assert abs(torque[wheel]) < 1e-6 < abs(torque[2])  # about an axis through nearly its own centre of mass


def test_joints_numbered_across_branches_are_refused_where_all_of_them_count(rtb: Any) -> None:
    stem = rtb.Link(rtb.ET.Rz(), name="stem", jindex=0)
    left = rtb.Link(rtb.ET.tx(1) * rtb.ET.Rz(), name="left", parent=stem, jindex=1)
    right = rtb.Link(rtb.ET.ty(1) * rtb.ET.Rz(), name="right", parent=stem, jindex=2)
    tip = rtb.Link(rtb.ET.tx(1) * rtb.ET.Rz(), name="tip", parent=left, jindex=3)
    robot = rtb.Robot([stem, left, right, tip], name="fork")
    assert np.allclose(robot.fkine([0, 0, 0, 0], end="tip").t, [2, 0, 0])
    with pytest.raises(ModelError, match="branch by branch"):
        robot.fkine_all([0, 0, 0, 0])
