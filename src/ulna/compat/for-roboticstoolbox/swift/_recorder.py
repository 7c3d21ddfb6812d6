"""A film of the environment: what is where is noted at each step, and drawn when the recording is stopped."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from ulna.checks.values import number, one_of, short_repr
from ulna.errors import InputError

FORMATS = {"webm": ".mp4", "mp4": ".mp4", "gif": ".gif", "png": ""}
"""What is written for each format that can be asked for: a film, or a folder of pictures."""


class Recorder:
    """A recording that goes on.

    Args:
        viewer: The `ulna.Viewer`.
        file: The file; the suffix is added.
        fps: Pictures a second.
        format: "webm" or "mp4" (an MP4 either way), "gif", or "png" for a folder of pictures.

    Raises:
        InputError: There is no such rate.
        NotImplementedError: There is no such format.
        UnknownName: It is no format at all.
    """

    def __init__(self, viewer: Any, file: str, fps: float, format: str) -> None:
        if isinstance(format, str) and format == "jpg":
            raise NotImplementedError("Pictures are written as PNG files: format='png'.")
        one_of("format of recordings", format, FORMATS)
        rate = number("framerate", fps, "pictures a second, above 0 and up to 240", above=0.0, most=240.0)
        if not isinstance(file, str | os.PathLike):
            raise InputError(f"`file_name` is {short_repr(file)}; expected the path of a file.")
        suffix, path = FORMATS[format], Path(file)
        self.path = path if path.suffix == suffix else path.with_name(path.name + suffix)
        self._viewer, self._fps = viewer, rate
        self._times: list[float] = []
        self._rows: list[tuple[dict[Any, Any], dict[str, Any]]] = []

    def record_row(self, t: float, figures: list[Any], names: list[str]) -> None:
        """Records where robots and shapes are.

        Args:
            t: Time [s].
            figures: Handles of the robots.
            names: Names of the other nodes.
        """
        scene = self._viewer.scene
        poses = {name: scene.pose(name) for name in names}
        poses |= {figure.name: scene.pose(figure.name) for figure in figures}
        self._times.append(t)
        self._rows.append(({figure: figure.q for figure in figures}, poses))

    def write(self) -> Path:
        """Draw and write it."""
        from ulna.viewer.output.video import frame_times

        times = np.array(self._times) - self._times[0]
        if self.path.suffix:
            return self._viewer.film(
                self.path,
                move=lambda t: self._synchronize(times, t),
                duration=float(times[-1]),
                fps=self._fps,
            )
        self.path.mkdir(parents=True, exist_ok=True)
        for k, t in enumerate(frame_times(float(times[-1]), self._fps)):
            self._synchronize(times, float(t))
            self._viewer.picture(self.path / f"{k:05d}.png", 960, 600)
        self._synchronize(times, float(times[-1]))
        return self.path

    def _synchronize(self, times: Any, t: float) -> None:
        """Show what was at a time since the recording began."""
        k = int(np.searchsorted(times, t + 1e-9, side="right")) - 1
        configurations, poses = self._rows[max(k, 0)]
        scene = self._viewer.scene
        with scene.atomic():
            for figure, q in configurations.items():
                if figure.name in scene:
                    figure.display(q)
            for name, pose in poses.items():
                if name in scene:
                    scene.set_pose(name, pose)
