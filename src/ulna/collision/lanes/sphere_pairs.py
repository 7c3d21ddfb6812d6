"""Which spheres of two groups can meet at all, where one or two joints lie between them.

| symbol | meaning | unit |
|---|---|---|
| q_c | the middles of cells that cover the ranges of the joints between the groups | [rad, m] |
| h_k | width of a cell in joint k | [rad, m] |
| mu_k | how far two points of the groups approach at most when joint k moves by one | [m/rad], [1] |

Every configuration of a cell is within h_k / 2 of its middle, so two spheres are nowhere in the cell nearer than there
less sum_k mu_k h_k / 2. Cells in which that leaves doubt are divided (branch and bound, as in Schwarzer, Saha and
Latombe 2005).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna import disk_cache
from ulna.algorithms import joint_poses
from ulna.collision.lanes.motion_bounds import Group
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Array, Floats

RESERVE = 0.012
"""By how much nearer spheres may come, by all margins, than those that are left out [m]."""

_MAX_JOINTS_BETWEEN = 2  # between groups that are looked at
_MAX_CELLS = 6_000
_FIRST = 0.2  # two points approach by no more in a first cell [m]
_MIN_APPROACH = 0.002  # cells in which they approach by no more than this are not divided [m]


_VERSION = "meeting spheres 2"


def meeting_spheres(
    model: Model, groups: Sequence[Group], pairs: Sequence[tuple[int, int]], approach: Floats
) -> list[Array]:
    """Which spheres of pairs of groups can meet, from the disk where that was found out before.

    Args:
        model: The robot.
        groups: Spheres that move together.
        pairs: Numbers of two groups each.
        approach: How far they approach at most when a joint moves by one, shape (pairs, nq) [m/rad], [1].

    Returns:
        For each pair truth values, shape (spheres of the first, spheres of the second), as `can_meet` returns them.
    """
    if not pairs:
        return []
    sizes = [(len(groups[a].radii), len(groups[b].radii)) for a, b in pairs]
    ends = np.cumsum([0, *(m * n for m, n in sizes)]).tolist()
    content = [part for group in groups for part in (group.centres.tobytes(), group.radii.tobytes())]
    name = disk_cache.key(_VERSION, model.fingerprint, repr((RESERVE, pairs)), approach.tobytes(), *content)
    stored = disk_cache.read(name)
    if stored is not None and len(stored) == -(-ends[-1] // 8):
        bits = np.unpackbits(np.frombuffer(stored, np.uint8), count=ends[-1]).astype(bool)
        return [bits[i:j].reshape(size) for i, j, size in zip(ends, ends[1:], sizes, strict=False)]
    masks = [can_meet(model, groups[a], groups[b], row) for (a, b), row in zip(pairs, approach, strict=True)]
    disk_cache.write(name, np.packbits(np.concatenate([mask.ravel() for mask in masks])).tobytes())
    return masks


def can_meet(model: Model, a: Group, b: Group, approach: Floats) -> Array:
    """Which spheres of two groups can come within `RESERVE` of each other.

    Args:
        model: The robot.
        a: Spheres that move together.
        b: Others.
        approach: How far they approach at most when a joint moves by one, shape (nq,) [m/rad], [1].

    Returns:
        Truth values, shape (spheres of a, spheres of b).
    """
    columns = np.flatnonzero(approach)
    low, high = model.lower_position[columns], model.upper_position[columns]
    if len(columns) > _MAX_JOINTS_BETWEEN or not np.isfinite([low, high]).all():
        return np.ones((len(a.radii), len(b.radii)), dtype=bool)
    reach = (a.radii[:, None] + b.radii + RESERVE).ravel()
    counts = np.ceil(approach[columns] * (high - low) / _FIRST).astype(int) + 1
    width = (high - low) / counts
    axes = [lo + (np.arange(n) + 0.5) * w for lo, n, w in zip(low, counts, width, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(columns))
    meets = np.zeros(len(reach), dtype=bool)
    while True:
        q = np.zeros((len(cells), model.nq))
        q[:, columns] = cells
        beyond = _distances(model, q, a, b) - reach
        meets |= (beyond <= 0.0).any(axis=0)
        slack = float(approach[columns] @ width) / 2.0
        in_doubt = (beyond <= slack) & ~meets
        cells = cells[in_doubt.any(axis=1)]
        if not len(cells) or slack < _MIN_APPROACH or len(cells) * 2 ** len(columns) > _MAX_CELLS:
            return (meets | in_doubt.any(axis=0)).reshape(len(a.radii), len(b.radii))
        width = width / 2.0
        for k in range(len(columns)):
            half = np.zeros(len(columns))
            half[k] = width[k] / 2.0
            cells = np.concatenate([cells - half, cells + half])


def _distances(model: Model, q: Floats, a: Group, b: Group) -> Floats:
    """Distances of the centres, shape (configurations, pairs of spheres) [m]."""
    poses = joint_poses(model, q)
    first, second = (_placed(poses[group.joint], group) for group in (a, b))
    return np.linalg.norm(first[:, :, None] - second[:, None], axis=-1).reshape(len(q), -1)


def _placed(T: SE3, group: Group) -> Floats:
    """Centres in the world, shape (configurations, spheres, 3) [m]."""
    return group.centres @ np.swapaxes(T.rotation, -1, -2) + T.translation[..., None, :]
