"""Long work is reported after a moment, to the terminal and to watchers, and never once it is done."""

from __future__ import annotations

import io
import sys
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna.compiler.runtime import jit
from ulna.system import progress as module
from ulna.viewer.progress import progress, unwatch, watch

wait = patient(pause=0.01)


class Terminal(io.StringIO):
    """A stream that people look at."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def heard() -> Iterator[list[tuple[str, str]]]:
    out: list[tuple[str, str]] = []

    def listen(what: str, how_far: str) -> None:
        out.append((what, how_far))

    watch(listen)
    yield out
    unwatch(listen)
    unwatch(listen)  # twice is no mistake


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_DELAY", 0.02)
    monkeypatch.setattr(module, "_INTERVAL", 0.0)


def test_short_work_says_nothing(heard: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(module, "_DELAY", 300.0)
    before = set(threading.enumerate())
    with progress("Loading") as report:
        report(0, 3)
    assert heard == [] and terminal.getvalue() == "" and set(threading.enumerate()) <= before


def test_long_work_counts_and_is_gone_when_it_is_done(
    heard: list[Any], impatient: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress("Loading") as report:
        assert wait(lambda: heard)  # even before anything is counted
        report(1, 3)
        report(2, 3)
    assert heard == [("Loading", "..."), ("Loading", "1 of 3"), ("Loading", "2 of 3"), ("Loading", "")]
    assert "Loading: 2 of 3" in terminal.getvalue() and terminal.getvalue().endswith("\r")


def test_the_newest_of_quick_counts_is_reported(
    heard: list[Any], impatient: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_INTERVAL", 0.5)
    with progress("Loading") as report:
        assert wait(lambda: heard)
        for k in range(1, 8):
            report(k, 7)
        assert wait(lambda: heard[-1] == ("Loading", "7 of 7"))
    assert heard[0] == ("Loading", "...")
    assert heard[-2:] == [("Loading", "7 of 7"), ("Loading", "")] and len(heard) < 8


def test_work_that_fails_is_gone_too(heard: list[Any], impatient: None) -> None:
    with pytest.raises(ZeroDivisionError), progress("Loading") as report:
        assert wait(lambda: heard)
        report(1, 1 // 0)
    assert heard[-1] == ("Loading", "")


def test_a_stream_that_nobody_looks_at_gets_nothing(
    heard: list[Any], impatient: None, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress("Loading"):
        assert wait(lambda: heard)
    assert capsys.readouterr().err == "" and len(heard) == 2


def test_watchers_hear_of_long_compilations(
    heard: list[Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    monkeypatch.setattr(jit, "_ANNOUNCE_FROM", 0.0)
    monkeypatch.setenv("ULNA_CACHE", "0")
    kernel = ulna.compile(lambda x: np.sin(x) * 0.123456789, x=(1,))
    kernel(np.zeros(1))
    assert len(heard) >= 2 and heard[0][0].startswith("Compiling") and "about" in heard[0][1]
    assert heard[-1][1] == ""
    assert "compiling" in capsys.readouterr().err
