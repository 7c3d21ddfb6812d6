"""A forked child keeps none of the sockets of a page."""

from __future__ import annotations

import os

import pytest

from support.fork_scripts import run_script

pytest.importorskip("viser")
pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def test_a_page_that_is_closed_cannot_be_reached_while_a_child_lives():
    run_script(
        """
        import socket, stat
        from websockets.sync.client import connect
        from ulna.viewer.page import Page
        from ulna.viewer.scene import Scene
        page = Page(Scene(), port=0)
        port = page.port
        from viser import __version__
        tab = connect(f"ws://localhost:{port}", subprotocols=[f"viser-v{__version__}"], open_timeout=20, max_size=None)
        tab.recv(timeout=20)
        mine = {tab.socket.fileno()}

        def sockets_of_the_port():
            found = []
            for number in range(256):
                try:
                    if number in mine or not stat.S_ISSOCK(os.fstat(number).st_mode):
                        continue
                    copy = socket.socket(fileno=os.dup(number))
                except OSError:
                    continue
                with copy:
                    if copy.family in (socket.AF_INET, socket.AF_INET6) and copy.getsockname()[1] == port:
                        found.append(number)
            return found

        assert len(sockets_of_the_port()) >= 2, sockets_of_the_port()
        ready, leave = os.pipe(), os.pipe()
        number = os.fork()
        if number == 0:
            left = sockets_of_the_port()
            os.write(ready[1], b"%d" % len(left))
            os.close(leave[1])
            os.read(leave[0], 1)
            os._exit(0)
        assert os.read(ready[0], 9) == b"0"
        assert len(sockets_of_the_port()) >= 2  # the parent has them still
        page.close()
        try:
            socket.create_connection(("localhost", port), timeout=10.0).close()
        except OSError:
            pass
        else:
            raise SystemExit("something listens still")
        os.close(leave[1])
        assert os.waitpid(number, 0)[1] == 0
        """
    )


def test_what_a_child_loads_is_not_reported_to_the_page_of_its_parent():
    run_script(
        """
        from ulna.compiler.runtime import jit
        from ulna.viewer.page import Page
        from ulna.viewer.scene import Scene
        page = Page(Scene(), port=0)
        assert len(jit.watchers) == 1
        number = os.fork()
        if number == 0:
            os._exit(len(jit.watchers))
        assert os.waitpid(number, 0)[1] == 0
        page.close()
        assert jit.watchers == []
        """
    )
