"""Quartics through five even samples, and their Bernstein coefficients, which bound them from below and above.

Source: Farouki, The Bernstein polynomial basis: a centennial retrospective (2012), sections 4 and 5.
"""

from __future__ import annotations

from math import comb

import numpy as np

from ulna.typing import Floats

NODES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Where each segment is sampled, in parts of its length."""

PROBES = np.array([0.11])
"""Where the quartic through the samples is compared with the truth: about where it is worst."""

DEGREE = len(NODES) - 1


def _bernstein(degree: int, at: Floats) -> Floats:
    """The Bernstein polynomials of that degree at places, (places, degree + 1)."""
    i = np.arange(degree + 1)
    weights = np.array([comb(degree, k) for k in i], dtype=float)
    return weights * at[:, None] ** i * (1.0 - at[:, None]) ** (degree - i)


TO_BERNSTEIN = np.linalg.inv(_bernstein(DEGREE, NODES))
"""From values at the nodes to Bernstein coefficients of the quartic through them, (5, 5)."""

_HALVES = np.array(
    [[16, 0, 0, 0, 0], [8, 8, 0, 0, 0], [4, 8, 4, 0, 0], [2, 6, 6, 2, 0], [1, 4, 6, 4, 1],
     [0, 2, 6, 6, 2], [0, 0, 4, 8, 4], [0, 0, 0, 8, 8], [0, 0, 0, 0, 16]]
) / 16.0  # fmt: skip
TO_HALVES = _HALVES @ TO_BERNSTEIN
"""From values at the nodes to the Bernstein coefficients of both halves, (9, 5): bounds four times as tight."""

AT_PROBES = _bernstein(DEGREE, PROBES) @ TO_BERNSTEIN
"""From values at the nodes to values of that quartic at the probes, (2, 5)."""
