"""When the tests of this folder compile: as programs do, or at the first call."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for modules that tests share


@pytest.fixture
def compiled_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models are compiled at their first call, for tests of what is compiled."""
    monkeypatch.setenv("ULNA_COMPILE", "first")
