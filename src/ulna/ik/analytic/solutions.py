"""Which candidates are solutions: at the goal, within the limits, each once, in order."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.ik.analytic.candidates import Source
from ulna.ik.analytic.free_joints import free_branches, other_values
from ulna.spatial import SE3
from ulna.spatial.nearest import nearest_rotation
from ulna.typing import Floats

_DISTINCT = 1e-6  # two solutions are one when no joint differs by more [rad or m]
_STEPS = 12
_MAX_TOLERANCE = 1e-7  # tolerances above it could take what is no pose for one
_ROUNDED = 1e-13  # how far a rotation may be off by rounding
_PAIRWISE_CANDIDATES = 16  # candidates up to which all pairs are compared at once
_EARLIER = np.tri(_PAIRWISE_CANDIDATES, k=-1, dtype=bool)


@dataclass(frozen=True)
class SolutionFilter:
    """Picks the solutions among the candidates of a source.

    Attributes:
        source: Where candidates come from.
        near: Whether solutions come nearest to the base configuration first, angles next to its own.
        limits: Whether those outside the joint limits are left out.
        turns: Whether a solution is listed for every whole turn that the limits allow.
        position: Largest distance from the goal [m].
        rotation: Largest angle from the goal [rad].
    """

    source: Source
    near: bool
    limits: bool
    turns: bool
    position: float
    rotation: float

    def __call__(self, T: Floats, base: Floats, values: Floats, seed: int) -> tuple[list[Any], bool]:
        """The solutions for some poses.

        Args:
            T: Goals, shape (k, 4, 4) [m].
            base: Configurations whose other joints stay, shape (k, nq) [rad, m].
            values: Values of the free joint, shape (s,) [rad, m].
            seed: Seed of random starts.

        Returns:
            For each pose (q, position errors, rotation errors, found, miss), and whether the source found all.
        """
        source = self.source
        centre = base[:, source.index] if self.near else source.centre[None]
        q, evaluation, complete = source.candidates(T, base, centre, values, seed)
        reached, close = self._reached(evaluation)
        if close.any():
            pose = np.nonzero(close)[0]
            wanted = np.broadcast_to(centre, (len(T), len(source.index)))[pose]
            refined = source.refine(q[close], T[pose], _STEPS)
            q[close], evaluation[close] = source.evaluate(refined, T[pose], wanted)
            reached, _ = self._reached(evaluation)
        if self._try_free_joints(T, base, centre, values, q, evaluation, reached):
            reached, _ = self._reached(evaluation)
        reached &= self._is_first(q, reached)
        accepted = reached & (evaluation[..., 2] > 0.5) if self.limits else reached
        counts = reached.sum(axis=(1, 2)).tolist()
        # A goal that was met to within a small tolerance is a pose; others may have inaccurate rotations.
        if 0 in counts or max(self.position, self.rotation) > _MAX_TOLERANCE:
            exact = _orthogonal(T)
            if exact is not None:
                return self(exact, base, values, seed)
        poses = []
        for i, count in enumerate(counts):
            misses = evaluation[i][reached[i]] if count else _nearest(evaluation[i])
            chosen = accepted[i]
            poses.append((*self._ordered(q[i][chosen], evaluation[i][chosen], base[i]), count, misses[0, :2]))
        return poses, complete

    def _reached(self, evaluation: Floats) -> tuple[Any, Any]:
        """Whether candidates are at their goals; whether they are not, but so near that Newton may bring them there."""
        position, rotation = evaluation[..., 0], evaluation[..., 1]
        reached = (position <= self.position) & (rotation <= self.rotation)
        threshold = self.source.refine_threshold
        return reached, (position < threshold) & (rotation < threshold) & ~reached

    def _try_free_joints(
        self,
        T: Floats,
        base: Floats,
        centre: Floats,
        values: Floats,
        q: Floats,
        evaluation: Floats,
        reached: Any,
    ) -> bool:
        """Replaces branches in which a joint is free by solutions with another value of it; whether it did."""
        source, tolerances = self.source, (self.position, self.rotation)
        good = reached & (evaluation[..., 2] > 0.5) if self.limits else reached
        if not source.takes_base or good.all():
            return False
        free = free_branches(source, T, base, centre, values, q, ~good)
        poses = np.flatnonzero(free.any(axis=(1, 2)))
        for i in poses.tolist():
            other, judged = other_values(source, T[i], base[i], centre[i % len(centre)], values, tolerances)
            again = self._reached(judged)[0]
            better = free[i] & again & (~reached[i] | (judged[..., 2] > evaluation[i, ..., 2]))
            q[i][better], evaluation[i][better] = other[better], judged[better]
        return len(poses) > 0

    def _is_first(self, q: Floats, reached: Any) -> Any:
        """Whether no earlier solution of the same group is the same configuration, turns apart."""
        x = np.where(reached[..., None], q[..., self.source.index], np.nan)
        if x.shape[-2] <= _PAIRWISE_CANDIDATES:
            same = self._same(x[..., :, None, :], x[..., None, :, :])
            return ~(same & _EARLIER[: x.shape[-2], : x.shape[-2]]).any(axis=-1)
        out = np.ones(reached.shape, dtype=bool)
        for place in np.ndindex(reached.shape[:-1]):  # one by one
            left = np.flatnonzero(reached[place])
            while len(left):
                same = self._same(x[place][left[0]], x[place][left])
                out[place][left[same][1:]] = False
                left = left[~same]
        return out

    def _same(self, a: Floats, b: Floats) -> Any:
        gap = np.abs(a - b)
        apart = np.minimum(gap, np.abs(self.source.periods - gap))  # they are a turn apart at most
        return (apart < _DISTINCT).all(axis=-1)

    def _ordered(self, q: Floats, evaluation: Floats, base: Floats) -> tuple[Floats, Floats, Floats]:
        if self.turns and len(q):
            copies = [self._copies(row) for row in q]
            evaluation = np.repeat(evaluation, [len(c) for c in copies], axis=0)
            q = np.concatenate(copies)
        if self.near and len(q) > 1:
            order = (
                np.square(q[:, self.source.index] - base[self.source.index])
                .sum(axis=-1)
                .argsort(kind="stable")
            )
            q, evaluation = q[order], evaluation[order]
        return q, evaluation[:, 0], evaluation[:, 1]

    def _copies(self, q: Floats) -> Floats:
        """The same configuration with whole turns added wherever both limits allow them."""
        source, options = self.source, []
        for x, low, high, period in zip(
            q[source.index], source.lower, source.upper, source.periods, strict=True
        ):
            if not np.isfinite([low, high, period]).all():
                options.append([x])
                continue
            first, last = np.ceil((low - x) / period - 1e-12), np.floor((high - x) / period + 1e-12)
            options.append([x + n * period for n in np.arange(first, last + 1)] or [x])
        out = np.repeat(q[None], np.prod([len(o) for o in options]), axis=0)
        out[:, source.index] = list(product(*options))
        return out


def _orthogonal(T: Floats) -> Floats | None:
    """The poses with the nearest rotations, where those given are rotations in their first digits only; else None."""
    rounded = SE3.from_matrix(T).rotation
    rotation = nearest_rotation(rounded)
    if np.abs(rotation - rounded).max(initial=0.0) < _ROUNDED:
        return None
    return SE3(rotation, T[..., :3, 3]).matrix()


def _nearest(evaluation: Floats) -> Floats:
    """The evaluation of the candidate with the least errors, (1, 3)."""
    rows = evaluation.reshape(-1, evaluation.shape[-1])
    if not len(rows):
        return np.full((1, 3), np.inf)
    total = rows[:, 0] + rows[:, 1]
    least = np.where(np.isnan(total), np.inf, total).argmin()
    return rows[least : least + 1]
