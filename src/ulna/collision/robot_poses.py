"""Poses of the obstacles of a robot that was added to a world."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ulna import kernels
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import ArrayLike, Floats


def robot_poses(name: str, model: Model, q: ArrayLike, placement: SE3 | None = None) -> Mapping[str, Floats]:
    """The poses of the obstacles of a robot that was added to a world.

    Args:
        name: The name it was added as.
        model: Its model.
        q: Its configurations, shape (..., nq) [rad, m].
        placement: T_world_base, the pose of its base in this world [m]; None for the origin.

    Returns:
        Poses by name of the obstacle, shape (..., 4, 4) [m].
    """
    links = [link for link in model.links if link.collisions]
    fk = kernels.kernel(model, "fk", checked=True, frame=tuple(link.name for link in links))
    poses = fk(np.asarray(q, dtype=float))
    if placement is not None:
        poses = placement.matrix() @ poses
    return {
        f"{name}/{link.name}/{k}": poses[..., i, :, :] @ geometry.placement.matrix()
        for i, link in enumerate(links)
        for k, geometry in enumerate(link.collisions)
    }
