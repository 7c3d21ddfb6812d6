"""The model of Ulna that links and grippers form."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.shapes import geometry
from ulna.errors import ModelError
from ulna.formats.poses import without_rounding
from ulna.model import Fixed, JointKind, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def model_of(
    name: str,
    links: Sequence[Link],
    grippers: Sequence[Gripper],
    gravity: Any,
    base: Any,
    moving: bool,
    disabled: Iterable[tuple[str, str]] = (),
) -> Model:
    """One model of links and grippers, with the same link names.

    Args:
        name: The robot's name.
        links: Those of the arm.
        grippers: What it carries.
        gravity: Acceleration of free fall in the world, (3,) [m/s^2].
        base: Where it stands in the world, (4, 4).
        moving: Whether joints of grippers are joints of the model, after those of the arm; else they are fixed at
            `q`.
        disabled: Pairs of links whose shapes may touch.

    Returns:
        The model.

    Raises:
        ModelError: The joints of one branch are not numbered one after the other.
    """
    builder = ModelBuilder(name or "robot")
    builder.gravity = gravity
    gripper_links = [link for gripper in grippers for link in gripper.links]
    all_links = [*links, *gripper_links]
    roots = [link for link in all_links if link.parent is None]
    builder.add_link("base link of the robot")
    builder.root_joint(Fixed(), "where the robot stands", SE3.from_matrix(base))
    joints, fixed_values = _joints(links, grippers, moving)
    order = sorted(range(len(all_links)), key=lambda i: _first(all_links[i], joints))
    for link in all_links:
        drawn = [geometry(shape, f"{link.name} {k}") for k, shape in enumerate(link._drawn)]
        checked = [geometry(shape, f"{link.name} {k}") for k, shape in enumerate(link._solids)]
        builder.add_link(link.name, link._inertia(), drawn, checked)
    for i in order:
        link = all_links[i]
        parent = "base link of the robot" if link in roots else link.parent.name
        before, after, kind = _split(link, fixed_values.get(link))
        extra = _limits_and_armature(link) if link in joints else {}
        builder.add_joint(f"joint of {link.name}", kind, parent, link.name, before, offset=after, **extra)
    for pair in disabled:
        builder.disable_pair(*pair)
    model = builder.build()
    expected = [f"joint of {link.name}" for link in sorted(joints, key=lambda link: joints[link])]
    actual = [joint.name for joint in model.joints if joint.nq]
    if expected != actual:
        raise ModelError(
            f"The joints of {name!r} are numbered across its branches: {expected}; expected branch by branch: "
            f"{actual}. "
            "Give its links `jindex` in that order."
        )
    return model


def _joints(
    links: Sequence[Link], grippers: Sequence[Gripper], moving: bool
) -> tuple[dict[Link, int], dict[Link, float]]:
    """The numbers of joints, those of grippers last, and the coordinates of joints that are fixed."""
    joints = {link: int(link.jindex or 0) for link in links if link.isjoint}
    fixed_values: dict[Link, float] = {}
    for gripper in grippers:
        first = len(joints)
        for link in gripper.links:
            if link.isjoint and moving:
                joints[link] = first + int(link.jindex or 0)
            elif link.isjoint:
                fixed_values[link] = float(gripper.q[link.jindex])
    return joints, fixed_values


def _limits_and_armature(link: Link) -> dict[str, Any]:
    extra: dict[str, Any] = {"armature": link._drive().at_joint["armature"]}
    if link.qlim is not None:
        extra |= {"lower": float(link.qlim[0]), "upper": float(link.qlim[1])}
    return extra


def _first(link: Link, places: dict[Link, int]) -> float:
    """The least of the places in q of a link and those beyond it: branches come in the order of their joints."""
    position = places.get(link, np.inf)
    return min([position, *(_first(child, places) for child in link.children)])


def _split(link: Link, fixed_value: float | None) -> tuple[SE3, SE3, JointKind]:
    """The pose before the joint, that after it, and the motion."""
    parts = [SE3.identity(), SE3.identity()]
    kind: JointKind = Fixed()
    side = 0
    for et in link.ets.data:
        *shift, plain = et._parts_in_ulna(0 if et.isjoint else None)
        for one in shift:
            parts[side] = without_rounding(parts[side] @ one.transform())
        if et.isjoint and fixed_value is None:
            x, y, z = (-x + 0.0 if et.isflip else x for x in _AXES[et.ax or "z"])
            axis = (x, y, z)
            kind = Revolute(axis) if et.isrotation else Prismatic(axis)
            side = 1
            continue
        T = plain.transform(np.float64(fixed_value)) if et.isjoint else plain.transform()
        parts[side] = without_rounding(parts[side] @ T)
    return parts[0], parts[1], kind
