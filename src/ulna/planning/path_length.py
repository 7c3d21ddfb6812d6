"""How long a path is."""

from __future__ import annotations

import numpy as np

from ulna.typing import Floats


def length(points: Floats) -> float:
    """The length of a path in joint space [rad, m].

    Args:
        points: Its points, shape (n, nq) [rad, m].

    Returns:
        The length.
    """
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
