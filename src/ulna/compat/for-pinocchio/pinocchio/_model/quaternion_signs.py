"""Integration of free flyers, whose quaternion is the one of two that is nearer to that of the start."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from ulna.model import Composite, FreeFlyer, JointKind
from ulna.numeric import less, where
from ulna.typing import Array

_POSITION = 3  # numbers of a free flyer before its quaternion


def quaternion_starts(kinds: Iterable[tuple[int, JointKind]]) -> tuple[int, ...]:
    """Where the quaternions of free flyers begin.

    Args:
        kinds: Kinds of joints, each with the index at which its entries begin.

    Returns:
        The indices.
    """
    starts: list[int] = []
    for start, kind in kinds:
        place = start
        for part in kind.kinds if isinstance(kind, Composite) else (kind,):
            if isinstance(part, FreeFlyer):
                starts.append(place + _POSITION)
            place += part.nq
    return tuple(starts)


def with_continuous_signs(
    integrate: Callable[[Array, Array], Array], starts: tuple[int, ...]
) -> Callable[[Array, Array], Array]:
    """An integration that turns the sign of quaternions which would point away from those it starts from.

    Args:
        integrate: The integration, of q (nq,) and v (nv,).
        starts: Where these quaternions begin.

    Returns:
        The new integration, of the same arrays; its result is q (nq,).
    """

    def run(q: Array, v: Array) -> Array:
        reached = integrate(q, v)
        factor = [1.0] * reached.shape[-1]
        for start in starts:
            cosine = sum(q[..., i] * reached[..., i] for i in range(start, start + 4))
            factor[start : start + 4] = [where(less(cosine, 0.0), -1.0, 1.0)] * 4
        return np.stack([factor[i] * reached[..., i] for i in range(len(factor))], axis=-1)

    return run
