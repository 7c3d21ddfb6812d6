"""Batches in threads: all parts are computed and no thread goes on, whatever fails."""

from __future__ import annotations

import threading

import pytest

from ulna.compiler.runtime.array_call import _in_threads


def test_parts_whose_thread_cannot_start_are_still_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    start, started, computed = threading.Thread.start, [], []

    def start_once(thread: threading.Thread) -> None:
        if started:
            raise RuntimeError("can't start new thread")
        started.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", start_once)
    _in_threads(computed.append, 5)
    assert sorted(computed) == [0, 1, 2, 3, 4] and not started[0].is_alive()


def test_errors_come_after_all_threads_have_ended() -> None:
    ended = []

    def part(k: int) -> None:
        if k == 0:
            raise KeyboardInterrupt
        threading.Event().wait(0.05)
        ended.append(k)

    with pytest.raises(KeyboardInterrupt):
        _in_threads(part, 3)
    assert sorted(ended) == [1, 2]
