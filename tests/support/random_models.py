"""Random robots with every kind of joint, branches, fixed and mimic joints; the same for the same seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ulna.model import (
    Composite,
    Continuous,
    Cylindrical,
    Fixed,
    FreeFlyer,
    Helical,
    JointKind,
    Model,
    ModelBuilder,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
    Universal,
)
from ulna.spatial import SE3, SO3, Inertia

Rng = np.random.Generator


def random_axis(rng: Rng) -> tuple[float, float, float]:
    """A coordinate axis, its opposite, or any direction."""
    axis = rng.standard_normal(3)
    if rng.random() < 0.5:
        axis = np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    x, y, z = (float(c) for c in axis / np.linalg.norm(axis))
    return x, y, z


def _two_axes(rng: Rng) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    while True:
        first, second = random_axis(rng), random_axis(rng)
        if np.linalg.norm(np.cross(first, second)) > 0.1:
            return first, second


KINDS: dict[str, Callable[[Rng], JointKind]] = {
    "revolute": lambda rng: Revolute(random_axis(rng)),
    "continuous": lambda rng: Continuous(random_axis(rng)),
    "prismatic": lambda rng: Prismatic(random_axis(rng)),
    "helical": lambda rng: Helical(random_axis(rng), float(rng.uniform(-0.3, 0.3))),
    "universal": lambda rng: Universal(*_two_axes(rng)),
    "translation": lambda rng: Translation(),
    "planar": lambda rng: Planar(random_axis(rng)),
    "spherical": lambda rng: Spherical(),
    "free_flyer": lambda rng: FreeFlyer(),
    "composite": lambda rng: Composite(
        (Revolute(random_axis(rng)), Prismatic(random_axis(rng)), Universal(*_two_axes(rng))),
        tuple(random_pose(rng) for _ in range(3)),
    ),
    "composite_ball": lambda rng: Composite(
        (Spherical(), Helical(random_axis(rng), 0.2)), (random_pose(rng), random_pose(rng))
    ),
    "cylindrical": lambda rng: Cylindrical(random_axis(rng)),
}
"""For each kind a maker with random constants. New ones come last, so that the models of the seeds in use keep their order."""

SCALAR_KINDS = ("revolute", "continuous", "prismatic", "helical")
"""The kinds with one coordinate, which can mimic one another."""


def random_pose(rng: Rng, reach: float = 0.5) -> SE3:
    """A pose turned any way, or, as in most robots, by quarter turns only."""
    if rng.random() < 0.5:
        return SE3.random(rng, reach=reach)
    quarter = SE3.rx(0.5 * np.pi * rng.integers(4)) @ SE3.rz(0.5 * np.pi * rng.integers(4))
    return SE3(np.round(quarter.rotation), rng.uniform(-reach, reach, 3))


def random_inertia(rng: Rng) -> Inertia:
    """The inertia of a random box, turned, beside the origin: physically possible by construction."""
    mass, (x, y, z) = rng.uniform(0.2, 3.0), rng.uniform(0.05, 0.5, 3) ** 2
    R = SO3.random(rng).matrix
    box = R @ np.diag([y + z, x + z, x + y]) @ R.T * (mass / 12.0)
    return Inertia(mass, rng.uniform(-0.2, 0.2, 3), 0.5 * (box + box.T))


def random_model(
    rng: Rng,
    kinds: Sequence[str] | None = None,
    joints: int | None = None,
    *,
    root: str | None = None,
    mimics: int = 1,
    branching: float = 0.4,
) -> Model:
    """A random tree.

    Args:
        rng: Where randomness comes from.
        kinds: Names out of `KINDS`; in this order when `joints` is None, else drawn from.
        joints: How many movable joints; None for one of each of `kinds`.
        root: The kind of the joint between world and root link; None holds it still.
        mimics: How many mimic joints to add, where there is a joint to follow.
        branching: Probability that a joint stands on any link, instead of the newest.

    Returns:
        A model with frames "tip" (on the last link) and "side" (on a middle link).
    """
    names = list(KINDS) if kinds is None else list(kinds)
    chosen = names if joints is None else [names[rng.integers(len(names))] for _ in range(joints)]
    builder = ModelBuilder("random")
    builder.add_link("link0", random_inertia(rng))
    if root is not None:
        builder.root_joint(KINDS[root](rng))
    links = ["link0"]
    scalars: list[str] = []

    def attach(name: str, kind: JointKind, mimic: tuple[str, float, float] | None = None) -> None:
        parent = links[rng.integers(len(links))] if rng.random() < branching else links[-1]
        child = f"link{len(links)}"
        one = kind.nq == kind.nv == 1
        builder.add_link(child, random_inertia(rng))
        builder.add_joint(
            name,
            kind,
            parent,
            child,
            random_pose(rng),
            lower=-2.0 if one else None,
            upper=2.5 if one else None,
            velocity=3.0 if one else None,
            effort=50.0 if one else None,
            damping=float(rng.uniform(0.0, 0.5)) if kind.nv else 0.0,
            friction=float(rng.uniform(0.0, 0.5)) if kind.nv else 0.0,
            armature=float(rng.uniform(0.0, 0.2)) if kind.nv else 0.0,
            mimic=mimic,
        )
        links.append(child)

    for i, name in enumerate(chosen):
        attach(f"joint{i}", KINDS[name](rng))
        if name in SCALAR_KINDS:
            scalars.append(f"joint{i}")
        if rng.random() < 0.2:
            attach(f"fixed{i}", Fixed())
    for i in range(mimics if scalars else 0):
        source = scalars[rng.integers(len(scalars))]
        kind = KINDS[SCALAR_KINDS[rng.integers(len(SCALAR_KINDS))]](rng)
        attach(f"mimic{i}", kind, (source, float(rng.uniform(-1.5, 1.5)), float(rng.uniform(-0.5, 0.5))))
    builder.add_frame("tip", links[-1], random_pose(rng))
    builder.add_frame("side", links[len(links) // 2], random_pose(rng))
    builder.set_tool("tip")
    return builder.build()


def several_roots(
    rng: Rng, roots: Sequence[str] = ("revolute", "free_flyer", "spherical", "planar"), joints: int = 6
) -> Model:
    """Several trees on one base, as in a scene with a robot and objects that float.

    Args:
        rng: Where randomness comes from.
        roots: The kind of the first joint of each tree.
        joints: How many further joints, with one velocity each, every tree has.
    """
    builder = ModelBuilder("scene")
    builder.add_link("base", random_inertia(rng))
    kinds = [name for name in SCALAR_KINDS if name in KINDS]
    for i, root in enumerate(roots):
        parent = "base"
        for k, name in enumerate([root, *(kinds[rng.integers(len(kinds))] for _ in range(joints))]):
            child = f"link{i}_{k}"
            builder.add_link(child, random_inertia(rng))
            builder.add_joint(f"joint{i}_{k}", KINDS[name](rng), parent, child, random_pose(rng))
            parent = child if rng.random() < 0.7 else f"link{i}_0"
    return builder.build()
