"""Robots by products of exponentials: a screw axis for each joint, and where the end is at zero.

Source: Lynch & Park, Modern Robotics (2017), section 4.1; frames on the axes as in Huczala et al., An automated
conversion between selected robot kinematic representations (2022).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._common.poses import matrix, pose
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link
from roboticstoolbox._robots.robot import Robot
from ulna.errors import InputError
from ulna.typing import Floats

_ZERO_STEP = 1e-8  # [m or rad] below which a step between two frames is left out


class PoELink(Link):
    """A link that is known by a screw in the base's axes, at the robot's zero configuration; fixed, unless derived.

    Attributes:
        S: The screw, a `Twist3`.
    """

    _joint: str = ""

    def __init__(self, twist: Any, name: str = "", **more: Any) -> None:
        """A link.

        Args:
            twist: The screw, linear part first, a `Twist3` or (6,) [m and rad].
            name: Its name; numbered by the robot where there is none.
            more: Arguments of `Link`, such as `m` or `qlim`.
        """
        from spatialmath import Twist3  # pyright: ignore[reportMissingImports]

        self.S = Twist3(twist)
        self.frame = _frame(np.asarray(self.S.v), np.asarray(self.S.w), self._joint)
        super().__init__(_transforms(self.frame, self._joint), name=name or "", **more)

    def __str__(self) -> str:
        return f'{type(self).__name__}[twist={self.S}, name="{self.name}"]'

    def __repr__(self) -> str:
        name = f', name="{self.name}"' if self.name else ""
        return f"PoELink({np.array2string(self.S.S, separator=',')}{name})"


class PoERevolute(PoELink):
    """A joint that turns about a line."""

    _joint = "Rz"

    def __init__(self, axis: Any, point: Any, **more: Any) -> None:
        """A joint.

        Args:
            axis: Direction of the line, (3,).
            point: A point of it, (3,) [m].
            more: Arguments of `PoELink`.
        """
        w = _unit("axis", axis)
        super().__init__(np.r_[-np.cross(w, np.asarray(point, dtype=float).ravel()), w], **more)


class PoEPrismatic(PoELink):
    """A joint that slides along a direction."""

    _joint = "tz"

    def __init__(self, axis: Any, **more: Any) -> None:
        """A joint.

        Args:
            axis: The direction, (3,).
            more: Arguments of `PoELink`.
        """
        super().__init__(np.r_[_unit("axis", axis), np.zeros(3)], **more)


class PoERobot(Robot):
    """A serial arm of screw axes: T = exp(S1 q1) ... exp(Sn qn) T0; its links are base, joints and end."""

    def __init__(self, links: Any, T0: Any, **more: Any) -> None:
        """A robot.

        Args:
            links: The joints, PoE links, in order.
            T0: Pose of the end with all joints at zero, an SE3 or (4, 4).
            more: Arguments of `Robot`, such as `name`.

        Raises:
            WrongType: `links` holds something else.
        """
        joints = list(links)
        for link in joints:
            if not isinstance(link, PoELink):
                raise WrongType(f"{link!r} is no PoE link; expected PoERevolute or PoEPrismatic.")
        self.T0 = pose(matrix(T0).copy())
        chain = [PoELink(np.zeros(6)), *joints, PoELink(self.T0.twist().S)]
        chain[-1].frame = np.asarray(self.T0.A, dtype=float)
        for i, link in enumerate(chain):
            before = chain[i - 1].frame if i else np.eye(4)
            link._parent, link.name = chain[i - 1] if i else None, link.name or f"link-{i}"
            link._ets = _transforms(np.linalg.solve(before, link.frame), link._joint)
        super().__init__(chain, **more)

    def __str__(self) -> str:
        lines = [f"  {i}: {link.S}" for i, link in enumerate(self._links)]  # type: ignore[attr-defined]
        return "\n".join(["PoERobot:", *lines, f"  T0: {self.T0.strline()}"])

    def __repr__(self) -> str:
        links = "\n".join(f"    {link!r}," for link in self._links)
        return f'PoERobot([\n{links}\n    ],\n    T0=SE3({np.array_repr(self.T0.A)}),\n    name="{self.name}",\n)'


def _unit(name: str, vector: Any) -> Floats:
    v = np.asarray(vector, dtype=float).ravel()
    length = float(np.linalg.norm(v))
    if v.shape != (3,) or not length > 0.0:
        raise InputError(f"`{name}` is {vector}; expected three numbers that are not all zero.")
    return v / length


def _frame(v: Floats, w: Floats, joint: str) -> Floats:
    """The frame of a screw: z along it; of a line the origin is the point nearest to the base's, and x leads there."""
    T = np.eye(4)
    if not joint:
        T[:3, 3] = v
        return T
    z = v if joint == "tz" else w
    if joint == "Rz":
        T[:3, 3] = np.cross(w, v)
    distance = float(np.linalg.norm(T[:3, 3]))
    y = np.cross(z, T[:3, 3] / distance if distance > _ZERO_STEP else [1.0, 0.0, 0.0])
    if np.linalg.norm(y) < _ZERO_STEP:
        y = np.cross(z, [0.0, 1.0, 0.0])
    y /= np.linalg.norm(y)
    T[:3, 0], T[:3, 1], T[:3, 2] = np.cross(y, z), y, z
    return T


def _transforms(T: Floats, joint: str) -> ETS:
    """A pose as three translations and rotations about z, y and x, those that do nothing left out, and the joint."""
    from spatialmath.base import tr2rpy  # pyright: ignore[reportMissingImports]

    roll, pitch, yaw = tr2rpy(T)
    steps = dict(zip(("tx", "ty", "tz"), T[:3, 3], strict=True)) | {"Rz": yaw, "Ry": pitch, "Rx": roll}
    parts = [ET(kind, float(size)) for kind, size in steps.items() if abs(size) > _ZERO_STEP]
    out = ETS([*parts, ET(joint)] if joint else parts)
    out._auto_jindex = True
    return out
