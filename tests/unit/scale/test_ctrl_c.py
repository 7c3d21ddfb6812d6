"""Ctrl-C while processes are started."""

from __future__ import annotations

import signal
import threading

import pytest

from ulna.scale import ctrl_c


def test_ctrl_c_is_raised_at_the_end_of_the_block() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), ctrl_c.later():
        signal.raise_signal(signal.SIGINT)
        done.append(1)
    assert done == [1]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with ctrl_c.later():
        pass


def test_threads_of_the_block_do_not_see_it() -> None:
    if not hasattr(signal, "pthread_sigmask"):
        pytest.skip("signals cannot be blocked here")
    blocked: list[bool] = []

    def look() -> None:
        blocked.append(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ()))

    def start() -> None:
        thread = threading.Thread(target=look)
        thread.start()
        thread.join()

    with ctrl_c.later():
        start()
    start()
    assert blocked == [True, False]


def test_other_plans_for_ctrl_c_are_kept() -> None:
    came: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        with ctrl_c.later():
            signal.raise_signal(signal.SIGINT)
            assert came == [signal.SIGINT]
    finally:
        signal.signal(signal.SIGINT, before)
