"""Functions of Lie groups have the same results before they are compiled and after."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

GROUPS: dict[str, Callable[[Any], Any]] = {
    "R3": lambda groups: groups.R3(),
    "SO2": lambda groups: groups.SO2(),
    "SO3": lambda groups: groups.SO3(),
    "SE2": lambda groups: groups.SE2(),
    "SE3": lambda groups: groups.SE3(),
    "SE3 x R2 x SO2": lambda groups: groups.SE3() * groups.R2() * groups.SO2(),
}
FUNCTIONS: dict[str, Callable[[Any, Any, Any, Any, Any], Any]] = {
    "interpolate": lambda pin, G, q, r, v: G.interpolate(q, r, 0.3),
    "interpolate, whole": lambda pin, G, q, r, v: G.interpolate(q, r, 1),
    "dIntegrate, ARG0": lambda pin, G, q, r, v: G.dIntegrate(q, v, pin.ARG0),
    "dIntegrate_dv": lambda pin, G, q, r, v: G.dIntegrate_dv(q, v),
    "dDifference, ARG0": lambda pin, G, q, r, v: G.dDifference(q, r, pin.ARG0),
    "dDifference, ARG1": lambda pin, G, q, r, v: G.dDifference(q, r, pin.ARG1),
    "tangentMap": lambda pin, G, q, r, v: G.tangentMap(q),
    "tangentMapProduct": lambda pin, G, q, r, v: G.tangentMapProduct(q, np.ones((G.nv, 2))),
}


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture(params=GROUPS)
def group(pin: Any, request: pytest.FixtureRequest) -> Any:
    return GROUPS[request.param](pin.liegroups)


def _state(group: Any) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(7103)
    v, w = rng.normal(size=(2, group.nv))
    q = group.integrate(group.neutral, v)
    return q, group.integrate(q, 0.5 * w), w


@pytest.mark.parametrize("name", FUNCTIONS)
def test_compiled_functions_have_the_results_of_those_that_are_not(
    pin: Any, group: Any, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pinocchio._model import lie_group

    state, function = _state(group), FUNCTIONS[name]
    monkeypatch.setattr(lie_group, "_calls", {})
    monkeypatch.setattr(lie_group, "_asked", {})
    fresh = pin.liegroups.LieGroup(group._blocks)
    first = function(pin, fresh, *state)
    assert not lie_group._calls
    for _ in range(15):
        last = function(pin, fresh, *state)
    assert lie_group._calls
    np.testing.assert_allclose(last, first, rtol=1e-12, atol=1e-13)
    strided = [np.repeat(x, 2)[::2] for x in state]
    np.testing.assert_array_equal(function(pin, fresh, *strided), last)
    last[...] = 0.0  # of the caller's own array
    np.testing.assert_allclose(function(pin, fresh, *state), first, rtol=1e-12, atol=1e-13)
    with pytest.raises(InputError):
        function(pin, fresh, state[0][:-1], *state[1:])


def test_points_are_scaled_in_place(pin: Any, group: Any) -> None:
    q, *_ = _state(group)
    for _ in range(15):
        scaled = 1.5 * q
        assert group.normalize(scaled) is None
        wanted = group.integrate(q, np.zeros(group.nv))
        units = scaled if group == pin.liegroups.R3() else wanted
        np.testing.assert_allclose(scaled[-1], units[-1], atol=1e-12)
    fixed = q.copy()
    fixed.flags.writeable = False
    for wrong in (fixed, q.tolist()):
        with pytest.raises(InputError):
            group.normalize(wrong)


def test_derivatives_are_those_of_the_functions(pin: Any, group: Any) -> None:
    q, r, v = _state(group)
    step = 1e-6
    for _ in range(15):
        by_v, by_r = group.dIntegrate(q, v, pin.ARG1), group.dDifference(q, r, pin.ARG1)
    for k, unit in enumerate(np.eye(group.nv)):
        moved = group.difference(group.integrate(q, v), group.integrate(q, v + step * unit)) / step
        np.testing.assert_allclose(by_v[:, k], moved, atol=1e-5)
        turned = group.integrate(r, step * unit)
        np.testing.assert_allclose(
            by_r[:, k], (group.difference(q, turned) - group.difference(q, r)) / step, atol=1e-5
        )
    for wrong in (0, pin.ARG2, None):
        with pytest.raises(TypeError):
            group.dIntegrate(q, v, wrong)


def test_products_know_their_sizes(pin: Any) -> None:
    groups = pin.liegroups
    product = groups.SE3() * groups.Rn(4)
    assert (product.nq, product.nv, product.name) == (11, 10, "SE(3) x R^4")
    assert product == groups.SE3() * groups.Rn(4)
    assert (groups.LieGroup().nq, groups.LieGroup().nv) == (0, 0)
    model = pin.buildSampleModelHumanoid()
    whole = pin.lieGroup(model)
    assert (whole.nq, whole.nv) == (model.nq, model.nv)
    q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    np.testing.assert_allclose(
        whole.integrate(q, np.ones(model.nv)), pin.integrate(model, q, np.ones(model.nv))
    )
