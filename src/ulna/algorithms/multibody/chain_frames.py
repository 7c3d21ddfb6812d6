"""Moving frames of serial chains of revolute joints by Denavit & Hartenberg, and poses as products in segments.

| symbol | meaning | shape | unit |
|---|---|---|---|
| z | axis of a joint, and of its moving frame | (3) | [1] |
| x | common normal of a joint's axis and the next one's | (3) | [1] |
| phi | what is added to the angle, so that the moving frame has the common normal as its x axis | | [rad] |
| a, d, alpha | length of the common normal, its place along z, and the angle between the axes | | [m], [m], [rad] |
| psi, l | turn about the next axis and slide along it that are left, which the next joint takes | | [rad], [m] |
| P | pose of the next moving frame at position zero: Rz(phi) Tz(d) Tx(a) Rx(alpha) Tz(-l) Rz(psi) | SE3 | [m] |

The pose of a frame is T_1 Rz(q_1 + phi_1) Tz(d_1) Tx(a_1) Rx(alpha_1) Rz(q_2 + phi_2) ..., the same operations for each
joint: the product of a segment of the chain is computed in each SIMD lane (`ulna.compiler.forms.scans`).

Where axes are nearly parallel, common normals are far away and badly conditioned: there are no such frames then.

Source: Siciliano et al. 2009, section 2.8.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ulna.algorithms.multibody.link_frames import LinkFrames
from ulna.algorithms.multibody.tree import Step, steps
from ulna.data_classes import dataclass
from ulna.model import Model, Revolute
from ulna.numeric import cos, is_symbolic, sin
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_PARALLEL, _NEARLY = 1e-12, 0.02
"""Sines of the angles between axes: below the first they are parallel, and between the two nearly so."""

PADDING = (0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
"""Numbers of a joint that does not move and is where the one before is."""
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
"""The pose that changes nothing: rotation row by row, then translation."""


@dataclass(frozen=True, eq=False)
class ChainFrames:
    """A serial chain between the frames of Denavit & Hartenberg.

    Attributes:
        links: Its steps, and the new frames in those of the model.
        numbers: For each joint factor of its position, phi, d, a, cos(alpha) and sin(alpha), shape (6, n); those of the
            last one, after which no axis comes, do nothing but turn.
        first_q: The place of the first joint's position.
    """

    links: LinkFrames
    numbers: Floats
    first_q: int

    @property
    def start(self) -> tuple[float, ...]:
        """The pose of the first moving frame at position -phi."""
        P = self.links.tree[0].placement
        return (*np.reshape(P.rotation, -1).tolist(), *np.asarray(P.translation).tolist())


def chain_frames(model: Model, joints: Sequence[int] | None = None) -> ChainFrames | None:
    """The frames of a serial chain.

    Args:
        model: The robot.
        joints: The joints of the chain, root first; None for all.

    Returns:
        The frames; None where the joints are no chain, others than revolute ones whose positions follow each other, or
        where axes are nearly parallel.
    """
    old = steps(model, joints)
    if not old or not all(_is_plain(step, k, old[0]) for k, step in enumerate(old)):
        return None
    numbers = np.tile([[1.0], [0.0], [0.0], [0.0], [1.0], [0.0]], len(old))
    tree: list[Step] = []
    frames: list[SE3] = []
    rest, placement = SE3.identity(), old[0].placement @ _to_axis(old[0])
    for k, step in enumerate(old):
        turned = _to_axis(step)
        normal = None
        if k + 1 < len(old):
            outer = turned.inverse() @ old[k + 1].placement @ _to_axis(old[k + 1])
            normal = _normal(rest @ outer)
            if normal is None:
                return None
            numbers[1:, k] = normal.phi, normal.d, normal.a, math.cos(normal.alpha), math.sin(normal.alpha)
        phi = float(numbers[1, k])
        tree.append(replace(step, placement=placement, kind=Revolute((0.0, 0.0, 1.0)), offset=phi))
        frames.append(turned @ rest.inverse() @ SE3(_turn(phi, 2), np.zeros(3)))
        if normal is not None:
            rest, placement = normal.rest, normal.placement
    return ChainFrames(LinkFrames(tuple(tree), tuple(frames)), numbers, old[0].joint.idx_q)


def _is_plain(step: Step, k: int, root: Step) -> bool:
    """Whether a step is a revolute joint with a position of its own, the k-th of a chain."""
    joint = step.joint
    if not isinstance(step.kind, Revolute) or joint.mimic is not None or step.ratio != 1.0:
        return False
    if is_symbolic(step.placement.rotation, step.placement.translation):
        return False
    follows = joint.idx_q == root.joint.idx_q + k and joint.idx_v == root.joint.idx_v + k
    return follows and step.parent == k - 1 and joint.kind is step.kind


class _Normal(NamedTuple):
    """What lies between two axes; see the table above."""

    phi: float
    d: float
    a: float
    alpha: float
    rest: SE3

    @property
    def placement(self) -> SE3:
        """The pose of the next moving frame in this one, where the next angle is zero."""
        return SE3(_turn(self.alpha, 0), np.array([self.a, 0.0, self.d]))


def _normal(outer: SE3) -> _Normal | None:
    """The common normal of the z axes of a frame and of another one in it; None where they are nearly parallel."""
    R, t = np.asarray(outer.rotation, dtype=float), np.asarray(outer.translation, dtype=float)
    sine = math.hypot(R[0, 2], R[1, 2])
    if _PARALLEL < sine < _NEARLY:
        return None
    is_parallel = sine <= _PARALLEL
    phi = math.atan2(t[1], t[0]) if is_parallel else math.atan2(R[0, 2], -R[1, 2])
    alpha = math.atan2(0.0 if is_parallel else sine, R[2, 2])
    back = _turn(-phi, 2)
    x, y, z = back @ t
    along = 0.0 if is_parallel else y / sine
    left = _turn(-alpha, 0) @ back @ R
    rest = SE3(_turn(math.atan2(left[1, 0], left[0, 0]), 2), np.array([0.0, 0.0, -along]))
    return _Normal(phi, z + along * R[2, 2], x, alpha, rest)


def _turn(angle: float, axis: int) -> Floats:
    """The rotation about a coordinate axis."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[a, a] = R[b, b] = math.cos(angle)
    R[b, a] = math.sin(angle)
    R[a, b] = -R[b, a]
    return R


