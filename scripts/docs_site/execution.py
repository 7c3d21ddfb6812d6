"""Runs the blocks of a page in order, in one scope, and keeps what they print and which files they write."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

from docs_site.pages import blocks


class PageError(Exception):
    """A block of a page failed; says which."""


@dataclass(frozen=True)
class Output:
    """What one block did.

    Args:
        text: What it printed.
        files: Names of the files that it wrote, relative to the page's folder of results.
    """

    text: str
    files: tuple[str, ...]


def run(page: Path, folder: Path) -> list[Output]:
    """Run a page.

    Args:
        page: The page.
        folder: The empty working folder of its code.

    Returns:
        An output for each block, in order.

    Raises:
        PageError: A block failed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    scope: dict[str, object] = {"__name__": f"page_{page.stem}"}
    outputs = []
    with contextlib.chdir(folder), _without_screen(), _warnings_as_errors():
        for block in blocks(page.read_text(encoding="utf-8")):
            before = _files(folder)
            printed = io.StringIO()
            code = "\n" * (block.line - 1) + block.code  # line numbers of messages are those of the page
            try:
                with contextlib.redirect_stdout(printed):
                    exec(compile(code, str(page), "exec"), scope)
            except Exception as error:
                raise PageError(f"{page}: the block at line {block.line}: {error!r}") from error
            after = _files(folder)
            written = sorted(
                (name for name, at in after.items() if before.get(name) != at), key=lambda n: after[n]
            )
            outputs.append(Output(printed.getvalue(), tuple(written)))
    return outputs


def run_timed(page: Path, folder: Path) -> tuple[list[Output], float]:
    """Run a page, and return how long it took.

    Args:
        page: The page.
        folder: The empty working folder of its code.

    Returns:
        The outputs, and the time [s].
    """
    began = time.perf_counter()
    return run(page, folder), time.perf_counter() - began


@contextlib.contextmanager
def _without_screen():
    """No browser opens and no window of matplotlib; figures are closed."""
    before = {name: os.environ.get(name) for name in ("ULNA_HEADLESS", "MPLBACKEND", "ULNA_QUIET")}
    os.environ |= {"ULNA_HEADLESS": "1", "MPLBACKEND": "agg", "ULNA_QUIET": "1"}
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")


@contextlib.contextmanager
def _warnings_as_errors():
    """A warning fails a page, as it fails a test; those of other packages about themselves do not."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", category=DeprecationWarning, module="(?!ulna)")
        warnings.filterwarnings("ignore", category=SyntaxWarning, module=".*site-packages.*")
        warnings.filterwarnings("ignore", "FigureCanvasAgg is non-interactive")
        warnings.filterwarnings("ignore", "os.fork\\(\\) was called", RuntimeWarning)
        yield


def _files(folder: Path) -> dict[str, int]:
    """The files below a folder and when each was written [ns]."""
    return {str(p.relative_to(folder)): p.stat().st_mtime_ns for p in folder.rglob("*") if p.is_file()}
