"""How large a kernel will be before it is traced: an estimate from the model's tree, its announcement, and its limit.

| symbol | meaning |
|---|---|
| n | number of columns of S, of all joints or of those that carry the frames asked for |
| n_k | number of columns between the world and column k, itself included (Featherstone 2008, section 6.5) |
| nodes | a n + b sum n_k + c sum n_k^2 |

The coefficients are those of chains with inclined axes, which are the largest: robots have half as many nodes or more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import ceil
from typing import Any

from ulna.algorithms.multibody.tree import steps
from ulna.model import Model
from ulna.quantities.quantity import Quantity

SECONDS, BYTES = 8e-5, 1.6e3
"""For each node, to trace and compile it."""
_TRACING = 0.3
"""The part of the time that tracing takes."""
_SILENT_SECONDS = 3.0
"""Tracing that takes longer is announced [s]; it is made anew in every process, also where the code is kept on disk."""


def estimated_nodes(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> int:
    """About how many nodes the graph of a kernel has.

    Args:
        model: The robot.
        quantity: The quantity that the kernel computes; its `nodes` are the coefficients.
        options: Those of the kernel.

    Returns:
        The number of nodes.
    """
    n, pairs, squares = _sizes(model, _joints(model, quantity, options))
    a, b, c = quantity.nodes
    return round(a * n + b * pairs + c * squares)


def check_size(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> int:
    """Refuse a kernel that would be too large.

    Args:
        model: The robot.
        quantity: The quantity that the kernel computes.
        options: Those of the kernel.

    Returns:
        About how many nodes its graph has.

    Raises:
        TooLargeError: The estimate is above `most_operations()`.
    """
    from ulna.compiler.size_limit import most_operations, raise_too_large  # when the compiler is needed

    nodes = estimated_nodes(model, quantity, options)
    if nodes > most_operations():
        what = f"{quantity.name} of {model.name!r} would take about {_rounded(nodes)} operations"
        raise_too_large(what, nodes * SECONDS, nodes * BYTES)
    return nodes


@contextmanager
def sized(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> Iterator[None]:
    """Refuses a kernel that would be too large, and announces one that takes long to trace.

    Args:
        model: The robot.
        quantity: The quantity that the kernel computes.
        options: Those of the kernel.

    Yields:
        Nothing; the kernel is traced within.

    Raises:
        TooLargeError: The estimate is above `most_operations()`.
    """
    nodes = check_size(model, quantity, options)
    seconds = nodes * SECONDS
    if _TRACING * seconds < _SILENT_SECONDS:
        yield
        return
    from ulna.compiler.runtime.jit import announced  # with what compiles, which is imported when first used

    text = (
        f"tracing {quantity.name} of {model.name!r} (about {_rounded(nodes)} operations), about "
        f"{ceil(_TRACING * seconds)} s; to compile it then takes about {ceil((1.0 - _TRACING) * seconds)} s and "
        f"{nodes * BYTES / 1e9:.1f} GB"
    )
    with announced(text, f"Tracing {quantity.name}", _TRACING * seconds):
        yield


def _joints(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> Iterable[int]:
    """Those that carry the frames asked for; all where the quantity is not one of frames alone."""
    frame = options.get("frame")
    if "frame" not in quantity.options or quantity.inverts_mass or frame == "all":
        return range(len(model.joints))
    frames = frame if isinstance(frame, tuple) else (model.tool if frame is None else frame,)
    if not all(isinstance(one, str) for one in frames):
        return ()  # refused, with a better message, by the quantity
    return sorted({joint for one in frames for joint in model.support(model.frame(one).joint)})


def _sizes(model: Model, joints: Iterable[int]) -> tuple[int, int, int]:
    """n, sum n_k and sum n_k^2."""
    before: list[int] = []
    n = pairs = squares = 0
    for step in steps(model, joints):
        depth = before[step.parent] if step.parent >= 0 else 0
        for _ in range(step.kind.nv):
            depth += 1
            n, pairs, squares = n + 1, pairs + depth, squares + depth**2
        before.append(depth)
    return n, pairs, squares


def _rounded(x: float) -> str:
    """Two digits of a large number."""
    return f"{float(f'{x:.1e}'):,.0f}"
