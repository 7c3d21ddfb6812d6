"""When something is compiled for a model: its first calls are evaluated instead, without compiling anything.

A program that meets many models and calls each a few times would wait for the compiler most of the time. So each
function of a model is evaluated at its first calls, and compiled when it is called more often; every model that was
compiled doubles how often the next one must be called.
"""

from __future__ import annotations

import os
import warnings
from typing import final

ENVIRONMENT_VARIABLE = "ULNA_COMPILE"
MODES = ("frequent", "first", "never")
_MAX_DOUBLINGS = 9


@final
class FirstCalls:
    """How often the functions of one model were called before they were compiled."""

    _compiled_models = 0
    """How many models of this process something was compiled for, after their first calls."""

    def __init__(self) -> None:
        self._counts: dict[object, int] = {}
        self._doublings: int | None = None

    def includes(self, function: object, usual: int) -> bool:
        """Whether this call is to be evaluated; counts it.

        Args:
            function: The function, by its name or key.
            usual: How many calls of it are evaluated for the first model.

        Returns:
            Whether it is.
        """
        mode = compile_mode()
        if mode != "frequent":
            return mode == "never"
        count = self._counts[function] = self._counts.get(function, 0) + 1
        if self._doublings is not None:
            return count <= usual << self._doublings
        if count <= usual << min(FirstCalls._compiled_models, _MAX_DOUBLINGS):
            return True
        self._doublings = min(FirstCalls._compiled_models, _MAX_DOUBLINGS)
        FirstCalls._compiled_models += 1
        return False


def compile_mode() -> str:
    """When models are compiled: "frequent", or what the environment variable `ULNA_COMPILE` says.

    "first" compiles at the first call; "never" evaluates every call.
    """
    mode = os.environ.get(ENVIRONMENT_VARIABLE, "") or "frequent"
    if mode not in MODES:
        warnings.warn(
            f"The environment variable {ENVIRONMENT_VARIABLE} is {mode!r}; expected one of {', '.join(MODES)}. "
            "It is ignored.",
            stacklevel=2,
        )
        return "frequent"
    return mode
