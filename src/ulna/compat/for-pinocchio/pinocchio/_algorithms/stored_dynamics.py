"""The inverse mass matrix and derivatives of forward dynamics at the last aba, out of a Data's fields as they are.

| symbol | meaning |
|---|---|
| J_i | columns of joint i of the Jacobian in the world |
| V_i, A_i, h_i | its twist, its acceleration relative to free fall, and the momentum of its body, in the world |
| Y_i, B_i | inertia of a body about the world's origin; V x* Y - Y V x + (. x* h), twice that of `Rates` |
| U_i, D_i | articulated inertia times the subspace; inertia that the joint feels, its armature included |
| P_k, Q_k, R_k | accelerations by the coordinate of column k, and by its rate; twists by the coordinate |

Where no field was written to, what follows from q, v and a by Ulna's own algorithms is right, and takes less time: a
kernel compares the fields with these. Else the recursions run with the fields in place of what they stand for.

Sources: Carpentier, Analytical inverse of the joint space inertia matrix (2018); Carpentier and Mansard, Analytical
Derivatives of Rigid Body Dynamics Algorithms (2018), section III.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from pinocchio._algorithms.of_fields import OfFields
from pinocchio._algorithms.stored_derivatives import Rates, Tree
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.compiled_fields import split_forces
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import checked_forces
from pinocchio._spatial.small_kernels import as_force, as_motion
from ulna import algorithms
from ulna.algorithms.derivatives.forward_dynamics import derivatives_at_acceleration
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.mass_moments import MassMoments
from ulna.compiler.runtime.repeated_calls import CallCache, call_cache
from ulna.model import Model as CoreModel
from ulna.numeric import less, minimum, where
from ulna.quantities.mass import with_mass
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array

_TINY = 1e-300
_TOLERANCE = 1e-24
"""Squares of relative differences of a field from what was computed, above which it was written to: 1e-12."""
_LEAST = 1e-28
"""The same for absolute ones, for what is zero but for rounding."""


class _Stored(NamedTuple):
    """A field as it is where it is of the state that counts, else what it is of that state."""

    values: Array
    margin: Any
    """Above zero where it differs by rounding alone."""

    @classmethod
    def of(
        cls, x: dict[str, Array], field: str, state: str, own: dict[str, Array], expected: Array
    ) -> _Stored:
        """That of inputs (...).

        Args:
            x: The inputs by their names.
            field: The name of the field.
            state: The name of its state.
            own: The state that counts, by letters.
            expected: What the field is of that state.

        Returns:
            The field.
        """
        gaps = [x[f"mark of {field}"] ** 2, *(_square(x[f"{state} {k}"] - y) for k, y in own.items())]
        counts = less(sum(gaps), _TINY)
        if field == "oh":
            counts = less(where(less(x["subtree momenta"], 2.0), 1.0, sum(gaps)), _TINY)
        values = x[field][len(x[field]) - len(expected) :]
        margin = _TOLERANCE * _square(expected) + _LEAST - _square(values - expected)
        return cls(where(counts, values, expected), where(counts, margin, 1.0))


def _square(values: Array) -> Any:
    """The sum of the squares of all entries."""
    flat = np.reshape(values, -1)
    return flat @ flat


def _columns(core: CoreModel, x: dict[str, Array], q: Array) -> _Stored:
    """`J`, where it is of q."""
    return _Stored.of(x, "J", "jacobians", {"q": q}, algorithms.joint_jacobians(core, q))


def _inverse(core: CoreModel) -> Any:
    def run(x: dict[str, Array]) -> tuple[Any, ...]:
        q = x["articulated q"]
        return algorithms.inverse_mass_matrix(core, q), _columns(core, x, q).margin

    return run


def _inverse_with_columns(core: CoreModel) -> Any:
    tree = Tree.of(core)

    def run(x: dict[str, Array]) -> tuple[Array]:
        q = x["articulated q"]
        return (_Articulated.of(core, tree, q).inverse(tree, _columns(core, x, q).values),)

    return run


def _bodies(core: CoreModel, poses: Sequence[SE3]) -> list[MassMoments]:
    """The inertia of the body of each joint about the world's origin."""
    return [MassMoments.of_body(Y).to_outer_frame(T) for Y, T in zip(core.inertias, poses, strict=True)]


