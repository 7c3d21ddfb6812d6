"""Lists of a model, names of its bodies and functions of configurations, which are remembered, follow every change."""

from __future__ import annotations

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


LISTS = ("nqs", "nvs", "idx_qs", "idx_vs", "nvExtendeds", "idx_vExtendeds")


def _model(pin: Any) -> Any:
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.addJoint(1, pin.JointModelRX(), pin.SE3.Random(), "left")
    model.addJoint(1, pin.JointModelRUBY(), pin.SE3.Random(), "right")
    model.addBodyFrame("foot", 2, pin.SE3.Random(), 0)
    return model


def test_lists_of_a_model_follow_its_joints(pin: Any) -> None:
    model = _model(pin)
    for _ in range(2):
        assert list(model.nqs) == [0, 7, 1, 2] and list(model.nvs) == [0, 6, 1, 1]
        assert list(model.idx_qs) == [0, 0, 7, 8] and list(model.idx_vs) == [0, 0, 6, 7]
        assert [list(x) for x in model.supports] == [[0], [0, 1], [0, 1, 2], [0, 1, 3]]
        assert [list(x) for x in model.subtrees] == [[1, 2, 3], [1, 2, 3], [2], [3]]
        assert [list(x) for x in model.children] == [[1], [2, 3], [], []]
    for name in (*LISTS, "supports", "subtrees", "children"):
        with pytest.raises(AttributeError, match="computed when it is read"):
            getattr(model, name)[0] = 1
        with pytest.raises(AttributeError, match="computed when it is read"):
            getattr(model, name).append(1)
    copied = model.copy()
    model.addJoint(3, pin.JointModelSpherical(), pin.SE3.Random(), "end")
    assert list(model.nqs) == [0, 7, 1, 2, 4] and list(model.supports[4]) == [0, 1, 3, 4]
    assert list(model.children[3]) == [4] and list(model.subtrees[1]) == [1, 2, 3, 4]
    assert len(copied.nqs) == len(copied.supports) == 4
    model.joints[2].setIndexes(2, 20, 21)
    assert model.idx_qs[2] == 20 and model.idx_vs[2] == 21


def test_names_of_bodies_follow_the_frames(pin: Any) -> None:
    model = _model(pin)
    place = model.nframes - 1
    for _ in range(2):
        assert (
            model.existBodyName("foot")
            and not model.existBodyName("base")
            and model.getBodyId("foot") == place
        )
    model.frames[place].name = "toe"
    assert model.existBodyName("toe") and not model.existBodyName("foot") and model.getBodyId("toe") == place
    model.addFrame(pin.Frame("toe", 1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    assert model.getBodyId("toe") == place and model.existFrame("toe")
    model.frames[place].type = pin.FrameType.SENSOR
    assert not model.existBodyName("toe") and model.getBodyId("toe") == model.nframes
    for wrong in (3, None, b"toe", ["toe"]):
        for ask in (model.existBodyName, model.getBodyId, model.existFrame):
            with pytest.raises(TypeError, match="expected a text"):
                ask(wrong)


def test_lengths_are_judged_by_the_tolerance(pin: Any) -> None:
    model = _model(pin)
    q = pin.neutral(model)
    for _ in range(3):
        assert (
            pin.isNormalized(model, q)
            and pin.isNormalized(model, list(q))
            and pin.isNormalized(model, q, 1e-9)
        )
        far = q.copy()
        far[3:7] *= 1.001
        assert not pin.isNormalized(model, far) and pin.isNormalized(model, far, 0.01)
        assert not pin.isNormalized(model, far, 1e-3 - 1e-9) and pin.isNormalized(model, far, np.inf)
        assert not pin.isNormalized(model, q, 0) and not pin.isNormalized(
            model, np.full(model.nq, np.nan), 1.0
        )
        for wrong in (-1.0, np.nan):
            with pytest.raises(ValueError, match="expected 0 or more"):
                pin.isNormalized(model, q, wrong)
    arm = pin.Model()
    arm.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "a")
    assert [pin.isNormalized(arm, np.ones(1)) for _ in range(3)] == [True] * 3


def test_derivatives_of_configurations_are_one_or_both(pin: Any) -> None:
    model, rng = _model(pin), np.random.default_rng(7000)
    for _ in range(3):
        q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
        v = rng.normal(size=model.nv)
        k = pin.integrate(model, q, v)
        for function, x in ((pin.dIntegrate, v), (pin.dDifference, k)):
            by_first, by_second = function(model, q, x)
            np.testing.assert_array_equal(function(model, q, x, pin.ARG0), by_first)
            np.testing.assert_array_equal(function(model, q, list(x), pin.ARG1), by_second)
            with pytest.raises(TypeError):
                function(model, q, x, 0)
            with pytest.raises(TypeError):
                function(model, q, x, None)
        step = 1e-6 * np.eye(model.nv)
        moved = [pin.difference(model, k, pin.integrate(model, q, v + d)) / 1e-6 for d in step]
        np.testing.assert_allclose(np.stack(moved, 1), pin.dIntegrate(model, q, v, pin.ARG1), atol=1e-5)
        rates = [(pin.integrate(model, q, d) - q) / 1e-6 for d in step]
        np.testing.assert_allclose(np.stack(rates, 1), pin.tangentMap(model, q), atol=1e-5)
        np.testing.assert_array_equal(pin.interpolate(model, q, k, 1), pin.interpolate(model, q, k, 1.0))
        parts = pin.squaredDistance(model, q, k)
        assert parts.sum() == pytest.approx(v @ v) and parts.sum() == pytest.approx(
            pin.distance(model, q, k) ** 2
        )
