"""Pictures of a robot: stick figures in matplotlib, films, or the viewer."""

from __future__ import annotations

import importlib.util
import os
import warnings
from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from roboticstoolbox._plot.figure import PyPlot, PyPlot2, has_window
from roboticstoolbox._plot.robot_plot import RobotPlot
from ulna.errors import InputError, UlnaWarning
from ulna.typing import Array, Floats

_BACKENDS = ("pyplot", "pyplot2", "swift")
_FLAT_ONLY = (
    "matplotlib's figures have it, the viewer does not. Take backend='pyplot'; for films of the viewer see "
    "ulna.Viewer.film, for its camera ulna.Viewer.camera."
)
_APPEARANCE_ARGUMENTS = (
    "color",
    "options",
    "display",
    "jointaxes",
    "jointlabels",
    "eeframe",
    "shadow",
    "name",
)


class Plotting(RobotMixin):
    """Pictures."""

    _backend: str | None = None
    _figure: PyPlot | None = None
    """Where it was plotted last: ellipsoids are added there."""
    _backend_of_all: ClassVar[str | None] = None

    @property
    def default_backend(self) -> str | None:
        """The backend of `plot` and `teach` by default: "pyplot", "swift", or None to choose automatically."""
        return self._backend or self._backend_of_all

    @default_backend.setter
    def default_backend(self, be: str | None) -> None:
        self._backend = _checked(be)

    @classmethod
    def set_default_backend(cls, be: str | None) -> None:
        """Sets `default_backend` of all robots of the class for which it is not set."""
        cls._backend_of_all = _checked(be)

    def _backend_for(self, backend: str | None, here: bool = False) -> str:
        """The backend to use; `here` where only matplotlib supports the arguments."""
        name = _checked(backend) or self.default_backend
        flat = "pyplot2" if self._size == 3 else "pyplot"  # type: ignore[attr-defined]
        return name or ("swift" if not here and self._prefers_viewer() else flat)

    def plot(
        self,
        q: Any,
        backend: str | None = None,
        block: bool = False,
        dt: float = 0.05,
        limits: Any = None,
        vellipse: bool = False,
        fellipse: bool = False,
        fig: str | None = None,
        movie: str | None = None,
        loop: bool = False,
        notebook: bool | None = None,
        ax: Any = None,
        env: Any = None,
        view: str | None = None,
        **options: Any,
    ) -> Any:
        """Draws the robot, or plays a trajectory, in matplotlib, or in the viewer with backend="swift".

        Args:
            q: Configuration (n,), or rows of them (m, n) [rad or m].
            backend: "pyplot" or "swift"; None for the viewer where the robot has shapes and there is a screen.
            block: Whether to wait until the window is closed.
            dt: Time from row to row [s].
            limits: Of the picture, x, y, z from and to [m]; in matplotlib, without `env`.
            vellipse: Whether to draw the ellipsoid of velocities; in matplotlib.
            fellipse: Whether to draw the ellipsoid of forces; in matplotlib.
            fig: Name of the figure, which is drawn anew where there is one of that name; the robot's by default; in
                matplotlib, without `env`.
            movie: A file to write, .gif or .mp4, each row shown for `dt` seconds.
            loop: Whether to play for ever, where there is a window.
            ax: Axes to draw into; in matplotlib, without `env`.
            env: What an earlier call returned, to draw the robot beside what is there; its backend is used.
            view: "xy", "xz" or "yz" to look at that plane, also with `env`; in matplotlib.
            notebook: Whether to draw as in a notebook; only None and what is the case are offered.
            **options: How the robot is drawn, see `RobotPlot`: `color`, `eeframe`, `shadow` ...; a warning says which
                have no effect.

        Returns:
            The figure or environment; it has `hold()` and `close()`.

        Raises:
            WrongShape: `q` has another shape.
            InputError: The backend or a figure that is there cannot use an argument.
        """
        rows = _rows(q, self.n)
        _check_with_scene(env, limits=limits, fig=fig, ax=ax, notebook=notebook)
        only_flat = _names_of_arguments_set(
            limits=limits, vellipse=vellipse, fellipse=fellipse, fig=fig, ax=ax, view=view, movie=movie
        )
        chosen = self._backend_of(env) or self._backend_for(backend, here=bool(only_flat))
        names = () if chosen == "swift" else _APPEARANCE_ARGUMENTS
        looks = {name: options.pop(name) for name in names if name in options}
        _warn_of_unused([*options, *(["notebook"] if notebook else [])])
        if chosen == "swift":
            if only_flat:
                raise InputError(f"{', '.join(only_flat)} of plot: {_FLAT_ONLY}")
            return self._play(rows, block, dt, loop, env)
        if env is None:
            env = (PyPlot2 if chosen == "pyplot2" else PyPlot)(ax, None, fig or f"{self.name} Plot")
            env.launch(limits=limits)
        drawing = self._drawing_in(env, rows[0], view, looks, _kinds(vellipse, fellipse))
        _show_rows(drawing, rows, dt, loop, movie)
        self.q = rows[-1]
        if block:
            env.hold()
        return env

    def _drawing_in(
        self, figure: Any, q: Floats, view: str | None, looks: dict[str, Any], ellipsoids: tuple[str, ...]
    ) -> Any:
        """The robot in a figure of matplotlib, which is remembered."""
        figure.set_view(view)
        figure.heading, self._figure = self.name, figure
        drawing = figure.add(self, readonly=True, q=q, **looks)
        drawing.ellipsoids = ellipsoids
        return drawing

    def _prefers_viewer(self) -> bool:
        """Whether the robot has shapes and there is a screen."""
        from ulna.viewer.page.browser import has_screen

        if not any(link._drawn for link in self._links) or os.environ.get("SWIFT_HEADLESS"):
            return False
        return has_screen() and importlib.util.find_spec("viser") is not None

    @staticmethod
    def _backend_of(env: Any) -> str | None:
        """The backend of a scene that is there; None without one."""
        return None if env is None else "pyplot" if isinstance(env, PyPlot) else "swift"

    def _play(self, rows: Floats, block: bool, dt: float, loop: bool, env: Any = None) -> Any:
        """Plays configurations in the viewer; a robot that is there already stays, and another one is shown."""
        is_there = env is not None and env.has(self)
        if not is_there:
            self.q = rows[0]
        if env is None:
            env = self._launched_environment(realtime=len(rows) > 1)
        drawing = env.add(self, readonly=True)
        while True:
            for row in rows:
                drawing.q = row
                env.step(dt)
            if not loop or env.headless or env.viewer.closed:
                break
        if block:
            env.hold()
        return env

    def _launched_environment(self, realtime: bool) -> Any:
        """An environment of the viewer, with a page only where somebody can look at it."""
        import swift

        env = swift.Swift()
        env.launch(realtime=realtime)
        return env


