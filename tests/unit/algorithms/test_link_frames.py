"""Optimised link frames and regrouped inertias: the same robot in fewer operations."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from support.random_models import KINDS, random_inertia, random_model, random_pose
from ulna.algorithms import frame_jacobian, frame_pose, random
from ulna.algorithms.multibody import link_frames
from ulna.algorithms.multibody.link_frames import choose_link_frames, frame_chain
from ulna.algorithms.multibody.mass_moments import (
    MassMoments,
    in_parent_frame,
    rotate_symmetric,
    rotation_axis,
    steiner,
)
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.algorithms.multibody.tree import chain, poses, steps, sum_in_world, tip_pose
from ulna.compiler import trace
from ulna.model import Continuous, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3, Motion


@pytest.fixture(params=[(seed, root) for seed in range(3) for root in (None, "free_flyer")])
def model(request: pytest.FixtureRequest) -> Model:
    seed, root = request.param
    return random_model(np.random.default_rng(seed), list(KINDS) * 2, root=root, mimics=2)


def same_frames(model: Model) -> None:
    rng = np.random.default_rng(0)
    q = random(model, rng)
    old, new = steps(model), choose_link_frames(model)
    for before, after, C, step, new_step in zip(
        poses(old, q), poses(new.tree, q), new.frames, old, new.tree, strict=True
    ):
        assert after.is_close(before @ C, 1e-12)
        for s, t in zip(step.subspace(), new_step.subspace(), strict=True):
            assert C.act(t).is_close(s, 1e-12)
        if isinstance(new_step.kind, (Revolute, Continuous, Prismatic)):
            assert np.count_nonzero(new_step.kind.axis) == 1


def test_poses_and_motion_subspaces_are_the_same(model: Model) -> None:
    same_frames(model)


def test_frames_are_chosen_once_for_a_model_and_go_with_it() -> None:
    made = random_model(np.random.default_rng(7100), list(KINDS), mimics=2)
    links = choose_link_frames(made)
    assert choose_link_frames(made) is links
    few = choose_link_frames(made, [0])
    assert len(few.tree) < len(links.tree)
    assert choose_link_frames(made) is links
    same_frames(made)
    rng = np.random.default_rng(7101)
    for _ in range(20):  # at the address of one that is gone, too
        made = random_model(rng, list(KINDS), mimics=2)
        same_frames(made)
    key = id(made)
    assert key in link_frames._chosen
    del made
    gc.collect()
    assert key not in link_frames._chosen


@pytest.mark.parametrize("root", [None, "free_flyer"])
def test_traced_poses_and_jacobians_of_frames_after_many_joints(root: str | None) -> None:
    """They take optimised frames, and equal those in the frames that the model names."""
    rng = np.random.default_rng(7)
    model = random_model(rng, list(KINDS) * 2, root=root, mimics=3, branching=0.0)
    q = random(model, rng)
    numbers = {len(chain(model, frame)): frame for frame in model.frames}
    frame = numbers[max(numbers)]
    assert max(numbers) >= 24
    optimised, _ = frame_chain(model, frame, np.array([None]))
    assert optimised != chain(model, frame) and frame_chain(model, frame, q)[0] == chain(model, frame)
    pose = trace(lambda q: frame_pose(model, q, frame).matrix(), q=(model.nq,))
    plain = trace(lambda q: tip_pose(chain(model, frame), q, frame.placement).matrix(), q=(model.nq,))
    assert pose.operations < plain.operations
    np.testing.assert_allclose(pose(q), frame_pose(model, q, frame).matrix(), atol=1e-12)
    for reference in ("world", "local", "local_world_aligned"):
        jacobian = trace(lambda q, r=reference: frame_jacobian(model, q, frame, r), q=(model.nq,))
        np.testing.assert_allclose(
            jacobian(q), frame_jacobian(model, q, frame, reference), rtol=1e-11, atol=1e-11
        )


def test_an_axis_beside_a_coordinate_axis_keeps_its_direction() -> None:
    b = ModelBuilder("slant").add_link("a").add_link("b").add_link("c")
    b.add_joint("j", Revolute((0.0, -1.0, -4e-8)), "a", "b", SE3.trans(0.1, 0.2, 0.3))
    b.add_joint("k", Prismatic((1.0, 3e-9, 0.0)), "b", "c", SE3.trans(0.1, 0.2, 0.3))
    same_frames(b.build())
    assert rotation_axis(Revolute((0.0, -1.0, -4e-8))) is None
    assert rotation_axis(Revolute((0.0, -1.0, 0.0))) == 1


def test_the_frames_have_the_zeros_of_denavit_and_hartenberg() -> None:
    b = ModelBuilder("scara").add_link("a").add_link("b").add_link("c")
    b.add_joint("j", Revolute(), "a", "b", SE3.rz(0.3) @ SE3.trans(0.0, 0.0, 0.4))
    b.add_joint("k", Revolute(), "b", "c", SE3.trans(0.1, 0.2, 0.5) @ SE3.rz(0.7))
    tree = choose_link_frames(b.build()).tree
    assert np.count_nonzero(tree[1].placement.rotation) == 3
    assert np.count_nonzero(tree[1].placement.translation) == 1
    assert np.count_nonzero(tree[0].placement.rotation) == 3


def test_mass_moments_are_an_inertia_about_the_origin() -> None:
    rng = np.random.default_rng(0)
    body, other = random_inertia(rng), random_inertia(rng)
    V, T = Motion(*rng.standard_normal((2, 3))), random_pose(rng)
    assert MassMoments.of_body(body).apply(V).is_close(body.apply(V), 1e-12)
    whole, moved = MassMoments.of_body(body) + MassMoments.of_body(other), T.act(body + other)
    assert whole.to_outer_frame(T).apply(V).is_close(moved.apply(V), 1e-12)
    rest = whole - MassMoments.of_body(other)
    np.testing.assert_allclose(rest.second, body.about_origin(), atol=1e-12)


def test_rate_is_that_of_the_moving_body() -> None:
    rng = np.random.default_rng(1)
    body, V, h = MassMoments.of_body(random_inertia(rng)), Motion(*rng.standard_normal((2, 3))), 1e-5
    later, earlier = (body.to_outer_frame(SE3.exp(V * t)).second for t in (h, -h))
    np.testing.assert_allclose(body.rate(V), (later - earlier) / (2 * h), atol=1e-8)


@pytest.mark.parametrize("axis", range(3))
def test_rotation_of_a_symmetric_matrix_about_a_coordinate_axis(axis: int) -> None:
    rng = np.random.default_rng(2)
    half = rng.standard_normal((3, 3))
    I, R = half + half.T, (SE3.rx, SE3.ry, SE3.rz)[axis](0.7).rotation
    for how in (axis, None):
        np.testing.assert_allclose(rotate_symmetric(R, I, how), R @ I @ R.T, atol=1e-14)
    a, b = rng.standard_normal((2, 3))
    np.testing.assert_allclose(
        steiner(a, b), 2.0 * a @ b * np.eye(3) - np.outer(a, b) - np.outer(b, a), atol=1e-14
    )


def test_regrouping_leaves_the_base_parameters() -> None:
    rng = np.random.default_rng(3)
    model = random_model(rng, ["revolute", "revolute", "prismatic", "spherical"], mimics=0, branching=0.0)
    prepared = prepare(model)
    for step, whole, rest in zip(
        prepared.tree, prepared.body_moments, prepared.regrouped_moments, strict=True
    ):
        if isinstance(step.kind, Prismatic):
            assert not rest.second.any()
            continue
        assert rest.mass == 0.0
        assert whole.mass > 0.0
        if isinstance(step.kind, Revolute):
            k = int(np.abs(step.kind.axis).argmax())
            assert rest.first[k] == 0.0
            assert (np.diag(rest.second) == 0.0).sum() == 1


@pytest.mark.parametrize("root", KINDS)
def test_regrouped_bodies_and_what_is_at_rest_have_the_moments_of_the_robot(root: str) -> None:
    rng = np.random.default_rng(7100)
    model = random_model(rng, [root, *KINDS], mimics=1)
    prepared = prepare(model)
    assert any(step.parent < 0 and step.joint.name == "joint0" for step in prepared.tree)
    for _ in range(3):
        q = random(model, rng)
        before, after = (
            sum_in_world(prepared.tree, bodies, rest, lambda step, body, q=q: in_parent_frame(step, body, q))
            for bodies, rest in (
                (prepared.body_moments, MassMoments.zero()),
                (prepared.regrouped_moments, prepared.moments_at_rest),
            )
        )
        for name in ("mass", "first", "second"):
            np.testing.assert_allclose(getattr(after, name), getattr(before, name), rtol=1e-11, atol=1e-11)
