"""Programs as roboticists write them print the same on the package as on Pinocchio."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from support.two_pythons import variables

PROGRAMS = sorted(Path(__file__).with_name("programs").glob("*.py"))
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def _printed(program: Path, real: bool) -> str:
    done = subprocess.run(
        [sys.executable, str(program)],
        env=variables(None if real else "pinocchio"), capture_output=True, text=True, check=False, timeout=600,
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