class _Articulated(NamedTuple):
    """U, D^-1 and U D^-1 of each joint, the universe first, in the world."""

    U: list[Array]
    Dinv: list[Array]
    UDinv: list[Array]

    @classmethod
    def of(cls, core: CoreModel, tree: Tree, q: Array) -> _Articulated:
        """Those of a configuration (nq,)."""
        J = algorithms.joint_jacobians(core, q)
        inertias = [Y.matrix() for Y in _bodies(core, algorithms.joint_poses(core, q))]
        none = np.zeros((6, 0))
        terms: list[tuple[Array, Array, Array]] = [(none, none, none)] * len(tree.parents)
        for i in range(len(inertias), 0, -1):
            own, S = inertias[i - 1], J[:, tree.entries[i]]
            U = own @ S
            D = S.T @ U + np.diag(np.asarray(core.armature)[tree.entries[i]])
            Dinv = Factors(D).inverse()
            UDinv = U @ Dinv
            terms[i] = U, Dinv, UDinv
            p = tree.parents[i]
            if p:
                inertias[p - 1] = inertias[p - 1] + own - UDinv @ U.T
        return cls(*(list(part) for part in zip(*terms, strict=True)))

    def inverse(self, tree: Tree, J: Array) -> Array:
        """The inverse of the mass matrix, where the columns of the joints are those of J (6, nv)."""
        n = J.shape[1]
        Minv, F = batch_zeros((n, n), J[0]), batch_zeros((6, n), J[0])
        for i in range(len(tree.parents) - 1, 0, -1):
            own, moved = tree.entries[i], _moved(tree, i)
            Minv[np.ix_(own, own)] = self.Dinv[i]
            back = J[:, own] @ self.Dinv[i]
            for c in moved[len(own) :]:
                Minv[own, c] = -(back.T @ F[:, c])
            for c in moved if tree.parents[i] else ():
                F[:, c] = F[:, c] + self.U[i] @ Minv[own, c]
        motions: list[Any] = [None] * len(tree.parents)
        for i in range(1, len(tree.parents)):
            own, before = tree.entries[i], motions[tree.parents[i]]
            motions[i] = batch_zeros((6, n), J[0])
            for c in range(own.start, n):
                if before is not None:
                    Minv[own, c] = Minv[own, c] - self.UDinv[i].T @ before[:, c]
                motions[i][:, c] = J[:, own] @ Minv[own, c] + (0.0 if before is None else before[:, c])
        for k in range(n):
            Minv[k, :k] = Minv[:k, k]
        return Minv


def _moved(tree: Tree, joint: int) -> list[int]:
    """The entries of v of what a joint moves, its own first."""
    joints = [i for i in range(joint, len(tree.parents)) if i == joint or joint in tree.ancestors(i)]
    return [k for i in joints for k in tree.entries[i]]


_FORWARD = tuple(f"forward_dynamics {x}" for x in "qva")


class _State(NamedTuple):
    """What derivatives read: columns, and twist, acceleration and momentum of each joint, that of the base for A."""

    J: _Stored
    V: _Stored
    A: _Stored
    h: _Stored

    @classmethod
    def of(cls, core: CoreModel, x: dict[str, Array], poses: Sequence[SE3]) -> _State:
        """Those of inputs (...) by their names, and of the poses of the joints at the q that counts."""
        q, v, a = (x[name] for name in _FORWARD)
        moving = {"q": q, "v": v}
        local = algorithms.joint_velocities(core, q, v)
        twists = [T.act(one) for T, one in zip(poses, local, strict=True)]
        momenta = [T.act(Y.apply(one)) for T, Y, one in zip(poses, core.inertias, local, strict=True)]
        with_gravity = [Motion(-np.asarray(core.gravity), np.zeros(3))]
        for T, one in zip(poses, algorithms.joint_accelerations(core, q, v, a), strict=True):
            with_gravity.append(with_gravity[0] + T.act(one))
        return cls(
            _columns(core, x, q),
            _Stored.of(x, "ov", "velocities", moving, _rows(twists)),
            _Stored.of(x, "oa_gf", "accelerations_with_gravity", {**moving, "a": a}, _rows(with_gravity)),
            _Stored.of(x, "oh", "momenta", moving, _rows(momenta)),
        )

    def margin(self) -> Any:
        """Above zero where no field differs by more than rounding."""
        return reduce(minimum, (stored.margin for stored in self))


def _rows(values: Sequence[Any]) -> Array:
    return np.stack([one.vector() for one in values])


def _derivatives(core: CoreModel) -> Any:
    def run(x: dict[str, Array]) -> tuple[Any, ...]:
        q, v, a = (x[name] for name in _FORWARD)
        forces = split_forces(x["forward_dynamics f"]) if "forward_dynamics f" in x else None
        by_q, by_v, inverse, tau_q, tau_v = derivatives_at_acceleration(core, q, v, a, forces)
        margin = _State.of(core, x, algorithms.joint_poses(core, q)).margin()
        rate = algorithms.joint_jacobians_dot(core, q, v)
        return by_q, by_v, inverse, inverse, tau_q, tau_v, rate, margin

    return run


