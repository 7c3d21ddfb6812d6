"""The recursions over the tree of joints, factored out once for every algorithm.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| i, p(i) | a step and its parent; the world is -1 | | | p(i) < i |
| P | pose of the step's fixed frame in the moving frame of p(i) | SE3 | [m] | constant |
| J(q) | pose of the moving frame in the fixed frame | SE3 | [m] | joint kind |
| X | pose of the moving frame in the moving frame of p(i) | SE3 | [m] | X = P J(q) |
| S | motion subspace, written in the moving frame | nv Motions | [1] or [m/rad] | constant |
| T | pose of the moving frame in the world | SE3 | [m] | T_i = T_p(i) X_i |

Source: Featherstone, sections 4.1 to 4.4. A *step* is a joint, or one part of a joint that is made of parts
(composite, cylindrical, universal, chains of turns; see `JointKind.elementary_joints`). Unfolding joints into steps
makes every S constant in its own moving frame, so that no algorithm needs a derivative of S. Only the last step of a
joint carries links and frames. The steps of a mimic joint have positions that are affine in that of its source; their
columns of S, times the multiplier, belong to the source's velocity. Several turns of a chain follow one of its angles
in the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from ulna.data_classes import dataclass
from ulna.model import Frame, Helical, Joint, JointKind, Model, Prismatic, Revolute
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Step:
    """One elementary joint of the tree; its motion subspace is constant in its moving frame."""

    joint: Joint
    """The joint it is, or is a part of."""
    parent: int
    """Its parent, as an index into the sequence of steps; -1 for the world."""
    placement: SE3
    """P."""
    kind: JointKind
    start_q: int
    """Where its position begins in the joint's position."""
    start_v: int
    """Where its velocity begins in the joint's velocity."""
    is_last: bool
    """Whether its moving frame is the joint's, which carries links and frames."""
    offset: float = 0.0
    """What is added to the angle of a revolute joint; see link_frames.py."""
    ratio: float = 1.0
    """Its position as a multiple of the joint's; other than 1 for the turns of a `TurnChain` only."""

    @property
    def multiplier(self) -> float:
        """Its velocity as a multiple of the entry of v that moves it; 1 but for mimic joints and turns of chains."""
        mimic = self.joint.mimic
        return self.ratio if mimic is None else self.ratio * mimic.multiplier

    @property
    def shift(self) -> float:
        """Its position where the entries of q that move it are zero: that of a mimic joint, and `offset` [rad or m]."""
        mimic = self.joint.mimic
        return self.offset if mimic is None else self.ratio * mimic.offset + self.offset

    @property
    def indices(self) -> range:
        """Where its velocity, or for a mimic joint that of its source, stands in `v`."""
        start = self.joint.idx_v + self.start_v
        return range(start, start + self.kind.nv)

    def subspace(self) -> tuple[Motion, ...]:
        """S: its columns in the moving frame."""
        return self.kind.motion_subspace(self.kind.neutral())

    def columns(self) -> list[tuple[int, Motion]]:
        """The columns of S, times the multiplier, and the entry of `v` that each belongs to."""
        return [(k, s * self.multiplier) for k, s in zip(self.indices, self.subspace(), strict=True)]

    def transform(self, q: Array) -> SE3:
        """J(q)."""
        position = self.joint.q_of(q)[..., self.start_q : self.start_q + self.kind.nq]
        if self.ratio != 1.0:
            position = self.ratio * position
        return self.kind.transform(position + self.offset if self.offset else position)

    def pose(self, T: SE3 | None, q: Array) -> SE3:
        """The pose of the moving frame from that of the parent.

        Args:
            T: Pose of the parent's moving frame [m]; None for the world's.
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            T P J(q) [m].
        """
        fixed = self.placement if T is None else T @ self.placement
        return fixed @ self.transform(q)

    @property
    def moves_along_one_screw(self) -> bool:
        """Whether S is the same in the fixed frame, since J(q) turns about and slides along its one axis."""
        return isinstance(self.kind, (Revolute, Prismatic, Helical))

    def pose_in_parent(self, T: SE3, q: Array) -> SE3:
        """A pose in the moving frame, in the parent's moving frame.

        Args:
            T: A pose in the moving frame [m].
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            P J(q) T [m].
        """
        return self.placement @ (self.transform(q) @ T)

    def motion_from_parent(self, motion: Motion, q: Array) -> Motion:
        """X^-1 acting on a twist of the parent's moving frame.

        Args:
            motion: A twist in the parent's moving frame.
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            The same twist in the moving frame.
        """
        return self.transform(q).act_inverse(self.placement.act_inverse(motion))

    def force_to_parent(self, force: Force, q: Array) -> Force:
        """X acting on a wrench of the moving frame.

        Args:
            force: A wrench in the moving frame.
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            The same wrench in the parent's moving frame.
        """
        return self.placement.act(self.transform(q).act(force))

    def motion(self, v: Array) -> Motion:
        """S times the part of `v` that moves this step, in the moving frame; likewise of an acceleration."""
        part = self.joint.v_of(v)
        columns = self.subspace() if self.ratio == 1.0 else [s * self.ratio for s in self.subspace()]
        terms = [column * part[..., self.start_v + k] for k, column in enumerate(columns)]
        total = terms[0]
        for term in terms[1:]:
            total = total + term
        return total


