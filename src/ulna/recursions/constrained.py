"""Robots under constraints: recursions over the joints, and small systems of the constraints, by NumPy.

The symbols are those of `algorithms/constraints`. Each column of M^-1 J^T is the acceleration that a row of J brings
about as torques, of a weightless robot at rest; so the cost grows with the joints times the constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna.algorithms.constraints.dynamics import expanded_to_rows
from ulna.algorithms.constraints.proximal_settings import Proximal
from ulna.algorithms.constraints.proximal_solver import solve_proximal
from ulna.model import Model
from ulna.model.constraint import End, FramePair
from ulna.numeric import cross, skew
from ulna.recursions.composition import AnyRecursion, Composition
from ulna.recursions.frame_motions import jacobian_of, motion_of, poses_of
from ulna.spatial.exponential import so3_log
from ulna.typing import Floats


class Motion(NamedTuple):
    """How a frame moves, along the world's axes.

    Attributes:
        p: Its origin, (3,) [m].
        R: Its rotation, (3, 3).
        J: Its Jacobian, (6, nv).
        twist: Velocity of its origin and angular velocity, (6,) [m/s, rad/s].
        drift: Their rates without acceleration of the joints, (6,) [m/s^2, rad/s^2].
    """

    p: Floats
    R: Floats
    J: Floats
    twist: Floats
    drift: Floats


class _Frame:
    """A frame of a constraint."""

    def __init__(self, model: Model, end: End) -> None:
        self._nv, self._pose = model.nv, end.placement.matrix() if end.joint < 0 else None
        if self._pose is None:
            reference = "local_world_aligned"
            parts = (
                poses_of(model, [end], (4, 4)),
                jacobian_of(model, end, reference),
                motion_of(model, end, reference, 1),
                motion_of(model, end, reference, 2, True),
            )
            self._parts = [part.evaluator() for part in parts]

    def at(self, q: Floats, v: Floats | None) -> Motion:
        """Its motion at a configuration (1, nq) and a velocity (1, nv), None for none."""
        still = np.zeros(6)
        if self._pose is not None:
            return Motion(self._pose[:3, 3], self._pose[:3, :3], np.zeros((6, self._nv)), still, still)
        T, J, twist, drift = (
            np.empty((1, 16)),
            np.empty((1, 6 * self._nv)),
            np.zeros((1, 6)),
            np.zeros((1, 6)),
        )
        pose, jacobian, velocity, acceleration = self._parts
        pose.evaluate([q], [T])
        jacobian.evaluate([q], [J])
        if v is not None:
            velocity.evaluate([q, v], [twist])
            acceleration.evaluate([q, v, np.zeros(v.shape)], [drift])
        matrix = T.reshape(4, 4)
        return Motion(matrix[:3, 3], matrix[:3, :3], J.reshape(6, self._nv), twist[0], drift[0])


class ConstraintFrames:
    """The frames of constraints.

    Args:
        model: The robot.
        frame_pairs: The constraints.
    """

    def __init__(self, model: Model, frame_pairs: Sequence[FramePair]) -> None:
        self.frame_pairs = tuple(frame_pairs)
        self.rows = sum(pair.size for pair in frame_pairs)
        self._frames = [
            (_Frame(model, pair.first), None if pair.second is None else _Frame(model, pair.second))
            for pair in frame_pairs
        ]

    def at(self, q: Floats, v: Floats | None = None) -> State:
        """The constraints at a state.

        Args:
            q: Configuration, (1, nq) [rad, m].
            v: Velocity, (1, nv) [rad/s, m/s]; None where only the Jacobian is asked for.

        Returns:
            The constraints there.
        """
        motions = [(a.at(q, v), None if b is None else b.at(q, v)) for a, b in self._frames]
        return State(self.frame_pairs, motions)


@final
class State:
    """Constraints at a configuration and a velocity; rows are along the world's axes.

    Args:
        frame_pairs: The constraints.
        motions: The motions of their frames.
    """

    def __init__(
        self, frame_pairs: Sequence[FramePair], motions: Sequence[tuple[Motion, Motion | None]]
    ) -> None:
        self._pairs, self._motions = frame_pairs, motions

    def _stacked(self, row: Callable[[Motion, Motion | None, int], Floats]) -> Floats:
        parts = [
            row(a, b, pair.size)[: pair.size] for pair, (a, b) in zip(self._pairs, self._motions, strict=True)
        ]
        return np.concatenate(parts)

    @property
    def J(self) -> Floats:
        """The Jacobian, (m, nv)."""

        def rows(a: Motion, b: Motion | None, size: int) -> Floats:
            if b is None:
                return a.J
            J = a.J - b.J
            if size == 6:
                J[:3] += skew(a.p - b.p) @ b.J[3:]  # less w_b x d
            return J

        return self._stacked(rows)

    @property
    def bias(self) -> Floats:
        """dJ/dt v, (m,) [m/s^2, rad/s^2]."""

        def rows(a: Motion, b: Motion | None, size: int) -> Floats:
            if b is None:
                return a.drift
            k = a.drift - b.drift
            if size == 6:
                k[:3] -= cross(b.drift[3:], a.p - b.p) + cross(b.twist[3:], a.twist[:3] - b.twist[:3])
            return k

        return self._stacked(rows)

    def error(self, anchors: Floats | None) -> Floats:
        """How far frames are from where they are held.

        Args:
            anchors: Poses of contacts in their order, (contacts, 4, 4) [m]; None without contacts.

        Returns:
            e, (m,) [m, rad].
        """
        anchor_poses = iter(() if anchors is None else anchors)

        def rows(a: Motion, b: Motion | None, size: int) -> Floats:
            if b is None:
                T = next(anchor_poses)
                p, R = T[:3, 3], T[:3, :3]
            else:
                p, R = b.p, b.R
            return np.concatenate([a.p - p, so3_log(a.R @ R.T)]) if size == 6 else a.p - p

        return self._stacked(rows)

    def along_axes(self, rows: Floats) -> Floats:
        """Rows along the world's axes, along those of the constraints.

        Args:
            rows: Shape (m,) or (m, n).

        Returns:
            The same, those of "local" constraints along the axes of their first frames.
        """
        out, start = rows.copy(), 0
        for pair, (a, _) in zip(self._pairs, self._motions, strict=True):
            for first in range(start, start + pair.size, 3):
                if pair.local:
                    out[first : first + 3] = a.R.T @ rows[first : first + 3]
            start += pair.size
        return out


class _ConstraintComposition(Composition):
    """What is computed of constraints, sample by sample."""

    def __init__(
        self, pairs: ConstraintFrames, outputs: tuple[tuple[int, ...], ...], main: AnyRecursion
    ) -> None:
        super().__init__(outputs, main)
        self._pairs = pairs

    @final
    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        for k in range(len(outputs[0])):
            results = self._results(*(x[k : k + 1] for x in inputs))
            for output, result in zip(outputs, results, strict=True):
                output[k] = np.reshape(result, -1)

    def _results(self, *inputs: Floats) -> Sequence[Any]:
        raise NotImplementedError


@final
class ConstraintQuantity(_ConstraintComposition):
    """What follows from the frames of constraints alone.

    Args:
        pairs: The constraints.
        shape: The shape of the result.
        main: The part whose code is shown.
        has_velocity: Whether v is an input.
        read: Computes it: of the state, and of inputs that follow.
    """

    def __init__(
        self,
        pairs: ConstraintFrames,
        shape: tuple[int, ...],
        main: AnyRecursion,
        has_velocity: bool,
        read: Callable[..., Floats],
    ) -> None:
        super().__init__(pairs, (shape,), main)
        self._has_velocity, self._read = has_velocity, read

    def _results(self, *inputs: Floats) -> Sequence[Any]:
        q, *rest = inputs
        v = rest.pop(0) if self._has_velocity else None
        return (self._read(self._pairs.at(q, v), v, *rest),)


class Response(NamedTuple):
    """What constraints are solved by.

    Attributes:
        accelerations: Accelerations of a weightless robot at rest by torques: of q, v and tau.
        solver: How the forces are found.
    """

    accelerations: AnyRecursion
    solver: Proximal


@final
class ConstrainedAccelerations(_ConstraintComposition):
    """Forward dynamics under constraints.

    Args:
        pairs: The constraints.
        free: Forward dynamics without them: of q, v, tau, and wrenches.
        response: What they are solved by.
        has_wrenches: Whether wrenches are an input.
        is_stabilised: Whether gains are an input, and before them anchors, where there are contacts.
    """

    def __init__(
        self,
        pairs: ConstraintFrames,
        free: AnyRecursion,
        response: Response,
        has_wrenches: bool,
        is_stabilised: bool,
    ) -> None:
        super().__init__(pairs, (free.outputs[0], (pairs.rows,), (), ()), free)
        self._solve = _Solve(response)
        self._wrenches, self._is_stabilised = int(has_wrenches), is_stabilised
        self._has_contacts = any(pair.second is None for pair in pairs.frame_pairs)

    def _results(self, *inputs: Floats) -> Sequence[Any]:
        q, v, tau, *rest = inputs
        wrenches, rest = rest[: self._wrenches], rest[self._wrenches :]
        state = self._pairs.at(q, v)
        J, g = state.J, state.bias
        if self._is_stabilised:
            anchors = rest.pop(0).reshape(-1, 4, 4) if self._has_contacts else None
            gains = expanded_to_rows(rest[0].reshape(-1, 2), self._pairs.frame_pairs)
            g = g + gains[:, 1] * (J @ v[0]) + gains[:, 0] * state.error(anchors)
        a = np.empty(v.shape)
        self._main.evaluate([q, v, tau, *wrenches], [a])
        gain, forces, rounds = self._solve(q, J, J @ a[0] + g)
        acceleration = a[0] + gain
        return acceleration, state.along_axes(forces), np.abs(J @ acceleration + g).max(), rounds


@final
class Impulses(_ConstraintComposition):
    """The velocity after an impact.

    Args:
        pairs: The constraints.
        response: What they are solved by.
        is_elastic: Whether coefficients of restitution are an input.
    """

    def __init__(self, pairs: ConstraintFrames, response: Response, is_elastic: bool) -> None:
        nv = response.accelerations.outputs[0]
        super().__init__(pairs, (nv, (pairs.rows,), (), ()), response.accelerations)
        self._solve, self._is_elastic = _Solve(response), is_elastic

    def _results(self, *inputs: Floats) -> Sequence[Any]:
        q, v, *rest = inputs
        state = self._pairs.at(q)
        J = state.J
        before = J @ v[0]
        returned = (
            expanded_to_rows(rest[0].reshape(-1, 1), self._pairs.frame_pairs)[:, 0]
            if self._is_elastic
            else 0.0
        )
        gain, impulses, rounds = self._solve(q, J, (1.0 + returned) * before)
        after = v[0] + gain
        return after, state.along_axes(impulses), np.abs(J @ after + returned * before).max(), rounds


@final
class Delassus(_ConstraintComposition):
    """The Delassus matrix.

    Args:
        pairs: The constraints.
        response: What it is computed by; its solver is not used.
    """

    def __init__(self, pairs: ConstraintFrames, response: Response) -> None:
        super().__init__(pairs, ((pairs.rows, pairs.rows),), response.accelerations)
        self._solve = _Solve(response)

    def _results(self, *inputs: Floats) -> Sequence[Any]:
        state = self._pairs.at(inputs[0])
        J = state.along_axes(state.J)
        G = J @ self._solve.columns(inputs[0], J).T
        return (0.5 * (G + G.T),)


@final
class _Solve:
    """Forces that bring about accelerations of constraints."""

    def __init__(self, response: Response) -> None:
        self._accelerations: Any = response.accelerations.evaluator()
        self._solver = response.solver

    def columns(self, q: Floats, J: Floats) -> Floats:
        """M^-1 J^T as rows, (m, nv)."""
        rows = np.empty(J.shape)
        self._accelerations.evaluate([np.repeat(q, len(J), axis=0), np.zeros(J.shape), J], [rows])
        return rows

    def __call__(self, q: Floats, J: Floats, residual: Floats) -> tuple[Floats, Floats, float]:
        """M^-1 J^T f, f and the rounds, for J M^-1 J^T f = -residual."""
        X = self.columns(q, J)
        G = J @ X.T
        solution = solve_proximal(0.5 * (G + G.T), list(-residual), self._solver)
        forces = np.array(solution.forces, float)
        return forces @ X, forces, float(solution.iterations)


READERS: Mapping[str, tuple[bool, Callable[..., Floats]]] = {
    "constraint_jacobian": (False, lambda state, v: state.along_axes(state.J)),
    "constraint_velocity": (True, lambda state, v: state.along_axes(state.J @ v[0])),
    "constraint_bias": (True, lambda state, v: state.along_axes(state.bias)),
    "constraint_error": (
        False,
        lambda state, v, *anchors: state.along_axes(
            state.error(anchors[0].reshape(-1, 4, 4) if anchors else None)
        ),
    ),
}
"""What follows from frames alone: whether of v, too, and how."""
