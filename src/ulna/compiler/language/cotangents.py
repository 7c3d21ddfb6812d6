"""The cotangents of a reverse sweep, and where they count."""

from __future__ import annotations

from typing import Any

from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op
from ulna.compiler.language.scalar import Condition, index_in


class Cotangents:
    """The cotangents of nodes, summed as they arrive.

    One that came through one side of a `where` carries the condition and is set to zero only where it meets others:
    multiplied as zero by the partials of the side not taken it could become nan, which are inf or nan there.
    """

    def __init__(self, g: Graph) -> None:
        self._graph = g
        self._of: dict[int, tuple[Any, Condition | None]] = {}

    def __contains__(self, index: int) -> bool:
        return index in self._of

    def __getitem__(self, index: int) -> tuple[Any, Condition | None]:
        return self._of[index]

    def add(self, index: int, value: Any, condition: Condition | None) -> None:
        """Adds to the cotangent of a node.

        Args:
            index: The node.
            value: What is added: a traced scalar or a number.
            condition: Where it counts; None for everywhere.
        """
        if index not in self._of:
            self._of[index] = value, condition
            return
        other, its_condition = self._of[index]
        if _same(condition, its_condition):
            self._of[index] = other + value, condition
            return
        self._of[index] = (
            _where(its_condition, other) + _where(condition, value),
            either(its_condition, condition),
        )

    def total(self, index: int) -> int:
        """The node of the sum, zero where nothing arrived."""
        if index not in self._of:
            return index_in(self._graph, 0.0)
        value, condition = self._of[index]
        return index_in(self._graph, _where(condition, value))


def _where(condition: Condition | None, value: Any) -> Any:
    return value if condition is None else condition._where_(value, 0.0)


def either(a: Condition | None, b: Condition | None) -> Condition | None:
    """Where a sum of two cotangents counts: where one of them does; None stands for everywhere.

    Args:
        a: Where the first one counts.
        b: Where the second one counts.

    Returns:
        The condition of the same graph, or None.
    """
    both = None if a is None or b is None else a | b
    return None if both is None or both.graph.op[both.index] == Op.BOOL else both  # c or not c


def _same(a: Condition | None, b: Condition | None) -> bool:
    return a is b if a is None or b is None else a.index == b.index
