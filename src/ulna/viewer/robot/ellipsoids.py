"""Inertia ellipsoids of links, and manipulability ellipsoids of frames.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| I | moments about the principal axes through the centre of mass | (3,), kg m^2 | |
| a | half axes of an ellipsoid of even density: I_i = m (a_j^2 + a_k^2) / 5, solved for a | (3,), m | |
| J | linear part of the Jacobian | (3, nv) | |
| s, U | J = U s V^T: half axes and directions for velocities; 1/s for forces | (3,), (3, 3) | Siciliano 2009, 3.9 |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.values import one_of
from ulna.typing import Floats

KINDS = ("velocity", "force")
_MAX_RATIO = (
    10.0  # a direction that cannot move can push without bounds; drawn this much longer than the shortest
)


def inertia_ellipsoids(links: Sequence[Any]) -> list[tuple[int, Floats, Floats]]:
    """For each link with an inertia that a body can have: its number, T_link_ellipsoid (4, 4), half axes (3,) [m]."""
    out = []
    for number, link in enumerate(links):
        mass = float(link.inertia.mass)
        if mass <= 0.0:
            continue
        moments, axes = np.linalg.eigh(np.asarray(link.inertia.inertia, dtype=float))
        squares = 2.5 * (moments.sum() - 2.0 * moments) / mass
        if (squares <= 0.0).any():
            continue
        if np.linalg.det(axes) < 0.0:
            axes[:, 0] = -axes[:, 0]
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = axes, np.asarray(link.inertia.com, dtype=float)
        out.append((number, pose, np.sqrt(squares)))
    return out


def check_kind(kind: str) -> None:
    """Refuse what is no kind of ellipsoid.

    Raises:
        UnknownName: It is none.
    """
    one_of("ellipsoid", kind, KINDS)


def manipulability_ellipsoid(J: Floats, kind: str = "velocity") -> tuple[Floats, Floats]:
    """The ellipsoid of a Jacobian's linear part.

    Args:
        J: Linear part of the Jacobian, (3, nv).
        kind: "velocity", or "force" for its inverse.

    Returns:
        Axes as a pose (4, 4) at the origin, and half axes (3,).
    """
    values, axes = np.linalg.eigh(J @ J.T)
    radii = np.sqrt(np.maximum(values, 0.0))
    if kind == "force":
        least = 1.0 / max(float(radii.max()), 1e-9)
        radii = np.minimum(1.0 / np.maximum(radii, 1e-9), _MAX_RATIO * least)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    pose = np.eye(4)
    pose[:3, :3] = axes
    return pose, np.maximum(radii, 1e-4)
