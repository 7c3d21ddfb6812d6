"""Which poses a viewer can draw: programs that diverge yield numbers beyond those that a picture can hold."""

from __future__ import annotations

import warnings

import numpy as np

from ulna.checks.values import MAX_LENGTH
from ulna.typing import Floats


def is_drawable(pose: Floats, name: str) -> bool:
    """Whether a node can be placed; warns where it cannot, and the node stays where it is.

    Args:
        pose: Its pose, (4, 4).
        name: Its name, for the warning.

    Returns:
        Whether all entries are numbers of at most 1e15.
    """
    if (np.abs(pose) <= MAX_LENGTH).all():
        return True
    warnings.warn(
        f"{name!r} is not moved: its pose holds {np.abs(pose).max():g}, more than {MAX_LENGTH:g} m. Did the program "
        "diverge?",
        stacklevel=3,
    )
    return False
