"""Which values of an iteration the sweep back reads from the tape rather than computing once more: a minimum cut.

A value is read at the price of a store and a load, or computed at the price of its operation, where its operands are
read or computed as well. The cheapest choice is the minimum cut of a network with two nodes for each value, "needed"
and "computed". Sources: Dinic 1970, Algorithm for solution of a problem of maximum flow; Moses et al. 2021,
Reverse-mode automatic differentiation and optimization of GPU kernels via Enzyme (values that are cached).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial

from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import TABLE, Op

_PRICES = (6, 8, 12, 16, 24, 40)
"""Of a store, a load and the memory they take, beside a sum or a product; the first that needs little enough memory,
and where there is room the one before it for some of the values."""
_PARTNERS = {int(Op.SIN): int(Op.COS), int(Op.COS): int(Op.SIN)}
_LEAVES = frozenset(map(int, (Op.INPUT, Op.CONST, Op.BOOL, Op.LANE)))
_ALL = 1 << 40
"""A capacity that no cut goes through."""


def values_to_keep(g: Graph, values: Iterable[int], outputs: Sequence[int], most: int) -> list[int]:
    """The values that are cheaper to read than to compute.

    Args:
        g: A graph.
        values: Those of its nodes that another loop has computed, and can store.
        outputs: The nodes that are to be computed.
        most: How many values can be read.

    Returns:
        Nodes among `values`, in their order; none if even the fewest that are worth it are too many.
    """
    if most <= 0:
        return []
    live = g.live(outputs)
    known = {index for index in values if g.op[index] not in _LEAVES}
    needed = {a for index in live if index not in known for a in g.args[index]} | set(outputs)
    nodes = [index for index in live if index in known]
    place = {index: k for k, index in enumerate(nodes)}
    network = _Network(2 * len(nodes) + 2)
    source, sink = 2 * len(nodes), 2 * len(nodes) + 1
    readable = []
    for k, index in enumerate(nodes):
        is_condition = TABLE[g.op[index]].is_condition
        edge = network.edge(2 * k, 2 * k + 1, _ALL if is_condition else 0)
        if not is_condition:
            readable.append(edge)
        network.edge(2 * k + 1, sink, _cost(g, index, known))
        for a in g.args[index]:
            if a in place:
                network.edge(2 * k + 1, 2 * place[a], _ALL)
        if index in needed:
            network.edge(source, 2 * k, _ALL)
    return _affordable(network, partial(_kept, network, nodes, source, sink), readable, most)


def _affordable(
    network: _Network, kept_now: Callable[[], list[int]], readable: Sequence[int], most: int
) -> list[int]:
    """What is kept at the first price at which so many values can be read; some at the price before, if there is room.

    Args:
        network: The network, with prices of zero.
        kept_now: What is kept at the prices that it has.
        readable: The edges that have prices.
        most: How many values can be read.

    Returns:
        Nodes; none if even at the last price there are too many.
    """
    before = 0
    for price in _PRICES:
        cheaper = network.residual()
        network.raise_capacities(readable, price - before)
        kept = kept_now()
        if len(kept) > most:
            before = price
            continue
        if before:
            network.restore(cheaper)
            for edges in _parts(readable):
                network.raise_capacities(edges, price - before)
                kept = kept_now()
                if len(kept) <= most:
                    break
        return kept
    return []


def _kept(network: _Network, nodes: Sequence[int], source: int, sink: int) -> list[int]:
    """The nodes that the minimum cut reads."""
    reached = network.cut(source, sink)
    return [nodes[k] for k in range(len(nodes)) if reached[2 * k] and not reached[2 * k + 1]]


def _parts(edges: Sequence[int]) -> Iterable[Sequence[int]]:
    """Edges in eight parts, the last ones first."""
    size = -(-len(edges) // 8)
    return [edges[max(end - size, 0) : end] for end in range(len(edges), 0, -size)]


def _cost(g: Graph, index: int, known: Collection[int]) -> int:
    """About how many sums take as long as a node; a sine is free where its cosine is computed anyway."""
    partner = _PARTNERS.get(g.op[index])
    other = None if partner is None else g.find(partner, *g.args[index])
    return TABLE[g.op[index]].cost if other is None or other in known else 1


class _Network:
    """A network of directed edges; edge k ^ 1 is edge k backwards."""

    def __init__(self, size: int) -> None:
        self._ends: list[int] = []
        self._residual: list[int] = []
        self._edges: list[list[int]] = [[] for _ in range(size)]

    def edge(self, start: int, end: int, capacity: int) -> int:
        """Adds an edge; returns its number."""
        number = len(self._ends)
        self._edges[start].append(number)
        self._edges[end].append(number + 1)
        self._ends += [end, start]
        self._residual += [capacity, 0]
        return number

    def raise_capacities(self, edges: Iterable[int], more: int) -> None:
        """Raises the capacities of edges."""
        for edge in edges:
            self._residual[edge] += more

    def residual(self) -> list[int]:
        """The residual capacities of all edges."""
        return self._residual.copy()

    def restore(self, residual: list[int]) -> None:
        """Sets the residual capacities to what they were."""
        self._residual = residual

    def cut(self, source: int, sink: int) -> list[int]:
        """Finds a maximum flow; for each node whether it is on the source's side of the minimum cut, as a number."""
        while True:
            levels = self._levels(source)
            if not levels[sink]:
                return levels
            self._augment(source, sink, levels)

    def _levels(self, source: int) -> list[int]:
        """One more than the number of edges with residual capacity from the source to each node; zero for none."""
        levels = [0] * len(self._edges)
        levels[source] = 1
        waiting = [source]
        for node in waiting:
            for edge in self._edges[node]:
                end = self._ends[edge]
                if self._residual[edge] and not levels[end]:
                    levels[end] = levels[node] + 1
                    waiting.append(end)
        return levels

    def _augment(self, source: int, sink: int, levels: Sequence[int]) -> None:
        """A blocking flow: augments all shortest paths."""
        ends, residual = self._ends, self._residual
        following = [iter(edges) for edges in self._edges]
        path: list[int] = []
        node = source
        while True:
            if node == sink:
                amount = min(residual[edge] for edge in path)
                for edge in path:
                    residual[edge] -= amount
                    residual[edge ^ 1] += amount
                full = next(k for k, edge in enumerate(path) if not residual[edge])
                node = ends[path[full] ^ 1]
                del path[full:]
            edge = next(
                (e for e in following[node] if residual[e] and levels[ends[e]] == levels[node] + 1), -1
            )
            if edge >= 0:
                path.append(edge)
                node = ends[edge]
            elif path:
                node = ends[path.pop() ^ 1]
            else:
                return
