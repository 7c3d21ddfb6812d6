"""The page of an environment: opened where there is a viewer of it, closed, reset."""

from __future__ import annotations

import os
import time
import warnings
from typing import Any

from swift._controls import Controls, not_open_error
from swift._recorder import Recorder
from swift._scene_items import Item
from ulna.errors import UlnaWarning
from ulna.sim import Simulation
from ulna.viewer.page.browser import somebody_can_look
from ulna.viewer.viewer import Viewer

_BROWSER_TIMEOUT = 10.0  # s that `launch` waits for a browser that it opened
_OLDER = ("comms",)  # arguments of Swift 1 that mean nothing here
_SEE_THEME = "See `env.viewer.theme` and `env.viewer.floor`."
_NOT_USED = (
    "Swift.launch: the floor and the lights are those of the viewer; `lights` and `ground_...` are not used. "
    + _SEE_THEME
)
_ALTERNATIVES = {
    "realtime_speed": "It is an argument of `env.launch(realtime=2.0)`, and in the page's panel.",
    "swift_objects": "Take `env[number]` or `env[name]`; `env.show()` lists what there is.",
    "swift_names": "Take `env[name]`; `env.show()` lists what there is.",
    "elementid": "`env.elements` has the controls by their number.",
    "rendering": "Steps never wait for the page.",
    "recording": "A film begins with `env.start_recording` and ends with `env.stop_recording`.",
    "lights": _SEE_THEME,
    "ground_opacity": _SEE_THEME,
    "ground_pattern": _SEE_THEME,
    "ground_pattern_width": _SEE_THEME,
    **dict.fromkeys(
        ("inq", "outq", "server", "server_thread", "socket", "socket_thread"), "`env.viewer` serves the page."
    ),
    **dict.fromkeys(("axes", "browser", "notebook"), "It is an argument of `env.launch`."),
    "last_time": "`env.sim_time` is the time.",
    "shape_callbacks": "`env.add_shape(shape, callback)` takes one.",
}


class LaunchedEnvironment:
    """An environment with a viewer and a clock, as soon as it is launched."""

    def __init__(self, _dev: bool = False) -> None:
        self._viewer: Viewer | None = None
        self._items: dict[int, Item] = {}
        self._in_order: tuple[Item, ...] = ()
        self._controls = Controls(None)
        self._recorder: Recorder | None = None
        self._printed = False
        self.headless, self.rate = True, 60.0

    def __getattr__(self, name: str) -> Any:
        hint = _ALTERNATIVES.get(name, "")
        raise AttributeError(f"Swift on Ulna has no {name!r}. {hint}".strip())

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
        """Open the environment: a page in the browser, where there is a screen.

        Args:
            realtime: Whether steps wait for their time; a number for that many simulated seconds a second. Where
                there is no screen they wait only if `headless` was asked for as well.
            headless: True for no page, False for one in any case; None for one where there is a screen or somebody at
                the terminal. SWIFT_HEADLESS or ULNA_HEADLESS in the environment says True.
            rate: How often the page is drawn [1/s]; it is 60 times a second at most whatever is said.
            browser: The name of the browser, as the module `webbrowser` has it; the usual one when not given;
                "notebook" for the cell of a notebook.
            notebook: Whether to show the page in the cell of a notebook.
            axes: Whether to show the world's axes.
            ground_opacity: The floor is always opaque [-].
            ground_pattern: The floor always has its grid.
            ground_pattern_width: See `ground_pattern` [m].
            lights: The lights are those of the viewer's theme.
            timeout: Accepted and ignored [s]: `hold` ends when the page has been closed for 3 s, as a reload
                takes.
            browser_timeout: A page whose script has ended says so, and stays open [s].
            **kwargs: `comms` of Swift 1, which means nothing here.

        Raises:
            MissingExtra: There is to be a page, and viser is not installed.
            TypeError: There is no such argument.
        """
        unknown = [name for name in kwargs if name not in _OLDER]
        if unknown:
            raise TypeError(f"Swift.launch has no argument {unknown[0]!r}.")
        if lights is not None or ground_opacity != 1.0 or ground_pattern or ground_pattern_width != 1.0:
            warnings.warn(_NOT_USED, UlnaWarning, stacklevel=2)
        if browser == "notebook":
            warnings.warn(
                'launch(browser="notebook") is now launch(notebook=True)', FutureWarning, stacklevel=2
            )
            browser, notebook = None, True
        if self._viewer is not None:
            self.close()
        headless_requested = _headless_requested() if headless is None else bool(headless)
        page = not headless_requested and (headless is False or notebook or somebody_can_look())
        speed = 1.0 if isinstance(realtime, bool) else float(realtime)
        self.headless, self.rate = not page, rate
        self._start(page, None, bool(realtime) and (page or headless is True), speed or 1.0, axes)
        if notebook:
            self._in_notebook()
        elif page and _open(self.viewer, browser):
            self._await_tab()
        elif page:
            print(f"Swift: the page is at {self.viewer.url}", flush=True)

    def _start(self, page: bool, port: int | None, realtime: bool, speed: float, axes: bool) -> None:
        self._viewer = Viewer(port, page=page, browser=False, title="Swift")
        # with a page, the viewer records what happens, for its time line; robots are moved here
        self._simulation = (
            self._viewer.simulate(realtime, speed, control="position")
            if page
            else Simulation(realtime, speed)
        )
        self._items, self._in_order, self._next_id = {}, (), 0
        self._controls = Controls(self._viewer.panel)
        self._axes = axes
        if axes:
            self._viewer.axes(0.3, name="world axes")

    def _in_notebook(self) -> None:
        from IPython.display import display  # pyright: ignore[reportMissingImports]

        display(self.viewer)

    def _await_tab(self) -> None:
        """Wait until the browser that was opened shows the page, so that nothing is missed; not for ever."""
        due = time.monotonic() + _BROWSER_TIMEOUT
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
            raise not_open_error()
        return self._viewer

    @property
    def sim_time(self) -> float:
        """The simulated time [s]."""
        return 0.0 if self._viewer is None else self._simulation.t

    def close(self, clear_cell: bool = False) -> None:
        """Close the page, and the environment with it."""
        self._controls.clear()
        if self._viewer is not None:
            self._viewer.close()
        self._viewer, self._controls = None, Controls(None)

    def reset(self) -> None:
        """Reset to an empty environment at time zero. A tab that looks at the page finds it again."""
        old, sim = self.viewer, self._simulation
        port = None if old.closed else int(old.url.rsplit(":", 1)[1])
        page = not (self.headless or old.closed)
        self.close()
        self._start(page, port, sim.realtime, sim.speed, self._axes)

    restart = reset


def _headless_requested() -> bool:
    return any(os.environ.get(name, "") not in ("", "0") for name in ("SWIFT_HEADLESS", "ULNA_HEADLESS"))


def _open(viewer: Viewer, browser: str | None) -> bool:
    """Open a page in a browser, where there is a screen; whether that was done."""
    if viewer.open_browser(browser):
        return True
    if browser is not None and somebody_can_look():
        print(f"There is no browser named {browser!r} here; the usual one is taken.", flush=True)
    return browser is not None and viewer.open_browser()
