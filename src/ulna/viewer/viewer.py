"""The viewer: a scene to add objects to, a page in the browser, pictures and films without one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

from ulna.checks.values import flag, number
from ulna.checks.values import short_repr as worded
from ulna.errors import InputError, UnknownName
from ulna.idioms import unknown_attribute
from ulna.sim import Simulation
from ulna.sim.body import BODY_OPTIONS, check_body_options
from ulna.viewer.export import ExportMethods, Playable, checked_floor
from ulna.viewer.graph.camera import Camera, camera_for, checked_camera
from ulna.viewer.graph.handles import Handle
from ulna.viewer.graph.theme import LIGHT, Theme, theme_of
from ulna.viewer.notebook import page_html, picture_html
from ulna.viewer.page import Page
from ulna.viewer.page.access import checked_host
from ulna.viewer.page.browser import open_browser, somebody_can_look
from ulna.viewer.page.keep_open import keep_open
from ulna.viewer.page.port import checked_port
from ulna.viewer.panel import Panel
from ulna.viewer.panel.teach_panel import TeachPanel
from ulna.viewer.panel.timeline import SPEED_EXPECTED, Timeline
from ulna.viewer.robot.handle_motion import HandleMotion, recorded_motion
from ulna.viewer.robot.robot_handle import RobotHandle


@final
class Viewer(ExportMethods):
    """A scene with a page in the browser.

    It returns at once and never waits for a browser; a browser that opens `url` shows the scene. Without a screen, a
    browser or anybody to look, everything works the same, and pictures, films and HTML files can be written.

    Args:
        port: Port of the page; the next free one is taken when it is in use, 0 takes any; None for that of the
            environment variable `ULNA_PORT`, or 8080.
        host: Address to listen on. Addresses other than the loopback need a token, which `url` contains.
        browser: Whether to open a browser window, where there is a screen.
        page: Whether there is a page at all; without one nothing but NumPy is needed.
        title: The heading of the panel.
        theme: "light", "dark" or a `Theme`.
        camera: The first camera; one that shows the whole scene when not given.
        floor: Height of the floor [m]; at 0 or below everything when not given.
        server: A `viser.ViserServer` of the program to draw into; `port` and `host` are its own then, and its page,
            lights and camera stay as they are.

    Raises:
        InputError: `server` is no viser server, or there is to be no page.
        MissingExtra: The package viser is not installed.
        ViewerError: The page cannot be served.

    Example:
        >>> viewer = ulna.Viewer(page=False)  # without a page in the browser, for pictures and films
        >>> arm = viewer.add(ulna.load("panda"), "ready")
        >>> arm.q = arm.q + 0.1  # the picture, and an open page, follow
        >>> viewer.robots == (arm,)
        True
    """

    panel: Panel
    """The panel, for sliders, buttons, menus, texts and plots."""

    def __init__(
        self,
        port: int | None = None,
        host: str = "127.0.0.1",
        *,
        browser: bool = True,
        page: bool = True,
        title: str = "Ulna",
        theme: Theme | str = LIGHT,
        camera: Camera | None = None,
        floor: float | None = None,
        server: Any = None,
    ) -> None:
        super().__init__(title, theme, camera, floor)
        flag("browser", browser)
        port = checked_port(port)
        checked_host(host)
        _check_server(server, flag("page", page))
        self._page = (
            Page(self.scene, title, port, host, camera, self._theme, floor, server=server) if page else None
        )
        self.panel = Panel(self._page)
        self._simulation: Simulation | None = None
        self._timeline: Timeline | None = None
        if self._page is not None:
            self._page.play_out = self._play_out
            if browser:
                self.open_browser()

    # the page -------------------------------------------------------------------------------------------------

    @property
    def url(self) -> str:
        """The address of the page; empty without one."""
        return "" if self._page is None else self._page.url

    @property
    def clients(self) -> int:
        """How many tabs are looking."""
        return 0 if self._page is None else self._page.clients

    @property
    def closed(self) -> bool:
        """Whether there is no page, or no longer."""
        return self._page is None or self._page.closed

    def open_browser(self, name: str | None = None) -> bool:
        """Open the page in a browser, where there is a screen.

        Args:
            name: The browser, as the module `webbrowser` names it; the user's when not given.

        Returns:
            Whether a browser was started.
        """
        opened = self._page is not None and open_browser(self._page.url, name)
        if opened and self._page is not None:
            self._page.note_opened()
        return opened

    def flush(self) -> None:
        """Send what there is now, without waiting for the next sixtieth of a second."""
        if self._page is not None:
            self._page.flush()

    def hold(self, seconds: float | None = None) -> None:
        """Keep the page open until Ctrl-C, until `close`, until the last tab is closed, or for some seconds.

        Without a page, or without a display and an interactive terminal, it prints a message and returns at once.
        """
        if seconds is not None:
            number("seconds", seconds, "a time of at least 0 [s]", least=0.0)
        if self._page is None:
            print("There is no page to hold open.", flush=True)
        else:
            keep_open(self._page, seconds)

    def close(self) -> None:
        """Close the page. The scene stays."""
        if self._page is not None:
            self._page.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str | None:
        if self._page is None:
            return picture_html(self.scene, self._theme) if self.scene.names else None
        return None if self._page.closed else page_html(self._page, self._theme)

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("viewer", name, dir(type(self)))

    def __repr__(self) -> str:
        return f"<viewer of {len(self.scene.names)} things" + (
            f" at {self.url}>" if not self.closed else ", without a page>"
        )

    # how it is looked at --------------------------------------------------------------------------------------

    @property
    def theme(self) -> Theme:
        """The colours around; "light" and "dark" can be assigned, too."""
        return self._theme

    @theme.setter
    def theme(self, theme: Theme | str) -> None:
        self._theme = theme_of(theme)
        self._update_surroundings()

    @property
    def floor(self) -> float | None:
        """The height of the floor [m]; None for 0, or below everything."""
        return self._floor

    @floor.setter
    def floor(self, height: float | None) -> None:
        self._floor = checked_floor(height)
        self._update_surroundings()

    @property
    def camera(self) -> Camera:
        """The camera; assigning one sets that of every tab, None shows the whole scene again."""
        return self._camera or camera_for(self.scene)

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._camera = checked_camera(camera)
        if self._page is not None:
            self._page.set_camera(camera)

    def _update_surroundings(self) -> None:
        if self._page is not None:
            self._page.set_theme(self._theme, self._floor)

    def _on_added(self, handle: Handle) -> None:
        if self._page is not None:
            self._page.request_framing()
            self.keep_frame()
        if isinstance(handle, RobotHandle) and self._simulation is not None:
            self._simulate_robot(handle)

    def teach_panel(self, robot: RobotHandle) -> TeachPanel:
        """Put a robot's joints, its tool's pose and a target to drag into the panel.

        Raises:
            InputError: There is no page.
        """
        if not isinstance(robot, RobotHandle):
            raise InputError(
                f"`robot` is {worded(robot)}; expected a handle that viewer.add(robot) returned."
            )
        if self._page is None:
            raise InputError("There is no page to put sliders into.")
        return TeachPanel(self._page, robot, lambda: robot.world_pose, heading=robot.name)

    pendant = teach_panel
    """Old name."""

    # time -----------------------------------------------------------------------------------------------------

    def simulate(
        self, realtime: bool | None = None, speed: float = 1.0, substep: float = 1e-3, **body_options: Any
    ) -> Simulation:
        """A simulation of all robots here, also of those that come later; the panel gets its time line.

        `q` and `qd` of their handles are its state from now on; commands go to `handle.body`.

        Args:
            realtime: Whether steps run in real time; None for real time where a page can be shown.
            speed: Simulated seconds per second in real time [-].
            substep: The longest step of dynamics [s].
            **body_options: `control`, `limits`, `friction`, `record` of every robot, as for `ulna.sim.Body`.

        Returns:
            The simulation.

        Raises:
            InputError: A number is out of range.
            UnknownName: There is no such option.
        """
        unknown = [name for name in body_options if name not in BODY_OPTIONS]
        if unknown:
            raise UnknownName("option of simulated robots", unknown[0], BODY_OPTIONS)
        check_body_options(**body_options)
        watched = not self.closed and somebody_can_look()
        sim = Simulation(watched if realtime is None else realtime, speed, substep)
        sim.can_resume = lambda: self.clients > 0
        self._simulation, self._body_options = sim, body_options
        for robot in self.robots:
            robot.set_body(None)
            self._simulate_robot(robot)
        if self._page is not None:
            self._page.motion.follow_simulation(lambda: sim.t)
        sim.each_step(self._show_step)
        if self._timeline is not None:
            self._timeline.remove()
        self._timeline = Timeline(self._page, self._simulated, sim, speed)
        return sim

    def _simulate_robot(self, robot: RobotHandle) -> None:
        assert self._simulation is not None
        robot.set_body(
            self._simulation.add(robot.robot, q=robot.q, qd=robot.qd, name=robot.name, **self._body_options)
        )

    def _show_step(self, _: Simulation) -> None:
        with self.scene.atomic():  # all robots or none: no picture shows them at different times
            for robot in self.robots:
                robot.show_body_state()
        self.keep_frame()

    def keep_frame(self) -> None:
        """Keep the poses at the simulated time for the page, which plays them after the program has ended.

        Each step of a simulation does so 60 times in a second. Without a simulation the page keeps what is sent to it.
        """
        if self._page is not None and not self._page.closed:
            self._page.motion.add_step(self.scene.snapshot)

    def _play_out(self) -> None:
        """Add to the motion of the page what is left of a trajectory that is being played; take its controls away."""
        if self._timeline is not None and self._page is not None:
            motion = self._page.motion
            self._timeline.play_out(lambda passed: motion.add_later(passed, self.scene.snapshot()))
            self._timeline.remove()

    def _simulated(self) -> Sequence[HandleMotion]:
        return [recorded_motion(r, lambda b=b: b.recording) for r in self.robots if (b := r.body) is not None]

    def play(self, motion: Playable = None, speed: float = 1.0) -> Timeline:
        """Play a motion in the page, with a time line to pause and scrub, and return at once.

        Args:
            motion: A trajectory, recording, plan or configurations (n, nq) [rad, m] for the only robot, or
                {handle: motion} for several; None for what was simulated. Other things move by trajectories of poses.
                Plans and configurations have no times: their fastest joint moves at 1 rad/s or 1 m/s.
            speed: Seconds of what happened per second [-].

        Returns:
            The time line.

        Raises:
            InputError: It is not clear what to play.
            ShapeError: The configurations are not those of the robot.

        Example:
            >>> robot, viewer = ulna.load("panda"), ulna.Viewer(page=False)
            >>> arm = viewer.add(robot, "ready")
            >>> line = viewer.play(ulna.trajectory.quintic(arm.q, arm.q + 0.3, duration=2.0))
            >>> line.pause()
            >>> line.time = 1.0  # half of the way
            >>> line.duration, arm.q.round(3)
            (2.0, array([ 0.15 , -0.635,  0.15 , -2.206,  0.15 ,  1.721,  0.935]))
        """
        number("speed", speed, SPEED_EXPECTED, above=0.0)
        motions = self._motions(motion)
        if self._timeline is not None and (motion is not None or self._timeline.simulation is None):
            self._timeline.remove()
            self._timeline = None
        if self._timeline is None:
            live = motion is None and self._simulation is not None
            source = self._simulated if live else lambda: motions
            self._timeline = Timeline(self._page, source, self._simulation if live else None, speed)
        self._timeline.time = 0.0
        self._timeline.play(speed)
        return self._timeline


def _check_server(server: Any, page: bool) -> None:
    """Refuses what is no viser server.

    Raises:
        InputError: It is none, or it comes without a page.
    """
    if server is not None and not (page and hasattr(server, "scene") and hasattr(server, "get_clients")):
        arguments = "page=False and a server" if not page else f"`server` = {worded(server)}"
        raise InputError(
            f"The viewer was given {arguments}; expected a viser.ViserServer, whose page shows the scene."
        )
