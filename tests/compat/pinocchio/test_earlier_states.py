"""Of which earlier call the results are that are asked for without a configuration, and the force on the base."""

from __future__ import annotations

import json

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import printed

_BEGIN = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
q, v, world = np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6), pin.Convention.WORLD
forces = pin.StdVec_Force()
for k in range(7):
    forces.append(pin.Force(np.arange(6.0) + k))
found = []
"""
_EARLIER = f"""{_BEGIN}
firsts = ("pin.aba(model, data, q, v, v, world)", "pin.aba(model, data, q, v, v, forces, world)",
          "pin.computeABADerivatives(model, data, q, v, v)", "pin.computeABADerivatives(model, data, q, v, v, forces)",
          "pin.computeMinverse(model, data, q)")
seconds = ("None", "pin.forwardKinematics(model, data, 2.0 * q)", "pin.crba(model, data, 2.0 * q)",
           "pin.rnea(model, data, 2.0 * q, v, v)", "pin.aba(model, data, 2.0 * q, v, v, world)",
           "pin.computeABADerivatives(model, data, 2.0 * q, v, v)", "pin.computeMinverse(model, data, 2.0 * q)")
for first in firsts:
    for second in seconds:
        for turn in range(ROUNDS):
            data = model.createData()
            exec(first)
            exec(second)
            found.append(pin.computeMinverse(model, data).tolist())
            if "Minverse" not in first + second:
                found += [x.tolist() for x in pin.computeABADerivatives(model, data)]
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 13])
def test_results_without_a_configuration_are_of_the_last_forward_dynamics(rounds: int) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_EARLIER.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == (5 * 7 + 3 * 4 * 6) * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_BASE = f"""{_BEGIN}
for model in (model, pin.buildSampleModelHumanoid()):
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    v = np.linspace(-1.0, 1.0, model.nv)
    model.armature = np.linspace(0.0, 0.5, model.nv)
    for turn in range(ROUNDS):
        data = model.createData()
        for call in ("pin.computeAllTerms(model, data, q, v)", "pin.rnea(model, data, q, v, v)",
                     "pin.computeCentroidalMomentum(model, data, q, v)", "pin.aba(model, data, q, v, v)",
                     "pin.nle(model, data, q, v)"):
            exec(call)
            found += [data.f[0].vector.tolist(), data.h[0].vector.tolist()]
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 13])
def test_the_force_on_the_base_and_the_whole_momentum_stay_where_they_are_not_computed(rounds: int) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_BASE.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 20 * rounds
    assert np.abs(wanted[6]).max() > 1.0  # after aba
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("rounds", [1, 13])
def test_the_force_on_the_base_under_forces_is_that_of_its_joints(rounds: int) -> None:
    with using("pinocchio"):
        import pinocchio as pin

        model = pin.buildSampleModelHumanoid()
        data, q = model.createData(), pin.neutral(model)
        v, forces = (
            np.linspace(-1.0, 1.0, model.nv),
            [pin.Force(np.arange(6.0) + k) for k in range(model.njoints)],
        )
        for _ in range(rounds):
            pin.aba(model, data, q, v, v, forces)
            wanted = data.liMi[1].act(data.f[1]).vector
            np.testing.assert_allclose(data.f[0].vector, wanted, rtol=1e-9, atol=1e-8)
            np.testing.assert_allclose(data.of[0].vector, wanted, rtol=1e-9, atol=1e-8)
