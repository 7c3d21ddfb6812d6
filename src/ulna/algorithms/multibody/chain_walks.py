"""Walks along the segments of a serial chain: poses, twists and accelerations in one frame.

The frames are those of chain_frames.py, and the walks those of `ulna.compiler.forms.scans`. Sums along a segment have
`_local` in their names, those before it `_before`.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| T | pose of a joint's moving frame | SE3 | [m] | |
| s | motion of a joint about its axis z through p | Motion | | (p x z, z) |
| V | twist of a body | Motion | [m/s, rad/s] | sum of s v over the joints before and its own |
| psi | motion that s causes outward | Motion | | V x s |
| A | acceleration of a body, gravity g taken off | Motion | | -g + sum of s a + psi v over the same joints |

Source: Featherstone 2008, section 5.3, where motions are written in one frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ulna.algorithms.multibody.chain_frames import (
    IDENTITY,
    ChainFrames,
    following,
    joined,
    pose_numbers,
    pose_of,
    turned,
)
from ulna.compiler.forms.scans import Monoid, Walk, sums
from ulna.numeric import cross
from ulna.spatial import SE3, Motion
from ulna.typing import Array, Floats


def walk_of_poses(
    chain: ChainFrames,
    kept: Callable[[SE3], Array],
    start: Sequence[float] = (),
    end: Callable[[Array], Array] | None = None,
    whole: str = "",
) -> Walk:
    """The walk along segments that computes poses of moving frames, `local`, in those with which segments begin.

    It reads `numbers` and `q`; where segments begin is then called `segment`.

    Args:
        chain: The chain.
        kept: From a pose to what is kept of it.
        start: The pose of the first moving frame at position -phi, as `IDENTITY`; empty for that of the chain.
        end: From the pose of the last moving frame, as `IDENTITY`, to `whole`; None for nothing.
        whole: What that is called.

    Returns:
        The walk.
    """

    def step(state: Array, numbers: Array, q: Array) -> tuple[Array, Array]:
        pose = turned(state, numbers, q)
        return following(pose, numbers), kept(pose)

    states = Monoid(joined, IDENTITY, start or chain.start)
    return Walk(step, ("numbers", "q"), ("local",), states, "segment", end, whole)


def walk_of_twists() -> Walk:
    """The walk that computes T, s and `V_local`; it reads `numbers`, `v`, and what `walk_of_poses` has made.

    Returns:
        The walk.
    """

    def step(state: Array, segment: Array, local: Array, numbers: Array, v: Array) -> tuple[Array, ...]:
        T = placed(segment, local)
        s = screw(T)
        after = state + s * (v[0] * numbers[0])  # the factor is zero in padding
        return after, pose_numbers(T), s, after

    return Walk(step, ("segment", "local", "numbers", "v"), ("T", "s", "V_local"), sums(6), "V_before")


def walk_of_accelerations(gravity: Floats, a: str = "", with_psi: bool = False) -> Walk:
    """The walk that computes V of the whole chain and `A_local`; it reads what `walk_of_twists` reads and has made.

    Args:
        gravity: g, shape (3,) [m/s^2].
        a: The name of the joint accelerations; empty for zero.
        with_psi: Whether it computes psi, too.

    Returns:
        The walk.
    """

    def step(
        state: Array,
        V_before: Array,
        V_local: Array,
        s: Array,
        numbers: Array,
        v: Array,
        a: Array | None = None,
    ) -> tuple[Array, ...]:
        V = V_before + V_local
        psi = motion(V).cross(motion(s)).vector()
        after = state + psi * (v[0] * numbers[0])
        after = after if a is None else after + s * (a[0] * numbers[0])
        return (after, V, after, psi) if with_psi else (after, V, after)

    reads = ("V_before", "V_local", "s", "numbers", "v", *([a] if a else ()))
    writes = ("V", "A_local", "psi") if with_psi else ("V", "A_local")
    at_rest = (*(-np.asarray(gravity)).tolist(), 0.0, 0.0, 0.0)
    return Walk(step, reads, writes, sums(6, at_rest), "A_before")


def placed(segment: Array, local: Array) -> SE3:
    """T.

    Args:
        segment: The pose with which the segment begins, (12,).
        local: The pose in it, (12,).

    Returns:
        The product.
    """
    return pose_of(joined(segment, local))


def screw(T: SE3) -> Array:
    """s of a joint about the z axis of its moving frame.

    Args:
        T: The pose of the moving frame.

    Returns:
        Shape (6,), linear part first.
    """
    z = T.rotation[:, 2]
    return np.concatenate([cross(T.translation, z), z])


def motion(numbers: Array) -> Motion:
    """The motion of six numbers, linear part first."""
    return Motion(numbers[:3], numbers[3:])
