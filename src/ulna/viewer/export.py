"""Pictures, films and HTML files of a scene, drawn without a screen."""

from __future__ import annotations

import abc
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Any

from ulna.checks.values import MAX_LENGTH, number, short_repr, text
from ulna.checks.values import function as checked_function
from ulna.errors import InputError
from ulna.sim import Recording
from ulna.typing import Array
from ulna.viewer.graph.camera import Camera, camera_for, checked_camera
from ulna.viewer.graph.theme import Theme, theme_of
from ulna.viewer.output.png import checked_png_path
from ulna.viewer.output.video import checked_video_path, frame_times, write_video
from ulna.viewer.page.html_file import checked_html_path, write_html
from ulna.viewer.panel.timeline import RecordedMotion, Timeline
from ulna.viewer.progress import progress
from ulna.viewer.render.renderer import check_size, render, write_png
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.scene.objects import SceneMethods

RecordedMotions = Recording | Mapping[RobotHandle, Recording] | None


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
        self.title, self._theme = text("title", title), theme_of(theme)
        self._camera, self._floor = checked_camera(camera), checked_floor(floor)

    @abc.abstractmethod
    def _simulated(self) -> Sequence[RecordedMotion]:
        """The robots that a simulation moves, and functions that return their recordings."""

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
        """
        check_size(width, height, samples)
        target = None if path is None else checked_png_path(path)
        view = checked_camera(camera) or self._camera or camera_for(self.scene, width / height)
        image = render(self.scene, width, height, view, samples, self._theme, self._floor)
        if target is not None:
            write_png(target, image)
        return image

    def film(
        self,
        path: str | os.PathLike[str],
        recorded: RecordedMotions = None,
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
            fps: Pictures a second [1/s].
            speed: Seconds of what happened per second of film [-].
            width: Width [pixels].
            height: Height [pixels].
            camera: The camera; a fixed one that shows the first and the last frame when not given.
            samples: Samples along each edge of a pixel.
            move: Brings the scene to a time [s], called before each picture; instead of `recorded`, with
                `duration`.
            duration: How long it is that `move` shows [s].

        Returns:
            The path of the file.

        Raises:
            UnknownName: It ends neither in .mp4 nor in .gif.
            MissingExtra: imageio-ffmpeg or Pillow is not installed.
            InputError: It is not clear what to show, or the file cannot be written.
        """
        checked_video_path(path)
        check_size(width, height, samples)
        show_time, length = self._motion(recorded, move, duration)
        times = frame_times(length, fps, speed)
        with self._restoring_configurations():
            view = (
                checked_camera(camera)
                or self._camera
                or self._camera_for_motion(show_time, times, width / height)
            )
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
        recorded: RecordedMotions = None,
        *,
        fps: float = 30.0,
        camera: Camera | None = None,
    ) -> FilePath:
        """Write the scene as one HTML file that plays offline, with a time line and a camera to move.

        Args:
            path: The file.
            recorded: What moves, as for `film`; None for the simulation's recordings, or a scene at rest.
            fps: Poses a second [1/s].
            camera: The first camera.

        Returns:
            The path of the file.

        Raises:
            MissingExtra: viser is not installed.
            InputError: It is not clear what to show, or the file cannot be written.
        """
        checked_html_path(path)
        times, show_time = frame_times(0.0, fps), None
        if recorded is not None or self._simulated():
            show_time, length = self._motion(recorded, None, None)
            times = frame_times(length, fps)
        options: dict[str, Any] = {"title": self.title, "theme": self._theme, "floor": self._floor}
        with self._restoring_configurations():
            return write_html(
                path,
                self.scene,
                times.tolist(),
                show_time,
                camera=checked_camera(camera) or self._camera,
                **options,
            )

    def _motion(
        self, recorded: RecordedMotions, move: Callable[[float], None] | None, duration: float | None
    ) -> tuple[Callable[[float], None], float]:
        if (move is None) != (duration is None) or (move is not None and recorded is not None):
            raise InputError("Pass either a recording, or `move` with a `duration` [s].")
        if move is not None and duration is not None:
            return checked_function("move", move), duration
        motions = self._motions(recorded)
        timeline = Timeline(None, lambda: motions)

        def show_time(t: float) -> None:
            timeline.time = t

        return show_time, timeline.duration

    def _camera_for_motion(self, show_time: Callable[[float], None], times: Array, aspect: float) -> Camera:
        show_time(float(times[-1]))
        last = self.scene.points()
        show_time(float(times[0]))
        return camera_for(self.scene, aspect, also=last)

    @contextmanager
    def _restoring_configurations(self) -> Iterator[None]:
        """Robots stand afterwards where they stood before."""
        before = [(robot, robot.q) for robot in self.robots]
        try:
            yield
        finally:
            for robot, q in before:
                robot.display(q)

    def _motions(self, recorded: RecordedMotions) -> Sequence[RecordedMotion]:
        if recorded is None:
            motions = self._simulated()
            if not motions:
                raise InputError("Nothing was simulated here; pass a recording.")
            return motions
        if isinstance(recorded, Recording):
            if len(self.robots) != 1:
                raise InputError(
                    f"There are {len(self.robots)} robots here; expected {{handle: recording}}, so that each is named."
                )
            return [(self.robots[0], lambda: recorded)]
        if not isinstance(recorded, Mapping):
            raise InputError(
                f"Cannot play {short_repr(recorded)}; expected a recording, or {{handle: recording}}."
            )
        for robot, recording in recorded.items():
            if not isinstance(robot, RobotHandle) or not isinstance(recording, Recording):
                raise InputError(
                    f"Cannot play {{{short_repr(robot)}: {short_repr(recording)}}}; expected {{handle: recording}}."
                )
        if not recorded:
            raise InputError("Cannot play {}; expected a recording, or {handle: recording}.")
        return [(robot, lambda r=r: r) for robot, r in recorded.items()]


def checked_floor(floor: float | None) -> float | None:
    """The height of a floor [m], or None.

    Raises:
        InputError: It is no finite number.
    """
    return (
        None if floor is None else number("floor", floor, "a height [m]", least=-MAX_LENGTH, most=MAX_LENGTH)
    )
