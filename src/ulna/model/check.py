"""Checks of each value a builder is given, on its own; how they fit together is for `assemble` to see."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from ulna.errors import ModelError
from ulna.geometry import Geometry
from ulna.model.joints import JointKind
from ulna.model.joints.axes import constant, snap_pose
from ulna.model.parts import Limits
from ulna.model.records import model_error
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

ValueOrSequence = float | Sequence[float] | np.ndarray
"""One number for all entries of q or v, or one for each."""


def checked_name(what: str, name: object, where: str = "") -> str:
    """A name, if it can be one.

    Args:
        what: What is named, for the message.
        name: What was passed.
        where: The place in the file, for the message.

    Returns:
        The name.

    Raises:
        ModelError: it is not a string, or is empty.
    """
    if not isinstance(name, str) or not name:
        raise model_error(where, f"A {what} is named {name!r}; expected a string that is not empty.")
    return name


def checked_pose(what: str, pose: object, where: str = "") -> SE3:
    """A placement, if it is a single finite rigid motion.

    Args:
        what: What is placed, for the message.
        pose: What was passed [m].
        where: The place in the file, for the message.

    Returns:
        The pose, without rounding noise, its arrays read-only.

    Raises:
        ModelError: it is not a single finite rigid motion.
    """
    subject = f"The placement of {what}"
    if not isinstance(pose, SE3):
        raise model_error(
            where, f"{subject} is a {type(pose).__name__}; expected an SE3 such as SE3.trans(x, y, z)."
        )
    if pose.batch_shape != ():
        raise model_error(where, f"{subject} is a batch {pose.batch_shape}; expected a single SE3.")
    r, t = pose.rotation.astype(float), pose.translation.astype(float)
    if not (np.isfinite(r).all() and np.isfinite(t).all()):
        raise model_error(where, f"{subject} holds nan or inf; expected finite numbers.")
    if np.abs(r.T @ r - np.eye(3)).max() > 1e-6 or np.linalg.det(r) < 0.0:
        raise model_error(
            where, f"{subject} does not turn by a rotation; SE3.project(matrix) returns the nearest one."
        )
    return snap_pose(pose)


def checked_inertia(link: str, inertia: object, where: str = "") -> Inertia:
    """An inertia, if its values can be used.

    Args:
        link: The name of the link, for the message.
        inertia: What was passed [kg, m, kg m^2]; None for a body without inertia.
        where: The place in the file, for the message.

    Returns:
        The inertia, its arrays read-only.

    Raises:
        ModelError: it is not a single, finite, symmetric inertia, or its mass is negative.
    """
    subject = f"The inertia of link {link!r}"
    inertia = Inertia.zero() if inertia is None else inertia
    if not isinstance(inertia, Inertia):
        raise model_error(where, f"{subject} is a {type(inertia).__name__}; expected an Inertia or None.")
    if inertia.batch_shape != ():
        raise model_error(where, f"{subject} is a batch {inertia.batch_shape}; expected a single Inertia.")
    mass, com, tensor = float(inertia.mass), inertia.com.astype(float), inertia.inertia.astype(float)
    if not (math.isfinite(mass) and np.isfinite(com).all() and np.isfinite(tensor).all()):
        raise model_error(where, f"{subject} holds nan or inf; expected finite numbers.")
    if mass < 0.0:
        raise model_error(where, f"Link {link!r} has the mass {mass:g} kg; expected zero or more.")
    if np.abs(tensor - tensor.T).max() > 1e-9 * max(1.0, float(np.abs(tensor).max())):
        raise model_error(
            where,
            f"{subject} is not symmetric. Give Inertia.from_com the six numbers xx, xy, xz, yy, yz, zz.",
        )
    return Inertia(mass + 0.0, constant(com + 0.0), constant(tensor + 0.0))


def checked_geometries(what: str, items: Iterable[Geometry], where: str = "") -> tuple[Geometry, ...]:
    """A tuple of geometries.

    Args:
        what: What they are for, for the message.
        items: What was passed.
        where: The place in the file, for the message.

    Returns:
        The geometries, with checked placements.

    Raises:
        ModelError: they are not geometries.
    """
    if isinstance(items, Geometry) or not isinstance(items, Iterable):
        raise model_error(
            where, f"The {what} are a {type(items).__name__}; expected a list, such as [geometry]."
        )
    out = []
    for item in items:
        if not isinstance(item, Geometry):
            type_name = type(item).__name__
            raise model_error(
                where, f"One of the {what} is a {type_name}; expected Geometry(name, shape, placement)."
            )
        pose = checked_pose(f"one of the {what}", item.placement, where)
        out.append(Geometry(item.name, item.shape, pose, item.material))
    return tuple(out)


def checked_kind(joint: str, kind: object, where: str = "") -> JointKind:
    """A joint kind.

    Args:
        joint: The name of the joint, for the message.
        kind: What was passed.
        where: The place in the file, for the message.

    Returns:
        The kind.

    Raises:
        ModelError: it is not a joint kind.
    """
    subject = f"The kind of joint {joint!r}"
    if isinstance(kind, type) and issubclass(kind, JointKind):
        raise model_error(where, f"{subject} is the class {kind.__name__}; write {kind.__name__}(...).")
    if not isinstance(kind, JointKind):
        raise model_error(where, f"{subject} is {kind!r}; expected a JointKind such as Revolute((0, 0, 1)).")
    return kind


def checked_numbers(
    subject: str,
    value: ValueOrSequence | None,
    count: int,
    *,
    default: float = 0.0,
    minimum: float = 0.0,
    finite: bool = False,
    where: str = "",
) -> tuple[float, ...]:
    """As many numbers as are needed, not below a bound.

    Args:
        subject: What they are, for the message.
        value: What was passed; one number stands for all, None for `default`.
        count: How many numbers are needed.
        default: What None stands for [any].
        minimum: The smallest valid number [any].
        finite: Whether infinite numbers are refused, where they stand for no limit.
        where: The place in the file, for the message.

    Returns:
        The numbers.

    Raises:
        ModelError: there are not so many, or one is below `minimum`, nan, or infinite where `finite`.
    """
    if value is None:
        return (default,) * count
    try:
        out = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise model_error(where, f"{subject} is {value!r}; expected numbers.") from None
    if out.ndim == 0:
        out = np.full(count, float(out))
    if out.shape != (count,):
        raise model_error(where, f"{subject} has shape {out.shape}; expected one number or {count} of them.")
    if np.isnan(out).any():
        raise model_error(where, f"{subject} holds nan; expected numbers (inf for no limit).")
    if (out < minimum).any():
        raise model_error(where, f"{subject} is {out.min():g}; expected {minimum:g} or more.")
    if finite and np.isinf(out).any():
        raise model_error(where, f"{subject} is infinite; expected finite numbers.")
    return tuple(float(x) + 0.0 for x in out)


def checked_limits(
    joint: str, kind: JointKind, limits: dict[str, ValueOrSequence | None], where: str = ""
) -> Limits:
    """The four limits of a joint.

    Args:
        joint: The name of the joint, for the message.
        kind: Its kind, which has as many positions and velocities as there are numbers.
        limits: Any of `lower`, `upper` [rad, m], `velocity` [rad/s, m/s] and `effort` [N m, N]; None for no limit.
        where: The place in the file, for the message.

    Returns:
        The limits.

    Raises:
        ModelError: a limit cannot be used, or a lower one lies above the upper one.
    """
    inf = math.inf

    def numbers(name: str, count: int, default: float, minimum: float) -> tuple[float, ...]:
        subject = f"`{name}` of joint {joint!r}"
        return checked_numbers(
            subject, limits.get(name), count, default=default, minimum=minimum, where=where
        )

    lower, upper = numbers("lower", kind.nq, -inf, -inf), numbers("upper", kind.nq, inf, -inf)
    for low, high in zip(lower, upper, strict=True):
        if low > high or low == inf or high == -inf:
            raise model_error(
                where,
                f"Joint {joint!r} has the lower limit {low:g} and the upper limit {high:g}; "
                "expected lower <= upper. Swap them, or leave them out for no limits.",
            )
    return Limits(lower, upper, numbers("velocity", kind.nv, inf, 0.0), numbers("effort", kind.nv, inf, 0.0))


def checked_mimic(
    joint: str, mimic: object, kind: JointKind, where: str = ""
) -> tuple[str, float, float] | None:
    """Which joint is followed, and how.

    Args:
        joint: The name of the joint, for the message.
        mimic: What was passed: the name of the source, or name, multiplier and offset [rad, m]; None for none.
        kind: The kind of the joint that follows.
        where: The place in the file, for the message.

    Returns:
        Name of the source, multiplier and offset; None for none.

    Raises:
        ModelError: it is none of that, or the joint cannot follow another.
    """
    if mimic is None:
        return None
    try:
        source, multiplier, offset = (mimic, 1.0, 0.0) if isinstance(mimic, str) else mimic  # type: ignore[misc]
        out = checked_name("joint to mimic", source), float(multiplier), float(offset)
        if not (math.isfinite(out[1]) and math.isfinite(out[2])):
            raise ValueError
    except (TypeError, ValueError):
        raise model_error(
            where,
            f"`mimic` of joint {joint!r} is {mimic!r}; "
            "expected (name of the joint to follow, multiplier, offset).",
        ) from None
    if (kind.nq, kind.nv) != (1, 1):
        what = f"Joint {joint!r} ({kind.describe()})"
        raise model_error(where, f"{what} mimics another; only joints with one coordinate can.")
    return out


def checked_gravity(gravity: object) -> Floats:
    """`gravity` as an array (3,), read-only."""
    try:
        g = np.asarray(gravity, dtype=float)
    except (TypeError, ValueError):
        g = np.zeros(0)
    if g.shape != (3,) or not np.isfinite(g).all():
        raise ModelError(f"`gravity` is {gravity}; expected 3 finite numbers [m/s^2], such as (0, 0, -9.81).")
    return constant(g + 0.0)
