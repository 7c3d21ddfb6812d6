"""A robot in the browser with a slider for each joint, its tool's pose, and a target to drag."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import checked_robot, flag, short_repr
from ulna.errors import InputError
from ulna.system import forks
from ulna.typing import ArrayLike, Floats
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.theme import LIGHT, Theme, theme_of
from ulna.viewer.notebook import page_html
from ulna.viewer.page import Page
from ulna.viewer.page.browser import open_browser
from ulna.viewer.page.keep_open import keep_open
from ulna.viewer.panel.teach_panel import TeachPanel
from ulna.viewer.progress import progress
from ulna.viewer.robot.configuration import configuration
from ulna.viewer.robot.link_surfaces import RobotDisplay, checked_display
from ulna.viewer.robot.robot_visual import RobotVisual
from ulna.viewer.scene import Scene


def show(
    robot: Any,
    q: ArrayLike | str | None = None,
    *,
    port: int | None = None,
    host: str = "127.0.0.1",
    browser: bool = True,
    scene: Scene | None = None,
    camera: Camera | None = None,
    theme: Theme | str = LIGHT,
    show: RobotDisplay = "visual",
) -> Show:
    """Open a page that shows a robot, with sliders and a target to drag, and return at once.

    Args:
        robot: An `ulna.Robot`.
        q: Its configuration: an array (nq,) [rad or m], the name of one of `robot.configurations`, or None for
            the first of these ("qr" where there is one).
        port: Port of the page; the next free one is taken when it is in use, 0 takes any; None for that of the
            environment variable `ULNA_PORT`, or 8080.
        host: Address to listen on. Addresses other than the loopback need a token, which `url` contains.
        browser: Whether to open a browser window, where there is a screen.
        scene: A scene to show the robot in, with other things; an empty one when not given.
        camera: The first camera; one that shows the whole scene from the front right when not given.
        theme: "light" or "dark".
        show: What of it: "visual", "collision", "both" or "skeleton".

    Returns:
        The page, with the robot's handle.

    Raises:
        MissingExtra: The package viser is not installed.
        ShapeError, NonFiniteError: `q` is not a configuration of the robot.
        UnknownName: There is no configuration, theme or way to show it of that name.
        InputError: An argument has the wrong type, or is out of range.

    Example:
        >>> page = ulna.show(ulna.load("panda"), "ready")  # doctest: +SKIP
        >>> page.url  # doctest: +SKIP
        'http://127.0.0.1:8080'
    """
    start = configuration(checked_robot(robot), q)
    if not (scene is None or isinstance(scene, Scene)):
        raise InputError(
            f"`scene` is {short_repr(scene)}; expected a Scene, such as viewer.scene is, or None."
        )
    flag("browser", browser)
    target_scene = scene if scene is not None else Scene()
    out = Show(robot, start, target_scene, port, host, camera, theme_of(theme), checked_display(show))
    if browser and open_browser(out.url):
        out.page.note_opened()
    return out


@final
class Show(FixedAttributes):
    """A robot in a page. `q` is where it stands; setting it moves the robot, the sliders and the target.

    Args:
        robot: The robot.
        q: Configuration, shape (nq,) [rad, m].
        scene: The scene.
        port: Port of the page.
        host: Address of the page.
        camera: The camera; None for one that sees the robot.
        theme: Colours of the surroundings.
        showing: What is drawn of the robot.
    """

    robot: Any
    scene: Scene
    lock: Any
    name: str
    page: Page
    teach_panel: TeachPanel

    def __init__(
        self,
        robot: Any,
        q: Floats,
        scene: Scene,
        port: int | None,
        host: str,
        camera: Camera | None,
        theme: Theme,
        showing: RobotDisplay = "visual",
    ) -> None:
        self.robot, self.scene = robot, scene
        self.lock = forks.lock()
        with progress("Loading meshes") as report:
            self._visual = RobotVisual(scene, robot, q, show=showing, report=report)
        self.name = self._visual.name
        try:
            self.page = Page(scene, title=robot.name, port=port, host=host, camera=camera, theme=theme)
        except BaseException:
            self._visual.remove()
            raise
        self.teach_panel = TeachPanel(self.page, self)

    @property
    def pendant(self) -> TeachPanel:
        """Old name of `teach_panel`."""
        return self.teach_panel

    @property
    def url(self) -> str:
        """The address of the page."""
        return self.page.url

    @property
    def q(self) -> Floats:
        """The configuration, shape (nq,), read-only: assign all of it."""
        return self._visual.q

    @q.setter
    def q(self, q: ArrayLike | str) -> None:
        with self.lock:
            self._visual.move(configuration(self.robot, q))

    @property
    def moves(self) -> int:
        """How often it was moved."""
        return self._visual.moves

    @property
    def tool(self) -> Floats:
        """Where the tool is, T_world_tool, shape (4, 4)."""
        return np.asarray(self.robot.fk(self.q))

    def set_target(self, T_goal: ArrayLike) -> None:
        """Move the target, as dragging it does: the tool follows as far as the joints allow."""
        self.teach_panel.set_target(T_goal)

    aim = set_target
    """Old name."""

    def hold(self, seconds: float | None = None) -> None:
        """Keep the page open until Ctrl-C, until `close`, until the last tab is closed, or for some seconds.

        Without a display and without an interactive terminal it prints a message and returns at once.
        """
        keep_open(self.page, seconds)

    def close(self) -> None:
        """Close the page."""
        self.page.close()

    def __enter__(self) -> Show:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return page_html(self.page)

    def __repr__(self) -> str:
        return f"<page of {self.robot.name!r} at {self.url}>"
