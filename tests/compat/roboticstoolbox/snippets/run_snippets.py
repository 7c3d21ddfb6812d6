"""Runs snippets on whatever `roboticstoolbox` this Python finds: `python run_snippets.py IN OUT`, both pickles."""

from __future__ import annotations

import ast
import contextlib
import io
import pickle
import sys
import warnings
from typing import Any

import numpy as np

PRELUDE = """
import numpy as np, sympy
import roboticstoolbox as rtb, spatialmath as sm, spatialgeometry as sg
from roboticstoolbox import *
from roboticstoolbox import models
from spatialmath import SE2, SE3
"""


def plain(value: Any) -> Any:
    """A value as built-in types: (kind, content); kinds are the types as a script would tell them apart."""
    if isinstance(value, bool | np.bool_):
        return ("bool", bool(value))
    if isinstance(value, int | np.integer):
        return ("int", int(value))
    if isinstance(value, float | np.floating):
        return ("float", float(value))
    if value is None or isinstance(value, str):
        return ("text", value)
    if hasattr(value, "free_symbols"):
        return ("symbolic", str(value))
    if isinstance(value, np.ndarray):
        flat = [plain(x) for x in value.ravel()] if value.dtype == object else value.ravel().tolist()
        return ("array", value.shape, value.dtype.kind, flat)
    if type(value).__module__.startswith("spatialmath"):
        return (type(value).__name__, [plain(np.asarray(A)) for A in value.data])
    if isinstance(value, dict):
        return ("dict", [(plain(k), plain(v)) for k, v in value.items()])
    if isinstance(value, list | tuple | set):
        kind = "list" if isinstance(value, list) else "set" if isinstance(value, set) else "tuple"
        return (kind, [plain(x) for x in value])
    return (type(value).__name__, str(value))


def outcome(code: str, space: dict[str, Any]) -> dict[str, Any]:
    """The value of the last expression, what was printed, warned and raised."""
    tree = ast.parse(code)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    value, raised = None, []
    with contextlib.redirect_stdout(io.StringIO()) as printed, warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            exec(compile(tree, "snippet", "exec"), space)
            if last is not None:
                value = plain(eval(compile(ast.Expression(last.value), "snippet", "eval"), space))
        except Exception as error:
            raised = [kind.__name__ for kind in type(error).__mro__[:-2]]
            value = plain(f"{type(error).__name__}: {error}")
    kinds = sorted({w.category.__name__ for w in said if issubclass(w.category, DeprecationWarning)})
    return {"value": value, "printed": printed.getvalue(), "raised": raised, "warned": kinds}


def main(source: str, target: str) -> None:
    """Runs the snippets of one pickle and writes their outcomes to the other."""
    with open(source, "rb") as file:
        snippets = pickle.load(file)
    base: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        exec(PRELUDE, base)
    outcomes = {name: outcome(code, dict(base)) for name, code in snippets.items()}
    with open(target, "wb") as file:
        pickle.dump((base["rtb"].__file__, outcomes), file)


if __name__ == "__main__":
    main(*sys.argv[1:3])
