"""Writes graphs whose inputs are loaded where they are first used, and stores results once they are known."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator

from ulna.compiler.codegen.node_writer import Writer
from ulna.compiler.language.function import Function
from ulna.compiler.language.ops import Op


class LateInputsWriter(Writer, ABC):
    """A writer of one function; a subclass says how an input is loaded."""

    @abstractmethod
    def fetch(self, node: int) -> None:
        """Loads an input, unless the node is none or has a name.

        Args:
            node: Any node.
        """

    def results(self, f: Function) -> Iterator[tuple[str, int]]:
        """Writes all nodes that are needed.

        Args:
            f: The function.

        Yields:
            The name and the number of every result, as soon as it is known.
        """
        g = f.graph
        waiting: dict[int, list[int]] = {}
        for number, node in enumerate(f.results):
            waiting.setdefault(node, []).append(number)
        for node in g.live(f.results):
            if g.op[node] != Op.INPUT:
                for a in g.args[node]:
                    self.fetch(a)
                self.node(node)
            elif node in waiting:
                self.fetch(node)
            yield from ((self.names[node], number) for number in waiting.get(node, ()))
