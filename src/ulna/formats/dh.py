"""Denavit-Hartenberg tables, standard and modified -> Model.

| symbol | meaning | unit |
|---|---|---|
| theta | angle about z | [rad] |
| d | distance along z | [m] |
| a | distance along x | [m] |
| alpha | angle about x | [rad] |

Standard (distal): A_i = Rz(theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i); Spong, Hutchinson and Vidyasagar, Robot
Modeling and Control (2006), equation 3.10. Modified (proximal): A_i = Rx(alpha_i) Tx(a_i) Rz(theta_i)
Tz(d_i), where row i holds the alpha and a that Craig writes alpha_{i-1}, a_{i-1}; Craig, Introduction to
Robotics (2005), equation 3.6.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ulna.errors import InputError, UnknownName, excerpt
from ulna.formats.poses import snapped
from ulna.model import Fixed, JointKind, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3, Inertia

CONVENTIONS = ("standard", "modified")


@dataclass(frozen=True)
class DHRow:
    """One joint of a Denavit-Hartenberg table.

    Use `revolute` (theta is the joint's) or `prismatic` (d is the joint's) to write one down.

    Attributes:
        theta: angle about z [rad]; 0 for a revolute joint.
        d: distance along z [m]; 0 for a prismatic joint.
        a: distance along x [m].
        alpha: angle about x [rad].
        moves: "revolute" or "prismatic".
        offset: what is added to the joint coordinate [rad or m].
        flip: whether the joint coordinate counts backwards: theta = offset - q.
        limits: lowest and highest q [rad or m].
        velocity: limit [rad/s or m/s].
        effort: limit [N m or N].
        inertia: of the link, in its Denavit-Hartenberg frame.
        name: of the joint; "joint1", "joint2", ... where left out.
        extra: more arguments for ModelBuilder.add_joint (damping, friction, armature).
    """

    theta: float = 0.0
    d: float = 0.0
    a: float = 0.0
    alpha: float = 0.0
    moves: str = "revolute"
    offset: float = 0.0
    flip: bool = False
    limits: tuple[float, float] | None = None
    velocity: float | None = None
    effort: float | None = None
    inertia: Inertia | None = None
    name: str | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)


def revolute(d: float = 0.0, a: float = 0.0, alpha: float = 0.0, **more: Any) -> DHRow:
    """A row with a revolute joint: theta = q + offset.

    Args:
        d: Distance along the joint's axis [m].
        a: Distance between the axes [m].
        alpha: Angle between the axes [rad].
        **more: Other fields of `DHRow`.

    Returns:
        The row.
    """
    return _row("revolute", "theta", dict(more, d=d, a=a, alpha=alpha))


def prismatic(theta: float = 0.0, a: float = 0.0, alpha: float = 0.0, **more: Any) -> DHRow:
    """A row with a prismatic joint: d = q + offset.

    Args:
        theta: Angle about the joint's axis [rad].
        a: Distance between the axes [m].
        alpha: Angle between the axes [rad].
        **more: Other fields of `DHRow`.

    Returns:
        The row.
    """
    return _row("prismatic", "d", dict(more, theta=theta, a=a, alpha=alpha))


def _row(moves: str, moving: str, fields: dict[str, Any]) -> DHRow:
    if moving in fields:
        raise InputError(
            f"`{moving}` of a {moves} joint is its coordinate; write the constant part as `offset`."
        )
    known = DHRow.__dataclass_fields__
    for name in fields:
        if name not in known:
            raise UnknownName("field of a Denavit-Hartenberg row", name, known)
    return DHRow(moves=moves, **fields)


def model_from_dh(
    rows: Iterable[DHRow] | Sequence[Sequence[float]],
    convention: str = "standard",
    *,
    name: str = "robot",
    base: SE3 | None = None,
    tool: SE3 | None = None,
    configurations: Mapping[str, Any] | None = None,
) -> Model:
    """The serial arm of a Denavit-Hartenberg table.

    The links are "base", "link1", "link2", ...; the frame of link i is frame i of the table. Frame "tool"
    (the default tool) is the last of them, moved by `tool`.

    Args:
        rows: The table; plain rows of numbers are (theta [rad], d [m], a [m], alpha [rad]) of revolute joints, theta
            the offset.
        convention: "standard" (distal) or "modified" (proximal, Craig).
        name: of the robot.
        base: Pose of the first frame in the world [m]; None for the world's origin.
        tool: Pose of the tool in the last frame [m]; None for that frame.
        configurations: Named configurations, each of shape (n,) [rad, m].

    Returns:
        The model.

    Raises:
        InputError: the table is empty or holds something that is not a finite number.
        UnknownName: there is no such convention.
    """
    if convention not in CONVENTIONS:
        raise UnknownName("Denavit-Hartenberg convention", convention, CONVENTIONS)
    table = [_checked(row, i + 1) for i, row in enumerate(rows)]
    if not table:
        raise InputError("The Denavit-Hartenberg table has no rows; expected one for each joint.")
    builder = ModelBuilder(name)
    builder.add_link("base")
    if base is not None:
        builder.root_joint(Fixed(), "base_joint", base)
    parent = "base"
    for i, row in enumerate(table, 1):
        link = f"link{i}"
        head, tail = _split(row, convention)
        limits = {} if row.limits is None else {"lower": row.limits[0], "upper": row.limits[1]}
        limits |= {k: v for k, v in (("velocity", row.velocity), ("effort", row.effort)) if v is not None}
        builder.add_link(link, inertia=row.inertia)
        builder.add_joint(
            row.name or f"joint{i}", _kind(row), parent, link, head, offset=tail, **limits, **row.extra
        )
        parent = link
    builder.add_frame("tool", parent, tool)
    builder.set_tool("tool")
    for key, q in (configurations or {}).items():
        builder.add_configuration(key, q)
    return builder.build()


def _checked(row: DHRow | Sequence[float], index: int) -> DHRow:
    if not isinstance(row, DHRow):
        numbers = _numbers_of(row, index)
        if len(numbers) != 4:
            raise InputError(
                f"Row {index} of the Denavit-Hartenberg table has {len(numbers)} numbers; "
                "expected theta, d, a, alpha, or a row made by dh.revolute(...) or dh.prismatic(...)."
            )
        theta, d, a, alpha = numbers
        row = DHRow(d=d, a=a, alpha=alpha, offset=theta)
    if row.moves not in ("revolute", "prismatic"):
        raise UnknownName("kind of Denavit-Hartenberg joint", row.moves, ("revolute", "prismatic"))
    for symbol in ("theta", "d", "a", "alpha", "offset"):
        value = getattr(row, symbol)
        if not isinstance(value, (int, float, np.number)) or not math.isfinite(value):
            shown = excerpt(repr(value))
            raise InputError(
                f"`{symbol}` of row {index} of the Denavit-Hartenberg table is {shown}; expected a number."
            )
    return row


def _numbers_of(row: Sequence[float], index: int) -> tuple[float, ...]:
    try:
        return tuple(float(x) for x in row)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"Row {index} of the Denavit-Hartenberg table is {excerpt(repr(row))}; expected theta, d, a, alpha."
        ) from None


def _kind(row: DHRow) -> JointKind:
    axis = (0.0, 0.0, -1.0 if row.flip else 1.0)
    return Revolute(axis) if row.moves == "revolute" else Prismatic(axis)


def _split(row: DHRow, convention: str) -> tuple[SE3, SE3]:
    """What comes before the joint's motion, and what comes after it.

    A turn about z and a shift along z commute, so the constant parts of theta and d both go before.
    """
    theta = row.theta + (row.offset if row.moves == "revolute" else 0.0)
    d = row.d + (row.offset if row.moves == "prismatic" else 0.0)
    screw = _turn(SE3.rz, theta) @ SE3.trans(0.0, 0.0, d)
    if convention == "standard":
        return screw, SE3.trans(row.a, 0.0, 0.0) @ _turn(SE3.rx, row.alpha)
    return _turn(SE3.rx, row.alpha) @ SE3.trans(row.a, 0.0, 0.0) @ screw, SE3.identity()


def _turn(about: Any, angle: float) -> SE3:
    pose = about(angle)
    return SE3(snapped(pose.rotation), pose.translation)
