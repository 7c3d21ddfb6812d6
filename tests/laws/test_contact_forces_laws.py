"""Laws of the forces of contacts whose motion is given."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.algorithms.constraints.contact_forces import contact_forces


def test_forces_of_contacts_that_stick_slide_and_part() -> None:
    c = np.array([0.01, 0.0, -1.0, 3.0, 0.0, -1.0, 0.5, 0.5, 2.0])
    R = np.full(9, 0.1)
    found = contact_forces(c, [0.5] * 3, R, np.zeros(9), 1e-9, (1e-12, 0.0), 500)
    np.testing.assert_allclose(found.forces[:3], [-0.1, 0.0, 10.0], atol=1e-7)
    np.testing.assert_allclose(found.forces[6:], 0.0, atol=1e-12)
    f, y = found.forces[3:6], c[3:6] + R[3:6] * found.forces[3:6]
    assert np.hypot(*f[:2]) == pytest.approx(0.5 * f[2]) and abs(y[2]) < 1e-6 and y[0] > 0.0 > f[0]
    assert found.residual <= 1e-12
