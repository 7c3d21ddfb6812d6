"""Data of joints, and terms of articulated bodies, while states and the model change: asked of whichever pinocchio is imported."""

from __future__ import annotations

import json
import sys
import warnings
from typing import Any

import numpy as np
import pinocchio as pin

warnings.simplefilter("ignore")


def terms(data: Any, joints: list[Any]) -> list[Any]:
    """What the articulated-body algorithm left."""
    return [*(x for j in joints for x in (j.U, j.Dinv, j.UDinv)), *data.Yaba[1:]]


def answers(calls: int) -> list[list[float]]:
    """What objects that were taken before the first algorithm show after each call, and after changes of the model."""
    model, rng = pin.buildSampleModelHumanoid(), np.random.default_rng(1)
    data = model.createData()
    joints, found = [data.joints[i] for i in (1, 2, 7)], []
    for k in range(calls):
        q = pin.integrate(model, pin.neutral(model), rng.standard_normal(model.nv))
        v = rng.standard_normal(model.nv)
        if k % 3 == 0:
            pin.forwardKinematics(model, data, q, v)
        else:
            pin.aba(model, data, q, v, v)
        read = [x for j in joints for x in (j.M.homogeneous, j.v.vector, j.S, j.joint_q, j.joint_v)]
        if k % 3 == 1:
            read += terms(data, joints)
        if k % 3 != 0:
            added = pin.Inertia(1.0 + k, np.array([0.1, 0.2, 0.3]), np.eye(3))
            model.inertias[3] = model.inertias[3] + added
            model.armature = rng.random(model.nv)
            model.jointPlacements[4] = pin.exp6(rng.standard_normal(6) / 5.0)
            read += terms(data, joints)
        found.append(np.concatenate([np.ravel(x) for x in read]).tolist())
    return found


if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": answers(int(sys.argv[2]))}))
