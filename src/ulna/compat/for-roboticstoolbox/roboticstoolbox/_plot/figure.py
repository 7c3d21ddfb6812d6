"""Figures of matplotlib with robots in them: the toolbox's backend "pyplot"."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownOption
from roboticstoolbox._plot.background import Background
from roboticstoolbox._plot.robot_plot import RobotPlot
from ulna.checks.values import number as checked_number
from ulna.errors import InputError, MissingExtra, ShapeError, UlnaWarning
from ulna.typing import Array, Floats

_VIEWS = {"xy": (90, -90), "xz": (0, -90), "yz": (0, 0)}


def pyplot() -> Any:
    """matplotlib.pyplot.

    Raises:
        MissingExtra: matplotlib is not installed.
    """
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise MissingExtra("matplotlib", "toolbox", "plot") from None
    return plt


def has_window() -> bool:
    """Whether figures have windows that somebody could close."""
    import matplotlib

    backend = str(matplotlib.get_backend()).lower()
    return backend not in ("agg", "pdf", "svg", "ps", "cairo", "template") and "inline" not in backend


def _warn_of_options(function: str, options: Iterable[str]) -> None:
    """Says which options of the toolbox's pictures play no part."""
    if options:
        text = f"{function} draws Ulna's picture, without the options {', '.join(options)} of the toolbox's."
        warnings.warn(text, UlnaWarning, stacklevel=3)


