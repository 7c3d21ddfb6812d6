"""Pauses of Python's collector: where they end, and what they leave as it was."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from ulna.system.collector import paused_collection


def is_collecting() -> bool:
    return gc.isenabled() and gc.get_threshold()[0] > 0


def test_collection_goes_on_after_the_last_pause() -> None:
    assert is_collecting()
    with paused_collection():
        with paused_collection():
            assert not is_collecting()
        assert not is_collecting()
    assert is_collecting()


def test_it_goes_on_after_an_error() -> None:
    with pytest.raises(ZeroDivisionError), paused_collection():
        raise ZeroDivisionError
    assert is_collecting()


def test_a_collector_that_was_off_stays_off() -> None:
    gc.disable()
    try:
        with paused_collection():
            pass
        assert not is_collecting()
    finally:
        gc.enable()


@contextmanager
def paused_in_another_thread() -> Iterator[None]:
    """Within, another thread is in a pause."""
    inside, leave = threading.Event(), threading.Event()

    def pause() -> None:
        with paused_collection():
            inside.set()
            leave.wait()

    thread = threading.Thread(target=pause)
    thread.start()
    inside.wait()
    try:
        yield
    finally:
        leave.set()
        thread.join()


def test_pauses_of_threads_overlap() -> None:
    with paused_in_another_thread():
        with paused_collection():
            pass
        assert not is_collecting()
    assert is_collecting()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_child_forked_during_a_pause_collects() -> None:
    with paused_in_another_thread():
        child = os.fork()
        if not child:
            os._exit(0 if is_collecting() else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_thresholds_stay_as_they_were() -> None:
    before = gc.get_threshold()
    with paused_collection():
        assert gc.get_threshold()[1:] == before[1:] and gc.isenabled()
    assert gc.get_threshold() == before
    try:
        with paused_collection():
            gc.set_threshold(5000)  # somebody else's wish
        assert gc.get_threshold()[0] == 5000
    finally:
        gc.set_threshold(*before)


def test_dask_that_is_imported_during_a_pause_leaves_the_collector_on() -> None:
    """dask.array remembers for good whether the collector was on when it was imported, and sets it so after each slice."""
    pytest.importorskip("dask.array")
    script = (
        "import gc\n"
        "from ulna.system.collector import paused_collection\n"
        "with paused_collection():\n"
        "    import dask.array as da\n"
        "da.ones(10, chunks=2)[1:7]\n"
        "assert gc.isenabled() and gc.get_threshold()[0]\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
