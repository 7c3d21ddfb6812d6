"""How the torques of inverse dynamics change with q, v and a, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| U_i, V_i | twist of the parent and of the body of step i | Motion | [m/s, rad/s] | V_i = U_i + S_i v_i |
| C_i, A_i | acceleration of the same two, gravity taken off | Motion | | A_i = C_i + S_i a_i + U_i x S_i v_i |
| m, c, I | inertia of all bodies from step i outward | MassMoments | | see mass_moments.py |
| u | velocity of the observer of step i, for that of its parent | (3) | [m/s] | see states_of_moving_observers |
| h = (p, n), D | their momentum, and the rate of I | Force, (3, 3) | | |
| F_i | the force that moves them | Force | [N, N m] | sum of I A + V x* I V - external |
| s | a column of S_i | Motion | | constant |
| psi, chi, phi | motion that s causes outward: | Motion | | psi = U x s, chi = C x s + U x psi, phi = V x s + psi |
| B s | twice the Coriolis matrix of the bodies from i on | Force | | (2 w x p; D w + w x n) for s = (l; w) |
| B^T s | a pure moment | (3) | | 2 p x l + D w + n x w |
| r | column of the force at step i by a | Force | | I s |
| y, z | column of the force at step i by v, by q | Force | | B s + I phi, B psi + I chi + s x* F |

A column s_k of step k and a column s_j of a step j, k itself or an ancestor of k, give four entries:

    d tau_k / d v_j = r_k . phi_j + B^T s_k . s_j        d tau_j / d v_k = s_j . y_k
    d tau_k / d q_j = r_k . chi_j + B^T s_k . psi_j      d tau_j / d q_k = s_j . z_k (without s x* F when k = j)

Derivatives by q are along the tangent space. Each column travels inward as a force from one moving frame to the
next, where the subspaces are constant; B^T s, a pure moment, is only turned, and gains 2 u x r.linear with each
change of observer. Rigid bodies give p, n and D; u adds m u, first moment x u, and steiner(first moment, u) to them.

Source: Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018); Singh, Russell &
Wensing, Efficient Analytical Derivatives of Rigid-Body Dynamics using Spatial Vector Algebra (2022), whose B falls
into p, n and D here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External
from ulna.algorithms.multibody.mass_moments import MassMoments, rotate_symmetric, rotation_axis, steiner
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array


class State(NamedTuple):
    """Twists and accelerations at a step: before the joint (U, C), of the body (V, A); u in the parent's axes."""

    U: Motion
    V: Motion
    C: Motion
    A: Motion
    u: Array


class Subtree(NamedTuple):
    """Inertia, momentum, rate of the second moment, and force of all bodies from a step outward."""

    body: MassMoments
    h: Force
    D: Array
    F: Force

    def __add__(self, other: Any) -> Subtree:
        return Subtree(self.body + other.body, self.h + other.h, self.D + other.D, self.F + other.F)

    def to_parent(self, step: Step, q: Array, u: Array) -> Subtree:
        """The same as observed from the parent.

        Args:
            step: The step in whose moving frame the quantities are.
            q: Configuration, shape (..., nq) [rad, m].
            u: Velocity of the observer of the step relative to that of the parent, in the parent's axes, shape (...,
                3) [m/s].

        Returns:
            The quantities about the origin of the parent's moving frame.
        """
        J, P, axis = step.transform(q), step.placement.rotation, rotation_axis(step.kind)
        body, arm = self.body, origin_in_parent(step, J)
        first, linear, angular = (
            apply(P, apply(J.rotation, x)) for x in (body.first, self.h.linear, self.h.angular)
        )
        linear = linear + u * body.mass
        h = Force(linear, angular + cross(first, u) + cross(arm, linear))
        D = (
            rotate_symmetric(P, rotate_symmetric(J.rotation, self.D, axis))
            + steiner(first, u)
            + steiner(arm, linear)
        )
        return Subtree(
            body.to_outer_frame(J, axis).to_outer_frame(step.placement), h, D, step.force_to_parent(self.F, q)
        )

    def coriolis(self, s: Motion) -> Force:
        """B s."""
        w = s.angular
        return Force(2.0 * cross(w, self.h.linear), apply(self.D, w) + cross(w, self.h.angular))

    def coriolis_transposed(self, s: Motion) -> Array:
        """B^T s."""
        w = s.angular
        return 2.0 * cross(self.h.linear, s.linear) + apply(self.D, w) + cross(self.h.angular, w)


class ColumnDerivatives(NamedTuple):
    """A column s of a step, and what its motion changes from the step outward: psi, chi and phi of the table above."""

    index: int
    s: Motion
    psi: Motion
    chi: Motion
    phi: Motion


