"""Asks an installed pinocchio, or Ulna's package, about a model whose numbers change at random before every call."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

ROUNDS = 8


def model_of_many_kinds() -> Any:
    model = pin.Model()
    kinds = (
        pin.JointModelFreeFlyer(),
        pin.JointModelRevoluteUnaligned(np.array([0.6, 0.0, 0.8])),
        pin.JointModelPZ(),
        pin.JointModelSpherical(),
        pin.JointModelRY(),
    )
    joint = 0
    for k, kind in enumerate(kinds):
        place = pin.SE3(pin.utils.rotate("x", 0.5 * k) if k else np.eye(3), np.array([0.1, 0.0, 0.2 * k]))
        joint = model.addJoint(0 if k == 0 else max(joint - k // 4, 1), kind, place, f"j{k}")
        model.appendBodyToJoint(joint, pin.Inertia.FromBox(1.0 + k, 0.2, 0.3, 0.4), pin.SE3.Identity())
        model.addJointFrame(joint)
    model.addFrame(pin.Frame("tip", joint, 0, pin.SE3(np.eye(3), np.ones(3)), pin.FrameType.OP_FRAME))
    return model


def change(model: Any, what: str, rng: np.random.Generator) -> None:
    joint = int(rng.integers(1, model.njoints))
    if what == "mass":
        model.inertias[joint].mass = rng.uniform(0.5, 4.0)
    elif what == "inertia":
        size = rng.uniform(0.1, 0.5, 3)
        model.inertias[joint] = pin.Inertia.FromBox(rng.uniform(1.0, 3.0), *size)
        model.inertias[joint].lever = rng.normal(size=3)
    elif what == "place":
        model.jointPlacements[joint] = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    elif what == "gravity":
        model.gravity.linear = rng.normal(size=3)
    elif what == "armature":
        model.armature = rng.uniform(0.0, 2.0, model.nv)
    else:
        model.frames[model.nframes - 1].placement = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))


def answers(model: Any, data: Any, q: Any, v: Any, a: Any) -> dict[str, Any]:
    tip, joints = model.nframes - 1, range(1, model.njoints)
    found = {"rnea": pin.rnea(model, data, q, v, a).copy(), "f": np.array([data.f[k].vector for k in joints])}
    found |= {"crba": np.triu(pin.crba(model, data, q)), "aba": pin.aba(model, data, q, v, a).copy()}
    found |= {"nle": pin.nle(model, data, q, v).copy()}
    found |= {"g": pin.computeGeneralizedGravity(model, data, q).copy()}
    found |= {"Minv": np.triu(pin.computeMinverse(model, data, q))}
    found["by q"], found["by v"], _ = (x.copy() for x in pin.computeRNEADerivatives(model, data, q, v, a))
    slopes = pin.computeABADerivatives(model, data, q, v, a)
    found["ddq by q"], found["ddq by v"], found["ddq by tau"] = (x.copy() for x in slopes)
    pin.forwardKinematics(model, data, q, v, a)
    found |= {
        "oMi": np.array([data.oMi[k].homogeneous for k in joints]),
        "a": np.array([data.a[k].vector for k in joints]),
    }
    found |= {"liMi": np.array([data.liMi[k].homogeneous for k in joints])}
    pin.framesForwardKinematics(model, data, q)
    found |= {"oMf": np.array([M.homogeneous for M in data.oMf])}
    found |= {"J": pin.computeJointJacobians(model, data, q).copy()}
    found |= {"J tip": pin.getFrameJacobian(model, data, tip, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)}
    found |= {"J at": pin.computeFrameJacobian(model, data, q, tip, pin.ReferenceFrame.LOCAL)}
    found |= {"com": pin.centerOfMass(model, data, q, v, a).copy(), "com of a subtree": data.com[3].copy()}
    found |= {"mass": data.mass[0], "Ag": pin.ccrba(model, data, q, v).copy(), "hg": data.hg.vector.copy()}
    found |= {"regressor": pin.computeJointTorqueRegressor(model, data, q, v, a).copy()}
    forces = [pin.Force(np.arange(6.0) + k) for k in range(model.njoints)]
    found |= {"under forces": pin.rnea(model, data, q, v, a, forces).copy()}
    pin.computeAllTerms(model, data, q, v)
    found |= {"all M": np.triu(data.M), "all nle": data.nle.copy(), "Jcom": data.Jcom.copy()}
    return found | {"potential energy": data.potential_energy}


def asked() -> list[dict[str, Any]]:
    rng = np.random.default_rng(11)
    model = model_of_many_kinds()
    data = model.createData()
    state = rng.normal(size=(3, model.nv))
    q = pin.integrate(model, pin.neutral(model), state[0])
    results = []
    for what in ("mass", "inertia", "place", "gravity", "armature"):  # of which Ulna's package makes inputs
        change(model, what, rng)
        pin.rnea(model, data, q, *state[1:])
    for _ in range(ROUNDS):
        for what in ("mass", "inertia", "place", "gravity", "armature", "frame"):
            change(model, what, rng)
        results.append({k: np.asarray(x).tolist() for k, x in answers(model, data, q, *state[1:]).items()})
    return results


if __name__ == "__main__":
    found = {"file": pin.__file__, "answers": asked()}
    Path(sys.argv[1]).write_text(json.dumps(found), encoding="utf-8")
