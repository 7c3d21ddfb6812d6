"""How long a script takes from its start to the first frame with all that it shows, in a browser that is running.

A frame counts when every mesh is there, the picture is no longer veiled, and the browser has drawn it to the end.
"""

from __future__ import annotations

import socket
import statistics
import subprocess
import sys
import time
from typing import Any

_SCRIPT = """
import numpy as np
import ulna
viewer = ulna.Viewer(port={port}, browser=False)
{body}
input()
viewer.close()
"""

_SEEN = """([name, count]) => new Promise(done => {
    const look = () => {
        const page = window.__viserMutable, canvas = document.querySelector("canvas[data-engine]");
        let found = 0;
        for (const [path, node] of Object.entries(page?.nodeRefFromName ?? {})) {
            if (path !== name && !path.startsWith(name + "/")) continue;
            let drawn = false;
            node.traverse(part => { drawn ||= !!part.isMesh && part.instancesCount !== 0; });
            found += drawn;
        }
        if (found < count || !canvas || +(canvas.style.opacity || 1) < 0.99) return requestAnimationFrame(look);
        requestAnimationFrame(() => requestAnimationFrame(() => {
            const gl = canvas.getContext("webgl2");  // whoever asks for a pixel waits for the picture
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            done((performance.timeOrigin + performance.now()) / 1e3);
        }));
    };
    look();
})"""


def first_sight(browser: Any, body: str, count: int, stay: bool, repeat: int = 3) -> float:
    """Seconds from a script's start to that frame, the median.

    Args:
        browser: A browser of playwright.
        body: What the script puts into `viewer`, under a name that stands there as `{name}`.
        count: How many nodes with meshes that is.
        stay: Whether the tab of the script before is still open and comes back; else a tab is opened as soon as the
            port answers, in a browser that was at that address before.
        repeat: How many scripts, after a first one that is not counted.
    """
    context = browser.new_context(viewport={"width": 640, "height": 400})
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address, seconds, tab = f"http://localhost:{port}/?fixedDpr=1", [], None
    for k in range(repeat + 1):
        if tab is None or not stay:
            tab = context.new_page()
            tab.goto("about:blank")
        else:
            tab.wait_for_timeout(1500)
        name = f"thing{k}"
        script = _SCRIPT.format(port=port, body=body.format(name=name))
        began = time.time()
        program = subprocess.Popen(
            [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
        )
        try:
            if tab.url == "about:blank":
                _answers(port)
                tab.goto(address, wait_until="commit")
            seconds.append(tab.evaluate(_SEEN, [f"/{name}", count]) - began)
        finally:
            program.communicate(b"\n")
        if not stay:
            tab.close()
    context.close()
    return statistics.median(seconds[1:])


def _answers(port: int) -> None:
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 0.2).close()
            return
        except OSError:
            time.sleep(0.005)
