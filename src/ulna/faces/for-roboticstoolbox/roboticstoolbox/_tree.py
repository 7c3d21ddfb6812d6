"""The tree of a robot's links: numbering, paths from link to link, and the model Ulna makes of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from roboticstoolbox._gripper import Gripper
from roboticstoolbox._link import Link
from roboticstoolbox._shapes import geometry
from ulna.errors import ModelError, UnknownName
from ulna.formats.poses import tidy
from ulna.model import Fixed, JointKind, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def connect(links: Sequence[Link], robot: Any) -> None:
    """Names, numbers and joins links, and tells them whose they are.

    Raises:
        ModelError: Two links share a name.
        UnknownName: A parent does not exist.
    """
    for i, link in enumerate(links):
        link.name = link.name or f"link{i}"
        link.robot = robot
        link.children = []
    by_name = {link.name: link for link in links}
    if len(by_name) != len(links):
        twice = next(a.name for a in links if sum(a.name == b.name for b in links) > 1)
        raise ModelError(f"Two links are named {twice!r}; give each its own `name`.")
    for link in links:
        if link._parent is None and link._parent_name:
            if link._parent_name not in by_name:
                raise UnknownName("link", link._parent_name, by_name, f"It is the parent of {link.name!r}.")
            link._parent = by_name[link._parent_name]
        if link._parent is not None:
            link._parent.children.append(link)


def number(links: Sequence[Link]) -> None:
    """Gives joints their places in q, in the order of the links, unless they have them: 0 to n - 1, each once."""
    joints = [link for link in links if link.isjoint]
    if sorted(link.jindex or 0 for link in joints) != list(range(len(joints))):
        for i, link in enumerate(joints):
            link.jindex = i


def up(link: Link) -> list[Link]:
    """The links from the root to `link`."""
    out: list[Link] = []
    at: Link | None = link
    while at is not None:
        out.insert(0, at)
        at = at.parent
    return out


def between(start: Link | None, end: Link) -> tuple[list[Link], list[Link]]:
    """Links to go up and then down, from `start` (the base for None) to the frame of `end`.

    As in the toolbox the way down from a link begins before its own transforms, the way up from it beyond them.
    """
    down = up(end)
    if start is None:
        return [], down
    rise = up(start)
    shared = 0
    while shared < min(len(rise), len(down)) and rise[shared] is down[shared]:
        shared += 1
    if shared == len(rise):
        return [], down[shared - 1 :]
    return rise[shared:][::-1], down[shared:]


def model_of(
    name: str,
    links: Sequence[Link],
    grippers: Sequence[Gripper],
    gravity: Any,
    base: Any,
    moving: bool,
    disabled: Iterable[tuple[str, str]] = (),
) -> Model:
    """Links and grippers as one model, whose links bear their names.

    Args:
        name: The robot's name.
        links: Those of the arm.
        grippers: What it carries.
        gravity: Acceleration of free fall in the world, (3,) [m/s^2].
        base: Where it stands in the world, (4, 4).
        moving: Whether joints of grippers move, after those of the arm; else they stand at the grippers' `q`.
        disabled: Pairs of links whose shapes may touch.

    Raises:
        ModelError: The joints of one branch are not numbered one after the other.
    """
    builder = ModelBuilder(name or "robot")
    builder.gravity = gravity
    hands = [link for gripper in grippers for link in gripper.links]
    whole = [*links, *hands]
    roots = [link for link in whole if link.parent is None]
    builder.add_link("base link of the robot")
    builder.root_joint(Fixed(), "where the robot stands", SE3.from_matrix(base))
    joints = {link: int(link.jindex or 0) for link in links if link.isjoint}
    stay: dict[Link, float] = {}
    for gripper in grippers:
        first = len(joints)
        for link in gripper.links:
            if link.isjoint and moving:
                joints[link] = first + int(link.jindex or 0)
            elif link.isjoint:
                stay[link] = float(gripper.q[link.jindex])
    order = sorted(range(len(whole)), key=lambda i: _first(whole[i], joints))
    for link in whole:
        drawn = [geometry(shape, f"{link.name} {k}") for k, shape in enumerate(link._drawn)]
        checked = [geometry(shape, f"{link.name} {k}") for k, shape in enumerate(link._solids)]
        builder.add_link(link.name, link._inertia(), drawn, checked)
    for i in order:
        link = whole[i]
        parent = "base link of the robot" if link in roots else link.parent.name
        before, after, kind = _split(link, stay.get(link))
        extra: dict[str, Any] = {}
        if link in joints:
            drive = link._drive().at_joint
            extra = {"armature": drive["armature"]}
            if link.qlim is not None:
                extra |= {"lower": float(link.qlim[0]), "upper": float(link.qlim[1])}
        builder.add_joint(f"joint of {link.name}", kind, parent, link.name, before, offset=after, **extra)
    for pair in disabled:
        builder.disable_pair(*pair)
    model = builder.build()
    wanted = [f"joint of {link.name}" for link in sorted(joints, key=lambda link: joints[link])]
    given = [joint.name for joint in model.joints if joint.nq]
    if wanted != given:
        raise ModelError(
            f"The joints of {name!r} are numbered across its branches: {wanted}; expected branch by branch: {given}. "
            "Give its links `jindex` in that order."
        )
    return model


def _first(link: Link, places: dict[Link, int]) -> float:
    """The least of the places in q of a link and those beyond it: branches come in the order of their joints."""
    own = places.get(link, np.inf)
    return min([own, *(_first(child, places) for child in link.children)])


def _split(link: Link, held: float | None) -> tuple[SE3, SE3, JointKind]:
    """The pose before the joint, that after it, and the motion."""
    parts = [SE3.identity(), SE3.identity()]
    kind: JointKind = Fixed()
    side = 0
    for et in link.ets.data:
        if et.isjoint and held is None:
            x, y, z = (-x + 0.0 if et.isflip else x for x in _AXES[et.ax])
            axis = (x, y, z)
            kind = Revolute(axis) if et.isrotation else Prismatic(axis)
            side = 1
            continue
        plain = et._plain(0)
        T = plain.transform(np.float64(held)) if et.isjoint else plain.transform()
        parts[side] = tidy(parts[side] @ T)
    return parts[0], parts[1], kind
