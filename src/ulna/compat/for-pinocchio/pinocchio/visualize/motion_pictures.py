"""What a visualizer plays and films, and the axes and arrows it draws at frames."""

from __future__ import annotations

import abc
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar

import numpy as np
from gepetto.corbaserver.reach import is_drawable

from pinocchio._algorithms.frame_motions import getFrameVelocity
from pinocchio._containers.enums import LOCAL_WORLD_ALIGNED
from pinocchio._model.model import Model
from ulna.viewer.mesh.primitives import axes
from ulna.viewer.page.browser import somebody_can_look


class MotionPictures(abc.ABC):
    """The part of a visualizer that is about time and frames."""

    model: Model
    data: Any
    _gui: Any
    _scene: Any
    _root: str
    _frames: list[int]
    _film: list[Any] | None

    @abc.abstractmethod
    def display(self, q: Any = None) -> None:
        """Shows configuration q, or the data's present placements without one."""

    def displayFrames(
        self,
        visibility: bool,
        frame_ids: Sequence[int] | None = None,
        axis_length: float = 0.2,
        axis_width: float = 2,
    ) -> None:
        """Shows or hides the axes of frames.

        Args:
            visibility: Whether to show them.
            frame_ids: Indices of the frames; all by default.
            axis_length: Length of an axis [m].
            axis_width: Thickness of the axes [-]; 2 is a twentieth of their length.
        """
        for frame in self._frames:
            self._gui.deleteNode(self._frame_node(frame))
        chosen = range(self.model.nframes) if frame_ids is None else frame_ids
        self._frames = [int(i) for i in chosen] if visibility else []
        for frame in self._frames:
            arrows = axes(axis_length, axis_length * axis_width / 80)
            self._scene.add(
                self._frame_node(frame), arrows, self._frame_pose(frame), shadow=False, through=True
            )

    def initializeFrames(
        self, frame_ids: Sequence[int] | None = None, axis_length: float = 0.2, axis_width: float = 2
    ) -> None:
        """Shows the axes of frames.

        Args:
            frame_ids: Indices of the frames; all by default.
            axis_length: Length of an axis [m].
            axis_width: Thickness of the axes [-]; 2 is a twentieth of their length.
        """
        self.displayFrames(True, frame_ids, axis_length, axis_width)

    def updateFrames(self) -> None:
        """Moves the axes to where the frames are in the data."""
        for frame in self._frames:
            node, pose = self._frame_node(frame), self._frame_pose(frame)
            if is_drawable(pose, node):
                self._scene.set_pose(node, pose)

    def _frame_node(self, frame: int) -> str:
        return f"{self._root}/frames/{frame} {self.model.frames[frame].name}".rstrip("/")

    def _frame_pose(self, frame: int) -> Any:
        record = self.model.frames[frame]
        return (self.data.oMi[record.parentJoint] * record.placement).homogeneous

    FRAME_VEL_COLOR: ClassVar[int] = 0x00FF00
    """The colour of arrows of velocities, as in `0xrrggbb`."""
    FORCE_SCALE: ClassVar[float] = 0.06
    """The length of arrows of forces for users [m/N]; the visualizers draw none themselves."""

    def drawFrameVelocities(self, frame_id: int, v_scale: float = 0.2, color: Any = FRAME_VEL_COLOR) -> None:
        """Draws an arrow along the velocity of a frame's origin, after forwardKinematics with v.

        Args:
            frame_id: Index of the frame.
            v_scale: Length for each m/s [s].
            color: `0xrrggbb`, or red, green, blue and opacity from 0 to 1; green by default.
        """
        v = getFrameVelocity(self.model, self.data, frame_id, LOCAL_WORLD_ALIGNED).linear
        start = self._frame_pose(frame_id)[:3, 3]
        name = f"{self._root}/velocities/{frame_id}"
        shade = f"#{color:06x}" if isinstance(color, int) else color
        self._gui.viewer.arrow(v_scale * v, start, name=name, color=shade)

    def play(
        self,
        q_trajectory: Any,
        dt: float | None = None,
        callback: Callable[..., None] | None = None,
        capture: bool = False,
        **named: Any,
    ) -> list[Any] | None:
        """Shows configurations one after the other, `dt` seconds each; without a screen, without waiting.

        Args:
            q_trajectory: Configurations, (N, nq) or a list; an array (nq, N) as of older scripts, too.
            dt: How long each stays [s].
            callback: Called as `callback(i, **named)` after each.
            capture: Whether to return pictures of all of them.
            **named: What the callback is given besides.

        Returns:
            The pictures, (h, w, 3) uint8 each; None without `capture`.
        """
        images: list[Any] = []
        wait = dt is not None and somebody_can_look() and not self._gui.viewer.closed
        for i, q in enumerate(_configurations(q_trajectory, self.model.nq)):
            start = time.perf_counter()
            self.display(q)
            if callback is not None:
                callback(i, **named)
            if capture or self._film is not None:
                images.append(self.captureImage())
            if wait and dt is not None:
                time.sleep(max(0.0, dt - (time.perf_counter() - start)))
        if self._film is not None:
            self._film += images
        return images if capture else None

    def sleep(self, dt: float) -> None:
        """Waits [s]."""
        time.sleep(dt)

    def has_video_writer(self) -> bool:
        """Whether what is played is being filmed."""
        return self._film is not None

    def captureImage(self, w: int | None = None, h: int | None = None) -> Any:
        """A picture of the scene, drawn without a browser.

        Args:
            w: Width [pixels]; 960 by default.
            h: Height [pixels]; 600 by default.

        Returns:
            Array (h, w, 3) uint8.
        """
        return self._gui.viewer.picture(None, w or 960, h or 600)

    @contextmanager
    def create_video_ctx(self, filename: str, fps: float = 30, **_: Any) -> Iterator[None]:
        """Writes the motions that are played inside the `with` statement to a video file.

        Args:
            filename: Name of the file, .mp4 or .gif.
            fps: Pictures a second [1/s].
            **_: Accepted and ignored.

        Yields:
            Nothing.
        """
        from ulna.viewer.output.video import checked_video_path, write_video

        checked_video_path(filename)
        self._film = []
        try:
            yield
            write_video(filename, iter(self._film), fps)
        finally:
            self._film = None


def _configurations(values: Any, nq: int) -> Any:
    """Configurations as rows; a matrix (nq, n), as of older scripts, is transposed."""
    if isinstance(values, np.ndarray) and values.ndim == 2 and values.shape[1] != nq == values.shape[0]:
        return values.T
    return values
