"""Angles and coordinates of poses are finite numbers: what is none is refused by its name, not kept or taken for a symbol."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ulna import SE3, SO3
from ulna.errors import InputError

MAKERS: dict[str, Callable[[Any], Any]] = {
    "angle: rx": SE3.rx,
    "angle: ry": SE3.ry,
    "angle: rz": SO3.rz,
    "yaw: pointing_down": lambda yaw: SE3.pointing_down((0.0, 0.0, 0.0), yaw),
    "x: trans": lambda x: SE3.trans(x, 0.0, 0.0),
    "y: trans": lambda y: SE3.trans(0.0, y, 0.0),
    "z: trans": lambda z: SE3.trans(0.0, 0.0, z),
    "x: three": lambda x: SE3(x, 0.0, 1.0),
    "y: three": lambda y: SE3(0.0, y if y is not None else "None", 1.0),
}


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize(
    "wrong",
    [None, "0.3", b"x", 1j, {}, np.nan, np.inf, np.array(1 + 2j), [0.1, None], 10**400],
    ids=lambda x: str(x)[:12],
)
def test_what_is_no_finite_number_is_refused(name: str, wrong: Any) -> None:
    with pytest.raises(InputError, match=f"`{name.split(':', maxsplit=1)[0]}`"):
        MAKERS[name](wrong)


def test_batches_stay_and_a_choice_is_a_truth_value() -> None:
    np.testing.assert_array_equal(SE3.trans([1, 2], 0, 3).translation, [[1, 0, 3], [2, 0, 3]])
    np.testing.assert_array_equal(SE3.rz([0.0, np.pi]).matrix()[:, 0, 0], [1.0, -1.0])
    with pytest.raises(InputError, match="`check` is"):
        SE3.from_matrix(np.eye(4), "no")  # type: ignore[arg-type]
