"""When the tests of this folder compile: as programs do, or at the first call."""

from __future__ import annotations

import pytest


@pytest.fixture
def compiled_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models are compiled at their first call, for tests of what is compiled."""
    monkeypatch.setenv("ULNA_COMPILE", "first")
