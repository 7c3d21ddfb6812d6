"""The frames that recursions are asked for: what carries each, and where it is there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, f64

INT = np.int64
REFERENCES = ("world", "local_world_aligned", "local")
"""References by the numbers that procedures know them by."""


class Frames(NamedTuple):
    """Some frames.

    Attributes:
        rows: The row of the step that carries each, (k,).
        placements: F of each, rotation by rows and translation, (k, 12) [m].
        reference: The number of a reference, (1,).
    """

    rows: Array1[INT]
    placements: Array2[f64]
    reference: Array1[INT]
