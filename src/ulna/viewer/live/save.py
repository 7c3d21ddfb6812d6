"""`robot.save_html`: a robot as a file that browsers open."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ulna.checks.paths import checked_path
from ulna.checks.values import checked_robot, flag, one_of, text
from ulna.errors import InputError
from ulna.typing import ArrayLike
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.live.draggable import draggable_frames
from ulna.viewer.live.motion import motion_rows
from ulna.viewer.live.page import document, live_page, script
from ulna.viewer.output.atomic_file import atomic_write
from ulna.viewer.output.page_file import PageFile
from ulna.viewer.page.html_file import checked_html_path
from ulna.viewer.progress import progress
from ulna.viewer.robot.configuration import configuration
from ulna.viewer.robot.link_surfaces import checked_display
from ulna.viewer.robot.robot_visual import RobotVisual
from ulna.viewer.viewer import Viewer

THEMES = ("auto", "light", "dark")


def save_html(
    robot: Any,
    path: str | os.PathLike[str],
    recorded: Any = None,
    *,
    live: bool = True,
    q: ArrayLike | str | None = None,
    frames: Sequence[str] | None = None,
    show: str = "visual",
    theme: str = "auto",
    title: str | None = None,
) -> Path:
    """Write a robot as one HTML file, see `robot.save_html`.

    Args:
        robot: An `ulna.Robot`.
        path: The file: .html, or .js for a script that other pages include.
        recorded: What is played: a recording, a trajectory, a plan, or configurations (n, nq).
        live: Whether frames can be dragged.
        q: The first configuration, (nq,) [rad or m], or its name.
        frames: Names of the frames to drag; None to choose.
        show: "visual", "collision", "both" or "skeleton".
        theme: "auto", "light" or "dark".
        title: The title; None for the robot's name.

    Returns:
        The path of the file.

    Raises:
        UnknownName, ShapeError, NonFiniteError, InputError: An argument means nothing.
    """
    checked_robot(robot)
    display, chosen_theme = checked_display(show), one_of("theme", theme, THEMES)
    heading = robot.name if title is None else text("title", title)
    if not flag("live", live):
        if frames is not None:
            raise InputError(
                f"`frames` is {frames!r}; expected None where live=False, for nothing is dragged there."
            )
        light_or_dark = "light" if chosen_theme == "auto" else chosen_theme
        return _recorded_page(robot, path, recorded, configuration(robot, q), display, light_or_dark, heading)
    target = checked_path(path, "page", (".html", ".htm", ".js"))
    chosen = draggable_frames(robot.model, frames)
    with progress("Loading meshes") as report:
        visual = RobotVisual(SceneGraph(), robot, configuration(robot, q), show=display, report=report)
    motion = None if recorded is None else motion_rows(visual, recorded)
    if motion is not None and q is None:
        visual.move(motion[1][0])
    with progress(f"Writing {target.name}"):
        page = live_page(visual, chosen, motion, heading, chosen_theme)
        content = script(page) if target.suffix.lower() == ".js" else document(page)
        with atomic_write(target, "page") as file:
            file.write_text(content, encoding="utf-8")
    return PageFile(target)


def _recorded_page(robot: Any, path: Any, recorded: Any, q: Any, show: Any, theme: str, title: str) -> Path:
    checked_html_path(path)
    viewer = Viewer(page=False, title=title, theme=theme)
    viewer.add(robot, q, show=show)
    return viewer.html(path, recorded)
