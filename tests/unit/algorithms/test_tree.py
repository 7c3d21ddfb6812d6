"""The recursions over the tree: joints unfolded into steps, values passed outward and inward."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms.multibody import tree
from ulna.model import Composite, Model, ModelBuilder, Revolute, Spherical, Universal
from ulna.spatial import SE3


@pytest.fixture(scope="module")
def model() -> Model:
    """Two branches on a spherical shoulder; the second begins with a joint of four parts."""
    builder = ModelBuilder("tree")
    for name in "abcd":
        builder.add_link(name)
    several = Composite(
        (Revolute((0, 0, 1)), Universal((1, 0, 0), (0, 1, 0)), Spherical()), (SE3.rx(0.2),) * 3
    )
    builder.add_joint("1", Spherical(), "a", "b", SE3.trans(0, 0, 1))
    builder.add_joint("2", Revolute((0, 0, 1)), "b", "c")
    builder.add_joint("3", several, "b", "d", SE3.trans(1, 0, 0))
    return builder.build()


def test_joints_are_unfolded_into_steps(model: Model) -> None:
    steps = tree.steps(model)
    assert [step.joint.name for step in steps] == ["1", "2", "3", "3", "3", "3"]
    assert [step.parent for step in steps] == [-1, 0, 0, 2, 3, 4]
    assert [step.is_last for step in steps] == [True, True, False, False, False, True]
    assert [list(step.indices) for step in steps] == [[0, 1, 2], [3], [4], [5], [6], [7, 8, 9]]
    assert [step.kind.name for step in steps][2:] == ["revolute", "revolute", "revolute", "spherical"]
    assert [step.start_q for step in steps][2:] == [0, 1, 2, 3]


def test_a_chain_holds_only_what_a_frame_stands_on(model: Model) -> None:
    assert [step.joint.name for step in tree.chain(model, model.frame("c"))] == ["1", "2"]
    assert [step.parent for step in tree.chain(model, model.frame("d"))] == [-1, 0, 1, 2, 3]
    assert tree.chain(model, model.frame("a")) == ()


def test_outward_and_inward(model: Model) -> None:
    steps = tree.steps(model)
    depth = tree.outward(steps, 0, lambda step, before: before + 1)
    assert depth == [1, 2, 2, 3, 4, 5]
    below = tree.inward(steps, [1] * len(steps), lambda step, count: count)
    assert below == [6, 1, 4, 3, 2, 1]


def test_the_last_steps_are_the_joints() -> None:
    rng = np.random.default_rng(8)
    model = random_model(rng)
    q = alg.random(model, rng)
    steps = tree.steps(model)
    last = [T for T, step in zip(tree.poses(steps, q), steps, strict=True) if step.is_last]
    assert len(last) == len(model.joints)
    for joint, T in zip(model.joints, last, strict=True):
        parent = last[joint.parent] if joint.parent >= 0 else SE3.identity()
        assert T.is_close(parent @ joint.placement @ joint.kind.transform(joint.q_of(q)), 1e-13)
