"""Procedures that were read before: what is kept on disk, and when it no longer counts."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from ulna.compiler.imperative.types import BOOL, F32, F64, INT, ArrayType, KernelType, Lanes, RecordType
from ulna.compiler.procedures import Array1, f64, procedure
from ulna.compiler.runtime import procedure_cache
from ulna.compiler.runtime.procedure_cache import Compiled

CODE = """
from ulna.compiler.procedures import Array1, f64, procedure
from kept.numbers import SCALE

@procedure
def scaled(a: Array1[f64], n: int) -> float:
    total = 0.0
    for k in range(n):
        total += SCALE * a[k]
    return total
"""

RUN = """
import numpy as np
from ulna.compiler.imperative import program
from kept.code import scaled
print(scaled(np.ones(4), 3))
print("read" if scaled._instances else "kept")
"""


def run(folder: Path) -> list[str]:
    """The two lines that a new process prints."""
    environment = {**os.environ, "ULNA_CACHE": str(folder / "cache"), "PYTHONPATH": str(folder)}
    result = subprocess.run(
        [sys.executable, "-c", RUN], env=environment, capture_output=True, text=True, check=True, timeout=600
    )
    return result.stdout.split()


def test_a_procedure_is_read_once_and_again_when_a_file_or_number_changed(tmp_path: Path) -> None:
    package = tmp_path / "kept"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "code.py").write_text(CODE)
    (package / "numbers.py").write_text("SCALE = 2.0\n")
    assert run(tmp_path) == ["6.0", "read"]
    assert run(tmp_path) == ["6.0", "kept"]
    # texts of other lengths: Python itself recognizes a changed file by its size and whole seconds only
    (package / "numbers.py").write_text("SCALE = 10 / 2\n")
    assert run(tmp_path) == ["15.0", "read"]
    (package / "code.py").write_text(CODE.replace("total = 0.0", "total = 2 - 1.0"))
    assert run(tmp_path) == ["16.0", "read"]
    assert run(tmp_path) == ["16.0", "kept"]


class Pair(NamedTuple):
    """Two arrays."""

    a: Array1[f64]
    b: Array1[np.int64]


def test_types_survive() -> None:
    record = RecordType("Pair", (("a", ArrayType(F64, 1)), ("b", ArrayType(INT, 3))))
    for kind in (
        BOOL,
        INT,
        F32,
        F64,
        Lanes(F32, 16),
        Lanes(BOOL, 4),
        ArrayType(F32, 2),
        KernelType(),
        record,
    ):
        assert procedure_cache._type(procedure_cache._text(kind)) == kind


def test_a_record_counts_only_while_folders_and_numbers_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "folder"
    folder.mkdir()
    file = folder / "code.py"
    file.write_text("x = 1\n")
    numbers: Any = (("ulna.planning.rrt_connect", "FREE_PLACE", 1e15),)
    compiled = Compiled((("n", INT),), (F64,), frozenset({"a"}), (str(file),), numbers, "digest")
    import ulna.planning.rrt_connect as module

    procedure_cache.write("one", compiled)
    assert procedure_cache.read("one") == compiled
    monkeypatch.setattr(module, "FREE_PLACE", 2e15)
    assert procedure_cache.read("one") is None
    monkeypatch.setattr(module, "FREE_PLACE", 1e15)
    assert procedure_cache.read("one") == compiled
    (folder / "more.py").touch()
    assert procedure_cache.read("one") is None
    assert procedure_cache.read("two") is None


def test_functions_not_determined_by_files_are_not_cached() -> None:
    factor = 3.0

    @procedure
    def scaled(x: f64) -> float:
        return factor * x

    assert procedure_cache.key_of(scaled.function) is None
    assert scaled(2.0) == 6.0
    from ulna.planning.shortcuts import shortened_path

    one = procedure_cache.key_of(shortened_path.function, [("W", 8)])
    assert one is not None and one != procedure_cache.key_of(shortened_path.function, [("W", 16)])
