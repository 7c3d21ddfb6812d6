"""What a builder has been told so far: links, joints and frames by name, each value checked on its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ulna.errors import ModelError
from ulna.geometry import Geometry
from ulna.model.joints import Fixed, JointKind
from ulna.model.joints.axes import constant, snap_pose
from ulna.model.parts import FrameKind, Limits
from ulna.spatial import SE3, Inertia

ValueOrSequence = float | Sequence[float] | np.ndarray


@dataclass(frozen=True)
class LinkRecord:
    """A link, before its place in the tree is known."""

    name: str
    inertia: Inertia
    visuals: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]
    where: str


@dataclass(frozen=True)
class JointRecord:
    """A joint, movable or fixed; `parent` None is the world."""

    name: str
    kind: JointKind
    parent: str | None
    child: str
    placement: SE3
    offset: SE3
    limits: Limits
    damping: tuple[float, ...]
    friction: tuple[float, ...]
    armature: tuple[float, ...]
    mimic: tuple[str, float, float] | None
    where: str

    @property
    def movable(self) -> bool:
        """Whether it moves."""
        return not isinstance(self.kind, Fixed)


@dataclass(frozen=True)
class FrameRecord:
    """A named point on a link."""

    name: str
    link: str
    placement: SE3
    kind: FrameKind
    where: str


def at(where: str, text: str) -> str:
    """`text`, led by the place in a file where it was said."""
    return f"{where}: {text}" if where else text


def name_of(what: str, name: object, where: str) -> str:
    """`name`, if it can be one."""
    if not isinstance(name, str) or not name:
        raise ModelError(at(where, f"A {what} is named {name!r}; expected a string that is not empty."))
    return name


def pose_of(what: str, pose: object, where: str) -> SE3:
    """`pose`, if it is a single finite rigid motion; cleaned of rounding noise and read-only."""
    if not isinstance(pose, SE3):
        raise ModelError(
            at(
                where,
                f"The placement of {what} is a {type(pose).__name__}; expected an SE3, such as SE3.trans(x, y, z).",
            )
        )
    if pose.batch_shape != ():
        raise ModelError(
            at(where, f"The placement of {what} is a batch {pose.batch_shape}; expected a single SE3.")
        )
    r, t = pose.rotation.astype(float), pose.translation.astype(float)
    if not (np.isfinite(r).all() and np.isfinite(t).all()):
        raise ModelError(at(where, f"The placement of {what} holds nan or inf; expected finite numbers."))
    if np.abs(r.T @ r - np.eye(3)).max() > 1e-6 or np.linalg.det(r) < 0.0:
        raise ModelError(
            at(
                where,
                f"The rotation in the placement of {what} is none; SE3.project(matrix) gives the nearest one.",
            )
        )
    return snap_pose(pose)


def inertia_of(link: str, inertia: Inertia | None, where: str) -> Inertia:
    """`inertia`, if some numbers like it exist; None is the inertia of nothing. Its arrays are read-only."""
    if inertia is None:
        inertia = Inertia.zero()
    if not isinstance(inertia, Inertia):
        raise ModelError(
            at(
                where,
                f"The inertia of link {link!r} is a {type(inertia).__name__}; expected an Inertia or None.",
            )
        )
    if inertia.batch_shape != ():
        raise ModelError(at(where, f"The inertia of link {link!r} is a batch; expected a single one."))
    mass, com, tensor = float(inertia.mass), inertia.com.astype(float), inertia.inertia.astype(float)
    if not (math.isfinite(mass) and np.isfinite(com).all() and np.isfinite(tensor).all()):
        raise ModelError(
            at(where, f"The inertia of link {link!r} holds nan or inf; expected finite numbers.")
        )
    if mass < 0.0:
        raise ModelError(at(where, f"Link {link!r} has the mass {mass:g} kg; expected zero or more."))
    if np.abs(tensor - tensor.T).max() > 1e-9 * max(1.0, float(np.abs(tensor).max())):
        raise ModelError(at(where, f"The inertia matrix of link {link!r} is not symmetric."))
    return Inertia(mass, constant(com + 0.0), constant(tensor + 0.0))


def geometries_of(what: str, items: Sequence[Geometry], where: str) -> tuple[Geometry, ...]:
    """`items`, if they are geometries."""
    if isinstance(items, Geometry):
        raise ModelError(
            at(where, f"The {what} are one Geometry; expected a sequence of them, such as [geometry].")
        )
    for item in items:
        if not isinstance(item, Geometry):
            raise ModelError(
                at(
                    where,
                    f"One of the {what} is a {type(item).__name__}; expected Geometry(name, shape, placement).",
                )
            )
    return tuple(
        Geometry(g.name, g.shape, pose_of(f"one of the {what}", g.placement, where), g.material)
        for g in items
    )


def kind_of(joint: str, kind: object, where: str) -> JointKind:
    """`kind`, if it is one."""
    if isinstance(kind, type) and issubclass(kind, JointKind):
        raise ModelError(
            at(
                where,
                f"The kind of joint {joint!r} is the class {kind.__name__}; write {kind.__name__}(...).",
            )
        )
    if not isinstance(kind, JointKind):
        raise ModelError(
            at(
                where,
                f"The kind of joint {joint!r} is {kind!r}; expected a JointKind such as Revolute((0, 0, 1)).",
            )
        )
    return kind


def numbers_of(
    joint: str,
    what: str,
    value: ValueOrSequence | None,
    count: int,
    default: float,
    where: str,
    minimum: float,
) -> tuple[float, ...]:
    """`value` as `count` numbers not below `minimum`; one number serves for all, None is `default`."""
    if value is None:
        return (default,) * count
    try:
        out = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ModelError(at(where, f"`{what}` of joint {joint!r} is {value!r}; expected numbers.")) from None
    if out.ndim == 0:
        out = np.full(count, float(out))
    if out.shape != (count,):
        raise ModelError(
            at(
                where,
                f"`{what}` of joint {joint!r} has shape {out.shape}; expected one number or {count} of them.",
            )
        )
    if np.isnan(out).any():
        raise ModelError(
            at(where, f"`{what}` of joint {joint!r} holds nan; expected numbers (inf for no limit).")
        )
    if (out < minimum).any():
        raise ModelError(
            at(where, f"`{what}` of joint {joint!r} is {out.min():g}; expected {minimum:g} or more.")
        )
    return tuple(float(x) + 0.0 for x in out)


def limits_of(
    joint: str,
    kind: JointKind,
    lower: ValueOrSequence | None,
    upper: ValueOrSequence | None,
    velocity: ValueOrSequence | None,
    effort: ValueOrSequence | None,
    where: str,
) -> Limits:
    """The four limits of a joint, if the lower ones lie below the upper ones."""
    inf = math.inf
    limits = Limits(
        numbers_of(joint, "lower", lower, kind.nq, -inf, where, -inf),
        numbers_of(joint, "upper", upper, kind.nq, inf, where, -inf),
        numbers_of(joint, "velocity", velocity, kind.nv, inf, where, 0.0),
        numbers_of(joint, "effort", effort, kind.nv, inf, where, 0.0),
    )
    for low, high in zip(limits.lower, limits.upper, strict=True):
        if low > high or low == inf or high == -inf:
            raise ModelError(
                at(
                    where,
                    f"Joint {joint!r} has the lower limit {low:g} and the upper limit {high:g}; "
                    "expected lower <= upper. Swap them, or leave them out for no limits.",
                )
            )
    return limits


def mimic_of(joint: str, mimic: object, kind: JointKind, where: str) -> tuple[str, float, float] | None:
    """`mimic` as (name of the source, multiplier, offset)."""
    if mimic is None:
        return None
    expected = "expected (name of the joint to follow, multiplier, offset)"
    if isinstance(mimic, str):
        mimic = (mimic, 1.0, 0.0)
    if not isinstance(mimic, (tuple, list)) or len(mimic) != 3 or not isinstance(mimic[0], str):
        raise ModelError(at(where, f"`mimic` of joint {joint!r} is {mimic!r}; {expected}."))
    multiplier, offset = float(mimic[1]), float(mimic[2])
    if not (math.isfinite(multiplier) and math.isfinite(offset)):
        raise ModelError(at(where, f"`mimic` of joint {joint!r} is {mimic!r}; {expected}, both finite."))
    if (kind.nq, kind.nv) != (1, 1):
        raise ModelError(
            at(
                where,
                f"Joint {joint!r} ({kind.describe()}) mimics another; only joints with one coordinate can.",
            )
        )
    return (mimic[0], multiplier, offset)
