"""The joint-space mass matrix by the composite-rigid-body algorithm.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| I_i^c | inertia of all bodies from step i outward, in its moving frame | Lump | | I_i + sum of its children's |
| s | a column of S_i | Motion | | constant, see tree.py |
| r | force that accelerates those bodies along s | Force | | r = I_i^c s |
| M_ij | entry for a column of step j, on which step i stands | () | | s_j . r, with r seen from j |
| M | mass matrix | (nv, nv) | [kg], [kg m], [kg m^2] | plus armature on its diagonal |

Source: Featherstone 2008, section 6.2, algorithm of table 6.2. The frames are those of link_frames.py, and the
inertias those
a joint can feel. A column of a mimic joint, times the multiplier, is one of its source: it couples the place of the
mimic joint with all that the source moves, and with the source's own column, wherever the two stand in the tree. M is
then B^T M' B, where M' is the matrix of the tree with every joint free, and v' = B v.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna.algorithms.multibody.link_frames import tidy
from ulna.algorithms.multibody.mass_moments import Lump, felt, turning_axis
from ulna.algorithms.multibody.tree import Step, blank, inward
from ulna.model import Model
from ulna.spatial import Force, Motion
from ulna.typing import Array


def mass_matrix(model: Model, q: Array) -> Array:
    """M, shape (..., nv, nv): symmetric, positive definite where every motion moves some mass.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
    """
    tidied = tidy(model)
    return mass_matrix_of(model, tidied.tree, composites(tidied.tree, felt(model, tidied), q), q)


def composites(tree: Sequence[Step], bodies: Sequence[Lump], q: Array) -> list[Lump]:
    """I^c of every step."""
    return inward(tree, bodies, lambda step, body: outside(step, body, q))


def outside(step: Step, body: Lump, q: Array) -> Lump:
    """An inertia in the moving frame of a step, as the parent's moving frame sees it."""
    return body.moved(step.transform(q), turning_axis(step.kind)).moved(step.placement)


def mass_matrix_of(model: Model, tree: Sequence[Step], bodies: Sequence[Lump], *inputs: Array) -> Array:
    """M, out of the composite inertias of all steps; the first of `inputs` is q, the others count for the batch."""
    q = inputs[0]
    M = blank((model.nv, model.nv), *inputs)
    for i in range(len(tree)):
        own = columns_of(tree[i])
        for n, (k, s) in enumerate(own):
            r = bodies[i].apply(s)
            for index, other in own[:n]:
                _add_twice(M, k, index, r.dot(other))
            M[..., k, k] += r.dot(s)
            for step, seen in passed_inward(tree, i, r, q):
                for index, other in columns_of(step):
                    _add_twice(M, k, index, seen.dot(other))
    for k in range(model.nv):
        M[..., k, k] += model.armature[k]
    return M


def _add_twice(M: Array, k: int, index: int, entry: Any) -> None:
    M[..., k, index] += entry
    M[..., index, k] += entry


def columns_of(step: Step) -> list[tuple[int, Motion]]:
    """The columns s of a step, and where each stands in `v`; those of a mimic joint with its multiplier."""
    return [(k, S * step.multiplier) for k, S in zip(step.indices, step.subspace(), strict=True)]


def passed_inward(tree: Sequence[Step], i: int, force: Force, q: Array) -> list[tuple[Step, Force]]:
    """The steps that step `i` stands on, nearest first, each with a force of step `i` as its moving frame sees it."""
    found = []
    while tree[i].parent >= 0:
        force = tree[i].placement.act(tree[i].transform(q).act(force))
        i = tree[i].parent
        found.append((tree[i], force))
    return found
