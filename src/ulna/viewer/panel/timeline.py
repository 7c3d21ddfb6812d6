"""The time line: recordings are played at a chosen speed and scrubbed; a running simulation is paused."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import number
from ulna.sim import Simulation
from ulna.viewer.page import Page
from ulna.viewer.panel import Panel
from ulna.viewer.panel.controls import Folder
from ulna.viewer.robot.handle_motion import HandleMotion

SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5")
_UPDATE_INTERVAL = 1 / 15  # s between two updates of the panel
SPEED_EXPECTED = "seconds of what happened per second, above zero"
_FRAME_RATE, _MOST_FRAMES = 60.0, 6000  # of what is shown without waiting [1/s], [-]
_IDLE_TIME = 0.5  # s without a step after which a simulation is not running


@final
class Timeline(FixedAttributes):
    """Controls of time: play and pause, speed, a slider to scrub.

    Args:
        page: The page, or None to do without controls.
        motions: Returns what is moved; called each time, so that robots can be added later.
        simulation: What is recording, if it is one: as long as it steps the newest is shown.
        speed: Seconds of what happened per second [-].
    """

    def __init__(
        self,
        page: Page | None,
        motions: Callable[[], Sequence[HandleMotion]],
        simulation: Simulation | None = None,
        speed: float = 1.0,
    ) -> None:
        self._motions, self._simulation = motions, simulation
        self._speed, self._playing, self._t = number("speed", speed, SPEED_EXPECTED, above=0.0), False, 0.0
        self._steps, self._last_step, self._updated_at, self._last_tick = -1, -np.inf, 0.0, time.monotonic()
        self._page, self._folder = page, None
        if page is not None:
            self._folder = self._build(page)

    @property
    def simulation(self) -> Simulation | None:
        """What is recording; None for a motion that is complete."""
        return self._simulation

    @property
    def duration(self) -> float:
        """The last time of its motions [s]."""
        return max((motion.end() for motion in self._motions()), default=0.0)

    @property
    def time(self) -> float:
        """The time that is shown [s]; setting it shows that time."""
        return self._t

    @time.setter
    def time(self, t: float) -> None:
        self._t = float(np.clip(number("time", t, "a time [s]"), 0.0, self.duration))
        for motion in self._motions():
            motion.show(self._t)

    @property
    def playing(self) -> bool:
        """Whether the time is running."""
        return self._playing

    def play(self, speed: float | None = None) -> None:
        """Run the time, from the beginning when it is at its end; resume a paused simulation."""
        self._speed = self._speed if speed is None else number("speed", speed, SPEED_EXPECTED, above=0.0)
        if self._simulation is not None and self._simulation.paused:
            self._simulation.paused = False
            return
        if self._t >= self.duration:
            self._t = 0.0
        self._playing = True

    def pause(self) -> None:
        """Stop the time; pause a running simulation."""
        self._playing = False
        if self._simulation is not None and self._running():
            self._simulation.paused = True

    def play_out(self, shown: Callable[[float], object]) -> None:
        """Show what is left of a motion that is being played, without waiting; of a simulation nothing is left.

        Args:
            shown: Called after each frame with the time [s] since the one before.
        """
        if not self._playing or self._simulation is not None:
            return
        self._playing, length = False, self.duration
        frames = int(min(_FRAME_RATE * length, _MOST_FRAMES)) + 1
        for t in np.linspace(0.0, length, frames + 1).tolist():
            if t > self._t:
                passed, self.time = t - self._t, t
                shown(passed)

    def __repr__(self) -> str:
        state = "running" if self._playing else "at rest"
        return f"<time line at {self._t:.2f} s of {self.duration:.2f} s, {state}>"

    def remove(self) -> None:
        """Stop the time, and take the controls out of the panel."""
        self._playing = False
        if self._page is not None and self._folder is not None:
            self._page.remove_tick(self._tick)
            self._slider.remove()
            self._folder.remove()
            self._folder = None

    def _build(self, page: Page) -> Folder:
        panel = Panel(page)
        gui = page.server.gui
        with panel.folder("Time") as folder:
            self._clock = panel.text("")
            start = str(self._speed if self._speed % 1 else int(self._speed))
            panel.select("speed", SPEEDS, start if start in SPEEDS else "1", self._set_speed)
            panel.button("Play / pause", self._toggle)
            handle = gui.add_slider("time [s]", min=0.0, max=1e-3, step=1e-3, initial_value=0.0)
        self._slider = handle

        async def scrubbed(event: Any) -> None:
            if event.client is not None:
                page.post_event(id(handle), self._scrub, handle.value)

        handle.on_update(scrubbed)
        page.add_tick(self._tick)
        return folder

    def _set_speed(self, speed: str) -> None:
        self._speed = float(speed)
        if self._simulation is not None:
            self._simulation.speed = self._speed

    def _toggle(self) -> None:
        busy = self._playing or (
            self._running() and self._simulation is not None and not self._simulation.paused
        )
        self.pause() if busy else self.play()

    def _scrub(self, t: float) -> None:
        self.pause()
        self.time = t

    def _running(self) -> bool:
        sim, now = self._simulation, time.monotonic()
        if sim is None:
            return False
        if sim.steps != self._steps or sim.waiting:
            self._steps, self._last_step = sim.steps, now
        return now - self._last_step < _IDLE_TIME

    def _tick(self) -> None:
        now = time.monotonic()
        passed, self._last_tick = now - self._last_tick, now
        sim = self._simulation
        if self._running() and sim is not None and not sim.paused:
            self._playing, self._t = False, sim.t
        elif self._playing:
            self.time = self._t + passed * self._speed
            self._playing = self._t < self.duration
        if now - self._updated_at > _UPDATE_INTERVAL:
            self._updated_at = now
            self._update_panel()

    def _update_panel(self) -> None:
        end = max(round(self.duration, 3), 1e-3)
        if self._slider.max != end:
            self._slider.max = end
        shown = round(min(self._t, end), 3)
        if self._slider.value != shown:
            self._slider.value = shown
        state = "running" if self._playing or (self._running() and not self._paused) else "at rest"
        content = f"**{self._t:.2f} s** of {end:.2f} s, {state}"
        if self._clock.value != content:
            self._clock.value = content

    @property
    def _paused(self) -> bool:
        return self._simulation is not None and self._simulation.paused
