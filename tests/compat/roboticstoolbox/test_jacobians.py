"""Jacobians of Ulna's package are plain arrays to whoever looks, but their pseudoinverse comes from a kernel, good or not at all."""

from __future__ import annotations

import copy
import importlib
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def panda() -> Iterator[Any]:
    with using("roboticstoolbox"):
        yield importlib.import_module("roboticstoolbox").models.Panda()


def plain(J: Any) -> Any:
    out = np.array(J)
    assert type(out) is np.ndarray and type(J) is not np.ndarray
    return out


def configurations(panda: Any, count: int) -> Any:
    low, high = panda.qlim
    return np.random.default_rng(3).uniform(low, high, (count, panda.n))


def test_pseudoinverses_are_those_of_numpy(panda: Any) -> None:
    for q in configurations(panda, 50):
        for J in (panda.jacob0(q), panda.jacobe(q), panda.jacob0_analytical(q), panda.jacobe(q)[:3]):
            for at in (J, J.T, J[:, ::-1]):
                expected = np.linalg.pinv(plain(at))
                limit = 1e-14 * np.linalg.cond(plain(at)) * np.abs(expected).max()
                assert np.abs(np.linalg.pinv(at) - expected).max() < limit
        square = panda.jacob0(q)[:, :6]
        expected = np.linalg.inv(plain(square))
        limit = 1e-14 * np.linalg.cond(plain(square)) * np.abs(expected).max()
        assert np.abs(np.linalg.inv(square) - expected).max() < limit


def test_they_come_from_a_kernel(panda: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    J = panda.jacobe(panda.qr)
    monkeypatch.setattr(np.linalg._linalg, "svd", None)  # type: ignore[attr-defined]
    assert np.abs(J @ np.linalg.pinv(J) - np.eye(6)).max() < 1e-13
    with pytest.raises(TypeError):
        np.linalg.pinv(plain(J))


def test_in_doubt_numpy_decides(panda: Any) -> None:
    """Bit for bit: singular configurations, settings, other types, what is no matrix."""
    J = panda.jacob0(panda.qr)
    stretched = panda.jacob0(np.zeros(7))
    assert np.linalg.matrix_rank(plain(stretched)) < 6
    doubled = panda.jacob0(panda.qr)
    doubled[3] = doubled[2]
    beside = panda.jacob0(1e-10 * np.arange(7.0))
    for at in (stretched, doubled, beside, J.astype(np.float32), J.astype(complex), np.zeros_like(J)):
        assert (np.linalg.pinv(at) == np.linalg.pinv(plain(at))).all()
        assert np.linalg.pinv(at).dtype == at.dtype
    assert (np.linalg.pinv(J, 0.3) == np.linalg.pinv(plain(J), 0.3)).all()
    assert (np.linalg.pinv(J, rcond=0.3) == np.linalg.pinv(plain(J), rcond=0.3)).all()
    many = panda.jacob0(configurations(panda, 4))
    assert (np.linalg.pinv(many) == np.linalg.pinv(plain(many))).all()
    for wrong in (J[0], np.full_like(J, np.nan)):
        with pytest.raises(np.linalg.LinAlgError):
            np.linalg.pinv(wrong)
    for wrong in (J, stretched[:, :6]):
        with pytest.raises(np.linalg.LinAlgError):
            np.linalg.inv(wrong)


def test_jacobians_behave_like_plain_arrays(panda: Any) -> None:
    J, q = panda.jacobe(panda.qr), np.arange(7.0)
    P = plain(J)
    assert (repr(J), str(J), np.array_repr(J)) == (repr(P), str(P), np.array_repr(P))
    for same in (pickle.loads(pickle.dumps(J)), copy.deepcopy(J), copy.copy(J), np.asarray(J)):
        assert (same == P).all()
    assert type(pickle.loads(pickle.dumps(J))) is np.ndarray
    for f in (
        lambda A: A @ q, lambda A: P @ A.T, lambda A: P * A, lambda A: np.c_[A, np.eye(6)],
        lambda A: np.vstack([A, P]), lambda A: np.linalg.svd(A)[1], lambda A: np.linalg.lstsq(A, np.ones(6))[0],
        lambda A: np.linalg.solve(A[:, :6], np.ones(6)), lambda A: np.einsum("ij,j->i", A, q), lambda A: A.tolist(),
        lambda A: A[0, 0], lambda A: A.sum(), lambda A: A.max(axis=1), lambda A: 2.0 * A, lambda A: -A, lambda A: A @ A.T,
        lambda A: np.dot(A[0], A[1]), lambda A: A.mean(), lambda A: A > 0.0, lambda A: (A > 0.0).any(), lambda A: np.where(A > 0.0, A, 0.0), lambda A: np.linalg.norm(A),
    ):  # fmt: skip
        assert np.array_equal(f(J), f(P)) and type(f(J)) is type(f(P))
    A = J.copy()
    A[:3] *= 2.0
    A[3:, 0] = 1.0
    assert (A[:3] == 2.0 * P[:3]).all() and (A[3:, 0] == 1.0).all() and (J == P).all()


def test_a_chain_has_the_gradient_of_manipulability_of_its_robot(panda: Any) -> None:
    q = configurations(panda, 1)[0]
    np.testing.assert_allclose(panda.ets().jacobm(q), panda.jacobm(q), rtol=1e-9)
    assert np.abs(panda.ets().jacobm(q, "trans") - panda.ets().jacobm(q)).max() > 1e-3


def test_a_link_is_compiled_once_by_object_and_by_name(panda: Any) -> None:
    link = panda.ee_links[0]
    chain = panda._chain_between(None, link)
    assert panda._chain_between(None, link) is chain
    assert panda._chain_between(None, link.name) is chain
    assert "Pose of a tool" in panda.ikine_LM.__doc__ and "Greatest number of searches" in panda.ik_NR.__doc__
