"""Exported C, compiled with gcc and called through ctypes."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ulna.compiler import Function

STRICT = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wshadow",
    "-Wdouble-promotion",
    "-Wmissing-prototypes",
    "-Werror",
    "-fno-math-errno",
]


def needs(program: str) -> None:
    """Skips a test where a program is missing."""
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed (apt-get install gcc g++ cmake)")


def gcc(*words: str | Path, timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
    """Runs gcc."""
    needs("gcc")
    command = ["gcc", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


def library(folder: Path, flags: Sequence[str] = ("-O1",), sources: str = "*_*.c") -> ctypes.CDLL:
    """The sources of an exported folder but its test program as a shared library."""
    files = [f for f in sorted(folder.glob(sources)) if not f.name.startswith("test_")]
    made = folder.parent / f"{folder.name}.so"
    done = gcc(*STRICT, *flags, "-shared", "-fPIC", *files, "-o", made, "-lm")
    assert done.returncode == 0, done.stderr[:4000]
    return ctypes.CDLL(str(made))


def call(function: Any, traced: Function, arguments: Sequence[Any], dtype: Any = np.float64) -> list[Any]:
    """The outputs of a C function, as arrays."""
    given = [np.ascontiguousarray(a, dtype=dtype) for a in arguments]
    outputs = [np.full(p.shape, np.nan, dtype=dtype) for p in traced.outputs]
    function(*(ctypes.c_void_p(a.ctypes.data) for a in (*given, *outputs)))
    return outputs
