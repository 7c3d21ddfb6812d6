"""What algorithms under constraints leave of their way to the results: asked of whichever pinocchio is imported, by a test."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

warnings.simplefilter("ignore")
AT, TIP = pin.exp6(np.arange(6.0) / 14.0), pin.exp6(np.arange(6.0) / 10.0)


def robot() -> Any:
    """A floating body with two arms."""
    model = pin.Model()
    heavy = pin.Inertia(2.0, np.array([0.1, 0.2, 0.3]), np.diag([0.3, 0.4, 0.5]))
    kinds = ("FreeFlyer", 0), ("RX", 1), ("RY", 2), ("RZ", 3), ("Spherical", 1), ("RZ", 5)
    for kind, parent in kinds:
        made = getattr(pin, f"JointModel{kind}")()
        model.appendBodyToJoint(model.addJoint(parent, made, AT, f"j{model.njoints}"), heavy, AT)
    model.armature = np.linspace(0.01, 0.02, model.nv)
    return model


def contacts(model: Any, size: int, frame: Any, loop: bool) -> tuple[Any, Any, Any]:
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    kind = pin.ContactType.CONTACT_3D if size == 3 else pin.ContactType.CONTACT_6D
    for joint in (4, 6) if size == 3 else (4,):
        second = (2, AT) if loop else (0, pin.SE3.Identity())
        models.append(pin.RigidConstraintModel(kind, model, joint, TIP, *second, frame))
        datas.append(models[-1].createData())
    data = model.createData()
    pin.initConstraintDynamics(model, data, models, datas)
    return data, models, datas


def read(data: Any, *names: str) -> dict[str, list[float]]:
    entries = {name: getattr(data, name) for name in names}
    return {
        name: np.ravel(
            value if isinstance(value, np.ndarray) else [getattr(x, "vector", x) for x in value]
        ).tolist()
        for name, value in entries.items()
    }


def refused_without_values(model: Any) -> list[float]:
    """1 for each call whose last argument, None, is refused."""
    data, *bound = contacts(model, 3, pin.LOCAL, False)
    q, v, J = pin.neutral(model), np.zeros(model.nv), np.eye(2, model.nv)
    impact, motion = (model, data, q, v), (model, data, q, v, v)
    pin.constraintDynamics(*motion, *bound)
    calls = (
        (pin.impulseDynamics, *impact, *bound, None),
        (pin.impulseDynamics, *impact, *bound, 0.3, None),
        (pin.impulseDynamics, *impact, J, None),
        (pin.impulseDynamics, *impact, J, 0.3, None),
        (pin.computeImpulseDynamicsDerivatives, model, data, *bound, None),
        (pin.constraintDynamics, *motion, *bound, None),
        (pin.computeConstraintDynamicsDerivatives, model, data, *bound, None),
        (pin.lcaba, *motion, *bound, None),
    )
    found = []
    for function, *args in calls:
        try:
            function(*args)
            found.append(0.0)
        except TypeError:
            found.append(1.0)
    return found


def answers(model: Any, size: int, frame: Any, loop: bool) -> Iterator[tuple[str, Any]]:
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.6, model.nv))
    v, tau = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.0, 1.0, model.nv)
    for mu in (0.0, 0.1):
        data, *bound = contacts(model, size, frame, loop)
        pin.computeDelassusMatrix(model, data, q, *bound, mu)
        yield f"Delassus {mu}", read(data, "oL", "oK")
    data, *bound = contacts(model, size, frame, loop)
    pin.computeDampedDelassusMatrixInverse(model, data, q, *bound, 0.1)
    yield "damped", read(data, "oL", "oK")
    settings = pin.ProximalSettings(1e-14, 1e-14, 0.01, 40)
    data, *bound = contacts(model, size, frame, loop)
    pin.constraintDynamics(model, data, q, v, tau, *bound, settings)
    data.lambda_c[:] = 0.0  # what is read below is of the call
    yield (
        "solution",
        read(data, "lambda_c_prox", "primal_dual_contact_solution", "primal_rhs_contact", "dFda", "of"),
    )
    local = frame == pin.LOCAL  # else Pinocchio's derivatives are not those of what it computes
    along = ("dac_dq", "dac_dv", "dvc_dq", "dtau_dq", "dtau_dv") if local else ("dtau_dv",)
    for part in (0.5, 1.0):  # evaluated on numbers, then compiled
        pin.constraintDynamics(model, data, q, part * v, tau, *bound, settings)
        pin.computeConstraintDynamicsDerivatives(model, data, *bound, settings)
        yield f"derivatives {part}", read(data, "of", "dFdq", "dFdv", *along)
    pin.computeConstraintDynamicsDerivatives(model, data, *bound, settings)
    pin.constraintDynamics(model, data, q, 0.1 * v, tau, *bound, settings)
    yield "derivatives kept", read(data, "dFdq", "dFdv", *along)
    if loop:
        return
    pin.impulseDynamics(model, data, q, v, *bound, 0.3, settings)
    yield "impulse", read(data, "lambda_c_prox", "primal_dual_contact_solution", "dFda")
    exact = pin.ProximalSettings(1e-14, 1e-14, 0.0, 1)
    for part in (0.5, 1.0):  # each with a new Data: there, derivatives are added to what an earlier call left
        data, *bound = contacts(model, size, frame, loop)
        pin.impulseDynamics(model, data, q, part * v, *bound, 0.3, exact)
        pin.computeImpulseDynamicsDerivatives(model, data, *bound, 0.3, exact)
        yield f"of an impulse {part}", read(data, "of", "oa", "dAdq", "dFdq", "dtau_dq")
    data, *bound = contacts(model, size, frame, loop)
    pin.computeJointMinimalOrdering(model, data, bound[0])
    pin.lcaba(model, data, q, v, tau, *bound, pin.ProximalSettings(1e-12, 0.01, 1))
    yield "lcaba", read(data, "oYaba_augmented", "of_augmented")


if __name__ == "__main__":
    cases = ((3, pin.LOCAL, False), (6, pin.LOCAL_WORLD_ALIGNED, False), (3, pin.LOCAL, True))
    cases += ((6, pin.LOCAL, True), (3, pin.LOCAL_WORLD_ALIGNED, True))
    found = [dict(answers(robot(), *case)) for case in cases]
    found.append({"None": {"refused": refused_without_values(robot())}})
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": found}))
