"""The viewer: a scene to put things into, a page in the browser, pictures and films without one."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path as FilePath
from typing import Any, final

import numpy as np

from ulna.errors import InputError
from ulna.sim import Recording, Simulation
from ulna.typing import Array
from ulna.viewer.camera import Camera, frame
from ulna.viewer.film import check_film, moments, write_film
from ulna.viewer.handles import Handle
from ulna.viewer.hold import hold
from ulna.viewer.html import write_html
from ulna.viewer.page import Page
from ulna.viewer.panel import Panel
from ulna.viewer.pendant import Pendant
from ulna.viewer.progress import progress
from ulna.viewer.raster import render, write_png
from ulna.viewer.robot_handle import RobotHandle
from ulna.viewer.screen import open_browser, somebody_can_look
from ulna.viewer.stage import Stage
from ulna.viewer.theme import LIGHT, Theme, theme_of
from ulna.viewer.timeline import Motion, Timeline

Recorded = Recording | Mapping[RobotHandle, Recording] | None


@final
class Viewer(Stage):
    """A scene with a page in the browser.

    It returns at once and never waits for a browser; whoever opens `url` sees what there is. Without a screen, a
    browser or anybody to look, everything works the same, and pictures, films and HTML files can be written.

    Args:
        port: Port of the page; the next free one is taken when it is in use, 0 takes any.
        host: Address to listen on. Beyond the loopback the page asks for the token that its address carries.
        browser: Whether to open a browser window, where there is a screen.
        page: Whether there is a page at all; without one nothing but NumPy is needed.
        title: What stands over the panel.
        theme: "light", "dark" or a `Theme`.
        camera: Where the scene is looked at from at first; one that has everything in view when not given.
        floor: Height of the floor [m]; at 0 or below everything when not given.

    Raises:
        MissingExtra: The package viser is not installed.
        ViewerError: The page cannot be served.
    """

    def __init__(
        self,
        port: int = 8080,
        host: str = "127.0.0.1",
        *,
        browser: bool = True,
        page: bool = True,
        title: str = "Ulna",
        theme: Theme | str = LIGHT,
        camera: Camera | None = None,
        floor: float | None = None,
    ) -> None:
        super().__init__()
        self.title, self._theme, self._camera, self._floor = title, theme_of(theme), camera, floor
        self._grid = True
        self._page = Page(self.scene, title, port, host, camera, self._theme, floor) if page else None
        self.panel = Panel(self._page)
        """The panel, for sliders, buttons, menus, words and plots of your own."""
        self._simulation: Simulation | None = None
        self._timeline: Timeline | None = None
        if browser and self._page is not None:
            open_browser(self._page.url)

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

    def flush(self) -> None:
        """Send what there is now, without waiting for the next sixtieth of a second."""
        if self._page is not None:
            self._page.flush()

    def hold(self, seconds: float | None = None) -> None:
        """Keep the page open until Ctrl-C, until `close`, until the last tab is closed, or for some seconds.

        Where nobody can look (no page, no screen, no terminal) it says so and returns at once.
        """
        if self._page is None:
            print("There is no page to hold open.", flush=True)
        else:
            hold(self._page, seconds)

    def close(self) -> None:
        """Close the page. The scene stays."""
        if self._page is not None:
            self._page.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str | None:
        return None if self._page is None or self._page.closed else self._page._repr_html_()

    def __repr__(self) -> str:
        return f"<viewer of {len(self.scene.names)} things" + (
            f" at {self.url}>" if self.url else ", without a page>"
        )

    # how it is looked at --------------------------------------------------------------------------------------

    @property
    def theme(self) -> Theme:
        """The colours around; "light" and "dark" can be assigned, too."""
        return self._theme

    @theme.setter
    def theme(self, theme: Theme | str) -> None:
        self._theme = theme_of(theme)
        self._dress()

    @property
    def floor(self) -> float | None:
        """The height of the floor [m]; None for 0, or below everything."""
        return self._floor

    @floor.setter
    def floor(self, height: float | None) -> None:
        self._floor = None if height is None else float(height)
        self._dress()

    @property
    def camera(self) -> Camera:
        """Where the scene is looked at from; assigning one moves every tab, None has everything in view again."""
        return self._camera or frame(self.scene)

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._camera = camera
        if self._page is not None:
            self._page.look(camera)

    def _dress(self) -> None:
        if self._page is not None:
            self._page.dress(self._theme, self._floor)

    def _added(self, handle: Handle) -> None:
        if self._page is not None:
            self._page.frame_once()
        if isinstance(handle, RobotHandle) and self._simulation is not None:
            self._adopt(handle)

    def pendant(self, robot: RobotHandle) -> Pendant:
        """Put a robot's joints, its tool's pose and a target to drag into the panel.

        Raises:
            InputError: There is no page.
        """
        if self._page is None:
            raise InputError("There is no page to put sliders into.")
        return Pendant(self._page, robot, lambda: self.scene.snapshot().poses[self.scene.row(robot.name)])

    # time -----------------------------------------------------------------------------------------------------

    @property
    def robots(self) -> tuple[RobotHandle, ...]:
        """The robots in the scene."""
        return tuple(h for h in self._handles.values() if isinstance(h, RobotHandle))

    def simulate(
        self, realtime: bool | None = None, speed: float = 1.0, substep: float = 1e-3, **told: Any
    ) -> Simulation:
        """A simulation of all robots here, also of those that come later; the panel gets its time line.

        Their handles' `q` and `qd` are its state from now on; `handle.body` is what to tell.

        Args:
            realtime: Whether steps wait for their time; None for whenever somebody can look.
            speed: Simulated seconds per second in real time.
            substep: The longest step of dynamics [s].
            told: `control`, `limits`, `friction`, `record` of every robot, as for `ulna.sim.Body`.

        Raises:
            InputError: A number is out of range.
        """
        watched = not self.closed and somebody_can_look()
        sim = Simulation(watched if realtime is None else realtime, speed, substep)
        sim.patience = lambda: self.clients > 0
        self._simulation, self._told = sim, told
        for robot in self.robots:
            robot.simulated_by(None)
            self._adopt(robot)
        sim.each_step(self._show_step)
        self._timeline = Timeline(self._page, self._simulated, sim, speed)
        return sim

    def _adopt(self, robot: RobotHandle) -> None:
        assert self._simulation is not None
        robot.simulated_by(
            self._simulation.add(robot.robot, q=robot.q, qd=robot.qd, name=robot.name, **self._told)
        )

    def _show_step(self, _: Simulation) -> None:
        with self.scene.together():  # all robots or none: no picture shows them at different times
            for robot in self.robots:
                robot.follow_body()

    def _simulated(self) -> Sequence[Motion]:
        return [(r, lambda b=b: b.recording) for r in self.robots if (b := r.body) is not None]

    def play(self, recorded: Recorded = None, speed: float = 1.0) -> Timeline:
        """Play what was recorded in the page, with a time line to pause and scrub, and return at once.

        Args:
            recorded: A recording of the only robot, recordings by robot, or None for those of the simulation.
            speed: Seconds of what happened per second.

        Raises:
            InputError: It is not clear what to play.
        """
        motions = self._motions(recorded)
        timeline = self._timeline if recorded is None else None
        if timeline is None:
            timeline = self._timeline = Timeline(self._page, lambda: motions, None, speed)
        timeline.time = 0.0
        timeline.play(speed)
        return timeline

    def _motions(self, recorded: Recorded) -> Sequence[Motion]:
        if recorded is None:
            motions = self._simulated()
            if not motions:
                raise InputError("Nothing was simulated here; give a recording.")
            return motions
        if isinstance(recorded, Recording):
            if len(self.robots) != 1:
                raise InputError(
                    f"There are {len(self.robots)} robots here; give {{handle: recording}} to say which one it is of."
                )
            return [(self.robots[0], lambda: recorded)]
        return [(robot, lambda r=r: r) for robot, r in recorded.items()]

    # files ----------------------------------------------------------------------------------------------------

    def picture(
        self,
        path: str | os.PathLike[str] | None = None,
        width: int = 1600,
        height: int = 1000,
        *,
        camera: Camera | None = None,
        samples: int = 2,
    ) -> Array:
        """A picture of the scene (height, width, 3), uint8, drawn without a browser; written as a PNG file, too.

        Args:
            path: The file; none is written when not given.
            width: Width [pixels].
            height: Height [pixels].
            camera: From where; the viewer's when not given.
            samples: Samples along each edge of a pixel; 2 is smooth, 1 quick.

        Raises:
            InputError: The size is out of range, or the file cannot be written.
        """
        view = camera or self._camera or frame(self.scene, width / height)
        image = render(self.scene, width, height, view, samples, self._theme, self._floor)
        if path is not None:
            write_png(path, image)
        return image

    def film(
        self,
        path: str | os.PathLike[str],
        recorded: Recorded = None,
        *,
        fps: float = 25.0,
        speed: float = 1.0,
        width: int = 960,
        height: int = 600,
        camera: Camera | None = None,
        samples: int = 2,
        move: Callable[[float], None] | None = None,
        duration: float | None = None,
    ) -> FilePath:
        """Write a film at its true speed: .mp4 or .gif, drawn without a browser.

        Args:
            path: The file.
            recorded: A recording of the only robot, recordings by robot, or None for those of the simulation.
            fps: Pictures a second.
            speed: Seconds of what happened per second of film.
            width: Width [pixels].
            height: Height [pixels].
            camera: From where; one that stays and has the first and the last moment in view when not given.
            samples: Samples along each edge of a pixel.
            move: Brings the scene to a time [s], called before each picture; instead of `recorded`, with `duration`.
            duration: How long it is that `move` shows [s].

        Raises:
            UnknownName: It ends neither in .mp4 nor in .gif.
            MissingExtra: imageio-ffmpeg or Pillow is not installed.
            InputError: It is not clear what to show, or the file cannot be written.
        """
        check_film(path)
        bring, length = self._mover(recorded, move, duration)
        times = moments(length, fps, speed)
        with self._as_it_was():
            view = camera or self._camera or self._view_of(bring, times, width / height)

            def pictures() -> Iterator[Array]:
                with progress(f"Drawing {os.path.basename(os.fspath(path))}") as report:
                    for k, t in enumerate(times):
                        report(k, len(times))
                        bring(float(t))
                        yield self.picture(None, width, height, camera=view, samples=samples)

            return write_film(path, pictures(), fps)

    def html(
        self,
        path: str | os.PathLike[str],
        recorded: Recorded = None,
        *,
        fps: float = 30.0,
        camera: Camera | None = None,
    ) -> FilePath:
        """Write the scene as one HTML file that plays offline, with a time line and a camera to move.

        Args:
            path: The file.
            recorded: What moves, as for `film`; None for the simulation's recordings, or a scene at rest.
            fps: Poses a second.
            camera: From where at first.

        Raises:
            MissingExtra: viser is not installed.
            InputError: It is not clear what to show, or the file cannot be written.
        """
        times, bring = np.zeros(0), None
        if recorded is not None or self._simulated():
            bring, length = self._mover(recorded, None, None)
            times = moments(length, fps)
        options: dict[str, Any] = {"title": self.title, "theme": self._theme, "floor": self._floor}
        with self._as_it_was():
            return write_html(
                path, self.scene, times.tolist(), bring, camera=camera or self._camera, **options
            )

    def _mover(
        self, recorded: Recorded, move: Callable[[float], None] | None, duration: float | None
    ) -> tuple[Callable[[float], None], float]:
        if (move is None) != (duration is None) or (move is not None and recorded is not None):
            raise InputError("Give either what was recorded, or `move` with a `duration` [s].")
        if move is not None and duration is not None:
            return move, float(duration)
        motions = self._motions(recorded)
        timeline = Timeline(None, lambda: motions)

        def bring(t: float) -> None:
            timeline.time = t

        return bring, timeline.duration

    def _view_of(self, bring: Callable[[float], None], times: Array, aspect: float) -> Camera:
        bring(float(times[-1]))
        last = self.scene.points()
        bring(float(times[0]))
        return frame(self.scene, aspect, also=last)

    def _as_it_was(self) -> _AsItWas:
        return _AsItWas(self.robots)


class _AsItWas:
    """Robots stand afterwards where they stood before."""

    def __init__(self, robots: Sequence[RobotHandle]) -> None:
        self._before = [(robot, robot.q) for robot in robots]

    def __enter__(self) -> None:
        pass

    def __exit__(self, *_: object) -> None:
        for robot, q in self._before:
            robot.show_at(q)
