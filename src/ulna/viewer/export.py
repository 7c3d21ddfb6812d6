"""Pictures, films and HTML files of a scene, drawn without a screen."""

from __future__ import annotations

import abc
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ulna.checks.values import MAX_LENGTH, number, text
from ulna.checks.values import function as checked_function
from ulna.errors import InputError
from ulna.sim import Recording
from ulna.trajectory import Samples, Trajectory
from ulna.typing import Array, Floats
from ulna.viewer.graph.camera import Camera, camera_for, checked_camera
from ulna.viewer.graph.theme import Theme, theme_of
from ulna.viewer.output.picture import as_picture
from ulna.viewer.output.png import checked_png_path
from ulna.viewer.output.video import checked_video_path, frame_times, write_video
from ulna.viewer.page.html_file import checked_html_path, write_html
from ulna.viewer.panel.timeline import Timeline
from ulna.viewer.progress import progress
from ulna.viewer.render.renderer import check_size, render, write_png
from ulna.viewer.robot.handle_motion import HandleMotion, handle_motions
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.scene.objects import SceneMethods

if TYPE_CHECKING:
    from ulna.planning import Plan

OneMotion: TypeAlias = "Recording | Trajectory | Plan | Samples | Floats"
"""What can be played by one robot; arrays are configurations (n, nq) [rad, m]."""

Playable: TypeAlias = "OneMotion | Mapping[Any, OneMotion] | None"
"""What can be played: by the only robot, by each of several handles, or what was simulated."""

_PAGE_ASPECT = 1.6  # width over height of a usual window [-]
_CAMERA_TIMES = 8  # times of a motion that a camera which shows all of it looks at


