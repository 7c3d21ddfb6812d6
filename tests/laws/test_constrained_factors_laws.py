"""Laws of the factors of mass matrix and constraints together: on floats, in batches, and where they may have entries."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms.constraints.kkt_factors import (
    constrained_factors,
    constrained_impact,
    constrained_motion,
    filled,
    joined,
    moved_by,
)
from ulna.model import Frame, Model
from ulna.spatial import SE3
from ulna.typing import Floats

KINDS = ["revolute", "universal", "prismatic", "spherical", "revolute", "continuous"]


def tree(seed: int) -> Model:
    return random_model(np.random.default_rng(seed), KINDS, root="free_flyer" if seed % 2 else None, mimics=1)


def given(model: Model, seed: int, batch: tuple[int, ...] = ()) -> tuple[Floats, Floats, Floats]:
    """M, J of the frames of the last two joints, and a damping."""
    rng = np.random.default_rng(seed)
    q = np.array([alg.random(model, rng) for _ in range(int(np.prod(batch)))]).reshape(*batch, model.nq)
    last = len(model.joints) - 1
    frames = [Frame("f", last - k, SE3.identity(), "user", "", SE3.identity()) for k in range(2)]
    J = np.concatenate([alg.frame_jacobian(model, q, frame)[..., :3, :] for frame in frames], axis=-2)
    return alg.mass_matrix(model, q), J, rng.uniform(0.1, 1.0, (*batch, 6))


def whole(M: Floats, J: Floats, mu: Floats) -> Floats:
    top = np.concatenate([-np.eye(6) * mu[..., None, :], J], axis=-1)
    return np.concatenate([top, np.concatenate([np.swapaxes(J, -1, -2), M], axis=-1)], axis=-2)


@pytest.mark.parametrize("seed", range(4))
def test_the_factors_are_those_of_the_whole(seed: int) -> None:
    model = tree(seed)
    M, J, mu = given(model, seed)
    factors, G, unique = constrained_factors(M, J, mu)
    U = np.eye(6 + model.nv)
    for k, row in enumerate(factors.lower):
        for j, entry in row.items():
            U[j, k] = entry
    K = whole(M, J, mu)
    np.testing.assert_allclose((U * factors.pivots) @ U.T, K, atol=1e-9)
    np.testing.assert_allclose(G, J @ np.linalg.solve(M, J.T), atol=1e-8)
    np.testing.assert_allclose(np.array(factors.pivots) * factors.reciprocals, 1.0)
    assert unique > 0.0 and (np.array(factors.pivots[:6]) < 0.0).all() and min(factors.pivots[6:]) > 0.0
    last = len(model.joints) - 1
    rows = np.repeat([moved_by(model, [last]), moved_by(model, [last - 1])], 3, axis=0)
    assert not M[joined(model) == 0.0].any() and not J[rows == 0.0].any()
    assert not U[filled(joined(model), rows) == 0.0].any()


def test_batches_are_stacks_of_singles() -> None:
    model = tree(1)
    M, J, mu = given(model, 1, (2, 3))
    rng = np.random.default_rng(5)
    drive, g, v = (rng.normal(size=(2, 3, n)) for n in (model.nv, 6, model.nv))
    factors = constrained_factors(M, J, mu).factors
    a, f = constrained_motion(factors, drive, g)
    after, impulses = constrained_impact(factors, J, v, 0.3)
    K = whole(M, J, mu)
    for k in np.ndindex(2, 3):
        x = np.linalg.solve(K[k], np.concatenate([-g[k], drive[k]]))
        np.testing.assert_allclose(np.concatenate([-f[k], a[k]]), x, atol=1e-9 * np.abs(x).max())
        y = np.linalg.solve(K[k], np.concatenate([-1.3 * J[k] @ v[k], np.zeros(model.nv)]))
        wanted = np.concatenate([-impulses[k], after[k] - v[k]])
        np.testing.assert_allclose(wanted, y, atol=1e-9 * np.abs(y).max())


def test_what_is_not_unique_is_reported() -> None:
    model = tree(0)
    M, J, mu = given(model, 0)
    twice, none = np.concatenate([J[:3], J[:3]]), np.zeros(6)
    assert constrained_factors(M, twice, mu).unique > 0.0
    assert constrained_factors(M, twice, none).unique == 0.0
    assert constrained_factors(0.0 * M, J, mu).unique == 0.0
    assert constrained_factors(M, J[:0], mu[:0]).unique > 0.0
