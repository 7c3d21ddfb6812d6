"""Pictures of a robot: stick figures in matplotlib, films, sliders, or the viewer."""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

from ulna.errors import InputError, MissingExtra, ShapeError, UnknownName
from ulna.typing import Array, Floats

_BACKENDS = ("pyplot", "pyplot2", "swift")


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise MissingExtra("matplotlib", "toolbox", "plot") from None
    return plt


class PyPlot:
    """A figure of matplotlib with a robot in it.

    Attributes:
        fig: The figure.
        ax: Its axes.
    """

    def __init__(self, ax: Any = None, limits: Any = None, name: str = "") -> None:
        """Axes of matplotlib in three dimensions, new ones when not given; `limits` are x, y, z from and to [m]."""
        plt = _pyplot()
        self.ax = (
            plt.figure(name or None, figsize=(6.4, 4.8)).add_subplot(projection="3d") if ax is None else ax
        )
        self.fig = self.ax.figure
        self.limits = None if limits is None else np.asarray(limits, dtype=float).ravel()
        if self.limits is not None and self.limits.size == 2:
            self.limits = np.tile(self.limits, 3)

    def show(self, robot: Any, q: Floats, title: str = "", ellipses: Any = ()) -> None:
        """Draws the robot anew."""
        from ulna.viewer.sticks import stick_figure

        limits = None if not self.ax.lines else [self.ax.get_xlim(), self.ax.get_ylim(), self.ax.get_zlim()]
        self.ax.clear()
        stick_figure(robot._everything(), robot._configuration(q), self.ax)
        for points in ellipses:
            self.ax.plot_wireframe(*points, color="#e08a1e", lw=0.4)
        if self.limits is not None:
            limits = [self.limits[0:2], self.limits[2:4], self.limits[4:6]]
        if limits is not None:
            self.ax.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
        self.ax.set_title(title, fontsize=9)

    def picture(self) -> Array:
        """What the figure shows, (h, w, 3) uint8."""
        canvas = self.fig.canvas
        if not hasattr(canvas, "buffer_rgba"):
            from matplotlib.backends.backend_agg import FigureCanvasAgg

            canvas = FigureCanvasAgg(self.fig)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def step(self, dt: float = 0.05) -> None:
        """Lets the window draw, for `dt` seconds; at once where there is none."""
        if _has_window():
            _pyplot().pause(dt)

    def hold(self) -> None:
        """Waits until the window is closed; returns at once where there is none."""
        if _has_window():
            _pyplot().show(block=True)

    def close(self) -> None:
        """Closes the figure."""
        _pyplot().close(self.fig)

    def getframe(self) -> Array:
        """What the figure shows, (h, w, 3) uint8."""
        return self.picture()


def _has_window() -> bool:
    import matplotlib

    backend = str(matplotlib.get_backend()).lower()
    return backend not in ("agg", "pdf", "svg", "ps", "cairo", "template") and "inline" not in backend