class _Sweep:
    """Derivatives of inverse dynamics, and the columns that they are made of, out of fields."""

    def __init__(
        self, tree: Tree, state: _State, bodies: Sequence[MassMoments], forces: Sequence[Force]
    ) -> None:
        """Sums over what each joint moves, and the columns of accelerations.

        Args:
            tree: The joints.
            state: The fields.
            bodies: The inertias about the world's origin.
            forces: Those on the bodies from outside, in the world.
        """
        V = [as_motion(row) for row in state.V.values]
        self.A = [as_motion(row) for row in state.A.values]
        momenta = [as_force(row) for row in state.h.values]
        moving = zip(bodies, V, self.A[1:], momenta, forces, strict=True)
        through = [Y.apply(a) + v.cross(h) - f for Y, v, a, h, f in moving]
        rates = [Rates.of_body(*one) for one in zip(bodies, V, momenta, strict=True)]
        self.tree, self.V = tree, [None, *V]
        self.Y, self.B = tree.summed(bodies), tree.summed(rates, Rates.plus)
        self.F = tree.summed(through)
        self.J = [as_motion(column) for column in state.J.values.T]
        self.Q, self.P, self.R, self.dJ = ([Motion.zero()] * len(self.J) for _ in range(4))
        for i in range(1, len(tree.parents)):
            for k in tree.entries[i]:
                self._set_motions(i, k)

    def _set_motions(self, joint: int, k: int) -> None:
        """The motions that column k of a joint causes."""
        before, s = self.tree.parents[joint], self.J[k]
        self.dJ[k] = self.Q[k] = self.V[joint].cross(s)
        self.P[k] = self.A[before].cross(s)
        if before:
            self.R[k] = self.V[before].cross(s)
            self.P[k] = self.P[k] + self.V[before].cross(self.R[k])
            self.Q[k] = self.Q[k] + self.R[k]

    def columns(self, joint: int, k: int) -> tuple[Force, Force, Force]:
        """How the force on what a joint moves changes by q, v and a of column k, the axes turning with it."""
        Y, B, s = self.Y[joint], self.B[joint], self.J[k]
        by_q, by_v = Y.apply(self.P[k]), B.apply(s) + B.apply(s) + Y.apply(self.Q[k])
        if self.tree.parents[joint]:
            by_q = by_q + B.apply(self.R[k]) + B.apply(self.R[k])
        return by_q, by_v, Y.apply(s)

    def torques(self) -> tuple[Array, ...]:
        """Derivatives of the torques by q and v (nv, nv), and of forces by q, v and a (6, nv)."""
        n = len(self.J)
        by_q, by_v = (batch_zeros((n, n), self.J[0].vector()[0]) for _ in range(2))
        dF_dq, dF_dv, dF_da = ([Force.zero()] * n for _ in range(3))
        for i in range(len(self.tree.parents) - 1, 0, -1):
            own, moved = self.tree.entries[i], _moved(self.tree, i)
            for k in own:
                dF_dq[k], dF_dv[k], dF_da[k] = self.columns(i, k)
            for k in own:
                for c in moved:
                    by_q[k, c], by_v[k, c] = self.J[k].dot(dF_dq[c]), self.J[k].dot(dF_dv[c])
            for k in own:
                dF_dq[k] = dF_dq[k] + self.J[k].cross(self.F[i])
                back = self.B[i].transposed(self.J[k])
                back = back + back
                for c in (c for j in self.tree.ancestors(i) for c in self.tree.entries[j]):
                    by_q[k, c] = dF_da[k].dot(self.P[c]) + back.dot(self.R[c])
                    by_v[k, c] = dF_da[k].dot(self.Q[c]) + back.dot(self.J[c])
        return by_q, by_v, *(_rows(one).T for one in (dF_dq, dF_dv, dF_da))


