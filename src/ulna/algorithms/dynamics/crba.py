"""The joint-space mass matrix by the composite-rigid-body algorithm.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| I_i^c | inertia of all bodies from step i outward, in its moving frame | MassMoments | | I_i + sum of its children's |
| s | a column of S_i | Motion | | constant, see tree.py |
| F | force that accelerates those bodies along s | Force | | F = I_i^c s, then F = X F in the parent's frame |
| M_kl | entry of the columns k of step i and l of step j, on which i stands | () | | s_l . F, F seen from j |
| M | mass matrix | (nv, nv) | [kg], [kg m], [kg m^2] | plus armature on its diagonal |

Source: Featherstone 2008, section 6.2, table 6.2. A column of a mimic joint, times the multiplier, is one of its
source; it couples the place of the mimic joint with all that the source moves, and with the column of the source,
wherever the two are in the tree. M is then B^T M' B, where M' is the matrix of the tree with every joint free, and
v' = B v.

`composite_rigid_bodies` is the recursion of the book on any tree and inertias. `crba` applies it to the frames and
inertias of the model; `mass_matrix`, which is compiled, to optimised frames (link_frames.py) and regrouped inertias
(regrouped_moments.py). M is the same: the frames turn about and slide along the joints' axes, and regrouping keeps the
kinetic energy at every velocity. `tests/laws/test_textbook_dynamics_laws.py` compares the two.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.mass_moments import MassMoments, body_moments, in_parent_frame
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.algorithms.multibody.tree import Step, inward, steps
from ulna.model import Model
from ulna.spatial import Force
from ulna.typing import Array


def crba(model: Model, q: Array) -> Array:
    """The mass matrix in the frames and with the inertias of the model (Featherstone 2008, table 6.2).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        M, shape (..., nv, nv) [kg, kg m, kg m^2].
    """
    tree = steps(model)
    return composite_rigid_bodies(model, tree, body_moments(model, tree), q)


def mass_matrix(model: Model, q: Array) -> Array:
    """The mass matrix, by the form that is compiled; equal to `crba`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        M, shape (..., nv, nv) [kg, kg m, kg m^2]: symmetric, positive definite where every motion moves some mass.
    """
    prepared = prepare(model)
    return composite_rigid_bodies(model, prepared.tree, prepared.regrouped_moments, q)


def composite_rigid_bodies(model: Model, tree: Sequence[Step], I: Sequence[MassMoments], q: Array) -> Array:
    """The recursion of table 6.2.

    Args:
        model: The robot.
        tree: Its steps.
        I: The inertia of the body of every step, in its moving frame [kg, kg m, kg m^2].
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        M with the armature, shape (..., nv, nv) [kg, kg m, kg m^2].
    """
    I_c = composite_moments(tree, I, q)
    M = batch_zeros((model.nv, model.nv), q)
    for i, step in enumerate(tree):
        columns = step.columns()
        for n, (k, s) in enumerate(columns):
            F = I_c[i].apply(s)
            for l, s_l in columns[:n]:
                _add_symmetric(M, k, l, s_l.dot(F))
            M[..., k, k] += s.dot(F)
            for ancestor, F_j in _forces_at_ancestors(tree, i, F, q):
                for l, s_l in ancestor.columns():
                    _add_symmetric(M, k, l, s_l.dot(F_j))
    for k in range(model.nv):
        M[..., k, k] += model.armature[k]
    return M


def composite_moments(tree: Sequence[Step], I: Sequence[MassMoments], q: Array) -> list[MassMoments]:
    """The inertia I^c of all bodies from each step outward.

    Args:
        tree: The steps, parents first.
        I: The inertia of the body of every step, in its moving frame [kg, kg m, kg m^2].
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        I^c of every step, in its moving frame [kg, kg m, kg m^2].
    """
    return inward(tree, I, lambda step, I_i: in_parent_frame(step, I_i, q))


def _forces_at_ancestors(tree: Sequence[Step], i: int, F: Force, q: Array) -> Iterator[tuple[Step, Force]]:
    """The ancestors of step `i`, nearest first, each with a force of step `i` in its moving frame."""
    while tree[i].parent >= 0:
        F = tree[i].force_to_parent(F, q)
        i = tree[i].parent
        yield tree[i], F


def _add_symmetric(M: Array, k: int, l: int, entry: Any) -> None:
    M[..., k, l] += entry
    M[..., l, k] += entry