class Plotting:
    """Pictures."""

    name: str
    n: int
    q: Floats

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
        ax: Any = None,
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
            **options: Let pass.

        Returns:
            What it was drawn in; it has `hold()` and `close()`.
        """
        rows = np.atleast_2d(np.asarray(q, dtype=float))
        if rows.shape[-1] != self.n or rows.ndim != 2:
            raise ShapeError("q", np.shape(q), f"({self.n},) or (m, {self.n})")
        backend = backend and backend.lower()
        if backend and backend not in _BACKENDS:
            raise UnknownName("backend", backend, _BACKENDS)
        if (
            backend or ("swift" if movie is None and ax is None and self._is_for_the_viewer() else "")
        ) == "swift":
            return self._play(rows, block, dt, movie)
        env = PyPlot(ax, limits, fig or "")
        if movie is not None:
            from ulna.viewer.film import write_film

            write_film(movie, self._frames(env, rows, dt, vellipse, fellipse), 1.0 / dt)
        else:
            wait = _has_window()
            for _ in self._frames(env, rows if wait else rows[-1:], dt, vellipse, fellipse, drawn=False):
                env.step(dt)
            while loop and wait:
                for _ in self._frames(env, rows, dt, vellipse, fellipse, drawn=False):
                    env.step(dt)
        self.q = rows[-1]
        if block:
            env.hold()
        return env

    def _frames(
        self, env: PyPlot, rows: Floats, dt: float, vellipse: bool, fellipse: bool, drawn: bool = True
    ) -> Iterator[Array]:
        for i, row in enumerate(rows):
            kinds = [kind for kind, wanted in (("velocity", vellipse), ("force", fellipse)) if wanted]
            shells = [self._shell(row, kind, "trans", 0.1).points for kind in kinds]
            title = f"{self.name}   t = {i * dt:.2f} s" if len(rows) > 1 else self.name
            env.show(self, row, title, shells)
            yield env.picture() if drawn else row

    def _is_for_the_viewer(self) -> bool:
        """Whether there are shapes to see and a screen to see them on."""
        if not self.hasgeometry or os.environ.get("SWIFT_HEADLESS"):  # type: ignore[attr-defined]
            return False
        has_screen = sys.platform in ("darwin", "win32") or any(
            map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY"))
        )
        return has_screen and importlib.util.find_spec("viser") is not None

    def _play(self, rows: Floats, block: bool, dt: float, movie: str | None) -> Any:
        if movie is not None:
            raise InputError(
                "`movie` needs backend='pyplot'; for films of the viewer see ulna.Viewer.record."
            )
        import swift

        env = swift.Swift()
        env.launch(realtime=len(rows) > 1, headless=bool(os.environ.get("SWIFT_HEADLESS")))
        self.q = rows[0]
        env.add(self)
        for row in rows:
            self.q = row
            env.step(dt)
        if block:
            env.hold()
        return env

    def teach(
        self, q: Any = None, block: bool = True, limits: Any = None, backend: str | None = None, **_: Any
    ) -> Any:
        """A slider for each joint beside the stick figure."""
        plt = _pyplot()
        from matplotlib.widgets import Slider

        start = self.q if q is None else np.asarray(q, dtype=float)
        figure = plt.figure(f"teach {self.name}", figsize=(8.0, 5.0))
        env = PyPlot(figure.add_axes((0.35, 0.02, 0.63, 0.94), projection="3d"), limits)
        at = np.array(start, dtype=float)
        env.show(self, at, self.name)
        low, high = self.qlim  # type: ignore[attr-defined]
        sliders = []
        for j in range(self.n):
            place = figure.add_axes((0.06, 0.92 - 0.8 * j / max(self.n, 1), 0.22, 0.03))
            slider = Slider(place, f"q{j}", low[j], high[j], valinit=at[j])

            def moved(value: float, j: int = j) -> None:
                at[j] = value
                self.q = at
                env.show(self, at, self.name)

            slider.on_changed(moved)
            sliders.append(slider)
        env.sliders = sliders  # type: ignore[attr-defined]
        if block:
            env.hold()
        return env

    def vellipse(
        self, q: Any, opt: str = "trans", unit: str = "rad", centre: Any = "ee", scale: float = 0.1, **_: Any
    ) -> Ellipse:
        """The ellipsoid of the velocities that joint rates of one give."""
        return self._shell(q, "velocity", opt, scale, centre)

    def fellipse(
        self, q: Any, opt: str = "trans", unit: str = "rad", centre: Any = "ee", scale: float = 0.1, **_: Any
    ) -> Ellipse:
        """The ellipsoid of the forces that joint torques of one give."""
        return self._shell(q, "force", opt, scale, centre)

    def _shell(self, q: Any, kind: str, opt: str, scale: float, centre: Any = "ee") -> Ellipse:
        from ulna.viewer.ellipsoids import of_jacobian

        if opt not in ("trans", "rot"):
            raise InputError(f"`opt` is {opt!r}; expected 'trans' or 'rot'.")
        J = self.jacob0(q)  # type: ignore[attr-defined]
        axes, radii = of_jacobian(J[:3] if opt == "trans" else J[3:], kind)
        middle = self.fkine(q).t if isinstance(centre, str) else np.asarray(centre, dtype=float)  # type: ignore[attr-defined]
        return Ellipse(axes[:3, :3], scale * radii, middle)

    def plot_ellipse(self, ellipse: Ellipse, block: bool = True, limits: Any = None, **_: Any) -> PyPlot:
        """Draws an ellipsoid."""
        env = PyPlot(None, limits)
        env.ax.plot_wireframe(*ellipse.points, color="#e08a1e", lw=0.5)
        if block:
            env.hold()
        return env

    def plot_vellipse(
        self, q: Any, block: bool = True, opt: str = "trans", limits: Any = None, **_: Any
    ) -> PyPlot:
        """Draws the robot with its ellipsoid of velocities."""
        return self._with_shell(q, "velocity", opt, block, limits)

    def plot_fellipse(
        self, q: Any, block: bool = True, opt: str = "trans", limits: Any = None, **_: Any
    ) -> PyPlot:
        """Draws the robot with its ellipsoid of forces."""
        return self._with_shell(q, "force", opt, block, limits)

    def _with_shell(self, q: Any, kind: str, opt: str, block: bool, limits: Any) -> PyPlot:
        at = self.q if q is None else np.asarray(q, dtype=float)
        env = PyPlot(None, limits)
        env.show(self, at, self.name, [self._shell(at, kind, opt, 0.1).points])
        if block:
            env.hold()
        return env


class Ellipse:
    """An ellipsoid in the world: directions, half axes, centre."""

    def __init__(self, axes: Floats, radii: Floats, centre: Floats) -> None:
        """`axes` (3, 3) are columns, `radii` (3,) and `centre` (3,) in metres."""
        self.axes, self.radii, self.centre = axes, radii, centre

    @property
    def points(self) -> Floats:
        """A grid of points on it, (3, 17, 33)."""
        u, v = np.meshgrid(np.linspace(0, np.pi, 17), np.linspace(0, 2 * np.pi, 33), indexing="ij")
        ball = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)])
        return np.tensordot(self.axes * self.radii, ball, axes=1) + self.centre[:, None, None]


__all__ = ["Ellipse", "Plotting", "PyPlot"]
