"""Ellipsoids of a robot's end: velocities and forces that it can reach."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongType
from roboticstoolbox._common.poses import to_spatial
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from roboticstoolbox._plot.figure import PyPlot, pyplot
from ulna.errors import InputError
from ulna.typing import Floats

_KINDS = {"v": "velocity", "f": "force"}
_COLOUR = "#e08a1e"
_DRAWN_BY_FIGURES = {
    **dict.fromkeys(("draw", "draw2"), "`plot` draws it, and `env.add(ellipsoid)` in the figure of a robot"),
    **dict.fromkeys(("make_ellipsoid", "make_ellipsoid2"), "`points` has its points in the world"),
}
"""Methods of the toolbox by which its figures draw ellipsoids, and what to use instead."""


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


class EllipsePlot(Ellipse):
    """The ellipsoid of a robot's end."""

    def __init__(
        self,
        robot: Any,
        q: Any,
        etype: str,
        opt: str = "trans",
        centre: Any = (0.0, 0.0, 0.0),
        scale: float = 1.0,
    ) -> None:
        """An ellipsoid.

        Args:
            robot: The robot.
            q: Configuration, (n,) [rad or m]; None for the robot's.
            etype: "v" for velocities, "f" for forces.
            opt: "trans" for linear velocities or forces, "rot" for angular velocities or moments.
            centre: Where it is drawn, (3,) [m]; "ee" for the end.
            scale: Factor of its half axes [m s/m or m/N].

        Raises:
            UnknownOption: Another `etype`.
        """
        if etype not in _KINDS:
            raise UnknownOption("etype", str(etype), _KINDS)
        one = robot._ellipsoid(q, _KINDS[etype], opt, scale, centre)
        super().__init__(one.axes, one.radii, one.centre)
        self.robot, self.opt, self.scale, self.q = robot, opt, scale, robot.q if q is None else q

    def plot(self, ax: Any = None) -> None:
        """Draws it into axes of matplotlib in three dimensions, or into a new figure."""
        axes = pyplot().figure().add_subplot(projection="3d") if ax is None else ax
        axes.plot_wireframe(*self.points, color=_COLOUR, lw=0.5)

    plot2 = plot

    def __getattr__(self, name: str) -> Any:
        if name in _DRAWN_BY_FIGURES:
            raise AttributeError(f"`{name}` of an ellipsoid is not offered; {_DRAWN_BY_FIGURES[name]}.")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")


