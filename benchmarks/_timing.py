"""Times callables against each other in one process, in turns, so that a drifting machine hits both alike."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Sequence


def medians(
    candidates: Sequence[Callable[[], object]], repeat: int = 21, seconds: float = 0.02
) -> list[float]:
    """Median seconds of one call of each candidate; rounds interleave the candidates."""
    counts = []
    for f in candidates:
        f()
        start, n = time.perf_counter(), 0
        while time.perf_counter() - start < seconds:
            f()
            n += 1
        counts.append(max(n, 1))
    samples: list[list[float]] = [[] for _ in candidates]
    gc.disable()
    try:
        for _ in range(repeat):
            for f, n, into in zip(candidates, counts, samples, strict=True):
                runs = range(n)
                start = time.perf_counter()
                for _ in runs:
                    f()
                into.append((time.perf_counter() - start) / n)
    finally:
        gc.enable()
    return [statistics.median(s) for s in samples]


def shown(seconds: float) -> str:
    """A time with a unit that fits."""
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("us", 1e6)):
        if seconds * scale >= 1.0:
            return f"{seconds * scale:.2f} {unit}"
    return f"{seconds * 1e9:.1f} ns"


def table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    widths = [max(len(str(r[k])) for r in [header, *rows]) for k in range(len(header))]
    line = lambda cells: "| " + " | ".join(str(c).ljust(w) for c, w in zip(cells, widths, strict=True)) + " |"  # noqa: E731
    rule = "|" + "|".join("-" * (w + 2) for w in widths) + "|"
    return "\n".join([f"### {title}", "", line(header), rule, *(line(r) for r in rows), ""])
