"""Robots with any number of joints, and configurations of any robot."""

from __future__ import annotations

import numpy as np

from ulna.model import Circle, Model, ModelBuilder, PlanarCircle, Prismatic, Revolute
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

BODY = Inertia.from_com(1.0, (0.05, -0.02, 0.08), np.diag([0.1, 0.2, 0.15]))
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def long_robot(n: int, branching: float = 0.0, seed: int = 0, coupled: int = 0) -> Model:
    """A chain of n joints; where `branching` is above 0, a tree whose joints leave the newest one that often.

    Args:
        n: How many joints.
        branching: Probability that a joint stands a few joints before the newest one.
        seed: The seed of the branches.
        coupled: Every so many joints, one mimics the joint before; 0 for none.
    """
    rng = np.random.default_rng(seed)
    builder = ModelBuilder(f"robot{n}").add_link("l0")
    for k in range(1, n + 1):
        back = int(rng.integers(1, 9)) if rng.random() < branching else 0
        kind = Prismatic(AXES[k % 3]) if k % 7 == 3 else Revolute(AXES[k % 3])
        place = SE3.trans(0.03, 0.02, 0.01) @ SE3.rx(0.3 + 0.01 * (k % 50))
        builder.add_link(f"l{k}", BODY)
        mimic = (f"j{k - 1}", -0.7, 0.1) if coupled and k % coupled == 0 else None
        builder.add_joint(
            f"j{k}", kind, f"l{max(k - 1 - back, 0)}", f"l{k}", place, armature=0.01 * (k % 3), mimic=mimic
        )
    return builder.set_tool(f"l{n}").build()


def circles() -> Model:
    """Joints whose angles are written as cosine and sine."""
    builder = ModelBuilder("circles").add_link("l0")
    kinds = (Circle((0.0, 0.6, 0.8)), PlanarCircle((0.6, 0.0, 0.8)), Circle(), Revolute((1.0, 0.0, 0.0)))
    for k, kind in enumerate(kinds, start=1):
        builder.add_link(f"l{k}", BODY)
        builder.add_joint(f"j{k}", kind, f"l{max(k - 2, 0)}", f"l{k}", SE3.trans(0.1, 0.2, 0.3) @ SE3.ry(0.4))
    builder.add_frame("tip", "l4", SE3.trans(0.1, 0.0, 0.2)).add_frame("side", "l2", SE3.rx(0.3))
    return builder.set_tool("tip").build()


def configurations(model: Model, rng: np.random.Generator, count: int) -> Floats:
    """Configurations drawn by the kinds of joints, (count, nq).

    Args:
        model: The robot.
        rng: The source of random numbers.
        count: How many.
    """
    parts = [joint.kind.random(rng, size=(count,)) for joint in model.joints if joint.mimic is None]
    return np.concatenate(parts, axis=-1)
