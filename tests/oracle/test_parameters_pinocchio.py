"""Kernels whose parameters are inputs against Pinocchio's models with the same numbers written into them."""

from __future__ import annotations

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import Twin, from_pinocchio, to_pinocchio  # noqa: E402
from support.random_models import KINDS, random_model  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna import kernels  # noqa: E402
from ulna.model import parameters, with_parameters  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.typing import Floats  # noqa: E402

TOLD = ("inertia", "placement", "gravity", "armature")


def close(actual: Floats, expected: Floats, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def written(twin: Twin, inertia: Floats, off: Floats, gravity: Floats, armature: Floats):
    """Pinocchio's model with the numbers written into it, by Pinocchio's own functions."""
    theirs = pin.Model(twin.pin)
    for joint, ten, x in zip(twin.model.joint_names, inertia.reshape(-1, 10), off, strict=True):
        i = theirs.getJointId(joint)
        theirs.inertias[i] = pin.Inertia.FromDynamicParameters(ten)
        theirs.jointPlacements[i] = theirs.jointPlacements[i] * pin.SE3(pin.exp3(x[3:]), x[:3])
    theirs.gravity.linear = gravity
    theirs.armature[:] = armature[twin.order]
    return theirs


@pytest.mark.parametrize("name", ["panda", "ur5", "solo12+", "talos_arm"])
def test_robots_with_other_inertias_and_placements(name: str) -> None:
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name.removesuffix("+"))[0])
    twin = from_pinocchio(pin.buildModelFromUrdf(urdf, *[pin.JointModelFreeFlyer()] * name.endswith("+")))
    model, rng = twin.model, np.random.default_rng(1)
    frame, theirs_frame = twin.frames[-1]
    run = {
        recipe: kernels.function(model, recipe, parameters=TOLD)
        for recipe in ("inverse_dynamics", "forward_dynamics", "mass_matrix", "center_of_mass_jacobian")
    }
    fk, jacobian = (
        kernels.function(model, recipe, frame=frame.name, parameters="placement")
        for recipe in ("fk", "jacobian")
    )
    for _ in range(2):
        ten = parameters(model, "inertia").reshape(-1, 10) * rng.uniform(0.5, 1.5, (len(model.joints), 1))
        off = rng.normal(0.0, 0.1, (len(model.joints), 6))
        given = [ten.reshape(-1), off, rng.normal(size=3), rng.uniform(0.0, 0.3, model.nv)]
        theirs = written(twin, *given)
        data = theirs.createData()
        q = alg.random(model, rng)
        v, a = rng.standard_normal((2, model.nv))
        pq, pv, pa = twin.q(q), twin.v(v), twin.v(a)
        close(run["inverse_dynamics"](q, v, a, *given), twin.columns(pin.rnea(theirs, data, pq, pv, pa)))
        close(run["forward_dynamics"](q, v, a, *given), twin.columns(pin.aba(theirs, data, pq, pv, pa)), 1e-9)
        M = pin.crba(theirs, data, pq)
        close(run["mass_matrix"](q, *given), twin.both(np.triu(M) + np.triu(M, 1).T))
        J = pin.jacobianCenterOfMass(theirs, data, pq)
        close(run["center_of_mass_jacobian"](q, *given), twin.columns(J))
        pin.framesForwardKinematics(theirs, data, pq)
        close(fk(q, off), data.oMf[theirs_frame].homogeneous)
        J = pin.computeFrameJacobian(theirs, data, pq, theirs_frame, pin.LOCAL_WORLD_ALIGNED)
        close(jacobian(q, off), twin.columns(J))


@pytest.mark.parametrize("root", [None, "free_flyer"])
def test_every_kind_of_joint_with_other_numbers(root: str | None) -> None:
    rng = np.random.default_rng(8)
    model = random_model(rng, list(KINDS), root=root, mimics=0)
    names = (*TOLD, "shift", "base", "tool")
    values = {name: parameters(model, name) for name in names}
    values["inertia"] *= np.repeat(rng.uniform(0.5, 1.5, len(model.joints)), 10)
    values["armature"] += 0.1
    for name in ("placement", "shift", "base", "tool"):
        values[name] += rng.normal(0.0, 0.2, values[name].shape)
    twin = to_pinocchio(with_parameters(model, values))
    data = twin.pin.createData()
    q = alg.random(model, rng)
    v, a = rng.standard_normal((2, model.nv))
    run = {name: kernels.function(model, name, parameters=names) for name in ("inverse_dynamics", "fk")}
    torques = pin.rnea(twin.pin, data, twin.q(q), twin.v(v), twin.v(a))
    close(run["inverse_dynamics"](q, v, a, *values.values()), twin.columns(torques))
    pin.framesForwardKinematics(twin.pin, data, twin.q(q))
    tool = next(k for frame, k in twin.frames if frame.name == model.tool)
    close(run["fk"](q, *values.values()), data.oMf[tool].homogeneous)
