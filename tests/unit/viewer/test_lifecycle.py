"""Scripts with a page end as scripts do: at their end, by Ctrl-C, beside other pages; without a word, a thread, a port."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import ulna
from ulna.viewer.viewer import Viewer

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

OPEN = """
import ulna
viewer = ulna.Viewer(port=0, browser=False)
viewer.add(ulna.load("panda", visuals="simple"), "qr")
"""


def run(script: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        stdin=subprocess.DEVNULL,
        check=False,
    )


def test_a_script_that_just_ends_prints_nothing(tmp_path: Path) -> None:
    done = run(
        OPEN + "other = ulna.Viewer(port=0, browser=False)\nviewer.pendant(viewer['panda'])\nprint('end')",
        tmp_path,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_hold_without_a_screen_returns_with_a_message(tmp_path: Path) -> None:
    done = run(OPEN + "viewer.hold()", tmp_path, ULNA_HEADLESS="1")
    assert done.returncode == 0 and done.stderr == ""
    assert done.stdout.count("\n") == 1 and "There is no screen" in done.stdout


def test_an_error_of_the_script_is_all_that_is_said(tmp_path: Path) -> None:
    done = run(OPEN + "viewer.simulate().run(0.1, 0.05)\nraise SystemExit(3)", tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (3, "", "")


@pytest.mark.skipif(sys.platform == "win32", reason="there are no terminals of this kind")
def test_ctrl_c_ends_hold_and_the_script_goes_on(tmp_path: Path) -> None:
    import pty

    (tmp_path / "script.py").write_text(OPEN + "viewer.hold()\nprint('afterwards')\n")
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env={**os.environ, "ULNA_HEADLESS": ""},
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    said = ""
    try:
        while "Ctrl-C ends it" not in said:
            said += os.read(ours, 1000).decode()
        port = int(re.findall(r"localhost:(\d+)", said)[0])
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=600) == 0
        while "afterwards" not in said:
            said += os.read(ours, 1000).decode()
    finally:
        process.kill()
        process.wait()
        os.close(ours)
    assert "Traceback" not in said and "Exception" not in said
    with socket.socket() as again:
        again.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.bind(("127.0.0.1", port))


def test_many_pages_after_another_leave_no_thread_and_no_file_open() -> None:
    def files() -> int:
        return len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0

    def once() -> None:
        with Viewer(port=0, browser=False) as viewer, Viewer(port=0, browser=False) as second:
            assert viewer.url != second.url
            viewer.teach_panel(viewer.add(ulna.load("panda", visuals="simple"), "qr"))
            viewer.panel.slider("gain", 0, 1)
            viewer.simulate(realtime=False).step(0.01)

    once()
    before, open_before = set(threading.enumerate()), files()
    for _ in range(3):
        once()
    due = time.monotonic() + 30.0
    while time.monotonic() < due and (set(threading.enumerate()) - before or files() > open_before):
        time.sleep(0.05)
    assert set(threading.enumerate()) <= before
    assert files() <= open_before


def test_a_port_that_somebody_else_has_gives_the_next() -> None:
    with socket.socket() as foreign:
        foreign.bind(("127.0.0.1", 0))
        foreign.listen()
        port = foreign.getsockname()[1]
        with Viewer(port=port, browser=False) as viewer:
            assert viewer.url != f"http://localhost:{port}"
            assert viewer.url.startswith("http://localhost:")


def test_a_notebook_shows_the_page_inline_and_nothing_of_a_closed_one() -> None:
    from IPython.core.formatters import DisplayFormatter

    formatter = DisplayFormatter()
    with Viewer(port=0, browser=False) as viewer:
        shown, _ = formatter.format(viewer)
        assert f'<iframe src="{viewer.url}"' in shown["text/html"]
        assert viewer.url in shown["text/plain"]
    shown, _ = formatter.format(viewer)
    assert "text/html" not in shown
    shown, _ = formatter.format(Viewer(page=False))
    assert "text/html" not in shown
