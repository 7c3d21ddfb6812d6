"""Plans may take minutes on a busy machine: time limits of several seconds are not what these tests are about."""

from __future__ import annotations

from typing import Any

import pytest

from ulna.planning import planner


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    limit = planner._seconds
    monkeypatch.setattr(planner, "_seconds", lambda timeout: _longer(timeout, limit(timeout)))


def _longer(given: Any, seconds: float) -> float:
    """The limit of the default value, made longer; others stay."""
    return 300.0 if given == 10.0 else seconds
