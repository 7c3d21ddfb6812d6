"""How long a script takes from its start to the first frame with all that it shows, in a browser that is running.

A frame counts when every mesh is in it and throws its shadow, the picture is not veiled, and the browser has drawn it
to the end. The browser keeps its profile on disk, as people's browsers do, and was at that address before: so it has the
page's program, and what it compiled of it.
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
    const seen = (page, canvas) => {
        let found = 0, whole = true, lit = false;
        for (const [path, node] of Object.entries(page.nodeRefFromName)) {
            if (path !== name && !path.startsWith(name + "/")) continue;
            const parts = [];
            node?.traverse(part => { if (part.isMesh) parts.push(part); });
            found += parts.some(part => part.castShadow && part.instancesCount !== 0);
            whole &&= !parts.some(part => part.visible && part.geometry.userData.level === "few");
        }
        page.scene.traverse(o => { lit ||= !!(o.isDirectionalLight && o.castShadow && o.shadow.map && !o.shadow.needsUpdate); });
        return [found >= count && lit && +(canvas.style.opacity || 1) > 0.99, whole];
    };
    let first = 0;
    const look = () => {
        const page = window.__viserMutable;
        if (!page?.scene) return requestAnimationFrame(look);
        const before = page.scene.onAfterRender;
        page.scene.onAfterRender = (renderer, scene, camera) => {
            before?.call(scene, renderer, scene, camera);
            const [there, whole] = seen(page, renderer.domElement);
            if (!there || (first && !whole)) return;
            const gl = renderer.getContext();  // whoever asks for a pixel waits for the picture
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            const now = (performance.timeOrigin + performance.now()) / 1e3;
            first ||= now;
            if (!whole) return;
            page.scene.onAfterRender = before;
            done([first, now]);
        };
    };
    look();
})"""


def first_sight(
    context: Any, port: int, body: str, count: int, stay: bool, before: int = 1, repeat: int = 3
) -> tuple[float, float]:
    """Seconds from a script's start to that frame, and to the first with every triangle of heavy meshes: medians.

    Args:
        context: A browser of playwright, with its profile.
        port: The port of all scripts.
        body: What the script puts into `viewer`, under a name that stands there as `{name}`.
        count: How many nodes with meshes that is.
        stay: Whether the tab of the script before is still open and comes back; else a tab is opened as soon as the
            port answers.
        before: How many scripts come first and are not counted.
        repeat: How many scripts are.
    """
    address, seconds, tab = f"http://localhost:{port}/?fixedDpr=1", [], None
    for k in range(before + repeat):
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
            seconds.append([now - began for now in tab.evaluate(_SEEN, [f"/{name}", count])])
        finally:
            program.communicate(b"\n")
        if not stay:
            tab.close()
    if tab is not None and stay:
        tab.close()
    first, whole = (statistics.median(times) for times in zip(*seconds[before:], strict=True))
    return first, whole


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def _answers(port: int) -> None:
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 0.2).close()
            return
        except OSError:
            time.sleep(0.005)