def inverse_dynamics_derivatives(
    model: Model, q: Array, v: Array, a: Array, external: External = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the torques of inverse dynamics.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        external: For every joint of the model the force on its body, in its moving frame and fixed in it [N, N m], or
            None.

    Returns:
        The derivatives with respect to q, v and a, each of shape (..., nv, nv); the last is the mass matrix.
    """
    prepared = prepare(model)
    tree = prepared.tree
    state = states_of_moving_observers(tree, q, v, a, model.gravity)
    columns_of = cache(lambda i: column_derivatives(tree[i], state(i)))
    by_q, by_v, M = (batch_zeros((model.nv, model.nv), q, v, a, external) for _ in range(3))
    for i, subtree in subtree_quantities(model, prepared, prepared.regrouped_moments, state, q, external):
        for column in columns_of(i):
            _add_pairs(tree, state, columns_of, i, column, subtree, q, by_q, by_v, M)
    for k in range(model.nv):
        M[..., k, k] += model.armature[k]
    return by_q, by_v, M


def _add_pairs(
    tree: Sequence[Step],
    state: Callable[[int], State],
    columns_of: Callable[[int], list[ColumnDerivatives]],
    i: int,
    column: ColumnDerivatives,
    subtree: Subtree,
    q: Array,
    by_q: Array,
    by_v: Array,
    M: Array,
) -> None:
    """Adds the entries of a column of step i with every column of its ancestors."""
    k, s = column.index, column.s
    r, t = subtree.body.apply(s), subtree.coriolis_transposed(s)
    y = subtree.coriolis(s) + subtree.body.apply(column.phi)
    z = subtree.coriolis(column.psi) + subtree.body.apply(column.chi)
    for c in columns_of(i):
        M[..., c.index, k] += r.dot(c.s)
        by_v[..., c.index, k] += y.dot(c.s)
        by_q[..., c.index, k] += z.dot(c.s)
    z = z + s.cross(subtree.F)
    while tree[i].parent >= 0:
        r, y, z = (tree[i].force_to_parent(force, q) for force in (r, y, z))
        t = apply(tree[i].placement.rotation, apply(tree[i].transform(q).rotation, t))
        t = t + cross(2.0 * state(i).u, r.linear)
        i = tree[i].parent
        for c in columns_of(i):
            m = r.dot(c.s)
            M[..., k, c.index] += m
            M[..., c.index, k] += m
            by_v[..., k, c.index] += r.dot(c.phi) + dot(t, c.s.angular)
            by_q[..., k, c.index] += r.dot(c.chi) + dot(t, c.psi.angular)
            by_v[..., c.index, k] += y.dot(c.s)
            by_q[..., c.index, k] += z.dot(c.s)


def column_derivatives(step: Step, state: State) -> list[ColumnDerivatives]:
    """The columns of a step, each with its psi, chi and phi.

    Args:
        step: The step.
        state: The twists and accelerations at it.

    Returns:
        The derivatives, one a column.
    """
    columns = []
    for index, s in step.columns():
        psi = state.U.cross(s)
        chi = state.C.cross(s) + state.U.cross(psi)
        columns.append(ColumnDerivatives(index, s, psi, chi, state.V.cross(s) + psi))
    return columns


def states_of_moving_observers(
    tree: Sequence[Step], q: Array, v: Array, a: Array, gravity: Array
) -> Callable[[int], State]:
    """The twists and accelerations at the steps, those of free fall subtracted.

    Each is as observed by somebody who moves on evenly with the origin of the moving frame of the step.

    Forces are the same to all who move evenly (Galilei), so the torques and their derivatives are, too; but half of the
    twists is zero. In exchange u appears, the velocity of an observer relative to that of the parent.

    A trace records in the order in which states are asked for; what is computed shortly before it is used stays in
    registers.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        gravity: Acceleration of free fall in the world, shape (3,) [m/s^2].

    Returns:
        A function that computes the state at a step, once.
    """

    @cache
    def state(i: int) -> State:
        step = tree[i]
        J, v_J = step.transform(q), step.motion(v)
        w, e, b = np.zeros(3), np.zeros(3), -np.asarray(gravity)
        if step.parent >= 0:
            parent = state(step.parent)
            w, e, b = parent.V.angular, parent.A.angular, parent.A.linear
        R, back = step.placement.rotation, np.swapaxes(step.placement.rotation, -1, -2)
        inverse = np.swapaxes(J.rotation, -1, -2)
        arm = origin_in_parent(step, J)
        carried = cross(w, arm)
        u = carried + apply(R, apply(J.rotation, v_J.linear))
        b = b + cross(e, arm) + cross(w, carried)
        w, e, b = (apply(inverse, apply(back, x)) for x in (w, e, b))
        U, C = Motion(-v_J.linear, w), Motion(b + cross(w, v_J.linear), e)
        V = Motion(np.zeros(3), w + v_J.angular)
        return State(U, V, C, C + step.motion(a) + U.cross(v_J), u)

    return state


def origin_in_parent(step: Step, J: SE3) -> Array:
    """The origin of the moving frame in the parent's.

    Args:
        step: The step.
        J: The joint transform at the configuration [m].

    Returns:
        Position, shape (..., 3) [m].
    """
    return step.placement.translation + apply(step.placement.rotation, J.translation)


def subtree_quantities(
    model: Model,
    prepared: PreparedModel,
    bodies: Sequence[MassMoments],
    state: Callable[[int], State],
    q: Array,
    external: External = None,
) -> Iterator[tuple[int, Subtree]]:
    """The quantities of all bodies from each step outward.

    Args:
        model: The robot.
        prepared: Its optimised frames.
        bodies: The inertia of the body of every step, in its optimised frame [kg, kg m, kg m^2].
        state: The twists and accelerations at each step.
        q: Configuration, shape (..., nq) [rad, m].
        external: Forces on the bodies [N, N m]; None for none.

    Yields:
        Every step with its quantities, the leaves first.
    """
    children: list[list[Subtree]] = [[] for _ in prepared.tree]
    for i, step in reversed(list(enumerate(prepared.tree))):
        body, V = bodies[i], state(i).V
        h = body.apply(V)
        F = body.apply(state(i).A) + V.cross(h)
        if external is not None and step.is_last:
            force = external[model.joint_index(step.joint.name)]
            F = F if force is None else F - prepared.frames[i].act_inverse(force)
        subtree = Subtree(body, h, body.rate(V), F)
        for child in children[i]:
            subtree = subtree + child
        children[i].clear()
        yield i, subtree
        if step.parent >= 0:
            children[step.parent].append(subtree.to_parent(step, q, state(i).u))
