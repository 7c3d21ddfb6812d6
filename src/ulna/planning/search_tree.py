"""The trees of a search, as a plan keeps them: for pictures, and to see where a search got stuck."""

from __future__ import annotations

from typing import final

import numpy as np

from ulna.data_classes import dataclass
from ulna.planning.trees import Trees
from ulna.typing import Array, Floats


@final
@dataclass(frozen=True, eq=False)
class SearchTree:
    """The configurations that a search reached, and from which others.

    Attributes:
        nodes: Configurations, shape (n, nq) [rad, m].
        parents: The number of the node that each was reached from, -1 for the start and the goals, shape (n,).
        is_from_start: Whether it belongs to the tree of the start; the others belong to that of the goals, shape (n,).
    """

    nodes: Floats
    parents: Array
    is_from_start: Array

    def __len__(self) -> int:
        return len(self.nodes)

    @property
    def edges(self) -> Array:
        """Numbers of the two nodes of each straight motion, shape (m, 2) [-]."""
        children = np.flatnonzero(self.parents >= 0)
        return np.column_stack([self.parents[children], children])

    def __repr__(self) -> str:
        first = int(self.is_from_start.sum())
        return f"<search tree, {first} configurations from the start, {len(self) - first} from the goals>"


def search_tree(trees: Trees) -> SearchTree:
    """A copy of both trees.

    Args:
        trees: As the search left them [rad, m].

    Returns:
        The nodes of both, those from the start first.
    """
    counts = trees.counts.tolist()
    nodes = np.concatenate([trees.nodes[k, :, :n].T for k, n in enumerate(counts)]).astype(float)
    first, second = (trees.parents[k, :n] for k, n in enumerate(counts))
    parents = np.concatenate([first, np.where(second >= 0, second + counts[0], -1)])
    return SearchTree(nodes, parents, np.arange(len(nodes)) < counts[0])
