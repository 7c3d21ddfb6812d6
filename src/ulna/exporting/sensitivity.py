"""How much results may differ from recorded ones: more where a function multiplies the rounding of its inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ulna.exporting.record import ExportedFunction
from ulna.typing import Floats

TOLERANCE: Mapping[str, float] = {"float64": 1e-12, "float32": 2e-4}
"""The largest difference that passes, relative to the largest number of an output, or to 1 [-]."""

_ROUNDINGS = 20.0  # how many times the effect of rounded inputs: a function rounds at each operation
_TRIALS = 3


def tolerance(f: ExportedFunction, samples: Sequence[Floats], dtype: str) -> float:
    """The largest difference from the interpreter's results that rounding explains at some samples.

    `TOLERANCE`, or more for functions near a singularity, such as the operational inertia of an arm near its full
    length: as much as results of double precision change when all inputs change in their last digit, in units of
    the last digit of `dtype`, times 20 (Higham 2002, section 1.6).

    Args:
        f: The function.
        samples: Inputs, an array (n, ...) for each.
        dtype: The type that is computed in, "float64" or "float32".

    Returns:
        The difference relative to the largest number of an output, or to 1 [-].
    """
    rng = np.random.default_rng(5)
    spacing = float(np.finfo(np.float64).eps)
    expected = _outputs(f, samples)
    worst = 0.0
    for _ in range(_TRIALS):
        changed = [x * (1.0 + spacing * rng.choice((-1.0, 1.0), x.shape)) for x in samples]
        for before, after in zip(expected, _outputs(f, changed), strict=True):
            finite = np.isfinite(before)
            scale = np.abs(before).max(axis=1, initial=1.0, keepdims=True, where=finite)
            change = np.subtract(after, before, out=np.zeros_like(before), where=finite)
            difference = np.abs(change) / scale
            worst = max(worst, float(difference[np.isfinite(difference)].max(initial=0.0)))
    return max(TOLERANCE[dtype], _ROUNDINGS * worst * float(np.finfo(dtype).eps) / spacing)


def _outputs(f: ExportedFunction, samples: Sequence[Floats]) -> list[Floats]:
    """The outputs of the interpreter, (n, numbers) each."""
    count = len(samples[0]) if samples else 1
    with np.errstate(all="ignore"):
        results = [f.function(*(x[k] for x in samples)) for k in range(count)]
    each = [(r,) if f.function.single else r for r in results]
    return [np.array([np.ravel(r[j]) for r in each], dtype=float) for j in range(len(f.outputs))]