class PyPlot:
    """A figure of matplotlib with robots in it.

    `step` moves the robots in control mode "v" by their `qd`, within their limits.
    """

    supports_teach = supports_ellipse = True

    def __init__(self, ax: Any = None, limits: Any = None, name: str = "") -> None:
        """A figure, opened by `launch`.

        Args:
            ax: Axes of matplotlib in three dimensions to draw into.
            limits: Of the picture, x, y, z from and to [m].
            name: The window's name.
        """
        self._ax, self.limits, self._name = ax, None, name
        self._set_limits(limits)
        self._objects: dict[int, Any] = {}
        self._moving: list[Any] = []
        self._canvas: Any = None
        self._background = Background()
        self.sim_time, self.heading = 0.0, ""

    def _set_limits(self, limits: Any) -> None:
        if limits is not None:
            bounds = np.asarray(limits, dtype=float).ravel()
            if bounds.size not in (2, 6):
                raise ShapeError(
                    "limits", np.shape(limits), "(2,) for all axes, or (6,): x, y, z from and to"
                )
            self.limits = np.tile(bounds, 3) if bounds.size == 2 else bounds

    def launch(
        self,
        name: str | None = None,
        fig: Any = None,
        ax: Any = None,
        limits: Any = None,
        view: str | None = None,
        **options: Any,
    ) -> None:
        """Opens the figure.

        Args:
            name: The window's name.
            fig: Figure of matplotlib to draw into, in axes of its own.
            ax: Axes of matplotlib in three dimensions to draw into.
            limits: Of the picture, x, y, z from and to [m].
            view: "xy", "xz" or "yz" to look at that plane; None for a corner.
            **options: How the toolbox opens it; a warning says that pictures are Ulna's.
        """
        _warn_of_options("launch", options)
        self._name = name or self._name
        if ax is not None:
            self._ax = ax
        elif fig is not None:
            self._ax = fig.add_subplot(projection="3d")
        self._set_limits(limits)
        self.set_view(view)

    def set_view(self, view: str | None) -> None:
        """Looks at a plane: "xy", "xz" or "yz"; None leaves the view as it is.

        Raises:
            UnknownOption: Another `view`.
        """
        if view is not None:
            if view not in _VIEWS:
                raise UnknownOption("view", view, _VIEWS)
            self.ax.view_init(*_VIEWS[view])

    @property
    def ax(self) -> Any:
        """The axes."""
        if self._ax is None:
            figure = pyplot().figure(self._name or None, figsize=(6.4, 4.8))
            figure.clear()  # one of that name may be there
            self._ax = figure.add_subplot(projection="3d")
        return self._ax

    @property
    def fig(self) -> Any:
        """The figure."""
        return self.ax.figure

    def add(
        self, ob: Any, readonly: bool = False, *, color: Any = None, options: Any = None, **more: Any
    ) -> Any:
        """Adds a robot, or an ellipsoid.

        Args:
            ob: The robot or ellipsoid.
            readonly: Whether a robot is shown only, never moved.
            color: Colour of a robot's sticks, as matplotlib writes it.
            options: Of a robot, see `RobotPlot`.
            **more: Of a robot, arguments of `RobotPlot` such as `q`; a warning says which have no effect.

        Returns:
            The `RobotPlot` of a robot, whose `q` may be assigned; the number of an ellipsoid.

        Raises:
            InputError: It is neither.
        """
        if not (hasattr(ob, "_complete_robot") or hasattr(ob, "points")):
            raise InputError(
                f"{ob!r} cannot be drawn here; robots and ellipsoids can, shapes by swift.Swift()."
            )
        number = max(self._objects, default=-1) + 1
        if hasattr(ob, "points"):
            _warn_of_options("add", more)
            self._objects[number] = ob
        else:
            looks = dict(options or {})
            if color is not None:
                looks["robot"] = {**looks.get("robot", {}), "color": color}
            plot = RobotPlot(ob, self, readonly, options=looks, **more)
            _warn_of_options("add", plot.without_effect)
            self._objects[number] = plot
        self.redraw()
        return number if hasattr(ob, "points") else self._objects[number]

    @property
    def robots(self) -> list[RobotPlot]:
        """The drawings of robots."""
        return [ob for ob in self._objects.values() if isinstance(ob, RobotPlot)]

    @property
    def ellipses(self) -> list[Any]:
        """The ellipsoids."""
        return [ob for ob in self._objects.values() if not isinstance(ob, RobotPlot)]

    def remove(self, id: Any) -> None:
        """Takes something out: a robot, an ellipsoid, or a `RobotPlot`; or by its number."""
        drawn = {key: ob.robot if isinstance(ob, RobotPlot) else ob for key, ob in self._objects.items()}
        number = next((key for key, ob in drawn.items() if id is ob or id is self._objects[key]), id)
        if not isinstance(number, int) or number not in self._objects:
            raise UnknownOption("number of an object in the figure", repr(number), map(str, self._objects))
        del self._objects[number]
        self.redraw()

    def reset(self) -> None:
        """Takes everything out."""
        self._objects, self.sim_time, self._moving = {}, 0.0, []
        self.ax.clear()

    restart = reset

    def redraw(self) -> None:
        """Draws everything where it is by now."""
        robots = [(plot.robot, plot.q, plot.looks) for plot in self.robots if plot.display]
        time = f"t = {self.sim_time:.2f} s" if self.sim_time else ""
        ellipses = [ob.points for ob in self.ellipses]
        ellipses += [points for plot in self.robots if plot.display for points in plot.ellipsoid_points()]
        self._show(robots, "   ".join(filter(None, (self.heading, time))), ellipses)

    def show(self, robot: Any, q: Floats, title: str = "", ellipses: Any = ()) -> None:
        """Draws one robot.

        Args:
            robot: The robot.
            q: Configuration (n,) [rad or m].
            title: Title of the figure.
            ellipses: Ellipsoids to draw.
        """
        self._show([(robot, q, {})], title, ellipses)

    def _show(self, robots: Any, title: str, ellipses: Any) -> None:
        from ulna.viewer.robot.stick_figure import stick_figure

        limits = None if not self.ax.lines else [self.ax.get_xlim(), self.ax.get_ylim(), self.ax.get_zlim()]
        for artist in self._moving:
            if artist.axes is not None:
                artist.remove()
        drawn = [artist for artist in self.ax.get_children() if not artist.stale]
        before = {id(artist) for artist in self.ax.get_children()}
        for robot, q, looks in robots:
            stick_figure(robot._complete_robot(), robot._complete_configuration(q), self.ax, **looks)
        for points in ellipses:
            self.ax.plot_wireframe(*points, color="#e08a1e", lw=0.4)
        if self.limits is not None:
            limits = [self.limits[0:2], self.limits[2:4], self.limits[4:6]]
        if limits is not None:
            self.ax.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
        if self._moving:
            self.ax.title.set_text(title)  # where the first one was placed
        else:
            self.ax.set_title(title, fontsize=9)
        if limits is not None:  # the axes are scaled as before, so that what was drawn is still right
            for artist in drawn:
                artist.stale = False
        self._moving = [artist for artist in self.ax.get_children() if id(artist) not in before]

    def picture(self) -> Array:
        """What the figure shows, (h, w, 3) uint8."""
        canvas = self.fig.canvas
        if not hasattr(canvas, "buffer_rgba"):
            from matplotlib.backends.backend_agg import FigureCanvasAgg

            canvas = self._canvas = self._canvas or FigureCanvasAgg(self.fig)
        self._background.draw(canvas, self.ax, [*self._moving, self.ax.title])
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def getframe(self) -> Any:
        """What the figure shows, as an image of Pillow in RGB, with `save` and `show`."""
        from PIL import Image  # which matplotlib needs, too

        return Image.fromarray(self.picture())

    def step(self, dt: float = 0.05) -> None:
        """Moves what was added, and lets the window draw for `dt` seconds; at once where there is none.

        Raises:
            InputError: `dt` is not above zero.
        """
        dt = checked_number("dt", dt, "a time above zero [s]", above=0.0)
        moving = {id(p.robot): p.robot for p in self.robots if not p.readonly and p.robot.control_mode == "v"}
        for robot in moving.values():
            low, high = robot._joint_bounds
            robot.q = np.clip(robot.q + dt * robot.qd, low, high)
        self.sim_time += dt
        if self._objects:
            self.redraw()
        if has_window():
            pyplot().pause(dt)

    def hold(self) -> None:
        """Waits until the window is closed; returns at once where there is none."""
        if has_window():
            pyplot().show(block=True)

    def close(self) -> None:
        """Closes the figure."""
        pyplot().close(self.fig)

    def __repr__(self) -> str:
        return f"PyPlot(t = {self.sim_time:g}, {len(self._objects)} objects)"


class PyPlot2(PyPlot):
    """The same for robots in the plane, looked at from above."""

    def launch(  # pyright: ignore[reportIncompatibleMethodOverride]
        self, name: str | None = None, limits: Any = None, view: str | None = None, **options: Any
    ) -> None:
        """Opens the figure.

        Args:
            name: The window's name.
            limits: Of the picture, x and y from and to; or x, y, z from and to [m].
            view: "xy" by default; "xz" or "yz" to look at that plane.
            **options: See `PyPlot.launch`.
        """
        if limits is not None and np.size(limits) == 4:
            limits = [*np.ravel(limits), -1.0, 1.0]
        super().launch(name, limits=limits, view=view or "xy", **options)


__all__ = ["PyPlot", "PyPlot2"]
