"""The second exercise in a real browser: arm and ball appear, and the ball sticks to the tool."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.patience import patient
from ulna.robots.example_robot_data import share_folder

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed"),
]
wait = patient()
WHERE = "n => window.__viserMutable?.nodeRefFromName[n]?.position.toArray() ?? [NaN, NaN, NaN]"


def test_the_ball_sticks_to_the_tool(chromium: Any) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "ulna", "run", str(Path(__file__).parent / "looked_at.py")],
        env={**os.environ, "ULNA_HEADLESS": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as script:
        assert script.stdin is not None and script.stdout is not None
        page = chromium.new_page(viewport={"width": 640, "height": 400})
        requests: list[str] = []
        page.on("request", lambda r: requests.append(r.url))
        url = script.stdout.readline().strip()
        page.goto(url)
        for _ in range(3):
            print(file=script.stdin, flush=True)
            reported = np.array(script.stdout.readline().split(), dtype=float).reshape(2, 3)
            names = ("/world/sphere", "/world/pinocchio › visuals › wrist_3_link_0")
            seen = lambda names=names: np.array([page.evaluate(WHERE, name) for name in names], dtype=float)  # noqa: E731
            assert wait(lambda seen=seen, reported=reported: np.allclose(seen(), reported, atol=1e-5)), (
                seen(),
                reported,
            )
        page.close()
        script.stdin.close()
        assert script.wait(600) == 0
    own = (url, url.replace("http", "ws"), "data:", "blob:")
    assert all(r.startswith(own) for r in requests)
