"""Procedures that were read before: what is kept on disk, and when it no longer counts."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

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


def run(folder: Path, script: str = RUN) -> list[str]:
    """The two lines that a new process prints."""
    path = os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")]))
    environment = {**os.environ, "ULNA_CACHE": str(folder / "cache"), "PYTHONPATH": path}
    result = subprocess.run(
        [sys.executable, "-c", script],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
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


OUTSIDE = """
import numpy as np
from ulna.compiler.procedures import f64, procedure
from kept.elsewhere import settings
from kept.elsewhere.settings import OFFSET, Kind, Points, chosen, root

@procedure
def scaled(points: Points, n: int) -> float:
    tenth = np.zeros(1, Kind)
    tenth[0] = 0.5 ** 2 + 0.1
    return settings.limits.GAIN * n + OFFSET + chosen(n) + root(4.0) + f64(tenth[0]) + points.values[0]
"""

FUNCTIONS = """
from ulna.compiler.procedures import procedure

@procedure
def first(n):
    return n

@procedure
def second(n):
    return n + 100
"""

SETTINGS = """
import numpy as np
from typing import NamedTuple
from ulna.compiler.procedures import Array1, f64
from kept.functions import first, second

class limits:
    GAIN = 2.0

class Points(NamedTuple):
    values: Array1[f64]

OFFSET = np.int64(1)
Kind = f64
root = np.sqrt
chosen = first
"""

RUN_OUTSIDE = """
import numpy as np
from kept.elsewhere.settings import Points
from kept.code import scaled
print(scaled(Points(*(np.full(2, 7.0 + k) for k in range(len(Points._fields)))), 3))
print("read" if scaled._instances else "kept")
"""

EDITS = {
    "GAIN = 2.0": ("GAIN = 12.00", 30.0),
    "OFFSET = np.int64(1)": ("OFFSET = np.int64(41)", 40.0),
    "Kind = f64": ("Kind = np.float32", float(np.float32(0.35)) - 0.35),
    "root = np.sqrt": ("root = np.negative if False else np.abs", 2.0),
    "chosen = first": ("chosen = second", 100.0),
    "    values: Array1": ("    first: Array1[f64]\n    values: Array1", 1.0),
}


def test_a_procedure_is_read_again_when_what_it_names_in_another_folder_changed(tmp_path: Path) -> None:
    folder = tmp_path / "kept" / "elsewhere"
    folder.mkdir(parents=True)
    for package in (folder, folder.parent):
        (package / "__init__.py").touch()
    (folder.parent / "code.py").write_text(OUTSIDE)
    (folder.parent / "functions.py").write_text(FUNCTIONS)
    text, value = SETTINGS, 6.0 + 1.0 + 3.0 + 2.0 + 0.35 + 7.0
    (folder / "settings.py").write_text(text)
    assert run(tmp_path, RUN_OUTSIDE)[1] == "read"
    assert run(tmp_path, RUN_OUTSIDE)[1] == "kept"
    for old, (new, difference) in EDITS.items():
        text, value = text.replace(old, new), value + difference
        (folder / "settings.py").write_text(text)
        result, how = run(tmp_path, RUN_OUTSIDE)
        assert float(result) == pytest.approx(value, abs=1e-12), new
        assert how == "read"
    assert run(tmp_path, RUN_OUTSIDE)[1] == "kept"


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
    names = (("ulna.planning.rrt_connect", "FREE_PLACE", "float 1000000000000000.0"),)
    compiled = Compiled((("n", INT),), (F64,), frozenset({"a"}), (str(file),), names, "digest")
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
