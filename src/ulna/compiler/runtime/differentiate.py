"""Derivatives of functions, announced where they take long."""

from __future__ import annotations

from math import ceil
from typing import Any

from ulna.compiler.language.function import Function
from ulna.compiler.runtime import jit

_SECONDS = 1.5e-5
"""About how long one operation takes in one sweep over the graph [s]."""


def differentiated(f: Function, what: str, *wrt: str | int) -> Any:
    """A derivative of a function, as a function.

    Args:
        f: The function.
        what: The method of `Function` that differentiates it: "jacobian", "hessian", ...
        *wrt: The name or number of the input, for methods that take one.

    Returns:
        The derivative.

    Raises:
        UnknownName: There is no such input.
    """
    sweeps = f.sweeps(what, *wrt)
    seconds = sweeps * f.operations * _SECONDS
    sweep = "one sweep" if sweeps == 1 else f"{sweeps:,} sweeps"
    text = (
        f"differentiating {f.name} ({sweep} over {f.operations:,} operations), about {ceil(seconds)} s; to compile "
        "the derivative then takes longer"
    )
    with jit.announced(text, f"Differentiating {f.name}", seconds):
        return getattr(f, what)(*wrt)
