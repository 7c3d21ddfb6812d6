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
from ulna.errors import InputError, UlnaWarning
from ulna.typing import Array, Floats

_BACKENDS = ("pyplot", "pyplot2", "swift")


class Plotting(RobotMixin):
    """Pictures."""

    _backend: str | None = None
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
        return name or ("swift" if not here and self._prefers_viewer() else "pyplot")

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
            limits: Of the picture, x, y, z from and to [m].
            vellipse: Whether to draw the ellipsoid of velocities.
            fellipse: Whether to draw the ellipsoid of forces.
            fig: Name of the figure.
            movie: A file to write, .gif or .mp4, each row shown for `dt` seconds.
            loop: Whether to play for ever.
            ax: Axes to draw into.
            env: What an earlier call returned, to draw into it again.
            view: "xy", "xz" or "yz" to look at that plane; in matplotlib.
            notebook: Whether to draw as in a notebook; only None and what is the case are offered.
            **options: How the toolbox draws; a warning says that pictures are Ulna's.

        Returns:
            The figure or environment; it has `hold()` and `close()`.

        Raises:
            WrongShape: `q` has another shape.
        """
        if options or notebook:
            names = ", ".join([*options, *(["notebook"] if notebook else [])])
            text = f"plot draws Ulna's picture of the robot, without the options {names} of the toolbox's."
            warnings.warn(text, UlnaWarning, stacklevel=2)
        rows = np.atleast_2d(np.asarray(q, dtype=float))
        if rows.shape[-1] != self.n or rows.ndim != 2:
            raise WrongShape("q", np.shape(q), f"({self.n},) or (m, {self.n})")
        flat = movie is not None or ax is not None or isinstance(env, PyPlot)
        chosen = self._backend_for(backend, flat)
        if chosen == "swift":
            return self._play(rows, block, dt, movie, env)
        if env is None:
            env = (PyPlot2 if chosen == "pyplot2" else PyPlot)(ax, limits, fig or "")
            env.launch(view=view)
        if movie is not None:
            from ulna.viewer.output.video import write_video

            write_video(movie, self._frames(env, rows, dt, vellipse, fellipse), 1.0 / dt)
        else:
            self._animate(env, rows, dt, vellipse, fellipse, loop)
        self.q = rows[-1]
        if block:
            env.hold()
        return env

    def _animate(
        self, env: PyPlot, rows: Floats, dt: float, vellipse: bool, fellipse: bool, loop: bool
    ) -> None:
        wait = has_window()
        for _ in self._frames(env, rows if wait else rows[-1:], dt, vellipse, fellipse, drawn=False):
            env.step(dt)
        while loop and wait:
            for _ in self._frames(env, rows, dt, vellipse, fellipse, drawn=False):
                env.step(dt)

    def _frames(
        self, env: PyPlot, rows: Floats, dt: float, vellipse: bool, fellipse: bool, drawn: bool = True
    ) -> Iterator[Array]:
        for i, row in enumerate(rows):
            kinds = [kind for kind, wanted in (("velocity", vellipse), ("force", fellipse)) if wanted]
            ellipsoids = [self._ellipsoid(row, kind, "trans", 0.1).points for kind in kinds]
            title = f"{self.name}   t = {i * dt:.2f} s" if len(rows) > 1 else self.name
            env.show(self, row, title, ellipsoids)
            yield env.picture() if drawn else row

    def _prefers_viewer(self) -> bool:
        """Whether the robot has shapes and there is a screen."""
        from ulna.viewer.page.browser import has_screen

        if not self.hasgeometry or os.environ.get("SWIFT_HEADLESS"):
            return False
        return has_screen() and importlib.util.find_spec("viser") is not None

    def _play(self, rows: Floats, block: bool, dt: float, movie: str | None, env: Any = None) -> Any:
        if movie is not None:
            raise InputError(
                "`movie` needs backend='pyplot'; for films of the viewer see ulna.Viewer.record."
            )
        self.q = rows[0]
        if env is None:
            env = self._launched_environment(realtime=len(rows) > 1)
            env.add(self, readonly=True)
        for row in rows:
            self.q = row
            env.step(dt)
        if block:
            env.hold()
        return env

    def _launched_environment(self, realtime: bool) -> Any:
        """An environment of the viewer, with a page only where somebody can look at it."""
        import swift

        env = swift.Swift()
        env.launch(realtime=realtime)
        return env


def _checked(backend: str | None) -> str | None:
    if backend is not None and backend.lower() not in _BACKENDS:
        raise UnknownOption("backend", backend, _BACKENDS)
    return backend and backend.lower()


__all__ = ["Plotting"]
