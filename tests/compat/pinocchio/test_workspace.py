"""Fields that hold a part of the way to results under constraints are Pinocchio's, or say what to read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both
from ulna.errors import InputError


def test_fields_on_the_way_to_results_are_as_there(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = both(Path(__file__).with_name("asked_workspace.py"), tmp_path)
    assert [len(answers) for answers in wanted] == [11, 11, 7, 7, 7, 1]
    assert wanted[-1]["None"]["refused"] == [1.0] * 8
    for mine, theirs in zip(own, wanted, strict=True):
        for call, fields in theirs.items():
            for name, values in fields.items():
                scale = max(1.0, np.abs(values).max())
                np.testing.assert_allclose(
                    mine[call][name], values, rtol=0, atol=1e-9 * scale, err_msg=f"{call}: {name}"
                )


def test_fields_without_a_meaning_here_name_the_call() -> None:
    with using("pinocchio"):
        import pinocchio as pin

        model = pin.buildSampleModelManipulator()
        data, q, v = model.createData(), np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6)
        loop = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 5, 2, pin.LOCAL)
        bound = [loop], [loop.createData()]
        settings = pin.ProximalSettings(1e-12, 0.1, 5)
        pin.initConstraintDynamics(model, data, *bound)
        pin.lcaba(model, data, q, v, v, *bound, settings)
        with pytest.raises(InputError, match="lcaba"):
            _ = data.oYaba_augmented
        pin.computeConstraintDynamicsDerivatives(model, data, *bound, settings)
        held = data.copy()
        for name in ("dac_dq", "dvc_dq", "dFdq", "dtau_dv"):
            np.testing.assert_array_equal(getattr(held, name), getattr(data, name))
        along_world = [
            pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 5, pin.LOCAL_WORLD_ALIGNED)
        ]
        fixed = along_world, [along_world[0].createData()]
        pin.constraintDynamics(model, data, q, v, v, *fixed, settings)
        pin.computeConstraintDynamicsDerivatives(model, data, *fixed, settings)
        assert data.dvc_dq.shape == (6, 6) and data.dvc_dq.any()
        pin.constraintDynamics(model, data, q, v, v, *bound, settings)
        pin.impulseDynamics(model, data, q, v, *bound)
        with pytest.raises(InputError, match="An impact has none"):
            _ = data.primal_rhs_contact
