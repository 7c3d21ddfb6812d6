"""A roadmap that many plans share: free configurations, joined by free straight motions.

Source: Kavraki, Svestka, Latombe and Overmars, Probabilistic roadmaps for path planning in high-dimensional
configuration spaces (IEEE T-RA 1996). How many neighbours each node needs: Karaman and Frazzoli, Sampling-based
algorithms for optimal motion planning (IJRR 2011), section 3.3: k >= e (1 + 1/n) log(nodes).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import Array1, Array2, Kernel, f32, procedure
from ulna.data_classes import dataclass
from ulna.errors import InputError, needed
from ulna.planning.edges import edge_touches
from ulna.planning.goals import joint_of_column
from ulna.planning.run import Run
from ulna.planning.samples import samples
from ulna.planning.scenes import PlanningScene
from ulna.planning.search import Search
from ulna.planning.workspace import COARSE, Workspace
from ulna.typing import Floats


@procedure(constants={"W": 8})
def which_edges_touch(
    kernel: Kernel, tables: Tables, step: f32, starts: Array2[f32], ends: Array2[f32], touching: Array1[f32],
    count: int, work: Work, W: int,
) -> int:  # fmt: skip
    """Writes 1 for each straight motion on which, or at whose end, anything touches, else 0.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        step: How far anything moves at most between checked states [m].
        starts: Where the motions begin, shape (at least count, n) [rad, m].
        ends: Where they end, shape (at least count, n) [rad, m].
        touching: Receives the answers, shape (at least count,).
        count: How many motions there are.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        How many touch.
    """
    total = 0
    for i in range(count):
        touching[i] = f32(0.0)
        if edge_touches(kernel, tables, step, starts[i], ends[i], work, W):
            touching[i] = f32(1.0)
            total += 1
    return total


_AT_ONCE = 1024  # motions that one call of machine code looks at: some hundredths of a second


@dataclass(frozen=True, eq=False)
class Roadmap:
    """Free configurations and free straight motions between them.

    Attributes:
        nodes: Configurations, shape (n, nq) [rad, m].
        edges: Pairs of nodes, shape (m, 2).
        lengths: Lengths of the edges, shape (m,) [rad, m].
        tree: Finds nearest nodes (a KD-tree of scipy).
    """

    nodes: Floats
    edges: Any
    lengths: Floats
    tree: Any

    @property
    def neighbours(self) -> int:
        """How many nearest nodes each configuration is joined to."""
        count = np.e * (1.0 + 1.0 / self.nodes.shape[1]) * np.log(max(len(self.nodes), 2))
        return min(int(np.ceil(count)), len(self.nodes))


class RoadmapSearch(Search):
    """Searches along a roadmap, and with trees where that joins start and goal not.

    Args:
        scene: The robot and the world.
        margin: How near everything may come at least [m].
        step: How far any point moves at most between the states by which paths are proved free [m].
        longest: The longest edge of the trees [rad, m].
        size: How many samples the roadmap is made of.

    Raises:
        InputError: If a joint has no limits.
        MissingExtra: If scipy is not installed.
    """

    _starts_at_once = False

    def __init__(self, scene: PlanningScene, margin: float, step: float, longest: float, size: int) -> None:
        super().__init__(scene, margin, step, longest)
        if not self._box.is_bounded:
            name = joint_of_column(self._model, int(np.flatnonzero(~self._box.has_limit)[0]))
            raise InputError(f"Joint {name!r} has no limits; a roadmap needs limits of all joints.")
        self.roadmap = self._built(size)

    def _built(self, size: int) -> Roadmap:
        with needed("scipy", "collision", "Making a roadmap"):
            from scipy.spatial import KDTree
        workspace = self._workspace(COARSE[0])
        q = samples(0, size, 0, self._model.lower_position, self._model.upper_position)
        nodes = q[~_touching(workspace, q, q)]
        roadmap = Roadmap(nodes.astype(float), np.zeros((0, 2), int), np.zeros(0), None)
        if not len(nodes):
            return roadmap
        tree: Any = KDTree(nodes)
        distances, others = tree.query(nodes, k=range(1, min(roadmap.neighbours + 1, len(nodes)) + 1))
        own = np.repeat(np.arange(len(nodes)), others.shape[1])
        pairs = np.stack([own, others.ravel()], axis=1)
        is_new = pairs[:, 0] < pairs[:, 1]
        is_new |= ~(others[others] == np.arange(len(nodes))[:, None, None]).any(axis=2).ravel()
        is_new &= pairs[:, 0] != pairs[:, 1]
        pairs, lengths = pairs[is_new], distances.ravel()[is_new]
        free = ~_touching(workspace, nodes[pairs[:, 0]], nodes[pairs[:, 1]])
        return Roadmap(roadmap.nodes, pairs[free], lengths[free], tree)

    def _grow(self, run: Run) -> bool:
        if (
            run.options.fixed_coordinates is not None
            or run.options.coarse != COARSE[0]
            or self.roadmap.tree is None
        ):
            return super()._grow(run)
        shortest = self._shortest_path(run)
        if shortest is None:
            return super()._grow(run)
        nodes, goal = shortest
        run.workspace.grow(0, 0, run.roots)  # start and goals, without samples
        while len(nodes) + 64 > run.workspace.storage.trees.nodes.shape[2]:
            run.workspace.storage.enlarge_trees()
        trees = run.workspace.storage.trees
        count = 1 + len(nodes)
        trees.nodes[0, :, 1:count] = self.roadmap.nodes[nodes].T
        trees.parents[0, 1:count], trees.counts[0] = np.arange(count - 1), count
        trees.meeting[:] = count - 1, goal
        return True

    def _shortest_path(self, run: Run) -> tuple[Any, int] | None:
        """The nodes of the shortest path from the start to a goal, and the goal's number; None where there is none."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        roadmap, ends = self.roadmap, np.vstack([run.q0, run.goals])
        size, total = len(roadmap.nodes), len(roadmap.nodes) + len(ends)
        distances, near = roadmap.tree.query(ends, k=range(1, roadmap.neighbours + 1))
        end = np.repeat(np.arange(len(ends)), near.shape[1])
        free = ~_touching(run.workspace, roadmap.nodes[near.ravel()], ends[end])
        rows = np.concatenate([roadmap.edges[:, 0], size + end[free]])
        columns = np.concatenate([roadmap.edges[:, 1], near.ravel()[free]])
        weights = np.concatenate([roadmap.lengths, distances.ravel()[free]])
        graph = csr_matrix((weights, (rows, columns)), shape=(total, total))
        lengths, before = dijkstra(graph, directed=False, indices=size, return_predecessors=True)
        goal = int(lengths[size + 1 :].argmin())
        if not np.isfinite(lengths[size + 1 + goal]):
            return None
        path, at = [], int(before[size + 1 + goal])
        while at != size:
            path.append(at)
            at = int(before[at])
        if any(node > size for node in path):  # through another goal, which is nearer
            goal = next(node for node in reversed(path) if node > size) - size - 1
            path = path[max(k for k, node in enumerate(path) if node > size) + 1 :]
        return np.array(path[::-1], int), goal


def _touching(workspace: Workspace, starts: Floats, ends: Floats) -> Any:
    """On which straight motions anything touches, truth values (n,)."""
    a, b = (np.ascontiguousarray(q, np.float32) for q in (starts, ends))
    touching = np.zeros(len(a), np.float32)
    for first in range(0, len(a), _AT_ONCE):  # Ctrl-C is heard in between
        part = slice(first, first + _AT_ONCE)
        rows = a[part], b[part], touching[part]
        workspace.call(which_edges_touch, workspace.step, *rows, len(rows[0]))
    return touching > 0.0
