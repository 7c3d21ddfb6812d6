"""Types of the arrays of the library, with their meaning and trailing shape."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]
"""An array of float64, of batched float64, of traced scalars or of symbols; algorithms do not care which."""

Floats: TypeAlias = NDArray[np.float64]
"""A float64 array."""

Numbers: TypeAlias = np.float64 | NDArray[np.float64]
"""A float64 number of one configuration, an array of them of a batch."""

__all__ = ["Array", "ArrayLike", "Floats", "Numbers"]
