"""A long run holds memory flat: with a page open, a trace drawn, and nothing recorded."""

import gc
import tracemalloc

import numpy as np
import pytest

import ulna
from ulna.viewer.viewer import Viewer

COUNTED = [tracemalloc.Filter(True, f"*/{package}/*") for package in ("ulna", "viser", "numpy")]
"""Not what threads of other packages allocate meanwhile, which other tests have started."""


@pytest.mark.slow
def test_memory_stays_flat_over_many_steps() -> None:
    pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
    with Viewer(port=0, browser=False) as viewer:
        arm = viewer.add(ulna.load("panda", visuals="simple"), "qr")
        arm.trace(most=500)
        arm.frames("panda_hand")
        plot = viewer.panel.plot("speed", ("v",))
        sim = viewer.simulate(realtime=False, record=False)
        page = viewer._page
        assert page is not None
        page.motion._capacity = (
            100_000  # bytes that the page's motion may take: reached before the count begins
        )

        def run(steps: int) -> int:
            for k in range(steps):
                if k % 500 == 0:
                    arm.qd = np.full(7, 0.1 if k % 1000 else -0.1)
                sim.step(1e-3)
                plot.add(sim.t, 0.1)
            viewer.flush()
            gc.collect()
            if not tracemalloc.is_tracing():
                return 0
            kept = tracemalloc.take_snapshot().filter_traces(COUNTED)
            return sum(statistic.size for statistic in kept.statistics("filename"))

        run(2_000)
        tracemalloc.start()
        try:
            first, second = run(5_000), run(25_000)
        finally:
            tracemalloc.stop()
    assert (
        second - first < 600_000
    )  # bytes; a float kept from each step would be 800,000, the plot varies by 200,000
