"""Tidy frames and moved inertias: the same robot, written more cheaply."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import KINDS, random_inertia, random_model, random_pose
from ulna.algorithms import random
from ulna.algorithms.multibody.link_frames import tidy
from ulna.algorithms.multibody.mass_moments import Lump, felt, lumps, steiner, turned, turning_axis
from ulna.algorithms.multibody.tree import poses, steps
from ulna.model import Continuous, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3, Motion


@pytest.fixture(params=[(seed, root) for seed in range(3) for root in (None, "free_flyer")])
def model(request: pytest.FixtureRequest) -> Model:
    seed, root = request.param
    return random_model(np.random.default_rng(seed), list(KINDS) * 2, root=root, mimics=2)


def same_frames(model: Model) -> None:
    rng = np.random.default_rng(0)
    q = random(model, rng)
    old, new = steps(model), tidy(model)
    for before, after, C, step, tidied in zip(
        poses(old, q), poses(new.tree, q), new.frames, old, new.tree, strict=True
    ):
        assert after.is_close(before @ C, 1e-12)
        for s, t in zip(step.subspace(), tidied.subspace(), strict=True):
            assert C.act(t).is_close(s, 1e-12)
        if isinstance(tidied.kind, (Revolute, Continuous, Prismatic)):
            assert np.count_nonzero(tidied.kind.axis) == 1


def test_frames_move_as_they_did(model: Model) -> None:
    same_frames(model)


def test_an_axis_beside_a_coordinate_axis_keeps_its_direction() -> None:
    b = ModelBuilder("slant").add_link("a").add_link("b").add_link("c")
    b.add_joint("j", Revolute((0.0, -1.0, -4e-8)), "a", "b", SE3.trans(0.1, 0.2, 0.3))
    b.add_joint("k", Prismatic((1.0, 3e-9, 0.0)), "b", "c", SE3.trans(0.1, 0.2, 0.3))
    same_frames(b.build())
    assert turning_axis(Revolute((0.0, -1.0, -4e-8))) is None
    assert turning_axis(Revolute((0.0, -1.0, 0.0))) == 1


def test_slides_and_turns_leave_denavits_and_hartenbergs_zeros() -> None:
    b = ModelBuilder("scara").add_link("a").add_link("b").add_link("c")
    b.add_joint("j", Revolute(), "a", "b", SE3.rz(0.3) @ SE3.trans(0.0, 0.0, 0.4))
    b.add_joint("k", Revolute(), "b", "c", SE3.trans(0.1, 0.2, 0.5) @ SE3.rz(0.7))
    tree = tidy(b.build()).tree
    assert np.count_nonzero(tree[1].placement.rotation) == 3
    assert np.count_nonzero(tree[1].placement.translation) == 1
    assert np.count_nonzero(tree[0].placement.rotation) == 3


def test_lump_is_an_inertia_about_the_origin() -> None:
    rng = np.random.default_rng(0)
    body, other = random_inertia(rng), random_inertia(rng)
    V, T = Motion(*rng.standard_normal((2, 3))), random_pose(rng)
    assert Lump.of(body).apply(V).is_close(body.apply(V), 1e-12)
    whole, moved = Lump.of(body) + Lump.of(other), T.act(body + other)
    assert whole.moved(T).apply(V).is_close(moved.apply(V), 1e-12)
    rest = whole - Lump.of(other)
    np.testing.assert_allclose(rest.second, body.about_origin(), atol=1e-12)


def test_rate_is_that_of_the_moving_body() -> None:
    rng = np.random.default_rng(1)
    lump, V, h = Lump.of(random_inertia(rng)), Motion(*rng.standard_normal((2, 3))), 1e-5
    later, earlier = (lump.moved(SE3.exp(V * t)).second for t in (h, -h))
    np.testing.assert_allclose(lump.rate(V), (later - earlier) / (2 * h), atol=1e-8)


@pytest.mark.parametrize("axis", range(3))
def test_turns_about_coordinate_axes(axis: int) -> None:
    rng = np.random.default_rng(2)
    half = rng.standard_normal((3, 3))
    I, R = half + half.T, (SE3.rx, SE3.ry, SE3.rz)[axis](0.7).rotation
    for how in (axis, None):
        np.testing.assert_allclose(turned(R, I, how), R @ I @ R.T, atol=1e-14)
    a, b = rng.standard_normal((2, 3))
    np.testing.assert_allclose(
        steiner(a, b), 2.0 * a @ b * np.eye(3) - np.outer(a, b) - np.outer(b, a), atol=1e-14
    )


def test_inner_bodies_keep_only_what_their_joint_feels() -> None:
    rng = np.random.default_rng(3)
    model = random_model(rng, ["revolute", "revolute", "prismatic", "spherical"], mimics=0, branching=0.0)
    tidied = tidy(model)
    all_, kept = lumps(model, tidied), felt(model, tidied)
    for step, whole, rest in zip(tidied.tree, all_, kept, strict=True):
        if isinstance(step.kind, Prismatic):
            assert not rest.second.any()
            continue
        assert rest.mass == 0.0
        assert whole.mass > 0.0
        if isinstance(step.kind, Revolute):
            k = int(np.abs(step.kind.axis).argmax())
            assert rest.first[k] == 0.0
            assert (np.diag(rest.second) == 0.0).sum() == 1
