"""A scene and its motion as one HTML file: it plays offline, with a time line and a camera to move."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path

from ulna.checks.paths import checked_path
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT, Theme
from ulna.viewer.output.atomic_file import atomic_write
from ulna.viewer.output.page_file import PageFile
from ulna.viewer.page import Page
from ulna.viewer.page.server import start_recording
from ulna.viewer.progress import progress


def write_html(
    path: str | os.PathLike[str],
    scene: SceneGraph,
    times: Iterable[float] = (),
    move: Callable[[float], None] | None = None,
    *,
    title: str = "Ulna",
    camera: Camera | None = None,
    theme: Theme = LIGHT,
    floor: float | None = None,
) -> Path:
    """Write a scene as an HTML file that needs nothing else.

    Args:
        path: Where to.
        scene: What to show.
        times: When there is something new [s], in rising order, from 0; none for a scene at rest.
        move: Brings the scene to one of these times.
        title: The title of the tab.
        camera: The first camera.
        theme: The colours around.
        floor: Height of the floor [m]; below everything when not given.

    Returns:
        The path of the file.

    Raises:
        MissingExtra: viser is not installed.
        InputError: The file cannot be written.
        UnknownName: It ends neither in .html nor in .htm.
    """
    target = checked_html_path(path)
    frame_times = list(times)
    if frame_times and move is not None:
        move(frame_times[0])
    with Page(scene, title, port=0, camera=camera, theme=theme, floor=floor, live=False) as page:
        recording = start_recording(page.server)
        before = frame_times[0] if frame_times else 0.0
        with progress(f"Writing {target.name}") as report:
            for k, t in enumerate(frame_times[1:] if move is not None else []):
                report(k, len(frame_times))
                recording.insert_sleep(t - before)
                before = t
                assert move is not None
                move(t)
                page.flush()
            content = recording.as_html(dark_mode=theme.dark)
    with atomic_write(target, "page") as file:
        file.write_text(content, encoding="utf-8")
    return PageFile(target)


def checked_html_path(path: str | os.PathLike[str]) -> Path:
    """The path of an HTML file.

    Raises:
        UnknownName: It ends neither in .html nor in .htm.
    """
    return checked_path(path, "page", (".html", ".htm"))
