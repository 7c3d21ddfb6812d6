"""Where a user's program called Ulna, so that warnings name its line instead of one inside of the library."""

from __future__ import annotations

import os
import sys

_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep


def level_of_caller() -> int:
    """The `stacklevel` with which `warnings.warn`, called by the caller, names the first line outside of Ulna."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        level, frame = level + 1, frame.f_back
    return level
