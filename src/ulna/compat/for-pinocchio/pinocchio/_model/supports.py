"""The supports of each joint of a tree: its ancestors, and their entries of v."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._containers.arrays import StdVec
from ulna.typing import Floats


def supports_of(parents: Sequence[int]) -> list[list[int]]:
    """For each joint, the joints from the universe to it.

    Args:
        parents: For each joint the joint before it, the universe first.
    """
    supports = [[0]]
    for i in range(1, len(parents)):
        supports.append([*supports[parents[i]], i])
    return supports


def subtrees_of(parents: Sequence[int]) -> list[list[int]]:
    """For each joint, the joints it moves, itself included; the universe is not counted."""
    subtrees: list[list[int]] = [[] for _ in parents]
    for i, support in enumerate(supports_of(parents)):
        for j in support if i else ():
            subtrees[j].append(i)
    return subtrees


def children_of(parents: Sequence[int]) -> list[list[int]]:
    """For each joint, the joints that follow it at once."""
    children: list[list[int]] = [[] for _ in parents]
    for i in range(1, len(parents)):
        children[parents[i]].append(i)
    return children


class Supports:
    """What a Model knows of its tree besides `supports`."""

    joints: Any
    supports: Any
    nv: int

    @property
    def span_indexes_vector(self) -> StdVec[StdVec[int]]:
        """For each joint, the entries of v that move it."""
        spans = (sorted({k for i in support for k in self._entries(i)}) for support in self.supports)
        return StdVec(StdVec(span) for span in spans)

    def _entries(self, joint: int) -> range:
        if joint == 0:  # the universe, whatever its joint says of itself
            return range(0)
        start, size = self.joints[joint].idx_v, self.joints[joint].nv
        return range(start, start + size)

    @property
    def sparsity_pattern_vector(self) -> StdVec[Any]:
        """For each joint a mask (nv,) of the entries of v that move it."""
        masks: StdVec[Floats] = StdVec()
        for span in self.span_indexes_vector:
            mask = np.zeros(self.nv, dtype=bool)
            mask[list(span)] = True
            masks.append(mask)
        return masks

    @property
    def mimic_joint_supports(self) -> StdVec[StdVec[int]]:
        """For each joint, the universe and the mimic joints among its supports."""
        return StdVec(StdVec([0, *(i for i in s[1:] if self.joints[i].mimic)]) for s in self.supports)
