"""What a graph records of values whose reverse derivative is known in closed form."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

from ulna.compiler.language.ports import Shape
from ulna.data_classes import dataclass


@dataclass(frozen=True, eq=False)
class VjpRule:
    """How cotangents pass from values to the arguments that they were computed from.

    Attributes:
        inputs: The nodes of all arguments, flat, one argument after the other.
        outputs: The nodes of the values.
        shapes: The shapes of the arguments.
        vjp: A function of the arguments, of the values, of their cotangents (arrays of traced scalars) and of which
            arguments need cotangents; it returns the cotangents of those arguments, and None for others.
    """

    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    shapes: tuple[Shape, ...]
    vjp: Callable[[Sequence[Any], Any, Any, Sequence[bool]], Sequence[Any]]

    def moved(self, nodes: Sequence[int]) -> VjpRule:
        """The same in another graph.

        Args:
            nodes: The nodes there of all arguments, then of the values.
        """
        count = len(self.inputs)
        return replace(self, inputs=tuple(nodes[:count]), outputs=tuple(nodes[count:]))


def of_live_values(rules: Sequence[VjpRule], live: Iterable[int]) -> list[VjpRule]:
    """The rules all values of which are used.

    Args:
        rules: Rules of a graph.
        live: The nodes that are used.

    Returns:
        Rules, in the same order.
    """
    used = set(live) if rules else set()
    return [rule for rule in rules if used.issuperset(rule.outputs)]
