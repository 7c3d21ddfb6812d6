"""Robots by products of exponentials: a screw axis for each joint, and where the end is at zero.

Source: Lynch & Park, Modern Robotics (2017), section 4.1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.poses import along, matrix
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link
from roboticstoolbox._robots.robot import Robot
from ulna.errors import InputError
from ulna.typing import Floats


def _unit(name: str, vector: Any) -> Floats:
    v = np.asarray(vector, dtype=float).ravel()
    length = float(np.linalg.norm(v))
    if v.shape != (3,) or not length > 0.0:
        raise InputError(f"`{name}` is {vector}; expected three numbers that are not all zero.")
    return v / length


class PoELink(Link):
    """A joint about or along a line of the base, as it lies with all joints at zero."""

    def __init__(self, axis: Any, point: Any = (0.0, 0.0, 0.0), slides: bool = False, **more: Any) -> None:
        """`axis` is the line's direction, `point` one of its points; the joint turns unless it `slides`."""
        self.axis, self.point, self.slides = (
            _unit("axis", axis),
            np.asarray(point, dtype=float).ravel(),
            slides,
        )
        self.frame = along(self.axis, self.point)
        super().__init__(ETS(ET.tz() if slides else ET.Rz()), **more)

    @property
    def S(self) -> Floats:
        """The screw, linear part first, (6,)."""
        if self.slides:
            return np.concatenate([self.axis, np.zeros(3)])
        return np.concatenate([np.cross(self.point, self.axis), self.axis])


class PoERevolute(PoELink):
    """A joint that turns about a line."""

    def __init__(self, axis: Any, point: Any, **more: Any) -> None:
        super().__init__(axis, point, False, **more)


class PoEPrismatic(PoELink):
    """A joint that slides along a direction."""

    def __init__(self, axis: Any, **more: Any) -> None:
        super().__init__(axis, (0.0, 0.0, 0.0), True, **more)


class PoERobot(Robot):
    """A serial arm of screw axes: T = exp(S1 q1) ... exp(Sn qn) T0."""

    def __init__(self, links: Any, T0: Any, **more: Any) -> None:
        """`links` are PoE links; `T0` is where the end is with all joints at zero, an SE3 or (4, 4)."""
        self.T0 = matrix(T0).copy()
        joints = list(links)
        before = np.eye(4)
        for i, link in enumerate(joints):
            link._parent, link.name = joints[i - 1] if i else None, link.name or f"link-{i + 1}"
            step = np.linalg.solve(before, link.frame)
            link._ets = ETS([ET("SE3", T=step), link._ets.data[-1]])
            link._ets._auto_jindex = True
            before = link.frame
        end = Link(
            ETS(ET("SE3", T=np.linalg.solve(before, self.T0).astype(float))), name="ee", parent=joints[-1]
        )
        super().__init__([*joints, end], **more)

    def __str__(self) -> str:
        from spatialmath import SE3, Twist3  # pyright: ignore[reportMissingImports]

        end = SE3(self.T0, check=False)
        screws = [Twist3(), *(Twist3(link.S) for link in self._links[:-1]), end.twist()]  # type: ignore[attr-defined]
        lines = [f"  {i}: {screw}" for i, screw in enumerate(screws)]
        return "\n".join(["PoERobot:", *lines, f"  T0: {end.strline()}"])
