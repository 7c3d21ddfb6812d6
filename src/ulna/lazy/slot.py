"""One argument or result of a function of arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.data_classes import dataclass


@final
@dataclass(frozen=True)
class Slot:
    """An argument or a result of a function: its last axes are known, batch axes come before them.

    Attributes:
        name: The name of the argument, for messages.
        shape: The lengths of its last axes.
        dtype: The type of its numbers; object for objects.
        labels: What the entries of its last axis are called, in order; an empty row for a result whose entries are no
            coordinates; None where nothing is known of that.
    """

    name: str
    shape: tuple[int, ...] = ()
    dtype: Any = np.float64
    labels: Sequence[str] | None = None
