"""What programs write into results of a Data is what later calls read, at the first calls of a model and at later ones."""

from __future__ import annotations

import json

import numpy as np
import pytest

from support.two_pythons import printed

_JACOBIANS = """
import json, numpy as np, pinocchio as pin
found = []
for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    placement = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))

    def read():
        for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            for joint in (0, 1, 3, model.njoints - 1):
                found.append(pin.getJointJacobian(model, data, joint, reference).tolist())
                found.append(pin.getFrameJacobian(model, data, joint, placement, reference).tolist())
            found.append(pin.getFrameJacobian(model, data, model.nframes - 1, reference).tolist())
        found.append(data.oMf[model.nframes - 1].homogeneous.tolist())

    for turn in range(ROUNDS):
        pin.computeJointJacobians(model, data, q)
        read()
        data.oMi[3] = placement
        data.oMi[model.njoints - 1].translation = np.ones(3)
        read()
        data.J[:] = 2.0 * data.J
        read()
        data.J = np.arange(6.0 * model.nv).reshape(6, model.nv)
        read()
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 4])
def test_jacobians_are_of_the_columns_and_placements_that_are_there(rounds: int) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_JACOBIANS.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 2 * 4 * 28 * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_FACTORS = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
data, q, v = model.createData(), np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6)
found = [data.U.tolist(), data.D.tolist()]
for change in ("data.M *= 2.0", "pin.crba(model, data, 2.0 * q)", "data.D = v", "data.D[0] = 9.0", "data.M = np.eye(6)",
               "pin.forwardDynamics(model, data, q, v, v, np.eye(3, 6), np.zeros(3), 0.0)", "data.D[1] = 3.0"):
    pin.crba(model, data, q)
    found.append(pin.cholesky.decompose(model, data).tolist())
    exec(change)
    found += [data.U.tolist(), data.D.tolist(), pin.cholesky.solve(model, data, v).tolist()]
print(json.dumps(found))
"""


def test_factors_of_the_mass_matrix_are_those_of_the_last_decomposition() -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_FACTORS))
    assert len(own) == len(wanted) == 30
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)
