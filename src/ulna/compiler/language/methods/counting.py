"""How many operations a function takes, and whether it has loops."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.system.cached import cached_property

_LOOP = int(Op.LOOP)


class Countable:
    """Mixin of `Function`: counts of its operations."""

    graph: Graph
    results: tuple[int, ...]

    @cached_property
    def operation_counts(self) -> dict[str, int]:
        """How often each operation occurs; a loop's body counts once."""
        counts = _own_counts(self.graph, self.results)
        for loop in _loops(self.graph, self.results):
            counts += _own_counts(loop.graph, [loop.condition, *loop.following])
        return dict(sorted(counts.items()))

    @property
    def operations(self) -> int:
        """How many scalar operations one evaluation takes; a loop's body counts once."""
        return sum(self.operation_counts.values())

    @cached_property
    def has_loops(self) -> bool:
        """Whether the graph iterates."""
        return Op.LOOP in self.graph.op

    @cached_property
    def tape_size(self) -> int:
        """How many numbers are on the tapes of its loops, on the stack while it runs."""
        return sum(x.limit * len(x.following) for x in _loops(self.graph, self.results) if x.is_taped)

    @property
    def recorded_numbers(self) -> int:
        """The former name of `tape_size`."""
        return self.tape_size


def _own_counts(graph: Graph, nodes: Sequence[int]) -> Counter[str]:
    """How often each operation occurs in a graph, without the bodies of its loops."""
    counts = Counter(map(graph.op.__getitem__, graph.live(nodes)))
    return Counter({TABLE[op].op.name.lower(): n for op, n in counts.items() if TABLE[op].cost})


def _loops(graph: Graph, nodes: Sequence[int]) -> Iterator[Loop]:
    """The loops that nodes depend on, and those within them."""
    for index in graph.live(nodes):
        if graph.op[index] == _LOOP:
            data = graph.data[index]
            yield data
            yield from _loops(data.graph, [data.condition, *data.following])
