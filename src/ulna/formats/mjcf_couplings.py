"""The equalities of joints in a compiled MJCF file as mimic joints: who follows whom, and which equalities are left.

Every equality q1 - r1 = c0 + c1 (q2 - r2), with the rest positions r, is an edge between two joints. The edges of a
spanning forest become mimic joints, turned round where that is needed; an edge more is either true already or not.

Source: MuJoCo documentation, "XML reference", equality/joint.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

CONNECT, WELD, SAME_JOINTS, TENDONS = range(4)
"""mjtEq."""

Relation = tuple[float, float]
"""(multiplier, offset): q = multiplier q_other + offset."""


@dataclass(frozen=True)
class Couplings:
    """How the joints of a file follow one another.

    Attributes:
        followed: for each joint that follows another, by index: the index of that one, multiplier, offset.
        expressed: indices of the equalities that these relations express.
    """

    followed: dict[int, tuple[int, float, float]]
    expressed: frozenset[int]

    def by_leader(self) -> dict[int, list[tuple[int, float, float]]]:
        """By joint that follows none, the joints that follow it, others between them or not, as in `followed`."""
        found: dict[int, list[tuple[int, float, float]]] = {}
        for j, (first, *numbers) in self.followed.items():
            leader, relation = first, (numbers[0], numbers[1])
            while leader in self.followed:
                leader, multiplier, offset = self.followed[leader]
                relation = _after(relation, (multiplier, offset))
            found.setdefault(leader, []).append((j, *relation))
        return found


def couplings(m: Any, equalities_on: bool = True) -> Couplings:
    """The couplings of a compiled model, those that are active when it starts.

    Args:
        m: The compiled `mujoco.MjModel`.
        equalities_on: Whether the file enables equalities.

    Returns:
        Which joint follows which other one, and the equalities that this expresses.
    """
    edges = {e: _edge(m, e) for e in range(m.neq) if _is_linear(m, e)} if equalities_on else {}
    neighbours: dict[int, list[tuple[int, int, Relation]]] = {}
    for e, (one, two, relation) in edges.items():
        neighbours.setdefault(one, []).append((e, two, _inverse(relation)))
        neighbours.setdefault(two, []).append((e, one, relation))
    followers = {one for one, _, _ in edges.values()}
    order = [*(j for j in neighbours if j not in followers), *neighbours]
    from_root: dict[int, Relation] = {}
    followed: dict[int, tuple[int, float, float]] = {}
    for root in order:
        if root in from_root:
            continue
        from_root[root] = (1.0, 0.0)
        waiting = [root]
        while waiting:
            leader = waiting.pop()
            for _, other, relation in neighbours[leader]:
                if other not in from_root:
                    from_root[other] = _after(relation, from_root[leader])
                    followed[other] = (leader, *relation)
                    waiting.append(other)
    expressed = {e for e, (one, two, r) in edges.items() if _same(from_root[one], _after(r, from_root[two]))}
    return Couplings(followed, frozenset(expressed))


def reason_omitted(m: Any, e: int) -> tuple[str, str, str]:
    """Why an equality is not expressed by a mimic joint.

    Args:
        m: The compiled `mujoco.MjModel`.
        e: The index of the equality.

    Returns:
        Its element, what is missing from the model, and what to do about it.
    """
    kind = int(m.eq_type[e])
    if kind in (CONNECT, WELD):
        return (
            f"<{'connect' if kind == CONNECT else 'weld'}>",
            "closed loops are not in the model.",
            "Pass ulna.formats.mjcf_loops.loops_from_mjcf(file) to the constrained dynamics.",
        )
    if kind != SAME_JOINTS:
        name = "tendon" if kind == TENDONS else "flex"
        return f"<equality><{name}>", f"equalities of {name}s are not kept.", "Use <equality><joint>."
    if m.eq_obj2id[e] < 0 or not np.any(m.eq_data[e, 1:5]):
        return (
            "<equality><joint>",
            "joints held at a constant are free here.",
            "Lock them: robot.lock({...}).",
        )
    if np.any(m.eq_data[e, 2:5]) or not m.eq_data[e, 1]:
        return (
            "<equality><joint polycoef>",
            "couplings that are not linear are not kept.",
            "Make them linear.",
        )
    return "<equality><joint>", "couplings that contradict others are not kept.", "Remove all but one."


def _is_linear(m: Any, e: int) -> bool:
    line = m.eq_type[e] == SAME_JOINTS and not np.any(m.eq_data[e, 2:5]) and m.eq_data[e, 1] != 0.0
    return bool(line and m.eq_obj2id[e] >= 0 and m.eq_obj1id[e] != m.eq_obj2id[e] and m.eq_active0[e])


def _edge(m: Any, e: int) -> tuple[int, int, Relation]:
    one, two = int(m.eq_obj1id[e]), int(m.eq_obj2id[e])
    c0, c1 = (float(c) for c in m.eq_data[e, :2])
    r1, r2 = (float(m.qpos0[m.jnt_qposadr[j]]) for j in (one, two))
    return one, two, (c1, c0 + r1 - c1 * r2)


def _inverse(relation: Relation) -> Relation:
    k, d = relation
    return 1.0 / k, -d / k


def _after(outer: Relation, inner: Relation) -> Relation:
    return outer[0] * inner[0], outer[0] * inner[1] + outer[1]


def _same(one: Relation, two: Relation) -> bool:
    return bool(np.allclose(one, two, rtol=1e-9, atol=1e-12))