def steps(model: Model, joints: Iterable[int] | None = None) -> tuple[Step, ...]:
    """The steps of some joints, or of all.

    Args:
        model: The robot.
        joints: Ascending indices; with every joint, its ancestors; None for all joints.

    Returns:
        The steps, parents first.
    """
    tree: list[Step] = []
    last_of = {-1: -1}
    for index in range(len(model.joints)) if joints is None else joints:
        joint = model.joints[index]
        parent = last_of[joint.parent]
        parts = joint.kind.elementary_joints(joint.placement)
        for k, (placement, kind, q, v, ratio) in enumerate(parts, start=1):
            tree.append(Step(joint, parent, placement, kind, q, v, k == len(parts), ratio=ratio))
            parent = len(tree) - 1
        last_of[index] = parent
    return tuple(tree)


def shares_velocities(model: Model) -> bool:
    """Whether an entry of v moves several steps: of mimic joints and their sources, and of chains of turns."""
    return (
        any(joint.mimic is not None for joint in model.joints)
        or sum(s.kind.nv for s in steps(model)) > model.nv
    )


def chain(model: Model, frame: Frame) -> tuple[Step, ...]:
    """The steps between the world and a frame.

    Args:
        model: The robot.
        frame: A frame of the model.

    Returns:
        The steps, root first: each is the parent of the next.
    """
    return steps(model, model.support(frame.joint) if frame.joint >= 0 else ())


def outward(tree: Sequence[Step], root: Value, f: Callable[[Step, Value], Value]) -> list[Value]:
    """Values that grow from the root: value_i = f(step_i, value_p(i)).

    Args:
        tree: The steps, parents first.
        root: The value of the world.
        f: Makes the value of a step from that of its parent.

    Returns:
        One value a step.
    """
    values: list[Value] = []
    for step in tree:
        values.append(f(step, values[step.parent] if step.parent >= 0 else root))
    return values


def inward(tree: Sequence[Step], values: Sequence[Any], f: Callable[[Step, Any], Any]) -> list[Any]:
    """Values summed towards the root: value_p(i) += f(step_i, value_i), the leaves first.

    Args:
        tree: The steps, parents first.
        values: One value a step.
        f: Takes a step and its value to what is added to the value of its parent.

    Returns:
        The sums, one a step.
    """
    sums = list(values)
    for step, i in zip(reversed(tree), reversed(range(len(tree))), strict=True):
        if step.parent >= 0:
            sums[step.parent] = sums[step.parent] + f(step, sums[i])
    return sums


def sum_in_world(
    tree: Sequence[Step], values: Sequence[Any], world: Any, f: Callable[[Step, Any], Any]
) -> Any:
    """The sum of f(step_i, value_i) over the steps whose parent is the world, after `inward`, added to `world`.

    Args:
        tree: The steps, parents first.
        values: One value a step.
        world: What the sum is added to.
        f: Takes a step and its value to what is added to the value of its parent, or of the world.

    Returns:
        The sum.
    """
    for step, value in zip(tree, inward(tree, values, f), strict=True):
        if step.parent < 0:
            world = world + f(step, value)
    return world


def poses(tree: Sequence[Step], q: Array) -> list[SE3]:
    """The pose of the moving frame of every step in the world.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        T of every step [m].
    """
    root: Any = None
    return outward(tree, root, lambda step, T: step.pose(T, q))


def tip_pose(tree: Sequence[Step], q: Array, placement: SE3) -> SE3:
    """The pose in the world of a frame on the last body of a chain; the last joint and the frame are composed first.

    Args:
        tree: The steps of a chain, root first.
        q: Configuration, shape (..., nq) [rad, m].
        placement: Pose of the frame in the moving frame of the last step [m].

    Returns:
        T of the last step, times `placement` [m].
    """
    if not tree:
        return placement
    *proximal, last = tree
    tip = last.transform(q) @ placement
    fixed = poses(proximal, q)[-1] @ last.placement if proximal else last.placement
    return fixed @ tip
