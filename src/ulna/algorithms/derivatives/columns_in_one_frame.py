"""The dynamics of a tree in one common frame, as stages that compute many columns at a time.

| symbol | meaning | shape | unit |
|---|---|---|---|
| T | pose of the moving frame of a step in the common frame | SE3 | [m] |
| s | a column of a motion subspace | Motion | |
| U, V | twist of the parent and of the body of a step | Motion | [m/s, rad/s] |
| C, A | acceleration of the same two, gravity taken off | Motion | |
| dU, dC | V - U and A - C of roots with several columns, zero for all other columns | Motion | |
| psi, chi, phi | motion that s causes outward, as in inverse_dynamics.py | Motion | |
| c, I, h, D, F | first and second moment, momentum, rate of I, and force of a body, or of all from a step outward | | |
| external | what the surroundings exert on a body; F is less by it | Force | [N, N m] |
| r, t, y, z | what a column does to forces, as in inverse_dynamics.py | Force, t: (3) | |

Seen from one frame, columns do not travel from body to body: what all bodies from a step outward have is a plain sum,
and an entry of a matrix is a scalar product of two columns. All else is the same for every column, so a SIMD register
of columns is computed at once. Only poses, twists, accelerations and sums follow the tree.

Where a step has one column, psi = V x s = U x s and chi = A x s + V x psi, since what the step itself adds cancels; so
U and C are needed for roots of several columns only, as a floating base is.

The common frame is the moving frame of a floating base, as seen by somebody who moves on evenly with its origin, so
that numbers stay small wherever the robot is; of a robot that stands fixed it is the world. The equations are those of
inverse_dynamics.py for an observer at rest in that frame (u = 0).

Source: Singh, Russell & Wensing, Efficient Analytical Derivatives of Rigid-Body Dynamics using Spatial Vector Algebra
(2022), who write all of it in the world's frame.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ulna.algorithms.derivatives.inverse_dynamics import State, Subtree, states_of_moving_observers
from ulna.algorithms.dynamics.mass_matrix_factors import rows_of_factors
from ulna.algorithms.multibody.chain_frames import (
    PADDING,
    ChainFrames,
    chain_frames,
    pose_numbers,
    pose_of,
)
from ulna.algorithms.multibody.chain_walks import (
    motion,
    placed,
    screw,
    walk_of_accelerations,
    walk_of_poses,
    walk_of_twists,
)
from ulna.algorithms.multibody.mass_moments import UPPER, MassMoments, symmetric
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.algorithms.multibody.tree import shares_velocities, steps
from ulna.compiler.forms.scans import Walk, sums
from ulna.compiler.forms.stages import PairFunction, Stages
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array

_LONG = 24
"""Velocities from which on poses of serial chains are computed in segments."""


def suits_one_frame(model: Model) -> bool:
    """Whether all joints but those at the root have one degree of freedom, and no two steps share a velocity."""
    tree = steps(model)  # link frames are not chosen for it, which takes 15 ms for a humanoid
    if shares_velocities(model) or not tree:
        return False
    return all(step.kind.nv == 1 or step.parent < 0 for step in tree)


def caused_motions(
    s: Array, psi: Array, V: Array, dU: Array, A: Array, dC: Array
) -> tuple[Motion, Motion, Motion]:
    """The motion s of a column, and what it causes outward: psi, and chi = C x s + U x psi.

    Args:
        s: The column, (6,).
        psi: What it causes of velocity, (6,).
        V: The twist of its body, (6,).
        dU: V - U, (6,).
        A: The acceleration of its body, (6,).
        dC: A - C, (6,).

    Returns:
        The three motions.
    """
    column, caused = motion(s), motion(psi)
    return column, caused, motion(A - dC).cross(column) + motion(V - dU).cross(caused)


class OneFrame:
    """The stages of a robot; the names of tables are those of the table above.

    Args:
        name: The name of the function.
        model: A robot that suits (`suits_one_frame`).
        **inputs: The shape of each input of the function.
    """

    def __init__(self, name: str, model: Model, **inputs: tuple[int, ...]) -> None:
        self.model, self.prepared = model, prepare(model)
        self.tree = self.prepared.tree
        self.stages = Stages(name, model.nv, **inputs)
        self._gravity = np.zeros(3)
        roots = [step for step in self.tree if step.parent < 0]
        self.is_floating = len(roots) == 1 and roots[0].kind.nv > 1
        """Whether the common frame is that of the only root."""

    @cached_property
    def movers(self) -> list[list[int]]:
        """For each column those columns of other joints that move it."""
        of_steps: list[list[int]] = []
        movers_of_columns: list[list[int]] = [[] for _ in range(self.model.nv)]
        for step in self.tree:
            before = of_steps[step.parent] if step.parent >= 0 else []
            of_steps.append([*before, *step.indices])
            for k in step.indices:
                movers_of_columns[k] = before
        return movers_of_columns

    @cached_property
    def joints(self) -> list[int]:
        """For each column the number of its step."""
        numbers = [0] * self.model.nv
        for number, step in enumerate(self.tree):
            for k in step.indices:
                numbers[k] = number
        return numbers

    @cached_property
    def unit_columns(self) -> dict[int, int]:
        """The columns of a floating base that are unit vectors, and which ones: they move all other columns."""
        unit_rows: dict[int, int] = {}
        for k, s in self.tree[0].columns() if self.is_floating else ():
            row = np.asarray(numbers(s), dtype=float)
            if row.max() == 1.0 and np.count_nonzero(row) == 1:
                unit_rows[k] = int(row.argmax())
        return unit_rows

    @cached_property
    def moves_all_evenly(self) -> Array:
        """For each column whether it moves a floating base, and with it the robot, without turning it."""
        found = np.zeros(self.model.nv, dtype=bool)
        for k, s in self.tree[0].columns() if self.is_floating else ():
            found[k] = not np.asarray(s.angular, dtype=float).any()
        return found

    def unrelated(self, by_q: bool = False) -> Array:
        """Which entries of a matrix of pairs are zero: those of columns of which neither moves the other.

        Args:
            by_q: Whether the matrix is a derivative with respect to q of what is the same everywhere.

        Returns:
            The answers, shape (nv, nv).
        """
        joints = np.array(self.joints)
        related = joints[:, None] == joints
        for k, movers in enumerate(self.movers):
            related[k, movers] = related[movers, k] = True
        return ~related | self.moves_all_evenly if by_q else ~related

    def kinematics(self) -> None:
        """T, s, V and dU from q and v; the constants of bodies."""
        self._bodies()
        self.stages.straight(self._kinematics, ("q", "v"), ("T", "s", "V", "dU"))

    def poses(self) -> None:
        """T and s from q; the constants of bodies."""
        self._bodies()
        still = np.zeros(self.model.nv)
        self.stages.straight(lambda q: self._kinematics(q, still)[:2], ("q",), ("T", "s"))

    def moments(self, are_sums: bool = False) -> None:
        """s from q, and c and I of every body, `own`, or of all from a step outward, `sums`; the constants of bodies.

        Args:
            are_sums: Whether they are those of all bodies from a step outward.
        """
        chain = self._chain_in_segments()
        if chain is None:
            self.poses()
            self.composite_moments() if are_sums else self.body_moments("own")
            return

        def of_body(segment: Array, local: Array, bodies: Array) -> tuple[Array, Array]:
            T = placed(segment, local)
            return screw(T), moment_numbers(moments(bodies[0], bodies[1:]).to_outer_frame(T))

        def outward(state: Array, *read: Array) -> tuple[Array, ...]:
            s, own = of_body(*read)
            return state + own, s, state + own

        read = ("segment", "local", "bodies")
        if are_sums:
            summed = Walk(outward, read, ("s", "own"), sums(9), "own_before", is_inward=True)
            self._walk_along(chain, (summed, _total("own_before", "own", "sums")), ("s", "sums"))
        else:
            self._walk_along(chain, (Walk(of_body, read, ("s", "own")),), ("s", "own"))

    def dynamics_in_segments(self, a: str = "") -> bool:
        """s, V, psi, A, own and sums of long chains of revolute joints; dU and dC are zero.

        Args:
            a: The name of the joint accelerations; empty for zero.

        Returns:
            Whether the robot is such a chain; nothing is done where it is not.
        """
        chain = self._chain_in_segments()
        if chain is None:
            return False

        def of_body(
            state: Array, A_before: Array, A_local: Array, V: Array, T: Array, bodies: Array
        ) -> tuple[Array, ...]:
            A = A_before + A_local
            rows, own = _moments_and_rates(T, bodies, V, A)
            return state + rows, state + rows, own, A

        reads = ("A_before", "A_local", "V", "T", "bodies")
        walks = (
            walk_of_twists(),
            walk_of_accelerations(self.model.gravity, a, with_psi=True),
            Walk(of_body, reads, ("own_sums", "own", "A"), sums(27), "sums_before", is_inward=True),
            _total("sums_before", "own_sums", "sums"),
        )
        self._walk_along(chain, walks, ("s", "V", "psi", "A", "own", "sums"))
        for name in ("dU", "dC"):
            self.stages.constant(name, np.zeros((6, self.model.nv)))
        return True

    def _chain_in_segments(self) -> ChainFrames | None:
        """The frames of a long chain of revolute joints, which become those of this robot; None for other robots.

        Nothing may have been taken from the tree or the prepared model before.
        """
        chain = chain_frames(self.model) if self.model.nv >= _LONG else None
        if chain is not None:
            self.prepared = PreparedModel(self.model, chain.links.tree, chain.links.frames)
            self.tree = self.prepared.tree
            self._bodies()
        return chain

    def _walk_along(self, chain: ChainFrames, walks: Sequence[Walk], tables: Sequence[str]) -> None:
        """A scan of a chain, after the walk for its poses, seen from the origin of its first frame."""
        known = {"numbers": chain.numbers, "bodies": self._body_columns()}
        inputs = {name for walk in walks for name in walk.reads} & {"v", "a"}
        vectors = {"q": chain.first_q, **dict.fromkeys(sorted(inputs), 0)}
        start = (*chain.start[:9], 0.0, 0.0, 0.0)  # digits do not depend on where the robot stands
        walks = (walk_of_poses(chain, pose_numbers, start), *walks)
        self.stages.scan(walks, known, {"numbers": PADDING}, vectors, tables)

    def _body_columns(self) -> Array:
        """m, c and I of every body in its own frame, in the last column of its step, (10, nv)."""
        bodies = np.zeros((10, self.model.nv))
        for step, body in zip(self.tree, self.prepared.regrouped_moments, strict=True):
            bodies[:, step.indices[-1]] = [body.mass, *body.first, *(body.second[i, j] for i, j in UPPER)]
        return bodies

    def _bodies(self) -> None:
        mass = np.zeros((1, self.model.nv))
        for step, total in zip(self.tree, self._subtree_masses(), strict=True):
            mass[0, list(step.indices)] = total
        self.stages.constant("bodies", self._body_columns())
        self.stages.constant("mass", mass)

    def center_of_mass(self, share: float) -> None:
        """c_G, and R from the axes of the common frame to those of the world.

        Args:
            share: The reciprocal of the robot's mass [1/kg].
        """
        heavy = np.zeros((4, self.model.nv))
        for step, body in zip(self.tree, self.prepared.body_moments, strict=True):
            heavy[:, step.indices[-1]] = [body.mass, *body.first]
        self.stages.constant("heavy", heavy)

        def first_moment(T: Array, heavy: Array) -> Array:
            return apply(T[:9].reshape(3, 3), heavy[1:]) + T[9:] * heavy[0]

        self.stages.lanes(first_moment, ("T", "heavy"), ("moments",))
        self.stages.straight(lambda moments: moments.sum(axis=1) * share, ("moments",), ("c_G",))
        self.stages.straight(lambda q: self.rotation(q).reshape(-1), ("q",), ("R",))

    def rotation(self, q: Array) -> Array:
        """R from the axes of the common frame to those of the world.

        Args:
            q: Configuration, shape (nq,) [rad, m].

        Returns:
            The rotation, shape (3, 3).
        """
        return self.tree[0].pose(None, q).rotation if self.is_floating else np.eye(3)

    def accelerations(self, a: str = "", gravity: bool = True) -> None:
        """psi, A and dC.

        Args:
            a: The name of the joint accelerations; empty for zero.
            gravity: Whether that of free fall is subtracted.
        """
        self._gravity = np.asarray(self.model.gravity) if gravity else np.zeros(3)
        self.stages.lanes(
            lambda s, V, dU: numbers(motion(V - dU).cross(motion(s))), ("s", "V", "dU"), ("psi",)
        )
        if a:
            self.stages.straight(self._accelerations, ("q", "v", a, "s", "psi"), ("A", "dC"))
            return
        zero = np.zeros(self.model.nv)
        self.stages.straight(
            lambda q, v, s, psi: self._accelerations(q, v, zero, s, psi), ("q", "v", "s", "psi"), ("A", "dC")
        )

    def carrier(self, joint: int) -> int:
        """The number of the step that carries the body of a joint of the model.

        Args:
            joint: The number of the joint.

        Returns:
            The number of the step.
        """
        carried = self.model.joints[joint]
        return next(i for i, step in enumerate(self.tree) if step.is_last and step.joint is carried)

    def external_forces(self, frames: Sequence[str], reference: Reference = "local") -> tuple[str, ...]:
        """`external` of every body, in the last column of its step, from the input `f_ext`.

        Args:
            frames: Names of the frames that the rows of `f_ext` act on; without any, there is no such table.
            reference: In whose axes, and about which point, the rows are written.

        Returns:
            The name of the table, or none.

        Raises:
            UnknownName: If there is no such frame or reference.
        """
        if not frames:
            return ()
        check_reference(reference)
        acting = [(k, frame) for k, frame in enumerate(map(self.model.frame, frames)) if frame.joint >= 0]

        def of_bodies(q: Array, T: Array, f_ext: Array) -> Array:
            f = np.zeros((6, self.model.nv), dtype=object)
            for k, frame in acting:
                number = self.carrier(frame.joint)
                column = self.tree[number].indices[-1]
                pose = pose_of(T[:, column])
                pose = pose @ self.prepared.frames[number].inverse() @ frame.placement
                wrench = Force(f_ext[k, :3], f_ext[k, 3:])
                f[:, column] = f[:, column] + numbers(self._seen(wrench, pose, q, reference))
            return f

        self.stages.straight(of_bodies, ("q", "T", "f_ext"), ("external",))
        return ("external",)

    def _seen(self, wrench: Force, pose: SE3, q: Array, reference: Reference) -> Force:
        """A wrench at a frame of that pose, about the origin of the common frame and along its axes."""
        if reference == "local":
            return pose.act(wrench)
        if reference == "world":
            return self.tree[0].pose(None, q).act_inverse(wrench) if self.is_floating else wrench
        back = np.swapaxes(self.rotation(q), -1, -2)
        force = apply(back, wrench.linear)
        return Force(force, apply(back, wrench.angular) + cross(pose.translation, force))

    def subtrees(self, with_forces: bool = True, external: Sequence[str] = ()) -> None:
        """c, I, h, D and F of all bodies from a step outward, one below the other: `sums`; of each body c and I: `own`.

        Args:
            with_forces: Whether F is there.
            external: The name of the table of external forces, if there is one.
        """
        reads = ("T", "bodies", "V", "A", *external) if with_forces else ("T", "bodies", "V")
        self.stages.lanes(_moments_and_rates, reads, ("sums", "own"))
        self.stages.rows(self.summed, ("sums",), "sums")

    def moments_and_forces(self, external: Sequence[str] = ()) -> None:
        """c, I and F of all bodies from a step outward, one below the other: `sums`.

        Args:
            external: The name of the table of external forces, if there is one.
        """

        def of_body(T: Array, bodies: Array, V: Array, A: Array, *f: Array) -> Array:
            body = moments(bodies[0], bodies[1:]).to_outer_frame(pose_of(T))
            F = numbers(body.apply(motion(A)) + motion(V).cross(body.apply(motion(V)))) - sum(f)
            return np.array([*moment_numbers(body), *F], dtype=object)

        self.stages.lanes(of_body, ("T", "bodies", "V", "A", *external), ("sums",))
        self.stages.rows(self.summed, ("sums",), "sums")

    def composite_moments(self) -> None:
        """c and I of all bodies from a step outward, one below the other: `sums`."""
        self.body_moments("sums")
        self.stages.rows(self.summed, ("sums",), "sums")

    def responses(self) -> None:
        """r of every column, from c and I."""

        def of_column(s: Array, sums: Array, mass: Array) -> Array:
            body = subtree(mass, np.concatenate([sums, np.zeros(18)])).body
            return numbers(body.apply(motion(s)))

        self.stages.lanes(of_column, ("s", "sums", "mass"), ("r",))

    def body_moments(self, name: str) -> None:
        """c and I of every body, one below the other, in the last columns of their steps.

        Args:
            name: What the table is called.
        """

        def of_body(T: Array, bodies: Array) -> Array:
            body = moments(bodies[0], bodies[1:]).to_outer_frame(pose_of(T))
            return moment_numbers(body)

        self.stages.lanes(of_body, ("T", "bodies"), (name,))

    def summed(self, of_bodies: Array) -> Array:
        """The sums over all bodies from a step outward.

        Args:
            of_bodies: A number of each body, shape (columns), in the last columns of their steps.

        Returns:
            The sums, in every column of a step, shape (columns).
        """
        totals = np.zeros(self.model.nv, dtype=object)
        sums: list[Any] = [0.0] * len(self.tree)
        for i, step in reversed(list(enumerate(self.tree))):
            total = of_bodies[step.indices[-1]] + sums[i]
            totals[list(step.indices)] = total
            if step.parent >= 0:
                sums[step.parent] = sums[step.parent] + total
        return totals

    def columns(self, forces: str = "") -> None:
        """r, t, y and z of every column, and psi, chi and phi beside it.

        Args:
            forces: The name of a table of further forces of all bodies from a step outward.
        """
        carried = [[0.0 if self.tree[joint].parent < 0 else 1.0 for joint in self.joints]]
        self.stages.constant("carried", carried)

        def of_column(
            s: Array,
            psi: Array,
            V: Array,
            dU: Array,
            A: Array,
            dC: Array,
            sums: Array,
            mass: Array,
            carried: Array,
            *more: Array,
        ) -> tuple[Array, ...]:
            column, caused, chi = caused_motions(s, psi, V, dU, A, dC)
            phi = motion(V).cross(column) + caused
            outward = subtree(mass, np.concatenate([sums[:21], sum(more, sums[21:])]))
            r, t = outward.body.apply(column), outward.coriolis_transposed(column)
            y = outward.coriolis(column) + outward.body.apply(phi)
            z = outward.coriolis(caused) + outward.body.apply(chi)
            z = z + column.cross(outward.F) * carried[0]
            return numbers(chi), numbers(phi), numbers(r), t, numbers(y), numbers(z)

        reads = ("s", "psi", "V", "dU", "A", "dC", "sums", "mass", "carried", *([forces] if forces else []))
        self.stages.lanes(of_column, reads, ("chi", "phi", "r", "t", "y", "z"))

    @cached_property
    def paths(self) -> list[list[int]]:
        """For each column the columns before it that move it, or belong to its joint."""
        movers, joints, n = self.movers, self.joints, self.model.nv
        return [
            sorted({*movers[k], *(j for j in range(k) if joints[j] == joints[k])} & set(range(k)))
            for k in range(n)
        ]

    def factors(self) -> None:
        """The rows of the factors of the mass matrix, and the reciprocals of its pivots, from s and r."""
        self.mass_matrix("M", is_half=True)
        self.stages.straight(lambda M: rows_of_factors(M, self.paths), ("M",), ("rows",))
        self.stages.factors(self.paths, "rows", "factors")

    def add_accelerations(self, more: Callable[..., Any] | None = None, reads: Sequence[str] = ()) -> None:
        """A and dC with the joint accelerations `a`; `dF`: what they add to forces of all bodies from a step outward.

        Args:
            more: What else is added to the force of each body, (6,), a function of columns; None for nothing.
            reads: Names of the tables and vectors that it takes.
        """
        has_several = any(len(step.indices) > 1 for step in self.tree)

        def added(A: Array, s: Array, a: Array, *of_roots: Array) -> tuple[Array, ...]:
            dA = np.zeros((6, self.model.nv), dtype=object)
            changes: list[Array] = []
            for step in self.tree:
                own = sum((s[:, k] * a[k] for k in step.indices), np.zeros(6))
                changes.append(changes[step.parent] + own if step.parent >= 0 else own)
                for k in step.indices:
                    dA[:, k] = changes[-1]
                    A[:, k] = A[:, k] + changes[-1]
                    for dC in of_roots if len(step.indices) > 1 else ():
                        dC[:, k] = dC[:, k] + own
            return A, dA, *of_roots

        def force(own: Array, bodies: Array, dA: Array, *others: Array) -> Array:
            moments = subtree(bodies[:1], np.concatenate([own, np.zeros(18)])).body
            wrench = numbers(moments.apply(motion(dA)))
            return wrench if more is None else wrench + more(*others)

        of_roots = ("dC",) if has_several else ()  # of all other columns it is zero
        self.stages.straight(added, ("A", "s", "a", *of_roots), ("A", "dA", *of_roots))
        self.stages.lanes(force, ("own", "bodies", "dA", *reads), ("dF",))
        self.stages.rows(self.summed, ("dF",), "dF")

    def torque_derivatives(self, by_q: str, by_v: str, mass: str = "") -> None:
        """The derivatives of the torques with respect to q and v, and the mass matrix, that with respect to a.

        Args:
            by_q: What the first is called.
            by_v: What the second is called.
            mass: What the mass matrix is called; empty to leave it out.
        """

        def below(s: Array, z: Array, y: Array, r: Array | None = None) -> tuple[Any, ...]:
            return dot(z, s), dot(y, s), *(() if r is None else (dot(r, s),))

        def above(r: Array, t: Array, s: Array, psi: Array, chi: Array, phi: Array) -> tuple[Any, ...]:
            with_mass = (dot(r, s),) if mass else ()
            return dot(r, chi) + dot(t, psi[3:]), dot(r, phi) + dot(t, s[3:]), *with_mass

        writes: dict[str, Sequence[float] | None] = {by_q: None, by_v: None}
        if mass:
            writes[mass] = [float(x) for x in self.model.armature]
        self.matrices(
            (below, ("s",), ("z", "y", "r") if mass else ("z", "y")),
            (above, ("r", "t"), ("s", "psi", "chi", "phi")),
            writes,
        )

    def mass_matrix(self, M: str, is_half: bool = False) -> None:
        """M from s and r.

        Args:
            M: What it is called.
            is_half: Whether only what is needed to factor it is computed.
        """

        def entry(x: Array, y: Array) -> tuple[Any, ...]:
            return (dot(x, y),)

        below, above = (entry, ("s",), ("r",)), (entry, ("r",), ("s",))
        self.matrices(below, above, {M: [float(x) for x in self.model.armature]}, is_half)

    def matrices(
        self,
        below: PairFunction,
        above: PairFunction,
        writes: Mapping[str, Sequence[float] | None],
        is_half: bool = False,
    ) -> None:
        """Matrices of pairs of columns; see `ulna.compiler.forms.stages.Pairs`.

        Args:
            below: Has s as its own column, and scalar products with it as results, in the order of the other tables.
            above: For columns that move the own one.
            writes: Names of the matrices, and what is added to their diagonals.
            is_half: Whether only what is needed to factor them is computed.
        """
        copies = {} if is_half else self.unit_columns
        self.stages.pairs(below, above, self.movers, self.joints, writes, copies, is_half)

    def _subtree_masses(self) -> list[float]:
        masses = [float(body.mass) for body in self.prepared.regrouped_moments]
        for i, step in reversed(list(enumerate(self.tree))):
            if step.parent >= 0:
                masses[step.parent] += masses[i]
        return masses

    def _root_state(self, q: Array, v: Array, a: Array) -> State:
        """The state of a floating base, as somebody sees it who moves on evenly with its origin."""
        return states_of_moving_observers(self.tree, q, v, a, self._gravity)(0)

    def _kinematics(self, q: Array, v: Array) -> tuple[Array, ...]:
        T, s, V, dU = (np.zeros((rows, self.model.nv), dtype=object) for rows in (12, 6, 6, 6))
        poses: list[SE3] = []
        twists: list[Motion] = []
        for step in self.tree:
            if step.parent < 0 and self.is_floating:
                root = self._root_state(q, v, np.zeros(self.model.nv))
                pose, twist = SE3.identity(), root.V
                dU[:, list(step.indices)] = numbers(root.V - root.U)[:, None]
            else:
                pose = step.pose(poses[step.parent] if step.parent >= 0 else None, q)
                twist = twists[step.parent] if step.parent >= 0 else Motion.zero()
                for k, column in step.columns():
                    twist = twist + pose.act(column) * v[k]
                if len(step.indices) > 1:  # one of several roots, whose parent is at rest
                    dU[:, list(step.indices)] = numbers(twist)[:, None]
            poses.append(pose)
            twists.append(twist)
            for k, column in step.columns():
                T[:, k] = [*pose.rotation.reshape(-1), *pose.translation]
                s[:, k], V[:, k] = numbers(pose.act(column)), numbers(twist)
        return T, s, V, dU

    def _accelerations(self, q: Array, v: Array, a: Array, s: Array, psi: Array) -> tuple[Array, Array]:
        A, dC = (np.zeros((6, self.model.nv), dtype=object) for _ in range(2))
        accelerations: list[Array] = []
        for step in self.tree:
            if step.parent < 0 and self.is_floating:
                root = self._root_state(q, v, a)
                after = numbers(root.A)
                dC[:, list(step.indices)] = (after - numbers(root.C))[:, None]
            else:
                at_rest = np.concatenate([-self._gravity, np.zeros(3)])
                after = accelerations[step.parent] if step.parent >= 0 else at_rest
                for k in step.indices:
                    after = after + (s[:, k] * a[k] + psi[:, k] * v[k])
                if len(step.indices) > 1:
                    dC[:, list(step.indices)] = (after - at_rest)[:, None]
            accelerations.append(after)
            for k in step.indices:
                A[:, k] = after
        return A, dC


def _moments_and_rates(
    T: Array, bodies: Array, V: Array, A: Array | None = None, *external: Array
) -> tuple[Array, Array]:
    """c, I, h, D and, where there is an acceleration, F of a body; and c and I alone."""
    body = moments(bodies[0], bodies[1:]).to_outer_frame(pose_of(T))
    h = body.apply(motion(V))
    F = [] if A is None else numbers(body.apply(motion(A)) + motion(V).cross(h)) - sum(external)
    own = moment_numbers(body)
    return np.array([*own, *numbers(h), *_upper(body.rate(motion(V))), *F], dtype=object), own


def _total(before: str, local: str, name: str) -> Walk:
    """The walk that adds what is summed before a segment and along it."""
    return Walk(lambda x, y: x + y, (before, local), (name,))


def subtree(mass: Array, sums: Array) -> Subtree:
    """The quantities of all bodies from a step outward.

    Args:
        mass: Shape (1,) [kg].
        sums: Shape (27,), as `OneFrame.subtrees` has them.

    Returns:
        The same by name.
    """
    second, rate = ([sums[k + j] for j in range(6)] for k in (3, 15))
    return Subtree(
        MassMoments(mass[0], sums[:3], symmetric(second)),
        Force(sums[9:12], sums[12:15]),
        symmetric(rate),
        Force(sums[21:24], sums[24:]),
    )


def moments(mass: Any, numbers: Array) -> MassMoments:
    """Mass moments from their numbers.

    Args:
        mass: The mass [kg].
        numbers: First moment and upper triangle of the second, shape (9,) [kg m, kg m^2].

    Returns:
        The same by name.
    """
    return MassMoments(mass, numbers[:3], symmetric(list(numbers[3:])))


def moment_numbers(body: MassMoments) -> Array:
    """The first moment and the upper triangle of the second, shape (9,)."""
    return np.array([*body.first, *_upper(body.second)], dtype=object)


def about(force: Force, c: Array, R: Array) -> Array:
    """A force about a point, along other axes.

    Args:
        force: A force about the origin [N, N m].
        c: The point, shape (3,) [m].
        R: The rotation to the other axes, shape (3, 3).

    Returns:
        Shape (6,), linear part first.
    """
    moment = force.angular - cross(c, force.linear)
    return np.concatenate([apply(R, force.linear), apply(R, moment)])


def numbers(x: Motion | Force) -> Array:
    """Six numbers, linear part first."""
    return np.concatenate([x.linear, x.angular])


def _upper(matrix: Array) -> list[Any]:
    return [matrix[i, j] for i, j in UPPER]
