"""Robots in the plane, whose poses are SE2."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.poses import pose, to_planar
from roboticstoolbox._ets.ets import ETS2
from roboticstoolbox._links.link import Link2
from roboticstoolbox._robots.robot import BaseRobot
from ulna.typing import Floats


@describe_arguments
class Robot2(BaseRobot):
    """A robot in the plane."""

    _link_class = Link2
    _size = 3

    def fkine(self, q: Any, end: Any = None, start: Any = None) -> Any:
        """The pose of `end` in the world.

        Returns:
            One SE2, with m elements for (m, n).
        """
        T = to_planar(self._chain(end, start).fk(q))
        T = T if self._base is None else self._base @ T
        return pose(T if self._tool is None else T @ self._tool)

    def fkine_all(self, q: Any) -> Any:
        """Poses of the base and of all links in the world.

        Args:
            q: Configuration (n,) [rad or m].

        Returns:
            One SE2 with an element for the base and for each link.
        """
        return pose(to_planar(np.asarray(super().fkine_all(q).A)))

    def _chain(self, end: Any, start: Any, tool: Any = None) -> Any:
        return self._chain_between(start, end)

    def ets(self, start: Any = None, end: Any = None) -> Any:
        """The transforms from `start` to `end`.

        Returns:
            The chain of transforms.
        """
        return ETS2._from_transforms(super().ets(start, end).data)

    def jacob0(self, q: Any, start: Any = None, end: Any = None) -> Floats:
        """The Jacobian in the axes of the start: x, y and the angle.

        Returns:
            Jacobian (3, n).
        """
        return self._chain(end, start).jacob0(q)[..., [0, 1, 5], :]

    def jacobe(self, q: Any, start: Any = None, end: Any = None) -> Floats:
        """The Jacobian in the axes of the end: x, y and the angle.

        Returns:
            Jacobian (3, n).
        """
        return self._chain(end, start).jacobe(q)[..., [0, 1, 5], :]


class ERobot2(Robot2):
    """The former name of `Robot2`."""