def _derivatives_of_fields(core: CoreModel) -> Any:
    tree = Tree.of(core)

    def run(x: dict[str, Array]) -> tuple[Array, ...]:
        poses = algorithms.joint_poses(core, x["forward_dynamics q"])
        forces = [Force.zero()] * len(poses)
        if "forward_dynamics f" in x:
            local = map(as_force, x["forward_dynamics f"])
            forces = [T.act(one) for T, one in zip(poses, local, strict=True)]
        state = _State.of(core, x, poses)
        sweep = _Sweep(tree, state, _bodies(core, poses), forces)
        by_q, by_v, *columns = sweep.torques()
        inverse = _Articulated.of(core, tree, x["forward_dynamics q"]).inverse(tree, state.J.values)
        g = Motion(np.asarray(core.gravity), np.zeros(3))
        without_gravity = [P + g.cross(s) for P, s in zip(sweep.P, sweep.J, strict=True)]
        motions = (_rows(one).T for one in (sweep.dJ, without_gravity, sweep.Q))
        through = _rows(sweep.F[1:])
        return -(inverse @ by_q), -(inverse @ by_v), inverse, inverse, by_q, by_v, *motions, *columns, through

    return run


Algorithm("inverse_mass_of_fields", "", (), not_applicable, invalidates=("Fcrb",), title="computeMinverse")
Algorithm(
    "derivatives_of_fields", "", (), not_applicable, invalidates=("Fcrb",), title="computeABADerivatives"
)
_INVERSE: dict[str, Any] = {
    "reads": ("articulated q",),
    "fills": ("Minv",),
    "of_numbers": True,
    "as_they_are": (("J", "jacobians", ""),),
    "leaves": (("inverse_mass_of_fields", ("Fcrb",)),),
    "depends_on": "masses",
}
INVERSE_MASS = OfFields(
    "inverse mass matrix",
    build=with_mass(_inverse),
    written=OfFields("inverse mass matrix of fields", build=with_mass(_inverse_with_columns), **_INVERSE),
    **_INVERSE,
)
_FILLED = ("ddq_dq", "ddq_dv", "ddq_dtau", "Minv", "dtau_dq", "dtau_dv", "dJ")
_DEFERRED = ("dAdq", "dAdv", "dFdq", "dFdv", "dFda")


def _forward(record: str, *more: str) -> OfFields:
    """Derivatives of forward dynamics, whose fields are left as a record says; `more` are further inputs."""
    common: dict[str, Any] = {
        "reads": (*_FORWARD, *more),
        "returns": (0, 1, 2),
        "of_numbers": True,
        "as_they_are": (
            ("J", "jacobians", ""),
            ("ov", "velocities", ""),
            ("oa_gf", "accelerations_with_gravity", ""),
            ("oh", "momenta", "subtree momenta"),
        ),
        "stores": tuple((f"jacobian_rates {x}", f"forward_dynamics {x}") for x in "qv"),
        "state": "forward_dynamics",
        "depends_on": "parameters",
    }
    invalid = ("derivatives_of_fields", ("Fcrb",))
    return OfFields(
        record.replace("_", " "),
        fills=_FILLED,
        build=with_mass(_derivatives),
        leaves=((record, (*_DEFERRED, "of")), invalid),
        written=OfFields(
            f"{record.replace('_', ' ')} of fields",
            fills=(*_FILLED, *_DEFERRED, "of[1:]"),
            build=with_mass(_derivatives_of_fields),
            leaves=(invalid,),
            **common,
        ),
        **common,
    )


FORWARD_DERIVATIVES = _forward("aba_derivatives")
FORWARD_DERIVATIVES_UNDER_FORCES = _forward("aba_derivatives_under_forces", "forward_dynamics f")


def inverse_of_fields(model: Model, data: Data, calls: CallCache) -> Any:
    """The inverse of the mass matrix at the last forward dynamics, where the columns of joints are those of J.

    Args:
        model: The model.
        data: Its data, which is filled.
        calls: The cache of calls that return what this does.

    Returns:
        Matrix (nv, nv); NotImplemented for models with mimic joints, whose columns are not separate.
    """
    return NotImplemented if model.nvExtended != model.nv else INVERSE_MASS.run(model, data, calls)


derivative_calls = call_cache(2, weak=2)


def derivatives_of_fields(model: Model, data: Data, fext: Any) -> Any:
    """Derivatives of forward dynamics at the last one, out of fields.

    Args:
        model: The model.
        data: Its data, which is filled.
        fext: Forces on the joints, the universe first, or None.

    Returns:
        Three matrices (nv, nv); NotImplemented for models with mimic joints, whose columns are not separate.
    """
    if model.nvExtended != model.nv:
        return NotImplemented
    if fext is None:
        return FORWARD_DERIVATIVES.run(model, data, derivative_calls)
    forces = checked_forces(fext, model.njoints)
    data._arrays["forward_dynamics f"][...] = np.reshape(forces[1:], (-1, 6))
    return FORWARD_DERIVATIVES_UNDER_FORCES.run(model, data)
