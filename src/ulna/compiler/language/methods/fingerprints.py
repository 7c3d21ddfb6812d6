"""A hash of what a graph computes."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

from ulna.compiler.language.graph import Graph, Loop


def fingerprint(graph: Graph, outputs: Sequence[int]) -> str:
    """A hash of what nodes compute, the same in every process.

    Args:
        graph: The graph.
        outputs: Its nodes.

    Returns:
        The hash as hexadecimal digits.
    """
    h = hashlib.sha256()
    number: dict[int, int] = {}
    for index in graph.live(outputs):
        number[index] = len(number)
        data = graph.data[index]
        if isinstance(data, Loop):
            inner = fingerprint(data.graph, [data.condition, *data.following])
            flags = (data.is_taped, data.is_backward, data.reads)
            data = (inner, data.size, data.limit, *(flags if any(flags) else ()))
        elif isinstance(data, float):
            data = data.hex()
        h.update(repr((int(graph.op[index]), [number[a] for a in graph.args[index]], data)).encode())
    h.update(repr([number[o] for o in outputs]).encode())
    return h.hexdigest()
