"""The generator of random numbers that compiled code runs, and what is made of its numbers."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _whole_numbers(state: list[int], count: int) -> list[float]:
    """MRG32k3a [L'Ecuyer 1999] in whole numbers."""
    first, second, found = state[:3], state[3:], []
    for _ in range(count):
        first = [*first[1:], (1403580 * first[1] - 810728 * first[0]) % 4294967087]
        second = [*second[1:], (527612 * second[2] - 1370589 * second[0]) % 4294944443]
        gap = first[2] - second[2]
        found.append((gap if gap > 0 else gap + 4294967087) / 4294967088)
    return found


def _sliders(pin: Any, count: int) -> Any:
    model = pin.Model()
    for k in range(count):
        model.addJoint(k, pin.JointModelPX(), pin.SE3.Identity(), f"slider {k}")
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = 0.0, 1.0
    return model


def test_numbers_are_those_of_the_recursions(pin: Any) -> None:
    STATE = importlib.import_module("pinocchio._spatial.random_numbers").STATE

    model = _sliders(pin, 3)
    pin.seed(3)
    state = [int(x) for x in STATE]
    found = np.array([pin.randomConfiguration(model) for _ in range(2000)]).ravel()
    np.testing.assert_allclose(found, _whole_numbers(state, 6000), rtol=0, atol=1e-15)


def test_a_seed_repeats_all(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()

    def drawn() -> list[Any]:
        pin.seed(5)
        small = [kind.Random() for kind in (pin.SE3, pin.Motion, pin.Force, pin.Inertia)]
        return [str(x) for x in small] + [pin.randomConfiguration(model).tolist()]

    assert drawn() == drawn()
    pin.seed(6)
    assert str(pin.SE3.Random()) != drawn()[0]


def test_rotations_are_even_and_sizes_in_their_intervals(pin: Any) -> None:
    pin.seed(1)
    rotations = np.array([pin.SE3.Random().rotation for _ in range(4000)])
    assert np.abs(rotations.mean(axis=0)).max() < 0.05
    np.testing.assert_allclose((rotations**2).mean(axis=0), 1.0 / 3.0, atol=0.03)
    entries = np.array([pin.Motion.Random().vector for _ in range(4000)])
    assert entries.min() < -0.99 and entries.max() > 0.99 and np.abs(entries).max() <= 1.0
    np.testing.assert_allclose(np.cov(entries.T), np.eye(6) / 3.0, atol=0.03)


def test_own_limits_are_those_of_the_moment(pin: Any) -> None:
    model = _sliders(pin, 2)
    for k in range(20):
        model.lowerPositionLimit[1] = model.upperPositionLimit[1] = float(k)
        assert all(pin.randomConfiguration(model)[1] == k for _ in range(3))
    model.lowerPositionLimit[0] = 2.0
    for _ in range(3):
        with pytest.raises(ValueError, match="a lower limit is above the upper one"):
            pin.randomConfiguration(model)
    model.upperPositionLimit[0] = 3.0
    assert 2.0 <= pin.randomConfiguration(model)[0] <= 3.0


def test_the_same_configuration(pin: Any) -> None:
    model = pin.buildSampleModelHumanoid()
    q = pin.neutral(model)
    near = pin.integrate(model, q, np.full(model.nv, 1e-3))
    for _ in range(3):
        assert pin.isSameConfiguration(model, q, q, 0.0) is True
        assert (
            pin.isSameConfiguration(model, q, near, 1e-2) is False
        )  # of entries that are 0 no difference is small
        assert pin.isSameConfiguration(model, near, near * (1.0 + 1e-9), 1e-8) is True
        with pytest.raises(ValueError, match="`prec` is -1"):
            pin.isSameConfiguration(model, q, q, -1.0)
        assert pin.isSameConfiguration(model, q, np.full(model.nq, np.nan), 1e3) is False
        assert pin.isSameConfiguration(model, q, q, 1) is True
