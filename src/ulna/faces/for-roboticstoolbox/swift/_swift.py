"""The environment: robots and shapes that are stepped, a page to look at them, controls to steer them by."""

from __future__ import annotations

import contextlib
import os
import time
import warnings
import webbrowser
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from swift._controls import Controls
from swift._elements import SwiftElement
from swift._handles import AssemblyHandle, Callback, Item, PartsHandle, RobotHandle, ShapeHandle
from swift._recorder import Recorder
from ulna.errors import InputError, UlnaWarning, UnknownName, ViewerError
from ulna.sim import Simulation
from ulna.viewer.camera import Camera
from ulna.viewer.screen import open_browser, somebody_can_look
from ulna.viewer.viewer import Viewer

_PATIENCE = 10.0  # s that `launch` waits for a browser that it opened
_OLDER = ("comms",)  # arguments of Swift 1 that mean nothing here


class Swift:
    """An environment of robots and shapes.

    `launch` it, `add` things, `step` it. Where nobody can look everything works the same, and nothing waits.
    """

    def __init__(self, _dev: bool = False) -> None:
        self._viewer: Viewer | None = None
        self._items: dict[int, Item] = {}
        self._controls = Controls(None)
        self._recorder: Recorder | None = None
        self._said = False

    # the page -------------------------------------------------------------------------------------------------

    def launch(
        self,
        realtime: bool | float = False,
        headless: bool | None = None,
        rate: float = 60,
        browser: str | None = None,
        notebook: bool = False,
        axes: bool = True,
        ground_opacity: float = 1.0,
        ground_pattern: bool | str = False,
        ground_pattern_width: float = 1.0,
        lights: Any = None,
        timeout: float | None = 1,
        browser_timeout: float | None = 5,
        **kwargs: Any,
    ) -> None:
        """Open the environment: a page in the browser, where somebody can look.

        Args:
            realtime: Whether steps wait for their time; a number for that many simulated seconds a second. Where
                nobody can look they wait only if `headless` was asked for as well.
            headless: True for no page, False for one in any case; None for one where there is a screen or somebody at
                the terminal. SWIFT_HEADLESS or ULNA_HEADLESS in the environment says True.
            rate: How often the page is drawn [1/s]; it is 60 times a second at most whatever is said.
            browser: The name of the browser, as the module `webbrowser` has it; the usual one when not given.
            notebook: Whether to show the page in the cell of a notebook.
            axes: Whether to show the world's axes.
            ground_opacity: The floor is always opaque.
            ground_pattern: The floor always has its grid.
            ground_pattern_width: See `ground_pattern`.
            lights: The lamps are those of the viewer's theme.
            timeout: How long the page may be closed before `hold` ends is up to the viewer: 3 s, as a reload takes.
            browser_timeout: A page whose script has ended says so, and stays open.
            kwargs: `comms` of Swift 1, which means nothing here.

        Raises:
            MissingExtra: There is to be a page, and viser is not installed.
            TypeError: There is no such argument.
        """
        strange = [name for name in kwargs if name not in _OLDER]
        if strange:
            raise TypeError(f"Swift.launch has no argument {strange[0]!r}.")
        if lights is not None or ground_opacity != 1.0 or ground_pattern or ground_pattern_width != 1.0:
            warnings.warn(
                "Swift.launch: the floor and the lamps are those of the viewer; `lights` and `ground_...` are not "
                "used. See `env.viewer.theme` and `env.viewer.floor`.",
                UlnaWarning,
                stacklevel=2,
            )
        if self._viewer is not None:
            self.close()
        told = _told_headless() if headless is None else bool(headless)
        page = not told and (headless is False or notebook or somebody_can_look())
        speed = 1.0 if isinstance(realtime, bool) else float(realtime)
        self.headless, self.rate = not page, rate
        self._start(page, 8080, bool(realtime) and (page or headless is True), speed or 1.0, axes)
        if notebook:
            self._in_notebook()
        elif page and _open(self.viewer.url, browser):
            self._await_tab()
        elif page:
            print(f"Swift: the page is at {self.viewer.url}", flush=True)

    def _start(self, page: bool, port: int, realtime: bool, speed: float, axes: bool) -> None:
        self._viewer = Viewer(port, page=page, browser=False, title="Swift")
        # with a page, the viewer records what happens, for its time line; robots are moved here
        self._simulation = (
            self._viewer.simulate(realtime, speed, control="position")
            if page
            else Simulation(realtime, speed)
        )
        self._items, self._controls, self._number = {}, Controls(self._viewer.panel), 0
        self._axes = axes
        if axes:
            self._viewer.axes(0.3, name="world axes")

    def _in_notebook(self) -> None:
        from IPython.display import display  # pyright: ignore[reportMissingImports]

        display(self.viewer)

    def _await_tab(self) -> None:
        """Wait until the browser that was opened shows the page, so that nothing is missed; not for ever."""
        due = time.monotonic() + _PATIENCE
        while not self.viewer.clients and time.monotonic() < due:
            time.sleep(0.05)
        if not self.viewer.clients:
            print(f"The browser has not opened the page yet: {self.viewer.url}", flush=True)

    @property
    def viewer(self) -> Viewer:
        """The `ulna.Viewer` behind it: theme, camera, pictures, films, panels.

        Raises:
            ViewerError: It was not launched.
        """
        if self._viewer is None:
            raise _closed()
        return self._viewer

    @property
    def sim_time(self) -> float:
        """The simulated time [s]."""
        return 0.0 if self._viewer is None else self._simulation.t

    def close(self, clear_cell: bool = False) -> None:
        """Close the page, and the environment with it."""
        if self._viewer is not None:
            self._viewer.close()
        self._viewer = None

    def reset(self) -> None:
        """Begin anew: an empty environment at time zero. A tab that looks at the page finds it again."""
        old, sim = self.viewer, self._simulation
        port = 8080 if old.closed else int(old.url.rsplit(":", 1)[1])
        page = not (self.headless or old.closed)
        self.close()
        self._start(page, port, sim.realtime, sim.speed, self._axes)

    restart = reset

    # what is in it --------------------------------------------------------------------------------------------

    def add(
        self,
        ob: Any,
        robot_alpha: float = 1.0,
        collision_alpha: float = 0.0,
        readonly: bool = False,
        name: str | None = None,
    ) -> Any:
        """Add a robot, a shape or a control.

        Args:
            ob: What to add.
            robot_alpha: How opaque a robot is, from 0 to 1.
            collision_alpha: How opaque what it collides with is.
            readonly: Whether a robot is shown only, never moved.
            name: A name, for `env[name]`, and of a control for `env.values[name]`.

        Returns:
            A handle of a robot, the number of a shape, the control itself.

        Raises:
            InputError: It is nothing that can be added, or a control that is there already.
            ViewerError: The environment was not launched.
        """
        if isinstance(ob, SwiftElement):
            return self.add_ui(ob, name)
        if hasattr(ob, "ulna") or hasattr(ob, "_everything"):
            return self.add_robot(ob, robot_alpha, collision_alpha, readonly, name=name)
        if hasattr(ob, "draw") and hasattr(ob, "_wT"):
            return self.add_shape(ob, name=name)
        raise InputError(
            f"Cannot add {ob!r}; expected a robot of roboticstoolbox, a shape of spatialgeometry, or a control such as "
            "swift.Slider."
        )

    def add_robot(
        self,
        robot: Any,
        robot_alpha: float = 1.0,
        collision_alpha: float = 0.0,
        readonly: bool = False,
        callback: Callback | None = None,
        name: str | None = None,
    ) -> AssemblyHandle:
        """Add a robot.

        Its state is `robot.q` and `robot.qd`, and the handle's `q` and `qd` are the same ones: assign to whichever you
        like, before or after. A robot that is added a second time gets a handle with a state of its own.

        Args:
            robot: The robot.
            robot_alpha: How opaque it is, from 0 to 1.
            collision_alpha: How opaque what it collides with is.
            readonly: Whether it is shown only, never moved.
            callback: Called before each step with the time and the values of named controls; gives the new `q`.
            name: A name, for `env[name]`.

        Raises:
            InputError: An opacity is out of range.
        """
        for what, alpha in (("robot_alpha", robot_alpha), ("collision_alpha", collision_alpha)):
            if not 0.0 <= alpha <= 1.0:
                raise InputError(f"`{what}` is {alpha}; expected a number from 0 to 1.")
        own = any(item.thing is robot for item in self._items.values())
        alphas = float(robot_alpha), float(collision_alpha)
        more = self._more(name, callback)
        return self._keep(RobotHandle(self.viewer, robot, alphas, readonly, own, **more))

    def add_assembly(
        self,
        fk: Callable[[Any], Sequence[Any]],
        parts: Sequence[Any],
        q0: Any = None,
        callback: Callback | None = None,
        readonly: bool = False,
        name: str | None = None,
    ) -> AssemblyHandle:
        """Add shapes that a function of joint coordinates places.

        Args:
            fk: Gives the world pose of each part at `q`.
            parts: The shapes.
            q0: The joint coordinates at first.
            callback: As for `add_robot`.
            readonly: Whether it is shown only, never moved.
            name: A name, for `env[name]`.
        """
        return self._keep(PartsHandle(self.viewer, fk, parts, q0, readonly, **self._more(name, callback)))

    def add_shape(self, shape: Any, callback: Callback | None = None, name: str | None = None) -> int:
        """Add a shape; gives its number. One that is there already keeps its number.

        Args:
            shape: The shape.
            callback: Called before each step with the time and the values of named controls; gives the new pose.
            name: A name, for `env[name]`.
        """
        for item in self._items.values():
            if item.thing is shape:
                return item.id
        return self._keep(ShapeHandle(self.viewer, shape, **self._more(name, callback))).id

    def add_ui(self, element: SwiftElement, name: str | None = None) -> SwiftElement:
        """Add a control to the panel.

        Raises:
            InputError: It is there already.
            ViewerError: The environment was not launched.
        """
        if self._viewer is None:
            raise _closed()
        self._controls.add(element, name)
        return element

    def _more(self, name: str | None, callback: Callback | None) -> dict[str, Any]:
        if name is not None and any(item.name == name for item in self._items.values()):
            raise InputError(f"There is something named {name!r} already.")
        return {"id": self._number, "name": name, "callback": callback}

    def _keep(self, item: Any) -> Any:
        self._items[item.id] = item
        self._number += 1
        return item

    def remove(self, id: Any) -> None:
        """Take a robot or a shape out, given as its handle, its number or itself.

        Raises:
            UnknownName: It is not there.
            NotImplementedError: It is a control.
        """
        if isinstance(id, SwiftElement):
            raise NotImplementedError("Controls stay in the panel. Put it in order with env.reset().")
        found = [
            i for i in self._items.values() if i is id or i.thing is id or (i.id == id and _is_number(id))
        ]
        if not found:
            raise UnknownName("thing in the environment", id, (str(i) for i in self._items))
        for item in found:
            bodies = (
                [f.body for f in item.figures if f.body is not None] if isinstance(item, RobotHandle) else []
            )
            item.remove()
            for body in bodies:
                self._simulation.remove(body)
            del self._items[item.id]

    def __getitem__(self, key: str | int) -> Any:
        """The handle of a robot or the shape of that name or number."""
        for item in self._items.values():
            if item.name == key if isinstance(key, str) else item.id == key:
                return item.thing if isinstance(item, ShapeHandle) else item
        names = [i.name for i in self._items.values() if i.name]
        raise UnknownName("thing in the environment", key, names or (str(i) for i in self._items))

    @property
    def values(self) -> dict[str, Any]:
        """The values of named controls."""
        return self._controls.values

    @property
    def elements(self) -> dict[int, SwiftElement]:
        """The controls in the panel, by their number."""
        return self._controls.elements

    def show(self) -> None:
        """Print what there is."""
        print(f"Swift over Ulna, t = {self.sim_time:g} s{f', {self.viewer.url}' if self.viewer.url else ''}")
        for item in self._items.values():
            thing = item if isinstance(item, AssemblyHandle) else item.thing
            print(f"  [{item.id}] {thing!r}" + (f" {item.name!r}" if item.name else ""))
        for number, element in self.elements.items():
            print(f"  control {number}: {type(element).__name__} {element.label!r}")

    # time -----------------------------------------------------------------------------------------------------

    def step(self, dt: float = 0.05, render: bool = True) -> None:
        """Move everything on, handle what was done in the panel, and show it; never waits for the page.

        Args:
            dt: By how much [s]; 0 to show only.
            render: Whether it is to be shown; it costs nothing.

        Raises:
            InputError: `dt` is below zero.
            ViewerError: The environment was not launched.
        """
        viewer = self.viewer
        if not (np.isfinite(dt) and dt >= 0.0):
            raise InputError(f"`dt` is {dt}; expected a time of at least zero [s].")
        self._controls.handle()
        items, simulation = self._items.values(), self._simulation
        t = simulation.t + dt
        with viewer.scene.together():
            if dt > 0.0:
                values = self._controls.values
                for item in items:
                    item.tell(t, dt, values)
            for item in items:
                item.show()
        if dt > 0.0:
            simulation.step(dt)
        if self._recorder is not None:
            self._note()

    def run(self, duration: float | None = None, dt: float = 0.05, timeout: float | None = None) -> None:
        """Step for some time [s], or until the page is closed; at once to an end where there is none to close."""
        if duration is None and not self._watched():
            self._say("so it does not run without an end; give it a duration.")
            return
        end, seen, gone = self.sim_time + (np.inf if duration is None else duration), False, 0.0
        while self.sim_time < end - 1e-9 and not (duration is None and self.viewer.closed):
            began = time.monotonic()
            self.step(min(dt, end - self.sim_time))
            if duration is None and not self._simulation.realtime:
                time.sleep(dt)
            seen = seen or bool(self.viewer.clients)
            gone = 0.0 if self.viewer.clients or not seen else gone + time.monotonic() - began
            if gone > (3.0 if timeout is None else timeout):
                return

    def hold(self, duration: float | None = None, timeout: float | None = None) -> None:
        """Keep the page open until it is closed or Ctrl-C, or for some time [s]. Where nobody can look it returns."""
        viewer = self.viewer
        self.process_events()
        if not self._watched():
            self._say("so it is not held open.")
            return
        with self._controls.at_once():
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

    def _say(self, what: str) -> None:
        if not self._said:
            page = "It was closed" if not self.headless and self.viewer.closed else "Nobody can look here"
            print(f"Swift: {page}, {what}", flush=True)
        self._said = True

    def process_events(self, events: dict[Any, Any] | None = None) -> None:
        """Handle what was done in the panel, or `events`: what was chosen, by the number of the control."""
        self._controls.handle(events)

    # looking at it --------------------------------------------------------------------------------------------

    def set_camera_pose(self, position: Any, look_at: Any) -> None:
        """Look from a place at a place, (3,) each [m]."""
        at, to = (
            tuple(float(x) for x in np.asarray(p, dtype=float).reshape(-1)) for p in (position, look_at)
        )
        if len(at) != 3 or len(to) != 3 or at == to or not np.isfinite([*at, *to]).all():
            raise InputError(
                f"Cannot look from {position} at {look_at}; expected two places of three numbers [m]."
            )
        self.viewer.camera = Camera(at, to)  # type: ignore[arg-type]

    def set_lights(self, lights: Any) -> None:
        """Not offered: the lamps are those of the viewer's theme."""
        raise NotImplementedError(
            "Lamps are not set one by one; see `env.viewer.theme`: 'light', 'dark' or a Theme."
        )

    def screenshot(self, file_name: str = "swift_snap") -> None:
        """Write a picture: a PNG file of that name, drawn without the browser."""
        self.viewer.picture(file_name if file_name.lower().endswith(".png") else f"{file_name}.png")

    def start_recording(self, file_name: str, framerate: float, format: str = "webm") -> None:
        """Begin a film, which `stop_recording` writes, at its true speed.

        Args:
            file_name: The file; its suffix is added.
            framerate: Pictures a second.
            format: "webm" or "mp4" for an MP4 film, "gif", or "png" for a folder of pictures.

        Raises:
            InputError: A recording goes on already.
        """
        if self._recorder is not None:
            raise InputError("A recording goes on already; call env.stop_recording() first.")
        self._recorder = Recorder(self.viewer, file_name, framerate, format)
        self._note()

    def stop_recording(self) -> None:
        """End the film and write it.

        Raises:
            InputError: No recording goes on.
        """
        if self._recorder is None:
            raise InputError("No recording goes on; call env.start_recording(file_name, framerate) first.")
        recorder, self._recorder = self._recorder, None
        print(f"Swift: wrote {recorder.write()}", flush=True)

    def _note(self) -> None:
        assert self._recorder is not None
        items = self._items.values()
        figures = [f for item in items if isinstance(item, RobotHandle) for f in item.figures]
        drawn = [name for item in items for name in item.drawn]
        self._recorder.note(self.sim_time, figures, drawn)

    def __repr__(self) -> str:
        if self._viewer is None:
            return "<Swift, not launched>"
        return f"<Swift of {len(self._items)} things at {self.sim_time:g} s>"


def _closed() -> ViewerError:
    return ViewerError("The environment is not open. Call env.launch() first.")


def _told_headless() -> bool:
    return any(os.environ.get(name, "") not in ("", "0") for name in ("SWIFT_HEADLESS", "ULNA_HEADLESS"))


def _is_number(id: Any) -> bool:
    return isinstance(id, int | np.integer) and not isinstance(id, bool)


def _open(url: str, browser: str | None) -> bool:
    """Open a page in a browser, where there is a screen; whether that was done."""
    if browser is None or not somebody_can_look():
        return open_browser(url)
    try:
        return bool(webbrowser.get(browser).open(url))
    except webbrowser.Error:
        print(f"There is no browser named {browser!r} here; the usual one is taken.", flush=True)
        return open_browser(url)
