"""Compares results of calls of both packages: values, types, printed text, warnings and classes of exceptions."""

from __future__ import annotations

import builtins
import re
from typing import Any

import numpy as np

NEAR = 1e-9
BY_DIFFERENCES = 1e-4  # of what the toolbox computes by differences
BY_ROOTS = 1e-7  # of the square root of a determinant, which rounding makes 1e-8 at a singularity
ZEROS = (
    r"(?<![\w.])[- ]*(0|\d(\.\d+)?e-(1[5-9]|[2-9]\d))(?![\d.])"  # in text: of either sign, or rounding errors
)
CLASSES = ("LinAlgError",)  # that scripts catch, beside the built-in ones


def difference(ours: dict[str, Any], theirs: dict[str, Any], near: float = NEAR) -> str | None:
    """How two results differ, in a few words; None where they are equal.

    An exception equals another if it is also of the class that the toolbox raises. Where the toolbox fails without a
    check of its arguments, any exception of Ulna's is as good.
    """
    if theirs["error"] or ours["error"]:
        return _errors_differ(ours, theirs)
    if not _same(ours["value"], theirs["value"], near):
        return "value"
    if not _same_text(ours["text"], theirs["text"]):
        return "text"
    return "warnings" if set(theirs["warnings"]) - set(ours["warnings"]) else None


def _errors_differ(ours: dict[str, Any], theirs: dict[str, Any]) -> str | None:
    if not ours["error"]:
        return f"no error for {theirs['error'][0]}"
    if not theirs["error"]:
        return f"{ours['error'][0]} for a result"
    expected = next((name for name in theirs["error"] if hasattr(builtins, name) or name in CLASSES), "")
    if expected in ours["error"][:-1]:  # of the class that scripts can name
        return None
    if not theirs.get("checked") and "UlnaError" in ours["error"]:
        return None  # the toolbox fails somewhere within; an error that explains why is better
    return f"{ours['error'][0]} for {theirs['error'][0]}"


def _same_text(ours: str, theirs: str) -> bool:
    a, b = (re.sub(r"<[\w.]*?(\w+) object at 0x\w+>", r"\1", text) for text in (ours, theirs))
    a, b = (re.sub(ZEROS, "0", text) for text in (a, b))
    return [line.rstrip() for line in a.splitlines()] == [line.rstrip() for line in b.splitlines()]


def _same(ours: Any, theirs: Any, near: float) -> bool:
    """Whether plain data is equal: numbers nearly, types by name."""
    if isinstance(theirs, str) and isinstance(ours, str):
        return _same_text(ours, theirs)
    if isinstance(theirs, (np.ndarray, float)) or isinstance(ours, (np.ndarray, float)):
        return _same_numbers(ours, theirs, near)
    if isinstance(theirs, (tuple, list)):
        if not isinstance(ours, type(theirs)) or len(ours) != len(theirs):
            return False
        if isinstance(theirs, tuple) and theirs and theirs[0] == "IKSolution" and ours[0] == "IKSolution":
            return _same_solution(ours, theirs)
        return all(_same(a, b, near) for a, b in zip(ours, theirs, strict=True))
    if isinstance(theirs, dict):
        if not isinstance(ours, dict) or set(ours) != set(theirs):
            return False
        return all(_same(ours[key], theirs[key], near) for key in theirs)
    return bool(ours == theirs)


def _same_solution(ours: Any, theirs: Any) -> bool:
    """Of inverse kinematics: whether there are as many numbers, and a solution where the toolbox has one."""
    return ours[2] == theirs[2] and (ours[1] or not theirs[1])


def _same_numbers(ours: Any, theirs: Any, near: float) -> bool:
    try:
        a, b = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    except (TypeError, ValueError):
        return False
    if a.shape != b.shape:
        return False
    finite = np.abs(b[np.isfinite(b)])
    size = max(1.0, float(finite.max(initial=0.0)))
    return bool(np.allclose(a, b, rtol=near, atol=near * size, equal_nan=True))


def nearness(key: str) -> float:
    """How near the numbers of a call must be, relative to the largest: less where the toolbox takes differences or roots."""
    by_differences = ("_x(", "jacob0_dot", "exp", "numerical", "jacobm", "partial")
    if any(word in key for word in by_differences):
        return BY_DIFFERENCES
    return BY_ROOTS if "manipulability" in key else NEAR
