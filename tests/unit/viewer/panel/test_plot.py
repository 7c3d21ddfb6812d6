"""Plots in the panel: what they keep, what they draw, and how often."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ulna.errors import ShapeError
from ulna.viewer.panel import plot as module
from ulna.viewer.panel.plot import Plot


class Bench:
    """A plot, what stands for it in the page, and a clock that is set by hand."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, seconds: float = 2.0) -> None:
        self.now, self.removed = 50.0, []
        monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: self.now))
        self.handle = SimpleNamespace(data="nothing yet", title="speed [m/s]", remove=lambda: None)
        self.plot = Plot(self.handle, "speed", "m/s", ("x", "y"), seconds, self.removed.append)

    def drawn(self, after: float = 1.0) -> Any:
        self.now += after
        self.plot.draw()
        return self.handle.data


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(monkeypatch)


def test_it_draws_what_is_new_ten_times_a_second_at_most(bench: Bench) -> None:
    assert bench.drawn() == "nothing yet"
    bench.plot.add(0.0, (1, 2))
    assert bench.drawn(0.0) is not None and len(bench.handle.data) == 3
    bench.plot.add(1.0, (3, 4))
    assert len(bench.drawn(0.09)[0]) == 1
    t, x, y = bench.drawn(0.02)
    np.testing.assert_array_equal((t, x, y), [(0, 1), (1, 3), (2, 4)])
    assert all(column.flags.c_contiguous for column in (t, x, y))
    bench.handle.data = "unchanged"
    assert bench.drawn() == "unchanged"


def test_a_cleared_plot_has_one_row_of_zeros(bench: Bench) -> None:
    bench.plot.add(3.0, (1, 2))
    bench.plot.clear()
    assert bench.plot.data.shape == (0, 3)
    np.testing.assert_array_equal(bench.drawn(), [(0,), (0,), (0,)])


def test_a_time_before_the_last_begins_anew(bench: Bench) -> None:
    for t in (0.0, 1.0, 1.0):
        bench.plot.add(t, (t, 0))
    assert len(bench.plot.data) == 3
    bench.plot.add(0.5, (7, 8))
    np.testing.assert_array_equal(bench.plot.data, [(0.5, 7, 8)])


def test_it_shows_its_seconds_and_another_span_is_drawn(bench: Bench) -> None:
    for k in range(40):
        bench.plot.add(0.25 * k, (k, -k))
    np.testing.assert_array_equal(bench.plot.data[:, 0], np.arange(7.75, 9.76, 0.25))
    assert len(bench.plot._rows) < 20  # what is older is forgotten
    assert len(bench.drawn()[0]) == 9
    bench.plot.seconds = 1.0
    assert len(bench.drawn()[0]) == 5
    assert bench.plot.seconds == 1.0


def test_of_too_many_rows_the_newer_half_is_kept(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Plot, "_MAX_ROWS", 10)
    for k in range(10):
        bench.plot.add(0.01 * k, (k, k))
    assert len(bench.plot.data) == 10
    bench.plot.add(0.1, (10, 10))
    np.testing.assert_array_equal(bench.plot.data[:, 1], np.arange(6, 11))


def test_a_row_has_a_number_for_each_line(bench: Bench) -> None:
    with pytest.raises(ShapeError, match=r"\(2,\), one for each of x, y"):
        bench.plot.add(0.0, (1, 2, 3))


def test_a_removed_plot_draws_no_more_and_is_forgotten(bench: Bench) -> None:
    bench.plot.add(0.0, (1, 2))
    bench.plot.remove()
    assert bench.removed == [bench.plot]
    assert bench.drawn() == "nothing yet"
