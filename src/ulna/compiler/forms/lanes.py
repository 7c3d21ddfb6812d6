"""Cross-lane operations: a function evaluated once in all lanes of a register can reduce over its lanes.

`trace(f, lanes=8)` makes such a function. Its inputs are the same in every lane; the lanes differ by their number
alone, go on together, and all must agree on the outputs in the end, since those of lane 0 are taken. So a search from
eight starting points costs little more than one, and ends when the first has arrived. With one lane the reductions
are the values themselves.
"""

from __future__ import annotations

from typing import Any

from ulna.compiler.language.ops import Op
from ulna.compiler.language.scalar import Condition, Scalar, under_trace
from ulna.errors import TraceError


def lane(count: int) -> Scalar:
    """The number of the lane, 0 to `count` - 1; `count` is the `lanes` of the trace under way.

    Raises:
        TraceError: Outside a trace.
    """
    graph = under_trace()
    if graph is None:
        raise TraceError("A lane has a number only while a function is traced: trace(f, lanes=8, ...).")
    return Scalar(graph, graph.lane(count))


def in_any_lane(condition: Any) -> Any:
    """Whether `condition` holds in any lane; all lanes get the same answer."""
    if not isinstance(condition, Condition):
        return condition
    return Condition(condition.graph, condition.graph.node(Op.ANY, condition.index))


def least(x: Any) -> Any:
    """The smallest `x` of all lanes; nan does not count. All lanes get the same answer."""
    if not isinstance(x, Scalar):
        return x
    return Scalar(x.graph, x.graph.node(Op.LEAST, x.index))


def choose(chosen: Condition, x: Any) -> Any:
    """The `x` of the one lane where `chosen` holds, in all lanes.

    Args:
        chosen: Condition that holds in exactly one lane.
        x: Number or array (...) of traced values.

    Returns:
        Number or array (...) that is the same in all lanes.
    """
    return least(chosen._where_(x, float("inf")))
