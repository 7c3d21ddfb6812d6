"""Short words for axes, for tables and messages."""

from __future__ import annotations

from ulna.model.joints.axes import Axis


def axis_name(axis: Axis) -> str:
    """``"x"``, ``"-z"``, or the rounded components ``"(0.6, 0, 0.8)"``."""
    for i, letter in enumerate("xyz"):
        if abs(axis[i]) == 1.0 and sum(map(abs, axis)) == 1.0:
            return letter if axis[i] > 0 else f"-{letter}"
    return "(" + ", ".join(f"{c:.3g}" for c in axis) + ")"
