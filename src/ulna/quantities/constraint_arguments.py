"""Arguments of constrained dynamics: solvers, gains of stabilisation, and the anchors of contacts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.algorithms import Proximal
from ulna.checks.arrays import batched_array
from ulna.checks.rotations import checked_rotation
from ulna.checks.values import short_repr
from ulna.errors import InputError, ShapeError
from ulna.model import Constraint
from ulna.numeric import is_symbolic
from ulna.spatial import SE3
from ulna.typing import Array, ArrayLike

_IDENTITY = np.eye(4)


def checked_solver(value: Any) -> Proximal:
    """The solver, if it is one."""
    if not isinstance(value, Proximal):
        raise InputError(
            f"`solver` is {value!r}; expected an ulna.algorithms.Proximal, such as Proximal(mu=0.0)."
        )
    return value


def stabilisation_arrays(constraints: Sequence[Constraint], anchors: Any, kp: Any, kd: Any) -> list[Array]:
    """Further arguments of the kernel, for Baumgarte stabilisation: anchors, and gains of errors and velocities.

    Args:
        constraints: The constraints.
        anchors: Where the contacts hold; None where there are none.
        kp: Gains [1/s^2], one number or (..., count); None for 0.
        kd: Gains [1/s]; None for critical damping.

    Returns:
        Anchors (..., contacts, 4, 4), if there are contacts, and kp and kd of each constraint, (..., count, 2).

    Raises:
        InputError: If gains are negative, `kd` is left out beside a traced `kp`, or `kp` has contacts without anchors.
    """
    count = len(constraints)
    position_gains = _gains("kp", 0.0 if kp is None else kp, count)
    if kd is None and is_symbolic(position_gains):
        raise InputError("`kd` is not given; expected it where `kp` is an input of your own function.")
    velocity_gains = 2.0 * np.sqrt(position_gains) if kd is None else _gains("kd", kd, count)
    gains = _stacked("kd", [position_gains, velocity_gains], -1)
    contacts = [constraint for constraint in constraints if constraint.is_contact]
    if not contacts:
        return [gains]
    if anchors is None and kp is not None:
        raise InputError(
            "`kp` pulls contacts to their anchors, and there are none; give "
            "anchors=robot.constraints.anchors(q0, constraints) of the configuration where they took hold."
        )
    return [anchor_poses(anchors, contacts), gains]


def _gains(name: str, value: ArrayLike, count: int) -> Array:
    gains = one_each(name, value, count)
    if not is_symbolic(gains) and not (gains >= 0.0).all():
        raise InputError(f"`{name}` is {value}; expected gains that are not below zero.")
    return gains


def one_each(name: str, numbers: ArrayLike, count: int) -> Array:
    """One number for all constraints, or one for each.

    Args:
        name: The argument, for messages.
        numbers: A number or (..., count).
        count: How many constraints there are.

    Returns:
        One for each, (..., count).

    Raises:
        ShapeError: If there are not as many as constraints.
    """
    value = batched_array(name, numbers, ())
    if value.ndim == 0:
        return np.broadcast_to(value, (count,))
    if value.shape[-1] != count:
        raise ShapeError(name, value.shape, f"one number, or one for each of {count} constraints")
    return value


def anchor_poses(anchors: Any, contacts: Sequence[Constraint]) -> Array:
    """Anchors as poses; of none as many identities.

    Args:
        anchors: One for each contact: poses, or points of point contacts; None for none.
        contacts: The contacts.

    Returns:
        Poses, (..., contacts, 4, 4).

    Raises:
        InputError: If they are no list or array, or those of frame contacts no poses.
        ShapeError: If they are not as many as contacts, of another shape, or leading axes do not broadcast.
    """
    if anchors is None:
        return np.broadcast_to(_IDENTITY, (len(contacts), 4, 4))
    if isinstance(anchors, Mapping | str | SE3) or not isinstance(anchors, Iterable):
        raise InputError(
            f"`anchors` is {short_repr(anchors)}; expected one anchor for each contact, in their order, in a list or "
            "an array."
        )
    poses = _as_poses(anchors, contacts)
    frames = [i for i, contact in enumerate(contacts) if contact.size == 6]
    if frames and not is_symbolic(poses):
        checked_rotation("anchors", poses[..., frames, :3, :3], "ulna.spatial.nearest_rotation(R)")
    return poses


def _as_poses(anchors: Iterable[Any], contacts: Sequence[Constraint]) -> Array:
    """Anchors as poses, (..., contacts, 4, 4)."""
    count = len(contacts)
    expected = f"one for each of {count} contacts: (..., {count}, 4, 4), or (..., {count}, 3) for points"
    if isinstance(anchors, np.ndarray):
        if anchors.shape[-3:] == (count, 4, 4):
            return anchors
        if anchors.shape[-2:] != (count, 3):
            raise ShapeError("anchors", anchors.shape, expected)
        anchors = [anchors[..., i, :] for i in range(count)]
    anchors = list(anchors)
    if len(anchors) != count:
        raise ShapeError("anchors", (len(anchors),), expected)
    pairs = zip(anchors, contacts, strict=True)
    return _stacked("anchors", [_pose(np.asarray(a), i, c) for i, (a, c) in enumerate(pairs)], -3)


def _stacked(name: str, arrays: Sequence[Array], axis: int) -> Array:
    """Arrays side by side along a new axis, after their leading axes are broadcast."""
    try:
        return np.stack(np.broadcast_arrays(*arrays), axis=axis)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise ShapeError(
            name, arrays[-1].shape, "leading axes that broadcast", f"Together: {shapes}."
        ) from None


def _pose(anchor: Array, index: int, contact: Constraint) -> Array:
    if anchor.shape[-2:] == (4, 4):
        return anchor
    if contact.size == 3 and anchor.shape[-1:] == (3,):
        pose = np.zeros((*anchor.shape[:-1], 4, 4), dtype=anchor.dtype) + _IDENTITY
        pose[..., :3, 3] = anchor
        return pose
    expected = "(..., 3) [m] or (..., 4, 4)" if contact.size == 3 else "(..., 4, 4)"
    raise ShapeError(f"anchors[{index}]", anchor.shape, expected)
