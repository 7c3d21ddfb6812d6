"""The end of the process: functions that are called then, however late the module that adds them was imported.

`atexit` calls what was registered last first, and ignores what is registered while it does so. This module registers
when `ulna` is imported; modules that are loaded later, even by a function that `atexit` calls, add functions here.
"""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable

_functions: list[Callable[[], object]] = []
_has_begun = False


def has_begun() -> bool:
    """Whether the process ends: Python starts no pools of threads any more, and from 3.12 on no threads."""
    return _has_begun or not threading.main_thread().is_alive()


def call_at_end(function: Callable[[], object]) -> None:
    """Has a function called when the process ends; at once, where that has begun.

    Args:
        function: Called without arguments; those that were added first are called first.
    """
    if _has_begun:
        function()
    else:
        _functions.append(function)


@atexit.register
def _call_all() -> None:
    global _has_begun
    for function in _functions:
        function()
    _has_begun = True
