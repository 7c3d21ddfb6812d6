"""Programs of packages that stand on Pinocchio run on the package as they are.

Where those packages bring example programs, and in the folder that ULNA_CLIENT_PROGRAMS names, all of them are run.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from client_programs import outcome

CLIENTS = ("pin-pink", "pyroboplan")


def programs() -> list[Path]:
    """Example programs of the installed clients, and those of a folder named in the environment."""
    found: list[Path] = []
    for client in CLIENTS:
        try:
            files = importlib.metadata.files(client) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        found += [Path(str(f.locate())) for f in files if "examples" in f.parts and f.suffix == ".py"]
    folder = os.environ.get("ULNA_CLIENT_PROGRAMS")
    return sorted({*found, *(Path(folder).rglob("*.py") if folder else ())})


@pytest.mark.slow
def test_example_programs_of_clients() -> None:
    pytest.importorskip("pinocchio")
    chosen = programs()
    if not chosen:
        pytest.skip("no client brings example programs; ULNA_CLIENT_PROGRAMS may name a folder of them")
    wrong = {}
    for program in chosen:
        if not outcome(program, real=True) and (error := outcome(program, real=False)):
            wrong[program.name] = error
    assert not wrong


@pytest.mark.slow
def test_a_program_of_pink_in_meshcat() -> None:
    for needed in ("pink", "daqp", "loop_rate_limiters", "viser"):
        if importlib.util.find_spec(needed) is None:
            pytest.skip(f"{needed} is not installed")
    assert outcome(Path(__file__).with_name("pink_shown.py"), real=False, steps=1000) == ""


def test_what_a_program_raises_is_its_outcome(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text("import pinocchio\npinocchio.no_such_function\n", encoding="utf-8")
    assert "no_such_function" in outcome(program, real=False)
    program.write_text("import time\nwhile True:\n    time.sleep(1.0)\n", encoding="utf-8")
    assert outcome(program, real=False) == ""