class Ellipsoids(RobotMixin):
    """Ellipsoids, and colours of links."""

    def vellipse(
        self,
        q: Any,
        opt: str = "trans",
        unit: str = "rad",
        centre: Any = "ee",
        scale: float = 0.1,
        add: bool = True,
    ) -> Ellipse:
        """The ellipsoid of the velocities that joint rates of one produce, in the axes of the world.

        Args:
            q: Configuration, (n,).
            opt: "trans" for linear velocities, "rot" for angular ones.
            unit: Of angles in `q`, "rad" or "deg".
            centre: Where it is drawn, "ee" for the end.
            scale: What its half axes are multiplied by [m per m/s].
            add: Whether to draw it in the figure in which the robot was plotted last, if there is one.

        Returns:
            The ellipsoid.
        """
        return self._drawn_if(add, EllipsePlot(self, self._radians(q, unit), "v", opt, centre, scale))

    def fellipse(
        self,
        q: Any,
        opt: str = "trans",
        unit: str = "rad",
        centre: Any = "ee",
        add: bool = True,
        scale: float = 0.1,
    ) -> Ellipse:
        """The ellipsoid of the forces that joint torques of one produce; see `vellipse`.

        Args:
            q: Configuration (n,).
            opt: "trans" for linear velocities or forces, "rot" for angular velocities or moments.
            unit: Of angles in `q`, "rad" or "deg".
            centre: Where it is drawn, "ee" for the end.
            scale: Factor of its half axes [m/N].
            add: Whether to draw it in the figure in which the robot was plotted last, if there is one.

        Returns:
            The ellipsoid.
        """
        return self._drawn_if(add, EllipsePlot(self, self._radians(q, unit), "f", opt, centre, scale))

    def _drawn_if(self, add: bool, ellipse: EllipsePlot) -> EllipsePlot:
        """An ellipsoid, added to the figure of the last `plot` or `teach` if that is wanted."""
        if add and self._figure is not None:
            self._figure.add(ellipse)
        return ellipse

    def _radians(self, q: Any, unit: str) -> Any:
        """A configuration that was passed in degrees or radians, in radians."""
        if unit not in ("rad", "deg"):
            raise UnknownOption("unit", unit, ("rad", "deg"))
        return q if unit == "rad" or q is None else self.toradians(q)

    def _ellipsoid(self, q: Any, kind: str, opt: str, scale: float, centre: Any = "ee") -> Ellipse:
        from ulna.viewer.robot.ellipsoids import manipulability_ellipsoid

        if opt not in ("trans", "rot"):
            raise InputError(f"`opt` is {opt!r}; expected 'trans' or 'rot'.")
        at = self.q if q is None else np.asarray(q, dtype=float)
        chain, end = self._chain(None, None), to_spatial(self.fkine(at).A)
        J = end[:3, :3] @ np.split(chain.jacobe(at), 2)[0 if opt == "trans" else 1]
        axes, radii = manipulability_ellipsoid(J, kind)
        middle = end[:3, 3] if isinstance(centre, str) else np.asarray(centre, dtype=float)
        return Ellipse(axes[:3, :3], scale * radii, middle)

    def plot_ellipse(
        self,
        ellipse: Ellipse,
        block: bool = True,
        limits: Any = None,
        jointaxes: bool = True,
        eeframe: bool = True,
        shadow: bool = True,
        name: bool = True,
    ) -> PyPlot:
        """Draws an ellipsoid.

        Args:
            ellipse: What `vellipse` or `fellipse` returned.
            block: Whether to wait until the window is closed.
            limits: Of the picture, x, y, z from and to [m].
            jointaxes: How the toolbox draws a robot beside it, likewise `eeframe`, `shadow` and `name`; none is drawn.
            eeframe: See `jointaxes`.
            shadow: See `jointaxes`.
            name: See `jointaxes`.

        Returns:
            The figure.

        Raises:
            WrongType: It is no ellipsoid.
        """
        if not isinstance(ellipse, Ellipse):
            raise WrongType(
                f"`ellipse` is {type(ellipse).__name__}; expected what vellipse or fellipse returned."
            )
        env = PyPlot(None, limits)
        env.ax.plot_wireframe(*ellipse.points, color=_COLOUR, lw=0.5)
        if block:
            env.hold()
        return env

    def plot_vellipse(
        self,
        q: Any,
        block: bool = True,
        vellipse: Ellipse | None = None,
        limits: Any = None,
        opt: str = "trans",
        centre: Any = "ee",
        jointaxes: bool = True,
        eeframe: bool = True,
        shadow: bool = True,
        name: bool = True,
    ) -> PyPlot:
        """Draws the robot with its ellipsoid of velocities.

        Args:
            q: Configuration, (n,); None for the robot's.
            block: Whether to wait until the window is closed.
            vellipse: The ellipsoid to draw instead of that at `q`.
            limits: Of the picture, x, y, z from and to [m].
            opt: "trans" for linear velocities, "rot" for angular ones.
            centre: Where the ellipsoid is drawn, "ee" for the end.
            jointaxes: How the toolbox draws the robot, likewise `eeframe`, `shadow` and `name`; Ulna draws sticks.
            eeframe: See `jointaxes`.
            shadow: See `jointaxes`.
            name: See `jointaxes`.

        Returns:
            The figure.
        """
        return self._plot_with_ellipsoid(q, "velocity", opt, block, limits, vellipse, centre)

    def plot_fellipse(
        self,
        q: Any,
        block: bool = True,
        fellipse: Ellipse | None = None,
        limits: Any = None,
        opt: str = "trans",
        centre: Any = "ee",
        jointaxes: bool = True,
        eeframe: bool = True,
        shadow: bool = True,
        name: bool = True,
    ) -> PyPlot:
        """Draws the robot with its ellipsoid of forces; see `plot_vellipse`.

        Args:
            q: Configuration (n,); None for the robot's.
            block: Whether to wait until the window is closed.
            fellipse: The ellipsoid to draw instead of that at `q`.
            limits: Of the picture, x, y, z from and to [m].
            opt: "trans" for forces, "rot" for moments.
            centre: Where the ellipsoid is drawn, "ee" for the end.
            jointaxes, eeframe, shadow, name: See `plot_vellipse`.

        Returns:
            The figure.
        """
        return self._plot_with_ellipsoid(q, "force", opt, block, limits, fellipse, centre)

    def _plot_with_ellipsoid(
        self, q: Any, kind: str, opt: str, block: bool, limits: Any, ellipse: Any, centre: Any
    ) -> PyPlot:
        at = self.q if q is None else np.asarray(q, dtype=float)
        drawn = self._ellipsoid(at, kind, opt, 0.1, centre) if ellipse is None else ellipse
        env = PyPlot(None, limits)
        env.heading, self._figure = self.name, env
        env.add(self, readonly=True, q=at)
        env.add(drawn)
        if block:
            env.hold()
        return env

    def linkcolormap(self, linkcolors: Any = "viridis") -> Any:
        """A colour map of matplotlib with a colour for each joint: named, or of a list of n colours.

        Raises:
            InputError: It is a list, and not of n colours.
        """
        pyplot()
        from matplotlib import colormaps, colors

        if isinstance(linkcolors, (list, tuple)):
            if len(linkcolors) != self.n:
                raise InputError(f"`linkcolors` has {len(linkcolors)} colours; expected {self.n}.")
            return colors.ListedColormap(list(linkcolors))
        return colormaps.get_cmap(linkcolors).resampled(self.n)


__all__ = ["Ellipse", "EllipsePlot", "Ellipsoids"]
