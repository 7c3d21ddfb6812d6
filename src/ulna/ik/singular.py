"""Singular configurations: where joints move and the frame does not."""

from __future__ import annotations

import numpy as np

from ulna.typing import Floats

_SINGULAR = 1e-7  # the part of the largest singular value below which the smallest counts as 0


def any_singular(J: Floats) -> bool:
    """Whether any of several Jacobians has less than full rank, or nearly so.

    Args:
        J: Jacobians (m, 6, n) [m/rad or -].

    Returns:
        Whether one has.
    """
    values = np.linalg.svd(J, compute_uv=False)
    return bool((values[:, -1] <= _SINGULAR * values[:, 0]).any())
