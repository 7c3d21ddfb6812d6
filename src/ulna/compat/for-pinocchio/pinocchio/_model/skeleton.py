"""What a copy of a model knows of its joints and frames besides their numbers, until lists of them are made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pinocchio._containers.arrays import StdVec
from pinocchio._model.frame import Facts
from pinocchio._model.joint_model import JointModel
from pinocchio._model.row_storage import RowStorage
from ulna.typing import Floats

Structure = TypeVar("Structure")

SLOTS = {"placements": "_m", "inertias": "_p", "frames": "_m"}
"""The attribute in which joints' placements and inertias, and frames' placements, hold their arrays."""
Attributes = tuple[type[JointModel], dict[str, Any]]
"""The class and the attributes of a joint."""
_PER_Q, _PER_V, _GRAVITY = 3, 10, 6


class Skeleton(NamedTuple):
    """Joints and frames of a model without their numbers. Nothing of it changes, so copies share it.

    Attributes:
        names: The name of each joint.
        parents: For each joint, the joint before it.
        joints: The class and the attributes of each joint.
        frames: What is known of each frame; see `Frame._facts_now`.
        nq: How many entries of q there are.
        nv: How many entries of v there are.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    joints: tuple[Attributes, ...]
    frames: tuple[Facts, ...]
    nq: int
    nv: int

    def row_blocks(self, numbers: Floats) -> tuple[Floats, Floats, Floats]:
        """Placements, inertias and frames, which lie one after the other.

        Args:
            numbers: All numbers of a model (n,); see `gathered` [any].

        Returns:
            Views (n, 4, 4), (n, 13) and (m, 4, 4).
        """
        joints, frames = len(self.joints), len(self.frames)
        first, second = 16 * joints, 29 * joints
        return (
            numbers[:first].reshape(joints, 4, 4),
            numbers[first:second].reshape(joints, 13),
            numbers[second : second + 16 * frames].reshape(frames, 4, 4),
        )

    def rows(self, numbers: Floats) -> dict[str, RowStorage]:
        """Storages of placements, inertias and frames, by these names.

        Args:
            numbers: All numbers of a model (n,) [any].

        Returns:
            The storages.
        """
        blocks = self.row_blocks(numbers)
        return {
            name: RowStorage(slot, block) for (name, slot), block in zip(SLOTS.items(), blocks, strict=True)
        }

    def array_blocks(self, numbers: Floats) -> list[Floats]:
        """The arrays with entries for each q, as rows, and those with entries for each v.

        Args:
            numbers: All numbers of a model (n,) [any].

        Returns:
            Both blocks (k, nq) and (k, nv).
        """
        first, last = numbers.size - _GRAVITY - _PER_V * self.nv, numbers.size - _GRAVITY
        per_q = numbers[first - _PER_Q * self.nq : first]
        return [per_q.reshape(_PER_Q, self.nq), numbers[first:last].reshape(_PER_V, self.nv)]


def gravity_of(numbers: Floats) -> Floats:
    """The acceleration of free fall (6,) among all numbers of a model."""
    return numbers[-_GRAVITY:]


def gathered(rows: Iterable[Floats], array_blocks: Iterable[Floats], gravity: Floats) -> Floats:
    """All numbers of a model in one new array.

    Args:
        rows: The blocks of placements, inertias and frames (n, ...), in this order.
        array_blocks: The arrays with entries for each q, as rows (k, nq), and those for each v (k, nv).
        gravity: The acceleration of free fall (6,) [m/s^2].

    Returns:
        Array (n,).
    """
    return np.concatenate([x.reshape(-1) for x in (*rows, *array_blocks, gravity)])


def renumbered(
    joints: Iterable[tuple[Attributes, Mapping[int, int] | Sequence[int]]],
) -> tuple[tuple[Attributes, ...], tuple[Any, ...], int]:
    """Joints that become those of another model, in this order.

    Args:
        joints: The joints, the universe first, each with the new indices of the joints of its former model.

    Returns:
        The joints with their new indices, their layout (see `KernelCache._layout`), and how many velocities they have,
        those of mimic joints counted.
    """
    out: list[Attributes] = []
    layouts: list[tuple[str, int, int]] = []
    nq = nv = extended = 0
    for new, ((kind, old), new_of) in enumerate(joints):
        joint = old
        if new:
            at, followed = (nq, nv), old["mimic"]
            if followed is not None:
                leader = new_of[followed[0]]
                followed, at = (leader, *followed[1:]), layouts[leader][1:]
            changed = {
                "id": new, "idx_q": at[0], "idx_v": at[1], "idx_vExtended": extended, "mimic": followed
            }  # fmt: skip
            joint = old | changed
            nq, nv, extended = nq + joint["nq"], nv + joint["nv"], extended + joint["kind"].nv
        out.append((kind, joint))
        layouts.append((joint["_shortname"], joint["idx_q"], joint["idx_v"]))
    return tuple(out), tuple(layouts), extended


def joints_with(attributes: Iterable[Attributes]) -> StdVec[JointModel]:
    """New joints of these classes and attributes."""
    return StdVec(kind._of_attributes(values) for kind, values in attributes)


_MOST_REMEMBERED = 16


def remembered(known: dict[Any, Structure], key: Any, made: Structure) -> Structure:
    """Keeps what was made for models with the same joints and frames, as the newest of a few.

    Args:
        known: What is kept, the newest last.
        key: What the models have in common.
        made: What was made for them.

    Returns:
        The same.
    """
    known.pop(key, None)
    known[key] = made
    for oldest in list(known)[:-_MOST_REMEMBERED]:
        known.pop(oldest, None)
    return made
