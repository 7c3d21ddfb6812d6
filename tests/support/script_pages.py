"""Scripts that open a browser: run as they are, and looked at in a real Chromium."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from support.patience import patient
from support.ports import free_port

PLACE = "n => window.__viserMutable?.nodeRefFromName[n]?.matrix.toArray() ?? null"
OPACITIES = """n => { const found = [];
  window.__viserMutable?.nodeRefFromName[n]?.traverse(o => { if (o.material && o.material.color && o.visible)
    found.push(o.material.opacity); });
  return found; }"""


wait = patient()


def tab_at(chromium: Any, url: str, width: int = 640, height: int = 400) -> Any:
    """A new tab that looks at a page."""
    tab = chromium.new_context(viewport={"width": width, "height": height}).new_page()
    tab.goto(f"{url}/?fixedDpr=1")
    return tab


def near(tab: Any, node: str, place: Any, within: float = 1e-4) -> Any:
    """The matrix of a node in the tab, if its origin is `place` (3,) [m]."""
    matrix = tab.evaluate(PLACE, node)
    return matrix and np.abs(np.array(matrix)[12:15] - place).max() < within and matrix


@contextmanager
def running(script: Path, folder: Path) -> Iterator[tuple[subprocess.Popen[str], Callable[[], str]]]:
    """A script run by `ulna run` in a folder, and what waits for the address it gives a browser to open."""
    opener = folder / "open"
    opener.write_text(f'#!/bin/sh\necho "$1" > {folder}/part && mv {folder}/part {folder}/url\n')
    opener.chmod(0o755)
    # not the port of another test's script: tabs that are left there would connect to this one
    screen = {
        "ULNA_PORT": str(free_port()),
        "DISPLAY": ":0",
        "BROWSER": f"{opener} %s",
        "ULNA_HEADLESS": "",
        "MPLBACKEND": "Agg",
    }
    process = subprocess.Popen(
        [sys.executable, "-m", "ulna", "run", str(script)],
        env={**os.environ, **screen},
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )

    def address() -> str:
        url = wait(lambda: (folder / "url").exists() or process.poll() is not None) and folder / "url"
        assert url and url.exists(), process.communicate()[1]
        return url.read_text().strip()

    try:
        yield process, address
    finally:
        process.kill()
        process.communicate()
