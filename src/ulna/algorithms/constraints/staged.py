"""Dynamics of a robot on contacts, and their derivatives, as stages in one frame, for one sample.

The symbols and the frame are those of columns_in_one_frame.py and of dynamics.py. What is computed is that of
dynamics.py and forward_dynamics_derivatives.py, which remain the definitions: `tests/laws/test_staged_contact_laws.py`
compares.

| symbol | meaning | shape | unit |
|---|---|---|---|
| p, w, u | a contact in the common frame; angular velocity of its body; velocity of the contact there | (3) | |
| C | from the common axes to those of a constraint | (3, 3) | |
| J | constraint Jacobian, its transpose in tables: a column for each row of J | (m, nv) | |
| y_0, z_0 | L^-T (tau - h_0), D^-1 y_0 | (nv) | |
| g | acceleration of contacts without joint accelerations | (m) | [m/s^2, rad/s^2] |
| h_0 | torques without joint accelerations | (nv) | [N m, N] |
| G, S, Y, f | as in dynamics.py and forward_dynamics_derivatives.py | | |

A contact accelerates as a point, which all observers who move evenly see alike. With a column s that moves it, and
l(x) = x.linear + x.angular x p, its acceleration, seen from its body, changes by

    q: (l(chi) + 2 psi.angular x u + gravity x s.angular; chi.angular - w x psi.angular)
    v: (l(phi) + 2 s.angular x u; phi.angular - w x s.angular)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.damped_dynamics import are_unique, damped_factors
from ulna.algorithms.constraints.dynamics import delassus_product
from ulna.algorithms.constraints.forward_dynamics_derivatives import BoundSolver
from ulna.algorithms.constraints.proximal_solver import Proximal, largest_entry, solve_proximal
from ulna.algorithms.derivatives.columns_in_one_frame import (
    OneFrame,
    numbers,
    subtree,
    suits_one_frame,
)
from ulna.algorithms.dynamics.joint_friction import Friction, friction_torque
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, factors_in_rows
from ulna.algorithms.multibody.chain_walks import motion
from ulna.algorithms.multibody.references import Reference
from ulna.compiler.forms.columns import ColumnForm, row_places
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.language.function import trace
from ulna.model import Model
from ulna.model.constraint import FramePair
from ulna.numeric import apply, cross, dot, vector
from ulna.spatial import SE3
from ulna.typing import Array


def stages_of_constrained_dynamics(
    model: Model,
    frame_pairs: Sequence[FramePair],
    settings: Proximal,
    forces: Sequence[str] = (),
    reference: Reference = "local_world_aligned",
    law: Friction | None = None,
) -> StagedForm | None:
    """Accelerations, forces, residual and rounds of constrained dynamics.

    Args:
        model: The robot; every motion must move some mass or have armature.
        frame_pairs: The constraints.
        settings: How the forces are computed.
        forces: Names of frames with external forces.
        reference: In whose axes, and about which point, these are written.
        law: The friction of the joints; None for none.

    Returns:
        The form; None for robots and constraints that need another one.
    """
    if not _suits(model, frame_pairs):
        return None
    inputs: dict[str, tuple[int, ...]] = {"q": (model.nq,), "v": (model.nv,), "tau": (model.nv,)}
    inputs |= {"f_ext": (len(forces), 6)} if forces else {}
    frame = OneFrame("constrained_dynamics", model, **inputs)
    contacts = _Contacts(frame, frame_pairs)
    frame.kinematics()
    frame.accelerations()
    frame.moments_and_forces(frame.external_forces(forces, reference))
    _responses(frame, force_at=9)
    frame.factors()
    contacts.poses(local_axes=False)
    contacts.velocities()
    contacts.drive("tau", law)
    contacts.response("g", "z_0")
    contacts.forces(settings)
    contacts.accelerations("y_0")
    contacts.results("a", "g")
    return frame.stages.form("result", "forces", "residual", "count")


def stages_of_impulse_dynamics(
    model: Model, frame_pairs: Sequence[FramePair], settings: Proximal
) -> StagedForm | None:
    """Velocity, impulses, residual and rounds of an impact without restitution.

    Args:
        model: The robot; every motion must move some mass or have armature.
        frame_pairs: The constraints.
        settings: How the impulses are computed.

    Returns:
        The form; None for robots and constraints that need another one.
    """
    if not _suits(model, frame_pairs):
        return None
    frame = OneFrame("impulse_dynamics", model, q=(model.nq,), v=(model.nv,))
    contacts = _Contacts(frame, frame_pairs)
    frame.poses()
    frame.composite_moments()
    _responses(frame)
    frame.factors()
    contacts.poses(local_axes=False)
    frame.stages.straight(lambda v: v, ("v",), ("before",))
    contacts.response("before")
    contacts.forces(settings)
    contacts.accelerations()
    frame.stages.straight(lambda before, a: before + a, ("before", "a"), ("after",))
    contacts.results("after")
    return frame.stages.form("result", "forces", "residual", "count")


def stages_of_constrained_derivatives(model: Model, frame_pairs: Sequence[FramePair]) -> ColumnForm | None:
    """The derivatives of accelerations and forces of constrained dynamics with respect to q, v and tau.

    Args:
        model: The robot; every motion must move some mass or have armature.
        frame_pairs: The constraints.

    Returns:
        The form; None for robots and constraints that need another one.
    """
    if not _suits(model, frame_pairs):
        return None
    n = model.nv
    frame = OneFrame("constrained_dynamics_derivatives", model, q=(model.nq,), v=(n,), tau=(n,))
    contacts, stages = _Contacts(frame, frame_pairs), frame.stages
    frame.kinematics()
    frame.accelerations()
    frame.subtrees()
    _responses(frame, force_at=21)
    frame.factors()
    contacts.poses(local_axes=True)
    contacts.velocities()
    contacts.drive("tau")
    contacts.response("g", "z_0")
    contacts.unique_forces()
    contacts.accelerations("y_0")
    frame.add_accelerations(contacts.minus_wrenches, ("wrenches", "carriers"))
    frame.columns(forces="dF")
    frame.torque_derivatives("r_q", "r_v")
    contacts.acceleration_derivatives()
    still = np.tile(~contacts.rows_moved, (2, 1))
    zeros = {
        "r_q": frame.unrelated(by_q=True),
        "g_q": still | frame.moves_all_evenly,
        "g_v": np.concatenate([still[: contacts.size], np.ones_like(contacts.rows_moved)]),
    }
    head = stages.form(("factors", "shared"), ("r_q", "g_q"), ("r_v", "g_v"), zeros=zeros)
    body = trace(
        contacts.column_answer,
        name="constrained_dynamics_derivatives_column",
        table=head.outputs[0].shape,
        column=(n + 2 * contacts.size,),
    )
    return ColumnForm(head, body, (None, None, -1.0), (n + contacts.size, n), serves_batches=True)


def _suits(model: Model, frame_pairs: Sequence[FramePair]) -> bool:
    """Whether all constraints are contacts of a robot that suits."""
    return all(frame_pair.second is None for frame_pair in frame_pairs) and suits_one_frame(model)


def _responses(frame: OneFrame, force_at: int = 0) -> None:
    """r, and where a row of `sums` is given at which forces begin, h_0."""

    def of_column(s: Array, sums: Array, mass: Array) -> tuple[Array, ...]:
        body = subtree(mass, np.concatenate([sums[:9], np.zeros(18)])).body
        torques = (np.array([dot(s, sums[force_at:])], dtype=object),) if force_at else ()
        return numbers(body.apply(motion(s))), *torques

    frame.stages.lanes(of_column, ("s", "sums", "mass"), ("r", "h_0") if force_at else ("r",))


_POSE = 21
"""How many numbers of `turns` a contact has."""


class _Contacts:
    """What contacts add to the stages of a robot."""

    def __init__(self, frame: OneFrame, frame_pairs: Sequence[FramePair]) -> None:
        self.frame, self.frame_pairs = frame, frame_pairs
        self.size = sum(frame_pair.size for frame_pair in frame_pairs)
        model, tree = frame.model, frame.tree
        self._placements: list[SE3] = []
        self._columns: list[int] = []
        moved = np.zeros((len(frame_pairs), model.nv))
        carriers = np.zeros_like(moved)
        for k, frame_pair in enumerate(frame_pairs):
            joint, placement = frame_pair.first
            last = frame.carrier(joint)
            self._placements.append(frame.prepared.frames[last].inverse() @ placement)
            self._columns.append(tree[last].indices[-1])
            moved[k, [*frame.movers[self._columns[-1]], *tree[last].indices]] = 1.0
            carriers[k, self._columns[-1]] = 1.0
        self._paths = [np.flatnonzero(row).tolist() for row in moved]
        sizes = [frame_pair.size for frame_pair in frame_pairs]
        self.rows_moved = np.repeat(moved, sizes, axis=0) > 0.0
        frame.stages.constant("moved", moved)
        frame.stages.constant("carriers", carriers)

    def poses(self, local_axes: bool) -> None:
        """C, p and gravity in the common frame; for each contact the rows of J as functions of a column: `axes`.

        `turns` has C, p, and what turns from C to the own axes, of each contact, then gravity.

        Args:
            local_axes: Whether C goes to the axes of "local" contacts; else always to those of the world.
        """

        def of_contacts(q: Array, T: Array) -> tuple[Array, ...]:
            R, entries, axes = self.frame.rotation(q), [], []
            for frame_pair, column, placement in zip(
                self.frame_pairs, self._columns, self._placements, strict=True
            ):
                pose = SE3(T[:9, column].reshape(3, 3), T[9:, column]) @ placement
                own = np.swapaxes(pose.rotation, -1, -2) if frame_pair.local else R
                along = own if local_axes else R
                rest = own @ np.swapaxes(along, -1, -2) if own is not along else np.eye(3)
                entries += [*along.reshape(-1), *pose.translation, *rest.reshape(-1)]
                rows = [[*row, *cross(pose.translation, row)] for row in along]
                rows += [[0.0, 0.0, 0.0, *row] for row in along if frame_pair.size == 6]
                axes.append(np.array(rows, dtype=object).T)
            entries += list(apply(np.swapaxes(R, -1, -2), np.asarray(self.frame.model.gravity)))
            return np.array(entries, dtype=object), *axes

        self.frame.stages.straight(of_contacts, ("q", "T"), ("turns", *self._names("axes")))

    def velocities(self) -> None:
        """`contacts`: w and u of each contact; `g` of each: its acceleration without joint accelerations, along C."""

        def of_contacts(turns: Array, V: Array, A: Array) -> tuple[Array, ...]:
            entries: list[Any] = []
            rates: list[Array] = []
            for k, (frame_pair, column) in enumerate(zip(self.frame_pairs, self._columns, strict=True)):
                (C, p), gravity = self._pose(turns, k), turns[-3:]
                linear, w = V[:3, column], V[3:, column]
                u = linear + cross(w, p)
                rate = A[:3, column] + cross(A[3:, column], p) + cross(w, u) + gravity
                entries += [*w, *u]
                rate = np.concatenate([apply(C, rate), apply(C, A[3:, column])])
                rates.append(rate[None, : frame_pair.size])
            return np.array(entries, dtype=object), *rates

        self.frame.stages.straight(of_contacts, ("turns", "V", "A"), ("contacts", *self._names("g")))

    def drive(self, tau: str, law: Friction | None = None) -> None:
        """`y_0` and `z_0`, L^-T (tau - h_0) and D^-1 of it.

        Args:
            tau: The name of the torques.
            law: The friction of the joints; None for none.
        """

        def drive(tau: Array, h_0: Array, *v: Array) -> Array:
            return tau - h_0[0] if law is None else tau + friction_torque(v[0], law) - h_0[0]

        def solved(drive: Array, table: Array) -> tuple[Array, Array]:
            factors = self.factors(table)
            y = factors.inward(list(drive))
            z = [entry * reciprocal for entry, reciprocal in zip(y, factors.reciprocals, strict=True)]
            return np.array(y, dtype=object), np.array(z, dtype=object)

        reads = (tau, "h_0") if law is None else (tau, "h_0", "v")
        self.frame.stages.straight(drive, reads, ("drive",))
        self.frame.stages.straight(solved, ("drive", "factors"), ("y_0", "z_0"))

    def response(self, drift: str, z: str = "") -> None:
        """J, Y and D^-1 Y of each contact, the rows of G, and b: what forces must bring about.

        Args:
            drift: The name of what forces must be the opposite of: of tables of accelerations, or of the velocity.
            z: The name of D^-1 L^-T (tau - h_0); empty for zero.
        """
        stages = self.frame.stages
        for k, frame_pair in enumerate(self.frame_pairs):
            path, size = self._paths[k], frame_pair.size

            def of_row(
                axes: Array, s: Array, table: Array, path: Sequence[int] = path
            ) -> tuple[Array, Array, Array]:
                factors, J = self.factors(table), np.zeros(self.frame.model.nv, dtype=object)
                for j in path:
                    J[j] = dot(axes, s[:, j])
                Y = np.array(factors.inward(list(J)), dtype=object)[list(path)]
                scaled = [y * factors.reciprocals[j] for y, j in zip(Y, path, strict=True)]
                return J[list(path)], Y, np.array(scaled, dtype=object)

            names = (f"J{k}", f"Y{k}", f"Z{k}")
            stages.lanes(of_row, (f"axes{k}", "s", "factors"), names, size, ("s",))
            self._products(k, size)
            self._wanted(k, size, drift, z)

    def _products(self, k: int, size: int) -> None:
        """The rows of G for contacts up to k."""

        def of_column(Z: Array, *others: Array) -> Array:
            entries = dict(zip(self._paths[k], Z, strict=True))
            rows: list[Any] = []
            for path, Y in zip(self._paths, others, strict=False):
                shared = [(place, j) for place, j in enumerate(path) if j in entries]
                for i in range(Y.shape[1]):
                    rows.append(sum((Y[place, i] * entries[j] for place, j in shared), 0.0))
            return np.array(rows, dtype=object)

        others = self._names("Y")[: k + 1]
        self.frame.stages.lanes(of_column, (f"Z{k}", *others), (f"G{k}",), size, others)

    def _wanted(self, k: int, size: int, drift: str, z: str) -> None:
        """b of contact k."""
        path = list(self._paths[k])

        def of_row(X: Array, given: Array, *more: Array) -> Array:
            start = given[0] if z else dot(X, given[path])
            return np.array([-start - (dot(X, more[0][path]) if z else 0.0)], dtype=object)

        reads = (f"Y{k}", f"{drift}{k}", z) if z else (f"J{k}", drift)
        self.frame.stages.lanes(of_row, reads, (f"b{k}",), size)

    def forces(self, settings: Proximal) -> None:
        """`f` and `rounds`.

        Args:
            settings: How the forces are computed.
        """

        def solved(table: Array, *tables: Array) -> tuple[Array, Array]:
            Y = [
                dict(zip(path, column, strict=True))
                for path, rows in zip(self._paths, tables[2 * len(self.frame_pairs) :], strict=True)
                for column in rows.T
            ]
            product = delassus_product(self.factors(table), Y)
            forces, count = solve_proximal(*self._system(tables), settings, product)
            return vector(*forces), vector(count)

        names = (*self._names("G"), *self._names("b"), *self._names("Y"))
        self.frame.stages.straight(solved, ("factors", *names), ("f", "rounds"))

    def unique_forces(self) -> None:
        """`f`, what the forces do to bodies, and Y and S for columns, nan where forces are not unique."""
        names = (*self._names("G"), *self._names("b"), *self._names("Y"), "turns")
        self.frame.stages.straight(self._unique, names, ("f", "wrenches", "shared"))

    def _unique(self, *tables: Array) -> tuple[Array, Array, Array]:
        count, turns = len(self.frame_pairs), tables[-1]
        G, b = self._system(tables[: 2 * count])
        factors = damped_factors(G, vector(*[0.0] * self.size))
        forces = vector(*factors.solve(b))
        wrenches: list[Any] = []
        for k, frame_pair in enumerate(self.frame_pairs):
            (C, p), start = self._pose(turns, k), self._start(k)
            back = np.swapaxes(C, -1, -2)
            force = apply(back, forces[start : start + 3])
            moment = cross(p, force)
            if frame_pair.size == 6:
                moment = moment + apply(back, forces[start + 3 : start + 6])
            wrenches += [*force, *moment]
        S = factors.inverse()
        unique = are_unique(factors, G, S)
        shared = [entry for Y in tables[2 * count : -1] for entry in Y.T.reshape(-1)]
        shared += [numeric.where(unique, S[i, j], np.nan) for i in range(self.size) for j in range(i + 1)]
        return forces, np.array(wrenches, dtype=object), np.array(shared, dtype=object)

    def _system(self, tables: Sequence[Array]) -> tuple[Array, list[Any]]:
        """G and b of all contacts."""
        count = len(self.frame_pairs)
        G = np.zeros((self.size, self.size), dtype=object)
        for k, rows in enumerate(tables[:count]):
            for i in range(rows.shape[1]):
                for j in range(self._start(k) + i + 1):
                    G[self._start(k) + i, j] = G[j, self._start(k) + i] = rows[j, i]
        return G, [entry for row in tables[count : 2 * count] for entry in row[0]]

    def accelerations(self, y: str = "") -> None:
        """`a`, the accelerations, or the change of the velocity.

        Args:
            y: The name of L^-T (tau - h_0); empty for zero.
        """

        def of_forces(f: Array, table: Array, *tables: Array) -> Array:
            factors, entries = self.factors(table), list(tables[-1]) if y else [0.0] * self.frame.model.nv
            for k, Y in enumerate(tables[: len(self.frame_pairs)]):
                for place, j in enumerate(self._paths[k]):
                    entries[j] = entries[j] + dot(Y[place], f[self._start(k) :][: Y.shape[1]])
            scaled = (
                entry * reciprocal for entry, reciprocal in zip(entries, factors.reciprocals, strict=True)
            )
            return np.array(factors.outward(scaled), dtype=object)

        reads = ("f", "factors", *self._names("Y"), *([y] if y else []))
        self.frame.stages.straight(of_forces, reads, ("a",))

    def results(self, motion: str, drift: str = "") -> None:
        """The outputs: the motion, forces along the axes of their contacts, residual and rounds.

        Args:
            motion: The name of accelerations or velocities.
            drift: The name of the tables of accelerations without joint accelerations; empty for zero.
        """
        for k, frame_pair in enumerate(self.frame_pairs):
            path = list(self._paths[k])

            def of_row(J: Array, moves: Array, *given: Array, path: list[int] = path) -> Array:
                return np.array([dot(J, moves[path]) + (given[0][0] if given else 0.0)], dtype=object)

            reads = (f"J{k}", motion, *([f"{drift}{k}"] if drift else []))
            self.frame.stages.lanes(of_row, reads, (f"c{k}",), frame_pair.size)

        def of_all(moves: Array, f: Array, rounds: Array, turns: Array, *left: Array) -> tuple[Any, ...]:
            residual = largest_entry(np.concatenate([row[0] for row in left]))
            return moves, self.turned(turns, f), residual, rounds[0]

        reads = (motion, "f", "rounds", "turns", *self._names("c"))
        self.frame.stages.straight(of_all, reads, ("result", "forces", "residual", "count"))

    def _names(self, letter: str) -> tuple[str, ...]:
        """The names of a table of each contact."""
        return tuple(f"{letter}{k}" for k in range(len(self.frame_pairs)))

    def acceleration_derivatives(self) -> None:
        """g_q and g_v: derivatives of accelerations, and below them how forces turn with their axes."""
        names = ("s", "psi", "chi", "phi", "turns", "contacts", "f", "moved")

        def of_column(
            s: Array,
            psi: Array,
            chi: Array,
            phi: Array,
            turns: Array,
            contacts: Array,
            f: Array,
            moved: Array,
        ) -> tuple[Array, Array]:
            by_q: list[Any] = []
            by_v: list[Any] = []
            turning: list[Any] = []
            start = 0
            for k, frame_pair in enumerate(self.frame_pairs):
                (C, p), w, u = self._pose(turns, k), contacts[6 * k :][:3], contacts[6 * k + 3 :][:3]
                turn, gravity = s[3:], turns[-3:]
                lever_q, lever_v = chi[:3] + cross(chi[3:], p), phi[:3] + cross(phi[3:], p)
                rates_q = [lever_q + 2.0 * cross(psi[3:], u) + cross(gravity, turn)]
                rates_v = [lever_v + 2.0 * cross(turn, u)]
                if frame_pair.size == 6:
                    rates_q.append(chi[3:] - cross(w, psi[3:]))
                    rates_v.append(phi[3:] - cross(w, turn))
                for rate_q, rate_v in zip(rates_q, rates_v, strict=True):
                    by_q += list(apply(C, rate_q) * moved[k])
                    by_v += list(apply(C, rate_v) * moved[k])
                    turned = cross(apply(C, turn), f[start : start + 3]) * moved[k]
                    turning += [0.0] * 3 if frame_pair.local else list(turned)
                    start += 3
            nothing = [0.0] * self.size
            return np.array([*by_q, *turning], dtype=object), np.array([*by_v, *nothing], dtype=object)

        self.frame.stages.lanes(of_column, names, ("g_q", "g_v"))

    def minus_wrenches(self, wrenches: Array, carriers: Array) -> Array:
        """What contacts do to the body of a column, with the other sign.

        Args:
            wrenches: Of each contact, about the origin of the common frame, shape (6 contacts,) [N, N m].
            carriers: Of each contact whether the column is that of its body, shape (contacts,).

        Returns:
            Force and moment, shape (6,) [N, N m].
        """
        parts = (wrenches[6 * k : 6 * k + 6] * carriers[k] for k in range(len(self.frame_pairs)))
        return -sum(parts, np.zeros(6))

    def column_answer(self, table: Array, column: Array) -> Array:
        """Changes of accelerations and forces; see forward_dynamics_derivatives.py.

        Args:
            table: The factors of the mass matrix, then `shared`.
            column: A column of r, g, and what is added to the forces, shape (nv + 2 m,).

        Returns:
            The changes, shape (nv + m,).
        """
        start = row_places(self.frame.paths)[1] + self.frame.model.nv
        entries = iter(table[start:])
        Y = [{int(j): next(entries) for j in np.flatnonzero(row)} for row in self.rows_moved]
        S = np.zeros((self.size, self.size), dtype=object)
        for i in range(self.size):
            for j in range(i + 1):
                S[i, j] = S[j, i] = next(entries)
        return np.array(BoundSolver(self.factors(table[:start]), Y, S).answer(list(column)), dtype=object)

    def factors(self, table: Array) -> Factors:
        """The factors of the mass matrix from their rows."""
        return factors_in_rows(table, self.frame.paths)

    def turned(self, turns: Array, forces: Array) -> Array:
        """Forces along the axes of their contacts.

        Args:
            turns: As from `poses`.
            forces: Forces along the axes of C, shape (m,) [N, N m].

        Returns:
            Shape (m,) [N, N m].
        """
        entries: list[Any] = []
        for k, frame_pair in enumerate(self.frame_pairs):
            rest = turns[_POSE * k + 12 :][:9].reshape(3, 3)
            for start in range(self._start(k), self._start(k) + frame_pair.size, 3):
                part = forces[start : start + 3]
                entries += list(apply(rest, part) if frame_pair.local else part)
        return np.array(entries, dtype=object)

    def _start(self, k: int) -> int:
        """The first row of a contact."""
        return sum(frame_pair.size for frame_pair in self.frame_pairs[:k])

    def _pose(self, turns: Array, k: int) -> tuple[Array, Array]:
        """C and p of a contact."""
        row = turns[_POSE * k :]
        return row[:9].reshape(3, 3), row[9:12]
