"""The closed loops of an MJCF file, as constraints for the dynamics: its equalities `connect` and `weld`."""

from __future__ import annotations

import os
from typing import Any

from ulna.formats.mjcf_parse import names_of, pose_of, read_mjcf
from ulna.formats.mjcf_switches import Switches
from ulna.model import FrameLoop, PointLoop
from ulna.numeric.arrays import triple
from ulna.spatial import SE3

CONNECT, WELD = 0, 1
"""mjtEq."""
SITE = 6
"""mjOBJ_SITE."""


def loops_from_mjcf(
    source: str | os.PathLike[str], *, trusted: bool = False
) -> tuple[PointLoop | FrameLoop, ...]:
    """The constraints that close the loops of an MJCF file or text, those that are active when it starts.

    There are none where the file disables equalities.

        robot = ulna.load("four_bar.xml")
        a = robot.constraints.forward_dynamics(q, v, tau, loops_from_mjcf("four_bar.xml"))

    MuJoCo's are soft; these hold exactly.

    Args:
        source: a path, or text (from "<").
        trusted: whether MuJoCo compiles it in this process and without limits.

    Returns:
        The constraints.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the file is missing or broken; says where and how to fix it.
    """
    m = read_mjcf(source, trusted).model
    links, _ = names_of(m)
    if not Switches.of(m).equalities:
        return ()
    kinds = (CONNECT, WELD)
    return tuple(_loop(m, links, e) for e in range(m.neq) if m.eq_type[e] in kinds and m.eq_active0[e])


def _loop(m: Any, links: list[str], e: int) -> PointLoop | FrameLoop:
    one, two, data = int(m.eq_obj1id[e]), int(m.eq_obj2id[e]), m.eq_data[e]
    if m.eq_objtype[e] == SITE:
        a, b = (pose_of(m.site_pos[s], m.site_quat[s]) for s in (one, two))
        one, two = (int(m.site_bodyid[s]) for s in (one, two))
    elif m.eq_type[e] == CONNECT:
        a, b = SE3.trans(*data[:3]), SE3.trans(*data[3:6])
    else:  # a point of the second body; the same point and the second body's axes, seen from the first
        a, b = pose_of(data[3:6], data[6:10]), SE3.trans(*data[:3])
    if m.eq_type[e] == CONNECT:
        return PointLoop(links[one], links[two], triple(a.translation), triple(b.translation))
    return FrameLoop(links[one], links[two], a, b)
