"""`pytest tests/golden --update` rewrites the files that the golden tests compare with; look at the diff then."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update", action="store_true", help="rewrite the files in tests/golden")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compares a text with the golden file of that name, or writes it."""

    def compare(name: str, text: str) -> None:
        path = Path(__file__).parent / name
        if request.config.getoption("--update", default=False):
            path.write_text(text, encoding="utf-8", newline="\n")
        assert path.exists(), f"{name} does not exist; make it with: pytest tests/golden --update"
        assert text == path.read_text(encoding="utf-8"), (
            f"{name} differs; if that is meant: pytest tests/golden --update"
        )

    return compare
