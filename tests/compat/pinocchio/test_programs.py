"""Programs as roboticists write them print the same on the package as on Pinocchio."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ulna.compat.packages import environment

PROGRAMS = sorted(Path(__file__).with_name("programs").glob("*.py"))
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def _printed(program: Path, real: bool) -> str:
    plain = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    variables = plain if real else environment(["pinocchio"], plain)
    done = subprocess.run(
        [sys.executable, str(program)],
        env=variables, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_a_program_prints_the_same_on_both(program: Path) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = _printed(program, real=False), _printed(program, real=True)
    words = [re.sub(r"\s+", "", _NUMBER.sub("#", text)) for text in (own, wanted)]
    assert words[0] == words[1]
    numbers = [[float(word) for word in _NUMBER.findall(text)] for text in (own, wanted)]
    np.testing.assert_allclose(*numbers, rtol=1e-6, atol=2e-5)
