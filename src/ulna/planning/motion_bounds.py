"""How far points of a robot move at most when its joints move.

Source: Schwarzer, Saha and Latombe, Adaptive dynamic collision checking, IEEE Transactions on Robotics 21 (2005),
section 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ulna.algorithms.multibody.tree import Step, steps
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
    """
    tree = steps(model)
    by_step = np.stack([_step_bounds(model, tree, group) for group in groups])
    both = np.array(list(pairs), int).reshape(-1, 2)
    first, second = by_step[both[:, 0]], by_step[both[:, 1]]
    apart = np.where((first > 0.0) != (second > 0.0), first + second, 0.0)
    columns = np.zeros((len(tree), model.nq))
    columns[np.arange(len(tree)), [step.joint.idx_q for step in tree]] = 1.0
    return by_step @ columns, apart @ columns


def _step_bounds(model: Model, tree: Sequence[Step], group: Group) -> Floats:
    """How far a point of a group moves at most when a step's source moves by one, shape (steps,)."""
    length = float((np.linalg.norm(group.centres, axis=1) + group.radii).max())
    bounds = np.zeros(len(tree))
    k = next(k for k, step in enumerate(tree) if step.is_last and step.joint is model.joints[group.joint])
    while k >= 0:
        step = tree[k]
        turns = float(np.linalg.norm(step.subspace()[0].angular)) > 0.0
        bounds[k] = abs(step.multiplier) * (length if turns else 1.0)
        length += float(np.linalg.norm(step.placement.translation)) + (0.0 if turns else _travel(model, step))
        k = step.parent
    return bounds


def _travel(model: Model, step: Step) -> float:
    """How far a sliding joint can slide from its zero [m]."""
    column, mimic = step.joint.idx_q, step.joint.mimic
    farthest = max(abs(model.lower_position[column]), abs(model.upper_position[column]))
    return farthest if mimic is None else abs(mimic.offset) + abs(mimic.multiplier) * farthest
