"""Numbers that break compilers, and comparisons that look at bits, for the tests of the tracing compiler."""

from __future__ import annotations

from typing import Any

import numpy as np

SPECIAL = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -3.7,
    2.0**-1074,
    -(2.0**-1030),
    1.7e308,
    -1.7e308,
    np.inf,
    -np.inf,
    np.nan,
)


def grid(count: int, values: Any = SPECIAL, dtype: Any = np.float64) -> list[np.ndarray]:
    """Every combination of `values` for `count` arguments, as flat arrays."""
    with np.errstate(over="ignore"):
        axes = np.meshgrid(*[np.array(values).astype(dtype)] * count)
    return [a.reshape(-1) for a in axes]


def same_bits(a: Any, b: Any) -> np.ndarray:
    """Where two arrays are equal bit for bit; every nan counts as the same."""
    a, b = np.asarray(a), np.asarray(b)
    a, b = np.broadcast_arrays(a, b)
    return (np.isnan(a) & np.isnan(b)) | ((a == b) & (np.signbit(a) == np.signbit(b)))


def ulps(a: Any, b: Any) -> float:
    """The largest difference in units in the last place of `b`; nan and inf must agree."""
    a, b = np.asarray(a), np.asarray(b)
    whole = ~np.isfinite(b)
    if not np.array_equal(a[whole], b[whole], equal_nan=True) or not np.isfinite(a[~whole]).all():
        return float("inf")
    if whole.all():
        return 0.0
    return float(
        np.max(np.abs(a[~whole].astype(float) - b[~whole].astype(float)) / np.spacing(np.abs(b[~whole])))
    )
