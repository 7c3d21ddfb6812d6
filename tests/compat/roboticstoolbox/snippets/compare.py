"""Runs snippets in both packages, in separate processes, and compares what they return, print, warn and raise."""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from support.two_pythons import variables
from ulna.compat.packages import FOLDERS

RUNNER = Path(__file__).parent / "run_snippets.py"


def run_both(snippets: dict[str, str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The outcomes in the compatibility package, and in the Toolbox."""
    with tempfile.TemporaryDirectory() as folder:
        asked = Path(folder) / "asked"
        asked.write_bytes(pickle.dumps(snippets))
        jobs = []
        for name, package in (("ulna", "roboticstoolbox"), ("toolbox", None)):
            target = Path(folder) / name
            command = [sys.executable, str(RUNNER), str(asked), str(target)]
            jobs.append((target, subprocess.Popen(command, env=variables(package, MPLBACKEND="agg"))))
        results = []
        for target, job in jobs:
            assert job.wait(timeout=600) == 0
            results.append(pickle.loads(target.read_bytes()))
    (ulna_place, ulna), (toolbox_place, toolbox) = results
    assert ulna_place.startswith(str(FOLDERS["roboticstoolbox"]))
    assert not toolbox_place.startswith(str(FOLDERS["roboticstoolbox"]))
    return ulna, toolbox


def difference(ulna: dict[str, Any], toolbox: dict[str, Any]) -> str:
    """What differs between two outcomes; empty when nothing does."""
    if toolbox["raised"]:
        if toolbox["raised"][0] in ulna["raised"]:
            return ""
        return f"raised {ulna['raised']} {ulna['value']}; expected {toolbox['raised'][0]} {toolbox['value']}"
    if ulna["raised"]:
        return f"raised {ulna['value']}; expected {toolbox['value']}"
    for key in ("printed", "warned"):
        if ulna[key] != toolbox[key]:
            return f"{key}:\n{ulna[key]}\nexpected:\n{toolbox[key]}"
    if not equal(ulna["value"], toolbox["value"]):
        return f"{ulna['value']}\nexpected:\n{toolbox['value']}"
    return ""


def equal(a: Any, b: Any, inside_array: bool = False) -> bool:
    """Whether two plain values are equal: numbers to 1e-8, symbols when their difference is zero."""
    if isinstance(a, tuple | list) and isinstance(b, tuple | list):
        if a and b and "symbolic" in (a[0], b[0]):
            return _equal_symbols(a, b)
        if a and b and inside_array and (a[0], b[0]) in (("int", "float"), ("float", "int")):
            return a[1] == b[1]
        if a and b and a[0] == b[0] == "array" and "O" not in (a[2], b[2]):
            same = a[1] == b[1] and (a[2] == b[2] or {a[2], b[2]} <= set("ifub"))
            return same and np.allclose(a[3], b[3], rtol=1e-8, atol=1e-8, equal_nan=True)
        if a and b and a[0] == b[0] == "array":
            return a[1] == b[1] and all(
                equal(x, y, True) for x, y in zip(_entries(a), _entries(b), strict=True)
            )
        return len(a) == len(b) and all(map(equal, a, b))
    if isinstance(a, float) and isinstance(b, float):
        return bool(np.isclose(a, b, rtol=1e-8, atol=1e-8, equal_nan=True))
    return a == b


def _entries(array: Any) -> list[Any]:
    return array[3] if array[2] == "O" else [("float", float(x)) for x in array[3]]


def _equal_symbols(a: Any, b: Any) -> bool:
    import sympy

    if a[1] == b[1]:
        return True
    gap = sympy.sympify(str(a[1])) - sympy.sympify(str(b[1]))
    points = np.random.default_rng(1).uniform(0.3, 1.2, (3, len(gap.free_symbols)))
    values = [gap.subs(dict(zip(sorted(gap.free_symbols, key=str), at, strict=True))) for at in points]
    return all(abs(complex(value)) < 1e-7 for value in values)