class ExportMethods(SceneMethods, abc.ABC):
    """A scene with a camera, a floor and a light or dark surrounding, and files that show it.

    Args:
        title: The title of the page.
        theme: "light", "dark", or a theme.
        camera: The camera; None for one that sees everything.
        floor: Height of the floor [m]; None for none.
    """

    def __init__(self, title: str, theme: Theme | str, camera: Camera | None, floor: float | None) -> None:
        super().__init__()
        self._title_of_files, self._theme = text("title", title), theme_of(theme)
        self._camera, self._floor = checked_camera(camera), checked_floor(floor)

    @property
    def title(self) -> str:
        """The title of HTML files; that of the open page is the one it was made with."""
        return self._title_of_files

    @title.setter
    def title(self, title: str) -> None:
        self._title_of_files = text("title", title)

    @abc.abstractmethod
    def _simulated(self) -> Sequence[HandleMotion]:
        """The motions of the robots that a simulation moves."""

    @property
    def robots(self) -> tuple[RobotHandle, ...]:
        """The robots in the scene."""
        return tuple(h for h in self._handles.values() if isinstance(h, RobotHandle))

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

        A notebook displays it.

        Args:
            path: The file; none is written when not given.
            width: Width [pixels].
            height: Height [pixels].
            camera: The camera; that of the viewer when not given.
            samples: Samples along each edge of a pixel; 2 is smooth, 1 quick.

        Returns:
            The picture, (height, width, 3) uint8.

        Raises:
            InputError: The size is out of range, or the file cannot be written.
            UnknownName: The path does not end in .png.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> arm = viewer.add(ulna.load("panda"), "ready")
            >>> viewer.picture("panda.png", width=320, height=200).shape
            (200, 320, 3)
        """
        check_size(width, height, samples)
        target = None if path is None else checked_png_path(path)
        view = checked_camera(camera) or self._camera or camera_for(self.scene, width / height)
        image = render(self.scene, width, height, view, samples, self._theme, self._floor)
        if target is not None:
            write_png(target, image)
        return as_picture(image)

    def film(
        self,
        path: str | os.PathLike[str],
        motion: Playable = None,
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
            motion: A trajectory, recording, plan or configurations (n, nq) [rad, m] for the only robot, or
                {handle: motion} for several; None for what was simulated. Other things move by trajectories of poses.
            fps: Pictures a second [1/s].
            speed: Seconds of what happened per second of film [-].
            width: Width [pixels].
            height: Height [pixels].
            camera: The camera; a fixed one that shows the whole motion when not given, or the first and the last
                frame with `move`.
            samples: Samples along each edge of a pixel.
            move: Brings the scene to a time [s], called before each picture; instead of `motion`, with
                `duration`.
            duration: How long it is that `move` shows [s].

        Returns:
            The path of the file.

        Raises:
            UnknownName: It ends neither in .mp4 nor in .gif.
            MissingExtra: imageio-ffmpeg or Pillow is not installed.
            InputError: It is not clear what to show, or the file cannot be written.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> arm = viewer.add(ulna.load("panda", visuals="simple"), "ready")
            >>> move = ulna.trajectory.quintic(arm.q, arm.q + 0.3, duration=0.2)
            >>> viewer.film("move.gif", move, width=160, height=100).name
            'move.gif'
        """
        checked_video_path(path)
        check_size(width, height, samples)
        motions, show_time, length = self._motion(motion, move, duration)
        times = frame_times(length, fps, speed)
        with self._restoring_state(motions):
            view = (
                checked_camera(camera)
                or self._camera
                or self._camera_for_motion(
                    show_time, times if move is None else times[[0, -1]], width / height
                )
            )
            self._clear_traces()
            floor = self.scene.floor() if self._floor is None else self._floor
            with progress(f"Drawing {os.path.basename(os.fspath(path))}") as report:

                def pictures() -> Iterator[Array]:
                    for k, t in enumerate(times):
                        report(k, len(times))
                        show_time(float(t))
                        yield render(self.scene, width, height, view, samples, self._theme, floor)

                return write_video(path, pictures(), fps)

    def html(
        self,
        path: str | os.PathLike[str],
        motion: Playable = None,
        *,
        fps: float = 30.0,
        camera: Camera | None = None,
    ) -> FilePath:
        """Write the scene as one HTML file that plays offline, with a time line and a camera to move.

        Args:
            path: The file.
            motion: What moves, as for `film`; None for what was simulated, or a scene at rest.
            fps: Poses a second [1/s].
            camera: The first camera.

        Returns:
            The path of the file; as the last line of a cell, a notebook displays the page.

        Raises:
            MissingExtra: viser is not installed.
            InputError: It is not clear what to show, or the file cannot be written.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> arm = viewer.add(ulna.load("panda", visuals="simple"), "ready")
            >>> move = ulna.trajectory.quintic(arm.q, arm.q + 0.3, duration=0.2)
            >>> viewer.html("move.html", move).name  # one file, for any browser
            'move.html'
        """
        checked_html_path(path)
        times, show_time, motions = frame_times(0.0, fps), None, ()
        if motion is not None or self._simulated():
            motions, show_time, length = self._motion(motion, None, None)
            times = frame_times(length, fps)
        options: dict[str, Any] = {"title": self._title_of_files, "theme": self._theme, "floor": self._floor}
        view = checked_camera(camera) or self._camera
        with self._restoring_state(motions):
            if show_time is not None:
                view = view or self._camera_for_motion(show_time, times, _PAGE_ASPECT)
                self._clear_traces()
            return write_html(path, self.scene, times.tolist(), show_time, camera=view, **options)

    def _motion(
        self, motion: Playable, move: Callable[[float], None] | None, duration: float | None
    ) -> tuple[Sequence[HandleMotion], Callable[[float], None], float]:
        if (move is None) != (duration is None) or (move is not None and motion is not None):
            raise InputError("Pass either a motion, or `move` with a `duration` [s].")
        if move is not None and duration is not None:
            return (), checked_function("move", move), duration
        motions = self._motions(motion)
        timeline = Timeline(None, lambda: motions)

        def show_time(t: float) -> None:
            timeline.time = t

        return motions, show_time, timeline.duration

    def _camera_for_motion(self, show_time: Callable[[float], None], times: Array, aspect: float) -> Camera:
        """A camera that sees the scene at some of these times, the last and the first among them."""
        points = []
        for k in np.unique(np.linspace(0, len(times) - 1, _CAMERA_TIMES).round().astype(int))[::-1]:
            show_time(float(times[k]))
            points.append(self.scene.points())
        return camera_for(self.scene, aspect, also=np.concatenate(points))

    def _clear_traces(self) -> None:
        for robot in self.robots:
            robot.traces = [()] * len(robot.traces)

    @contextmanager
    def _restoring_state(self, motions: Sequence[HandleMotion]) -> Iterator[None]:
        """Afterwards robots, their paths, and what a motion moves are as before."""
        before = [(robot, robot.q, robot.traces) for robot in self.robots]
        poses = [(m.handle, m.handle.pose) for m in motions if not isinstance(m.handle, RobotHandle)]
        try:
            yield
        finally:
            for robot, q, traces in before:
                robot.display(q)
                robot.traces = traces
            for handle, pose in poses:
                handle.pose = pose

    def _motions(self, played: Playable) -> Sequence[HandleMotion]:
        if played is not None:
            return handle_motions(played, self.robots)
        motions = self._simulated()
        if not motions:
            raise InputError("Nothing was simulated here; pass a trajectory or a recording.")
        return motions


def checked_floor(floor: float | None) -> float | None:
    """The height of a floor [m], or None.

    Raises:
        InputError: It is no finite number.
    """
    return (
        None if floor is None else number("floor", floor, "a height [m]", least=-MAX_LENGTH, most=MAX_LENGTH)
    )
