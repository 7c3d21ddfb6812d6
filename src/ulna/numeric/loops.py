"""A loop that can be traced."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import TraceError
from ulna.numeric.scalars import is_symbolic


def loop(condition: Any, body: Any, state: tuple[Any, ...], limit: int) -> tuple[Any, ...]:
    """Iterates `state = body(*state)` while `condition(*state)`, at most `limit` times.

    The state is a tuple of numbers, or of arrays of one batch shape; each element of the batch stops separately and
    then keeps its state. `body` returns a tuple of the same length. Traced, this becomes a loop in the SIMD lanes.

    Args:
        condition: Takes the numbers of the state, returns a truth value.
        body: Takes the numbers of the state, returns the next state.
        state: The numbers, or arrays of shape (...), to start from.
        limit: The largest number of iterations.

    Returns:
        The last state.

    Raises:
        TraceError: the state of a traced loop holds an array.
    """
    if any(isinstance(s, np.ndarray) and s.dtype == object for s in state):
        raise TraceError(
            "The state of a traced loop holds an array; expected numbers. Unpack it: loop(..., state=(*q, x), ...), "
            "with a body and a condition that take that many numbers."
        )
    traced = next((s for s in state if hasattr(s, "_loop_")), None)
    if traced is not None:
        return traced._loop_(condition, body, state, limit)
    values = [np.asarray(s, dtype=float)[()] for s in np.broadcast_arrays(*state)]
    active = np.ones(np.shape(values[0]), dtype=bool)
    for _ in range(limit):
        holds = condition(*values)
        if is_symbolic(holds):  # the state starts from numbers, and the values around the loop are traced
            return _loop_hook(holds)(condition, body, state, limit)
        active = active & holds
        if not active.any():
            break
        following = body(*values)
        traced = next((v for v in following if is_symbolic(v)), None)
        if traced is not None:
            return _loop_hook(traced)(condition, body, state, limit)
        values = [np.where(active, new, old)[()] for new, old in zip(following, values, strict=True)]
    return tuple(values)


def _loop_hook(traced: Any) -> Any:
    value = traced.reshape(-1)[0] if isinstance(traced, np.ndarray) else traced
    hook = getattr(value, "_loop_", None)
    if hook is None:
        raise TypeError(
            f"A loop cannot run on values of type {type(value).__name__}; pass numbers or traced scalars."
        )
    return hook
