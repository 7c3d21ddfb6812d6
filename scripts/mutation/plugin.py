"""The pytest plugin of the map: notes which functions each test calls, how long it took, and whether it passed."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mutation_mark  # pyright: ignore[reportMissingImports]  # beside the marked sources
import pytest

TEST = "MUTATION_TEST"  # names the running test to its child processes


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: Any) -> Iterator[None]:
    """Names the running test to the marks, also those in child processes."""
    os.environ[TEST] = item.nodeid
    mutation_mark.start(item.nodeid)
    try:
        return (yield)
    finally:
        os.environ.pop(TEST, None)


def pytest_runtest_logreport(report: Any) -> None:
    """Notes the test's time and outcome; the controlling process of xdist notes for all workers."""
    if os.environ.get("PYTEST_XDIST_WORKER"):
        return
    with Path(os.environ["MUTATION_NOTES"]).open("a") as notes:
        notes.write(json.dumps([report.nodeid, report.duration, report.outcome]) + "\n")