def _rows(q: Any, n: int) -> Floats:
    """Configurations (m, n), also of one."""
    rows = np.atleast_2d(np.asarray(q, dtype=float))
    if rows.shape[-1] != n or rows.ndim != 2:
        raise WrongShape("q", np.shape(q), f"({n},) or (m, {n})")
    return rows


def _warn_of_unused(options: list[str]) -> None:
    if options:
        text = f"plot draws Ulna's picture of the robot, without the options {', '.join(options)} of the toolbox's."
        warnings.warn(text, UlnaWarning, stacklevel=3)


def _check_with_scene(env: Any, **fixed: Any) -> None:
    """Refuses arguments that are chosen when a scene is made, together with a scene.

    Raises:
        InputError: One of them is given.
    """
    scene_options = [name for name, value in fixed.items() if value is not None]
    if env is not None and scene_options:
        raise InputError(
            f"plot was given env and {', '.join(scene_options)}; what a scene is drawn in is chosen by the plot that "
            "makes it. Pass them there."
        )


def _names_of_arguments_set(**arguments: Any) -> list[str]:
    """The names of arguments that are neither None nor False."""
    return [name for name, value in arguments.items() if value is not None and value is not False]


def _show_rows(drawing: RobotPlot, rows: Floats, dt: float, loop: bool, movie: str | None) -> None:
    """Writes configurations into a film, or plays them where there is none."""
    if movie is None:
        _animate(drawing, rows, dt, loop)
        return
    from ulna.viewer.output.video import write_video

    write_video(movie, _frames(drawing, rows, dt), 1.0 / dt)


def _kinds(vellipse: bool, fellipse: bool) -> tuple[str, ...]:
    """The kinds of ellipsoids that are wanted."""
    return tuple(kind for kind, wanted in (("velocity", vellipse), ("force", fellipse)) if wanted)


def _animate(drawing: RobotPlot, rows: Floats, dt: float, loop: bool) -> None:
    """Plays configurations in a window, for ever with `loop`; without a window the last one is drawn."""
    wait = has_window()
    while True:
        for row in rows if wait else rows[-1:]:
            drawing.q = row
            drawing.env.step(dt)
        if not (loop and wait):
            return


def _frames(drawing: RobotPlot, rows: Floats, dt: float) -> Iterator[Array]:
    """The pictures of a film."""
    for row in rows:
        drawing.q = row
        drawing.env.redraw()
        yield drawing.env.picture()
        drawing.env.sim_time += dt


def _checked(backend: str | None) -> str | None:
    if backend is not None and backend.lower() not in _BACKENDS:
        raise UnknownOption("backend", backend, _BACKENDS)
    return backend and backend.lower()


__all__ = ["Plotting"]
