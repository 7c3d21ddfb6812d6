"""Which results must equal recorded ones, and how much they may differ: more where a function multiplies rounding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ulna.compiler import Function
from ulna.compiler.language.ops import Op
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


def compared_outputs(f: ExportedFunction, dtype: str) -> list[bool]:
    """Which outputs are compared with recorded ones: in single precision, not those that count the rounds of a loop.

    Rounding decides when a loop ends that goes on until nothing changes; results are recorded in double precision.

    Args:
        f: The function.
        dtype: The type that is computed in, "float64" or "float32".

    Returns:
        For each output whether it is compared.
    """
    function, compared, start = f.function, [], 0
    for port in function.outputs:
        nodes = function.results[start : start + port.size]
        start += port.size
        counts = bool(nodes) and all(_counts_rounds(function, node) for node in nodes)
        compared.append(dtype == "float64" or not counts)
    return compared


def _counts_rounds(function: Function, node: int) -> bool:
    """Whether a result is the state of a loop that grows by one a round."""
    g = function.graph
    if g.op[node] != Op.ITEM:
        return False
    loop, item = g.data[g.args[node][0]], g.data[node]
    inner, following = loop.graph, loop.following[item]
    if inner.op[following] != Op.ADD:
        return False
    terms = inner.args[following]
    grows = any(inner.op[k] == Op.CONST and inner.data[k] == 1.0 for k in terms)
    return grows and any(inner.op[k] == Op.INPUT and inner.data[k] == item for k in terms)


def _outputs(f: ExportedFunction, samples: Sequence[Floats]) -> list[Floats]:
    """The outputs of the interpreter, (n, numbers) each."""
    count = len(samples[0]) if samples else 1
    with np.errstate(all="ignore"):
        results = [f.function(*(x[k] for x in samples)) for k in range(count)]
    each = [(r,) if f.function.single else r for r in results]
    return [np.array([np.ravel(r[j]) for r in each], dtype=float) for j in range(len(f.outputs))]
