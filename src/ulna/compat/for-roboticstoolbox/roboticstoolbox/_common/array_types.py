"""Types of arrays, for annotations: those of `roboticstoolbox.tools.types`."""

from __future__ import annotations

from collections.abc import Sequence

from numpy import ndarray

NDArray = ndarray
PyArrayLike = Sequence[float]
ArrayLike = NDArray | PyArrayLike
