"""A robot in a figure: how it is drawn, and where, if not at the robot's configuration."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.numbers import vector
from ulna.typing import Floats

_IGNORED = {"jointaxes": True, "jointlabels": False, "name": True}


class RobotPlot:
    """A drawing of a robot in a figure; `env.add(robot)` makes one.

    Attributes:
        robot: The robot.
        env: The figure.
        readonly: Whether steps leave the robot where it is.
        display: Whether it is drawn.
        ellipsoids: Kinds of ellipsoids to draw at the end: "velocity", "force".
    """

    def __init__(
        self,
        robot: Any,
        env: Any,
        readonly: bool = False,
        display: bool = True,
        jointaxes: bool = True,
        jointlabels: bool = False,
        eeframe: bool = True,
        shadow: bool = True,
        name: bool = True,
        options: Any = None,
        q: Any = None,
    ) -> None:
        """A drawing of a robot.

        Args:
            robot: The robot.
            env: The figure.
            readonly: Whether steps leave the robot where it is.
            display: Whether it is drawn.
            jointaxes: Accepted and ignored: Ulna draws sticks and balls; likewise `jointlabels` and `name`.
            jointlabels: See `jointaxes`.
            eeframe: Whether to draw the frame of the end.
            shadow: Whether to draw a shadow on the floor.
            name: See `jointaxes`.
            options: A dictionary; the "color" of its "robot" is that of the sticks.
            q: Configuration to draw, (n,) [rad or m]; None for the robot's, whatever it is at the time.
        """
        self.robot, self.env, self.readonly, self.display = robot, env, bool(readonly), bool(display)
        self.looks: dict[str, Any] = {"tool": bool(eeframe), "shadow": bool(shadow)}
        colour = dict(options or {}).get("robot", {}).get("color")
        if colour is not None:
            self.looks["color"] = _rgb(colour)
        ignored = {"jointaxes": jointaxes, "jointlabels": jointlabels, "name": name}
        self.without_effect = [key for key, value in ignored.items() if value != _IGNORED[key]]
        self.without_effect += [f"options[{key!r}]" for key in dict(options or {}) if key != "robot"]
        self.ellipsoids: tuple[str, ...] = ()
        self._q: Floats | None = None
        if q is not None:
            self.q = q

    @property
    def q(self) -> Floats:
        """The configuration that is drawn, (n,) [rad or m]: the robot's, unless one was assigned."""
        return self.robot.q if self._q is None else self._q

    @q.setter
    def q(self, q: Any) -> None:
        self._q = vector("q", q, self.robot.n)

    def ellipsoid_points(self) -> list[Floats]:
        """Points of its ellipsoids, (3, 17, 33) each [m]."""
        return [self.robot._ellipsoid(self.q, kind, "trans", 0.1).points for kind in self.ellipsoids]

    def draw(self) -> None:
        """Draws the figure anew."""
        self.env.redraw()


def _rgb(colour: Any) -> tuple[float, float, float]:
    """Red, green and blue of a colour as matplotlib writes it."""
    from matplotlib.colors import to_rgb

    red, green, blue = np.asarray(to_rgb(colour), dtype=float).tolist()
    return red, green, blue
