"""Methods that cannot be part of a compiled function say so."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import TraceError


def only_numbers(what: str, advice: str, *values: Any) -> None:
    """Refuses traced values in what cannot be compiled.

    Args:
        what: The method, such as "robot.distance".
        advice: What to do instead.
        *values: Its arrays.

    Raises:
        TraceError: If one of them holds a traced value.
    """
    for value in values:
        if isinstance(value, np.ndarray) and value.dtype.kind == "O":
            from ulna.compiler.language.scalar import Value  # numbers do without the compiler

            if any(isinstance(v, Value) for v in value.flat):
                raise TraceError(
                    f"{what} takes numbers only, so it cannot be part of a compiled function. {advice}"
                )
