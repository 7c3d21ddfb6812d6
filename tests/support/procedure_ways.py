"""Runs a procedure in the three ways that must agree."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.compiler.procedures import Procedure


def all_ways(p: Procedure, *args: Any) -> Any:
    """What a procedure returns, the same by machine code, checked machine code and the interpreter."""
    copies = [[a.copy() if isinstance(a, np.ndarray) else a for a in args] for _ in range(3)]
    results = [f(*a) for f, a in zip((p, p.checked, p.interpret), copies, strict=True)]
    for other, given in zip(results[1:], copies[1:], strict=True):
        np.testing.assert_equal(other, results[0])
        assert type(other) is type(results[0])
        for a, b in zip(given, copies[0], strict=True):
            if isinstance(a, np.ndarray):
                np.testing.assert_array_equal(a, b)
    for a, b in zip(args, copies[0], strict=True):
        if isinstance(a, np.ndarray) and a.flags.writeable:
            a[...] = b
    return results[0]
