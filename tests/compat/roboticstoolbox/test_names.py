"""The table of names in the docs is up to date, and names that are not supported raise an explanatory error."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import pytest

pytest.importorskip("spatialmath")
pytest.importorskip("matplotlib")
SCRIPT = Path(__file__).parents[3] / "benchmarks" / "compat_roboticstoolbox_names.py"


def test_the_table_of_names_is_up_to_date() -> None:
    distribution("roboticstoolbox-python")  # what is compared with
    command = [sys.executable, str(SCRIPT), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout[:2000] + done.stderr[-2000:]
