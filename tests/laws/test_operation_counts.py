"""Upper bounds of operation counts: a change that makes an algorithm dearer for any kind of robot must say so.

The bounds are the counts at the time of writing; the tests allow 2 % more, for rearrangements that cost nothing.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest

from support.random_models import random_model
from ulna import algorithms, kernels
from ulna.algorithms import Proximal
from ulna.model import FrameContact, Model, PointContact
from ulna.model.constraint import frame_pairs
from ulna.robots.panda import panda
from ulna.robots.ur5 import ur5

NAMES = (
    "fk", "jacobian", "inverse_dynamics", "forward_dynamics", "mass_matrix", "bias_forces", "gravity_forces",
    "inverse_mass_matrix",
)  # fmt: skip

BOUNDS: dict[str, tuple[int, ...]] = {
    "panda": (147, 187, 624, 1207, 386, 599, 115, 730),
    "ur5": (125, 148, 289, 527, 156, 259, 22, 330),
    "floating panda": (219, 301, 895, 2018, 594, 856, 186, 2690),
    "tree": (160, 136, 831, 1188, 391, 704, 262, 502),
    "floating tree": (589, 703, 1870, 5561, 1958, 1765, 589, 4476),
}

LEAVES = ("link1", "link2", "link7")
"""Links at the ends of three branches of the floating tree."""

CONSTRAINED: dict[str, tuple[tuple[PointContact | FrameContact, ...], tuple[int, ...]]] = {
    "one point": ((PointContact("link1", (0.1, 0.0, 0.0)),), (5436, 3472, 3037, 80)),
    "three points": (tuple(PointContact(name, (0.1, 0.0, 0.0)) for name in LEAVES), (8129, 6058, 4453, 572)),
    "two frames": (tuple(FrameContact(name) for name in LEAVES[:2]), (8828, 6719, 4249, 143)),
}
OF_CONSTRAINTS = ("constrained_dynamics", "impulse_dynamics", "delassus_matrix", "constraint_jacobian")


@functools.cache
def model(name: str) -> Model:
    kinds = ["revolute", "revolute", "prismatic"]
    match name:
        case "panda":
            return panda()
        case "ur5":
            return ur5()
        case "floating panda":
            return panda(root="free_flyer")
        case "tree":
            return random_model(np.random.default_rng(1), kinds, 10, mimics=0, branching=0.5)
    return random_model(np.random.default_rng(2), kinds, 10, root="free_flyer", mimics=0, branching=0.5)


@pytest.mark.parametrize("robot", BOUNDS)
def test_operation_counts_of_algorithms_do_not_grow(robot: str) -> None:
    counts = {name: kernels.function(model(robot), name).operations for name in NAMES}
    for name, bound in zip(NAMES, BOUNDS[robot], strict=True):
        assert counts[name] <= 1.02 * bound, (name, counts[name], bound)


STAGED = {
    "inverse_dynamics_derivatives": 3655,
    "forward_dynamics_derivatives": 5341,
    "coriolis_matrix": 2521,
    "centroidal_derivatives": 3933,
}
"""Operations that are written out in stages, for a floating tree of 24 joints."""


STAGED_ON_CONTACTS = {"constrained_dynamics": 4631, "impulse_dynamics": 3244, "constrained_derivatives": 6610}
"""The same, on a frame and a point."""


def staged_tree() -> Model:
    """A floating tree of 24 joints."""
    kinds = ["revolute", "revolute", "prismatic"]
    return random_model(np.random.default_rng(3), kinds, 24, root="free_flyer", mimics=0, branching=0.5)


def test_operation_counts_of_stages_do_not_grow() -> None:
    tree = staged_tree()
    forms = {name: getattr(algorithms, f"stages_of_{name}")(tree) for name in STAGED}
    counts = {name: form.operations for name, form in forms.items()}
    assert all(counts[name] <= 1.02 * bound for name, bound in STAGED.items()), counts


def test_operation_counts_of_stages_on_contacts_do_not_grow() -> None:
    tree = staged_tree()
    first, second = tree.link_names[-2:]
    pairs = frame_pairs(tree, (FrameContact(first), PointContact(second)))
    settings = {name: (Proximal(mu=0.0),) for name in STAGED_ON_CONTACTS if "dynamics" in name}
    forms = {
        name: getattr(algorithms, f"stages_of_{name}")(tree, pairs, *settings.get(name, ()))
        for name in STAGED_ON_CONTACTS
    }
    counts = {name: form.operations for name, form in forms.items()}
    assert all(counts[name] <= 1.02 * bound for name, bound in STAGED_ON_CONTACTS.items()), counts


@pytest.mark.parametrize("case", CONSTRAINED)
def test_operation_counts_of_constraints_do_not_grow(case: str) -> None:
    constraints, bounds = CONSTRAINED[case]
    for name, bound in zip(OF_CONSTRAINTS, bounds, strict=True):
        count = kernels.function(model("floating tree"), name, constraints=constraints).operations
        assert count <= 1.02 * bound, (name, count, bound)


def test_branches_without_contact_cost_a_contact_nothing() -> None:
    """The constraint Jacobian has entries only for the joints that carry the contact, and so has its factor."""
    whole = model("floating tree")
    one, three = (CONSTRAINED[name][0] for name in ("one point", "three points"))
    carried = {i for name in LEAVES for i in whole.support(whole.link(name).joint)}
    assert len(carried) < len(whole.joints)
    count = {
        n: kernels.function(whole, "constrained_dynamics", constraints=c).operations
        for n, c in ((1, one), (3, three))
    }
    free = kernels.function(whole, "forward_dynamics").operations
    assert count[1] < 1.2 * free and count[3] < 1.7 * free
