"""Coordinates by whole turns near a wanted one, and within limits that they may miss by a rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.ik.analytic.evaluation import RIM, _within

TURN = 2.0 * math.pi


def wanted(x: float, period: float, lower: float, upper: float, centre: float) -> tuple[float, bool]:
    """The same by trying every number of turns."""
    if math.isfinite(period):
        x = min((x + k * period for k in range(-6, 7)), key=lambda y: (abs(y - centre), -y))
        others = [x] if lower - RIM <= x <= upper + RIM else [x - period, x + period]
        x = next((y for y in others if lower - RIM <= y <= upper + RIM), x)
    ok = lower - RIM <= x <= upper + RIM
    return (min(max(x, lower), upper) if ok else x), ok


@pytest.mark.parametrize(
    ("lower", "upper"), [(-4.0, 4.0), (-1.0, 2.0), (-math.inf, 1.0), (-1.0, math.inf), (-math.inf, math.inf)]
)
@pytest.mark.parametrize("period", [TURN, TURN / 2, math.inf])
def test_it_is_near_the_wanted_one_and_within_the_limits(lower: float, upper: float, period: float) -> None:
    rng = np.random.default_rng(4)
    ends = [x for x in (lower, upper) if math.isfinite(x)] or [0.0]
    offsets = (0.0, 0.4 * RIM, -0.4 * RIM, 3.0 * RIM, -3.0 * RIM)
    places = [end + d for end in ends for d in offsets] + rng.uniform(-7.0, 7.0, 60).tolist()
    for x in places:
        for centre in (x + 0.1, x - 0.1, *rng.uniform(-5.0, 5.0, 3)):
            found, ok = _within(np.float64(x), period, lower, upper, np.float64(centre))
            value, inside = wanted(x, period, lower, upper, float(centre))
            assert bool(ok) == inside, (x, centre)
            assert not inside or float(found) == pytest.approx(value, abs=1e-13), (x, centre)
