"""Several joints in a row, with nothing heavy between them, taken as one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model.joints.axes import snap_pose
from ulna.model.joints.joint_kind import Coordinate, ElementaryJoint, JointKind
from ulna.numeric import is_symbolic
from ulna.spatial import SE3, Motion
from ulna.spatial.batched import column
from ulna.typing import Array, Floats


@dataclass(frozen=True)
class Composite(JointKind):
    """A chain of kinds, each placed in the moving frame of the one before; q and v are theirs in a row.

    Args:
        kinds: The kinds from the fixed frame outward; at least one, none of them fixed or composite.
        placements: For each kind, the pose of its fixed frame in the moving frame before it (for the first
            one, in the composite's fixed frame). None puts all on the frame before.
    """

    kinds: tuple[JointKind, ...]
    placements: tuple[SE3, ...] | None = None
    name: ClassVar[str] = "composite"

    def __post_init__(self) -> None:
        kinds = tuple(self.kinds)
        for kind in kinds:
            if not isinstance(kind, JointKind) or isinstance(kind, Composite) or kind.nv == 0:
                raise InputError(
                    f"Composite: {kind!r} is among the kinds; expected joints that move, none composite."
                )
        if not kinds:
            raise InputError("Composite: `kinds` is empty; expected at least one kind.")
        places = (SE3.identity(),) * len(kinds) if self.placements is None else tuple(self.placements)
        if len(places) != len(kinds):
            raise InputError(
                f"Composite: {len(kinds)} kinds but {len(places)} placements; expected one for each kind."
            )
        object.__setattr__(self, "kinds", kinds)
        object.__setattr__(self, "placements", tuple(snap_pose(p) for p in places))

    @property
    def symbol(self) -> str:
        """The letters of the kinds."""
        return "".join(kind.symbol for kind in self.kinds)

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The entries of q, each named with the number of its kind."""
        return _numbered([kind.coordinates for kind in self.kinds])

    @property
    def rates(self) -> tuple[Coordinate, ...]:
        """The entries of v, each named with the number of its kind."""
        return _numbered([kind.rates for kind in self.kinds])

    @property
    def is_vector(self) -> bool:
        """Whether q is a plain vector: those of all kinds are."""
        return all(kind.is_vector for kind in self.kinds)

    def describe(self) -> str:
        """A short label for tables."""
        return " + ".join(kind.describe() for kind in self.kinds)

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: the product along the chain."""
        steps = [step for step, *_ in self._steps(q)]
        pose = steps[0]
        for step in steps[1:]:
            pose = pose @ step
        return pose

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The columns of the kinds, each seen from the last moving frame."""
        columns: list[Motion] = []
        for step, kind, part, _ in self._steps(q):
            columns = [step.act_inverse(c) for c in columns]
            columns += kind.motion_subspace(part)
        return tuple(columns)

    def bias(self, q: Array, v: Array) -> Motion:
        """(dS/dt) v, by the recursion a' = X a + c + V x (S v) along the chain (Featherstone, eq. 5.8)."""
        velocity, total = Motion.zero(), Motion.zero()
        for step, kind, part, rates in self._steps(q):
            part_twist = Motion.zero()
            for k, s in enumerate(kind.motion_subspace(part)):
                rate = column(v[..., rates][..., k])
                part_twist = part_twist + Motion(rate * s.linear, rate * s.angular)
            velocity = step.act_inverse(velocity) + part_twist
            total = step.act_inverse(total) + kind.bias(part, v[..., rates]) + velocity.cross(part_twist)
        return total

    def elementary_joints(self, placement: SE3) -> tuple[ElementaryJoint, ...]:
        """Those of the kinds, in a row."""
        assert self.placements is not None  # __post_init__ filled them in
        places = (placement @ self.placements[0], *self.placements[1:])
        return tuple(
            part._replace(start_q=part.start_q + i.start, start_v=part.start_v + j.start)
            for (kind, i, j), place in zip(self._slices(), places, strict=True)
            for part in kind.elementary_joints(place)
        )

    def integrate(self, q: Array, v: Array) -> Array:
        """Each kind's part by its own rule."""
        return _join([kind.integrate(q[..., i], v[..., j]) for kind, i, j in self._slices()])

    def difference(self, q0: Array, q1: Array) -> Array:
        """Each kind's part by its own rule."""
        return _join([kind.difference(q0[..., i], q1[..., i]) for kind, i, _ in self._slices()])

    def coordinate_rates(self, q: Array, v: Array) -> Array:
        """Each kind's part by its own rule."""
        return _join([kind.coordinate_rates(q[..., i], v[..., j]) for kind, i, j in self._slices()])

    def integrate_derivatives(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The kinds' derivatives in blocks along the diagonal."""
        pairs = [kind.integrate_derivatives(q[..., i], v[..., j]) for kind, i, j in self._slices()]
        return block_diagonal([p[0] for p in pairs]), block_diagonal([p[1] for p in pairs])

    def difference_derivatives(self, q0: Array, q1: Array) -> tuple[Array, Array]:
        """The kinds' derivatives in blocks along the diagonal."""
        pairs = [kind.difference_derivatives(q0[..., i], q1[..., i]) for kind, i, _ in self._slices()]
        return block_diagonal([p[0] for p in pairs]), block_diagonal([p[1] for p in pairs])

    def neutral(self) -> Floats:
        """The kinds' neutral positions."""
        return np.concatenate([kind.neutral() for kind in self.kinds])

    def normalize(self, q: Array) -> Array:
        """Each kind's part by its own rule."""
        return _join([kind.normalize(q[..., i]) for kind, i, _ in self._slices()])

    def random(
        self,
        rng: np.random.Generator,
        lower: Array | None = None,
        upper: Array | None = None,
        size: tuple[int, ...] = (),
    ) -> Floats:
        """Each kind's part by its own rule."""
        parts = []
        for kind, i, _ in self._slices():
            low, high = (None if limit is None else np.asarray(limit)[i] for limit in (lower, upper))
            parts.append(kind.random(rng, low, high, size))
        return np.concatenate(parts, axis=-1)

    def _slices(self) -> Iterator[tuple[JointKind, slice, slice]]:
        """Each kind with its parts of q and of v."""
        i = j = 0
        for kind in self.kinds:
            yield kind, slice(i, i + kind.nq), slice(j, j + kind.nv)
            i, j = i + kind.nq, j + kind.nv

    def _steps(self, q: Array) -> Iterator[tuple[SE3, JointKind, Array, slice]]:
        """For each kind: its pose in the moving frame before, the kind, its part of q, its part of v."""
        assert self.placements is not None  # __post_init__ filled them in
        for (kind, i, j), place in zip(self._slices(), self.placements, strict=True):
            part = q[..., i]
            yield place @ kind.transform(part), kind, part, j


def block_diagonal(blocks: Sequence[Array]) -> Array:
    """Square blocks (..., n_i, n_i) along the diagonal of a matrix of zeros (..., n, n)."""
    batch = np.broadcast_shapes(*(b.shape[:-2] for b in blocks))
    n = sum(b.shape[-1] for b in blocks)
    out = np.full((*batch, n, n), 0.0, dtype=object if any(is_symbolic(b) for b in blocks) else float)
    at = 0
    for b in blocks:
        end = at + b.shape[-1]
        out[..., at:end, at:end] = b
        at = end
    return out


def _numbered(groups: Sequence[tuple[Coordinate, ...]]) -> tuple[Coordinate, ...]:
    return tuple(
        c._replace(name=f"{number}{'.' if c.name else ''}{c.name}")
        for number, group in enumerate(groups, start=1)
        for c in group
    )


def _join(parts: Sequence[Array]) -> Array:
    batch = np.broadcast_shapes(*(p.shape[:-1] for p in parts))
    return np.concatenate([np.broadcast_to(p, (*batch, p.shape[-1])) for p in parts], axis=-1)
