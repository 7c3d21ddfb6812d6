"""The joints between two links, and how the links stand to each other.

Each joint is on the way up from one of the links to what carries both. A joint's frame on the side of a link is its
moving frame where it carries the link, else its fixed frame; its twist is the same in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from ulna.algorithms.multibody.batch_shapes import broadcast_pose
from ulna.algorithms.multibody.tree import Step, steps
from ulna.model import Model
from ulna.spatial import SE3, Motion
from ulna.typing import Floats


@final
@dataclass(frozen=True)
class ChainJoint:
    """A joint between two links.

    Attributes:
        step: The elementary joint.
        is_upward: Whether it is above the first link: its moving frame is on the side of the first link.
        column: The number of a configuration that moves it.
    """

    step: Step
    is_upward: bool
    column: int


@final
@dataclass(frozen=True, eq=False)
class JointChain:
    """The joints between two links, from the first link to the second.

    Attributes:
        joints: The joints.
        columns: The numbers of a configuration that move them.
    """

    joints: tuple[ChainJoint, ...]
    columns: tuple[int, ...]

    def is_periodic(self, column: int) -> bool:
        """Whether a whole turn of a number of the configuration leaves everything as it was."""
        moved = [joint.step for joint in self.joints if joint.column == column]
        return all(
            not np.any(motion.linear) and float(step.multiplier).is_integer()
            for step in moved
            for motion in step.subspace()
        )

    def poses(self, q: Floats) -> tuple[SE3, list[SE3], list[SE3]]:
        """How the links stand.

        Args:
            q: Configurations, shape (n, nq) [rad, m].

        Returns:
            T_a_b, shape (n,), and for each joint the pose of a in its frame on the side of a, and that of b on the side
            of b, with the frames of the links' joints, shape (n,), or one for all configurations [m].
        """
        _, of_first = _walk(self.joints, q)
        reverse = [ChainJoint(j.step, not j.is_upward, j.column) for j in reversed(self.joints)]
        T_a_b, of_second = _walk(reverse, q)
        # Joints that only slide leave one rotation for all configurations.
        return broadcast_pose(T_a_b, q), of_first, of_second[::-1]

    def widths(self, half: Floats) -> Floats:
        """Half widths of a cell by joint, shape (joints,), from those by column, shape (columns,) [rad, m]."""
        return np.array([abs(j.step.multiplier) * half[self.columns.index(j.column)] for j in self.joints])

    @property
    def turning(self) -> Floats:
        """How fast each joint turns, shape (joints,) [1], [rad/m]."""
        return np.array([float(np.linalg.norm(motion.angular)) for motion in self.twists])

    @property
    def twists(self) -> list[Motion]:
        """S of each joint."""
        return [joint.step.subspace()[0] for joint in self.joints]


def _walk(joints: Sequence[ChainJoint], q: Floats) -> tuple[SE3, list[SE3]]:
    """Passes the joints from a link on: its pose in the last frame, and in each joint's frame on its side."""
    X, on_side = SE3.identity(), []
    for joint in joints:
        J = joint.step.transform(q)
        if joint.is_upward:
            on_side.append(X)
            X = joint.step.placement @ (J @ X)
        else:
            X = joint.step.placement.inverse() @ X
            on_side.append(X)
            X = J.inverse() @ X
    return X, on_side


def joint_chain(model: Model, a: str, b: str) -> JointChain | None:
    """The joints between two links.

    Args:
        model: The robot.
        a: Name of the first link.
        b: Name of the second.

    Returns:
        The joints; None where one of them is moved by more than one number.
    """
    tree = steps(model)
    up, down = (_branch(model, tree, link) for link in (a, b))
    shared = set(up) & set(down)
    numbers = [(k, True) for k in up if k not in shared] + [
        (k, False) for k in reversed(down) if k not in shared
    ]
    if any(tree[k].kind.nq != 1 or tree[k].kind.nv != 1 for k, _ in numbers):
        return None
    joints = tuple(ChainJoint(tree[k], is_up, tree[k].joint.idx_q + tree[k].start_q) for k, is_up in numbers)
    return JointChain(joints, tuple(sorted({joint.column for joint in joints})))


def _branch(model: Model, tree: Sequence[Step], link: str) -> list[int]:
    """The steps above a link, the nearest first."""
    number = model.link(link).joint
    if number < 0:
        return []
    k = next(k for k, step in enumerate(tree) if step.is_last and step.joint is model.joints[number])
    branch = []
    while k >= 0:
        branch.append(k)
        k = tree[k].parent
    return branch
