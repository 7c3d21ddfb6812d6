"""The environment: robots and shapes that are stepped, a page to look at them, controls to steer them by."""

from __future__ import annotations

import contextlib
import math
import time
from typing import Any

import numpy as np

from swift._controls import not_open_error
from swift._environment_contents import Contents
from swift._recorder import Recorder
from ulna.checks.arrays import finite_array
from ulna.checks.values import number
from ulna.errors import InputError
from ulna.viewer.graph.camera import Camera
from ulna.viewer.page.browser import somebody_can_look


class StepError(InputError, TypeError):
    """A time step that is no number (a TypeError in Swift), or below zero."""


def _checked_step(dt: Any) -> float:
    """A time step, as a number of at least zero [s]."""
    try:
        return number("dt", dt, "a time of at least zero [s]", least=0.0)
    except InputError as error:
        raise StepError(str(error)) from None


class Swift(Contents):
    """An environment of robots and shapes.

    `launch` it, `add` things, `step` it. Without a screen everything works the same, and nothing waits.
    """

    def step(self, dt: float = 0.05, render: bool = True) -> None:
        """Move everything on, handle what was done in the panel, and show it; never waits for the page.

        Args:
            dt: By how much [s]; 0 to show only.
            render: Whether it is to be shown; it costs nothing.

        Raises:
            StepError: `dt` is no number, or below zero.
            ViewerError: The environment was not launched.
        """
        viewer, controls = self._viewer, self._controls
        if viewer is None:
            raise not_open_error()
        simulation = self._simulation
        if dt.__class__ is not float or not 0.0 <= dt < math.inf:
            dt = _checked_step(dt)
        if controls.events:
            controls.handle()
        items = self._in_order
        if dt > 0.0:
            t, values = simulation.t + dt, controls.values
            for item in items:
                item.advance(t, dt, values)
        if len(items) == 1:  # which shows itself at once
            items[0].show()
        else:
            with viewer.scene.atomic():
                for item in items:
                    item.show()
        if dt > 0.0:
            simulation.step(dt)
        if self._recorder is not None:
            self._record()

    def run(self, duration: float | None = None, dt: float = 0.05, timeout: float | None = None) -> None:
        """Steps for some time, or until the page is closed; returns at once where there is no page to close.

        Args:
            duration: Simulated time [s]; None for until the page is closed.
            dt: Length of a step [s].
            timeout: How long the page may have no browser before it counts as closed [s]; 3 by default.
        """
        if duration is None and not self._watched():
            self._print_once("so it does not run without an end; give it a duration.")
            return
        end, was_watched, unwatched_for = (
            self.sim_time + (np.inf if duration is None else duration),
            False,
            0.0,
        )
        while self.sim_time < end - 1e-9 and not (duration is None and self.viewer.closed):
            started = time.monotonic()
            self.step(min(dt, end - self.sim_time))
            if duration is None and not self._simulation.realtime:
                time.sleep(dt)
            was_watched = was_watched or bool(self.viewer.clients)
            unwatched_for = (
                0.0 if self.viewer.clients or not was_watched else unwatched_for + time.monotonic() - started
            )
            if unwatched_for > (3.0 if timeout is None else timeout):
                return

    def hold(self, duration: float | None = None, timeout: float | None = None) -> None:
        """Keeps the page open until it is closed, Ctrl-C, or for some time.

        It returns at once without a screen.

        Args:
            duration: How long [s]; None for until it is closed.
            timeout: Accepted and ignored [s].
        """
        viewer = self.viewer
        self.process_events()
        if not self._watched():
            self._print_once("so it is not held open.")
            return
        with self._controls.handling_immediately():
            if duration is None:
                viewer.hold()
                return
            end = time.monotonic() + duration
            with contextlib.suppress(KeyboardInterrupt):
                while time.monotonic() < end and not viewer.closed:
                    time.sleep(0.05)

    def _watched(self) -> bool:
        viewer = self.viewer
        return not viewer.closed and (viewer.clients > 0 or somebody_can_look())

    def _print_once(self, what: str) -> None:
        if not self._printed:
            page = "It was closed" if not self.headless and self.viewer.closed else "There is no screen"
            print(f"Swift: {page}, {what}", flush=True)
        self._printed = True

    def process_events(self, events: dict[Any, Any] | None = None) -> None:
        """Handle what was done in the panel, or `events`: what was chosen, by the number of the control."""
        self._controls.handle(events)

    def set_camera_pose(self, position: Any, look_at: Any) -> None:
        """Moves the camera.

        Args:
            position: Where it is, (3,) [m].
            look_at: Where it looks, (3,) [m].
        """
        at, to = (
            np.reshape(finite_array(n, p), -1) for n, p in (("position", position), ("look_at", look_at))
        )
        self.viewer.camera = Camera(tuple(at), tuple(to))  # type: ignore[arg-type]

    def set_lights(self, lights: Any) -> None:
        """Not offered: the lights are those of the viewer's theme."""
        raise NotImplementedError(
            "Lights are not set one by one; see `env.viewer.theme`: 'light', 'dark' or a Theme."
        )

    def screenshot(self, file_name: str = "swift_snap") -> None:
        """Write a picture: a PNG file of that name, drawn without the browser."""
        self.viewer.picture(file_name if file_name.lower().endswith(".png") else f"{file_name}.png")

    def start_recording(self, file_name: str, framerate: float, format: str = "webm") -> None:
        """Begin a film, which `stop_recording` writes, at its true speed.

        Args:
            file_name: The file; its suffix is added.
            framerate: Pictures a second [1/s].
            format: "webm" or "mp4" for an MP4 film, "gif", or "png" for a folder of pictures.

        Raises:
            InputError: A recording is running already.
        """
        if self._recorder is not None:
            raise InputError("A recording is running already; call env.stop_recording() first.")
        self._recorder = Recorder(self.viewer, file_name, framerate, format)
        self._record()

    def stop_recording(self) -> None:
        """End the film and write it.

        Raises:
            InputError: No recording is running.
        """
        if self._recorder is None:
            raise InputError("No recording is running; call env.start_recording(file_name, framerate) first.")
        recorder, self._recorder = self._recorder, None
        print(f"Swift: wrote {recorder.write()}", flush=True)

    def _record(self) -> None:
        assert self._recorder is not None
        items = self._items.values()
        figures = [figure for item in items for figure in item.figures]
        drawn = [name for item in items for name in item.drawn]
        self._recorder.record_row(self.sim_time, figures, drawn)

    def __repr__(self) -> str:
        if self._viewer is None:
            return "<Swift, not launched>"
        return f"<Swift of {len(self._items)} objects at {self.sim_time:g} s>"
