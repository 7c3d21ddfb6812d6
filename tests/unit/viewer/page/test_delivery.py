"""At its end a program waits until its tabs have answered that they have everything."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

import ulna
from ulna.viewer import Viewer
from ulna.viewer.page import ending
from ulna.viewer.page.pose_channel import LAST, MOTION

ANSWER = {"type": "TransformControlsDragEndMessage", "name": LAST, "owner": ""}


class Tab:
    """A program that reads what is sent to a tab, and answers the last message where it is allowed to."""

    def __init__(self, viewer: Viewer, answers: bool = True) -> None:
        protocol: Any = f"viser-v{viser.__version__}"
        self._socket = connect(viewer.url.replace("http", "ws"), subprotocols=[protocol], max_size=None)
        self.messages: list[dict[str, Any]] = []
        self.may_answer, self.has_scene = threading.Event(), threading.Event()
        if answers:
            self.may_answer.set()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        for message in self._incoming():
            self.messages.append(message)
            self.has_scene.set()
            if message.get("name") == LAST:
                self.may_answer.wait()
                with contextlib.suppress(ConnectionClosed):
                    self._socket.send(msgspec.msgpack.encode(ANSWER))

    def _incoming(self) -> Iterator[dict[str, Any]]:
        try:
            while data := self._socket.recv():
                assert isinstance(data, bytes)
                size = int.from_bytes(data[8:16], "little")
                unpacked = zstandard.ZstdDecompressor().decompress(data[16 : 16 + size])
                yield from msgspec.msgpack.decode(unpacked)["messages"]
        except ConnectionClosed:
            return

    def motion_parts(self) -> int:
        """How many parts of the whole motion have arrived once the connection has ended."""
        self._thread.join(timeout=60.0)
        return sum(str(m.get("name", "")).startswith(MOTION) for m in self.messages)


def play(viewer: Viewer) -> None:
    box = viewer.box((0.1, 0.1, 0.1), name="box")
    viewer.play({box: ulna.trajectory.pose_line(np.eye(4), ulna.SE3.trans(0.0, 0.0, 1.0), 2.0)})


def test_closing_waits_for_the_answer_of_every_tab() -> None:
    viewer = Viewer(port=0, browser=False)
    tabs = [Tab(viewer), Tab(viewer, answers=False)]
    assert all(tab.has_scene.wait(60.0) for tab in tabs)
    play(viewer)
    closing = threading.Thread(target=viewer.close)
    closing.start()
    closing.join(timeout=0.5)
    assert closing.is_alive()  # the second tab has not answered
    tabs[1].may_answer.set()
    closing.join(timeout=60.0)
    assert not closing.is_alive()
    assert [tab.motion_parts() for tab in tabs] == [1, 1]


def test_a_tab_that_never_answers_is_not_waited_for_long(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ending, "_DELIVERY_TIME", 0.2)
    monkeypatch.setattr(ending, "_QUIET_DELIVERY_TIME", 0.1)
    viewer = Viewer(port=0, browser=False)
    tab = Tab(viewer, answers=False)
    assert tab.has_scene.wait(60.0)
    play(viewer)
    viewer.close()
    assert "still receiving" in capsys.readouterr().err
    tab.may_answer.set()


def test_a_scene_without_motion_is_delivered_too() -> None:
    viewer = Viewer(port=0, browser=False)
    tab = Tab(viewer)
    assert tab.has_scene.wait(60.0)
    viewer.box((0.1, 0.1, 0.1), name="box")
    viewer.close()
    assert tab.motion_parts() == 0
    names = [message.get("name") for message in tab.messages]
    assert "/box" in names[: names.index(LAST)]
