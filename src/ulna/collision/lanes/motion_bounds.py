"""How far points of a robot move at most when its joints move.

Source: Schwarzer, Saha and Latombe, Adaptive dynamic collision checking, IEEE Transactions on Robotics 21 (2005),
section 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ulna.algorithms.multibody.tree import Step, steps
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Model
from ulna.typing import Floats


@dataclass(frozen=True, eq=False)
class Group:
    """Spheres that move together: those of a link, or of an object that it carries.

    Attributes:
        name: Name of the link or object.
        joint: The joint that moves them.
        centres: In the frame that the joint moves, (n, 3) [m].
        radii: (n,) [m].
    """

    name: str
    joint: int
    centres: Floats
    radii: Floats


def motion_bounds(
    model: Model, groups: Sequence[Group], pairs: Iterable[tuple[int, int]]
) -> tuple[Floats, Floats]:
    """How far points of groups move at most, and how far groups approach each other, when a joint moves by one.

    A point moves by at most its distance from the axis, which is no more than the lengths of all that lies between,
    added. A joint that carries two groups moves neither towards the other.

    Args:
        model: The robot.
        groups: Spheres that move together; their surfaces are among the points.
        pairs: Numbers of groups that are checked against each other.

    Returns:
        Bounds of groups, shape (G, nq), and of pairs, (P, nq) [m/rad] for turning joints, [1] for sliding ones.

    Raises:
        InputError: If a joint turns what slides without limits.
    """
    tree = steps(model)
    columns = [
        (k, c, step.joint.idx_q + step.start_q + c)
        for k, step in enumerate(tree)
        for c in range(step.kind.nq)
    ]
    by_column = np.stack([_column_bounds(model, tree, columns, group) for group in groups])
    both = np.array(list(pairs), int).reshape(-1, 2)
    first, second = by_column[both[:, 0]], by_column[both[:, 1]]
    apart = np.where((first > 0.0) != (second > 0.0), first + second, 0.0)
    summed = np.zeros((len(by_column) + len(apart), model.nq))
    for bounds, (_, _, q) in zip(np.concatenate([by_column, apart]).T, columns, strict=True):
        summed[:, q] += bounds
    return summed[: len(by_column)], summed[len(by_column) :]


def _column_bounds(
    model: Model, tree: Sequence[Step], columns: Sequence[tuple[int, int, int]], group: Group
) -> Floats:
    """How far a point of a group moves at most when a number of a step, or its source, moves by one, (columns,)."""
    place = {(k, c): n for n, (k, c, _) in enumerate(columns)}
    length = float((np.linalg.norm(group.centres, axis=1) + group.radii).max())
    bounds = np.zeros(len(columns))
    k = next(k for k, step in enumerate(tree) if step.is_last and step.joint is model.joints[group.joint])
    while k >= 0:
        step = tree[k]
        for c, motion in enumerate(step.subspace()):
            turning, sliding = (float(np.linalg.norm(part)) for part in (motion.angular, motion.linear))
            if turning and not np.isfinite(length):
                raise InputError(
                    f"Joint {step.joint.name!r} turns what slides without limits, so nothing bounds how far "
                    f"{group.name!r} moves when it turns; expected limits of the sliding joint."
                )
            bounds[place[k, c]] = abs(step.multiplier) * (sliding + (turning * length if turning else 0.0))
        length += float(np.linalg.norm(step.placement.translation)) + _travel(model, step)
        k = step.parent
    return bounds


def _travel(model: Model, step: Step) -> float:
    """How far a joint can slide from its zero [m]."""
    total = 0.0
    for c, motion in enumerate(step.subspace()):
        sliding, column = float(np.linalg.norm(motion.linear)), step.joint.idx_q + step.start_q + c
        if sliding:
            farthest = max(abs(model.lower_position[column]), abs(model.upper_position[column]))
            mimic = step.joint.mimic
            if mimic is not None:
                farthest = abs(mimic.offset) + abs(mimic.multiplier) * farthest
            total += sliding * farthest
    return total
