"""The rotation nearest to a matrix."""

from __future__ import annotations

import numpy as np

from ulna.typing import Array


def nearest_rotation(matrix: Array) -> Array:
    """The rotation nearest to `matrix` (..., 3, 3) in the Frobenius norm. Source: Kabsch 1976."""
    u, _, vt = np.linalg.svd(matrix)
    sign = np.where(np.linalg.det(u @ vt) < 0.0, -1.0, 1.0)
    u = np.concatenate([u[..., :2], u[..., 2:] * sign[..., None, None]], axis=-1)
    return u @ vt
