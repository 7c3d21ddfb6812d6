"""Fields of a Data that are computed when they are read, from a joint table."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.joint_table import matrices_of
from pinocchio._tables.world_sums import (
    in_world,
    inertias_in_world,
    spatial_products,
    twist_rates_of_momenta,
    wrenches_in_world,
)
from ulna.typing import Floats

Fields = dict[str, Floats]


def joint_placements(evaluator: TableEvaluator, q: Floats) -> Fields:
    """`liMi` (njoints - 1, 4, 4).

    Returns:
        The field.
    """
    steps = evaluator.steps
    X = matrices_of(evaluator.run(r.PLACEMENTS, q).X)
    out = X[steps.first]
    for k, (first, last) in enumerate(zip(steps.first, steps.of_joint, strict=True)):
        for i in range(first + 1, last + 1):
            out[k] = out[k] @ X[i]
    return {"liMi": out}


def velocities(evaluator: TableEvaluator, q: Floats, v: Floats) -> Fields:
    """`v`, `ov` and `oh` (njoints - 1, 6).

    Returns:
        The fields.
    """
    fields = dynamics(evaluator, q, v)
    return {name: fields[name] for name in ("v", "ov", "oh")}


def accelerations(evaluator: TableEvaluator, q: Floats, v: Floats, a: Floats) -> Fields:
    """`a` and `oa` (njoints - 1, 6).

    Returns:
        The fields.
    """
    out = evaluator.run(r.MOTION, q, v, a)
    A = evaluator.of_joints(out.A)
    return {"a": A, "oa": in_world(evaluator.of_joints(out.T), A)}


def dynamics(
    evaluator: TableEvaluator, q: Floats, v: Floats, a: Floats | None = None, F: Floats | None = None
) -> Fields:
    """Velocities, momenta, accelerations relative to free fall and forces of joints (njoints - 1, 6).

    Args:
        F: Forces on the joints (njoints - 1, 6) [N, N m].

    Returns:
        The fields, and under `f[0]` and `of[0]` the force of the base on the joints that stand on it (6,) [N, N m].
    """
    out = evaluator.run(r.DYNAMICS, q, v, a, F)
    T, V, A, H, W = (evaluator.of_joints(x) for x in (out.T, out.V, out.A, out.H, out.F))
    fall = np.concatenate([evaluator.gravity, np.zeros(3)])
    oa_gf, of = in_world(T, A), wrenches_in_world(T, W)
    on_the_base = of[evaluator.stand_on_base()].sum(axis=0)
    return {
        **{"v": V, "h": H, "a_gf": A, "f": W, "ov": in_world(T, V)},
        **{"oh": wrenches_in_world(T, H), "of": of, "oa_gf": oa_gf, "oa": oa_gf + fall},
        **{"f[0]": on_the_base, "of[0]": on_the_base},
    }


def statics(evaluator: TableEvaluator, q: Floats, F: Floats) -> Fields:
    """Accelerations relative to free fall and forces of joints at rest (njoints - 1, 6); see `dynamics`.

    Args:
        F: Forces on the joints (njoints - 1, 6) [N, N m].

    Returns:
        The fields.
    """
    return dynamics(evaluator, q, np.zeros(len(evaluator.armature)), None, F)


def subtree_momenta(evaluator: TableEvaluator, q: Floats, v: Floats, a: Floats) -> Fields:
    """Momenta and their rates of all that each joint moves: `h`, `f`, `oh`, `of` (njoints - 1, 6).

    Returns:
        The fields.
    """
    out = evaluator.run(r.MOTION, q, v, a)
    Y = inertias_in_world(out.T, evaluator.inertias)
    V, A = in_world(out.T, out.V), in_world(out.T, out.A)
    momenta = spatial_products(Y, V)
    rates = spatial_products(Y, A) + twist_rates_of_momenta(V, momenta)
    oh, of = (evaluator.of_joints(evaluator.subtree_sums(x)) for x in (momenta, rates))
    T = evaluator.of_joints(out.T)
    return {"oh": oh, "of": of, "h": _into_moving(T, oh), "f": _into_moving(T, of)}


def _into_moving(T: Floats, wrenches: Floats) -> Floats:
    """Wrenches in the world (n, 6), in moving frames; T holds their placements, (n, 12)."""
    R, p = T[:, :9].reshape(-1, 3, 3), T[:, 9:]
    moments = wrenches[:, 3:] - np.cross(p, wrenches[:, :3])
    return np.concatenate([np.einsum("nji,nj->ni", R, x) for x in (wrenches[:, :3], moments)], axis=1)


def subtree_centers(evaluator: TableEvaluator, *state: Floats) -> Fields:
    """`com`, `vcom` and `acom` of what each joint moves, in its frame (njoints - 1, 3); nan without mass.

    Args:
        evaluator: The evaluator, whose parameters are loaded.
        *state: q (nq,), then v (nv,), then a (nv,), as far as they are known.

    Returns:
        The fields that follow from the state.
    """
    rest = np.zeros(len(evaluator.armature))
    q, v, a, *_ = *state, rest, rest
    out = evaluator.run(r.MASS, q)
    B, T = evaluator.of_joints(out.B).copy(), evaluator.of_joints(out.T).copy()
    R = T[:, :9].reshape(-1, 3, 3)
    with np.errstate(all="ignore"):
        fields: dict[str, Any] = {"com": B[:, 1:4] / B[:, :1]}
        momenta = subtree_momenta(evaluator, q, v, a) if len(state) > 1 else {}
        for name, source in (("vcom", "oh"), ("acom", "of"))[: len(state) - 1]:
            fields[name] = np.einsum("nji,nj->ni", R, momenta[source][:, :3] / B[:, :1])
    return fields


def subtree_masses(evaluator: TableEvaluator) -> Floats:
    """The mass of what each joint moves, that of all first (njoints,)."""
    masses = evaluator.inertias[:, :1]
    return np.concatenate([[masses.sum()], evaluator.of_joints(evaluator.subtree_sums(masses))[:, 0]])
