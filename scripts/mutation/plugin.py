"""The pytest plugin that records, for the map, which test runs which line, how long it takes and whether it passes."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import coverage
import pytest

TEST = "MUTATION_TEST"  # names the running test to its child processes: the static context of their coverage


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: Any) -> Iterator[None]:
    """Names the running test as the context of all lines run from here on, also in child processes."""
    running = coverage.Coverage.current()
    os.environ[TEST] = item.nodeid
    if running is not None:
        running.switch_context(item.nodeid)
    try:
        return (yield)
    finally:
        os.environ.pop(TEST, None)
        if running is not None:
            running.switch_context("")


def pytest_runtest_logreport(report: Any) -> None:
    """Notes the test's time and outcome; the controlling process of xdist notes for all workers."""
    if os.environ.get("PYTEST_XDIST_WORKER"):
        return
    with Path(os.environ["MUTATION_NOTES"]).open("a") as notes:
        notes.write(json.dumps([report.nodeid, report.duration, report.outcome]) + "\n")


def pytest_sessionfinish() -> None:
    """Saves the data now: a worker may be ended before its own end of life."""
    running = coverage.Coverage.current()
    if running is not None:
        running.stop()
        running.save()