def _to_axis(step: Step) -> SE3:
    """A rotation that takes the z axis to the axis of a joint."""
    assert isinstance(step.kind, Revolute)
    u = np.asarray(step.kind.axis)
    x = np.eye(3)[(int(np.abs(u).argmax()) + 1) % 3]
    x = x - u * (u @ x)
    x = x / np.linalg.norm(x)
    return SE3(np.stack([x, np.cross(u, x), u], axis=-1), np.zeros(3))


def joined(before: Array, after: Array) -> Array:
    """The product of two poses.

    Args:
        before: A pose as `IDENTITY` has it, (12,).
        after: Another one, (12,).

    Returns:
        The product, (12,).
    """
    return pose_numbers(pose_of(before) @ pose_of(after))


def pose_numbers(pose: SE3) -> Array:
    """The numbers of a pose.

    Args:
        pose: The pose.

    Returns:
        Its rotation, row by row, then its translation, (12,).
    """
    return np.concatenate([pose.rotation.reshape(-1), pose.translation])


def turned(state: Array, numbers: Array, q: Array) -> SE3:
    """The pose of a moving frame at a joint's position.

    Args:
        state: The pose of the moving frame where its angle is zero, (12,).
        numbers: Those of the joint, (6,); see `ChainFrames`.
        q: The position, (1,) [rad].

    Returns:
        The pose.
    """
    pose, angle = pose_of(state), q[0] * numbers[0] + numbers[1]
    c, s = cos(angle), sin(angle)
    x, y, z = pose.rotation.T
    return SE3(np.stack([x * c + y * s, y * c - x * s, z], axis=-1), pose.translation)


def following(pose: SE3, numbers: Array) -> Array:
    """The pose of the next moving frame where its angle is zero.

    Args:
        pose: That of the moving frame.
        numbers: Those of the joint, (6,); see `ChainFrames`.

    Returns:
        The pose, (12,).
    """
    _, _, d, a, c, s = numbers
    x, y, z = pose.rotation.T
    R = np.stack([x, y * c + z * s, z * c - y * s], axis=-1)
    return np.concatenate([R.reshape(-1), pose.translation + z * d + x * a])


def pose_of(numbers: Array) -> SE3:
    """The pose of its numbers.

    Args:
        numbers: Its rotation, row by row, then its translation, (12,).

    Returns:
        The pose.
    """
    return SE3(numbers[:9].reshape(3, 3), numbers[9:])
