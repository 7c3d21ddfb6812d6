"""Derivatives of inverse dynamics and of momenta by the state, from a table of joints, in world coordinates.

| symbol | meaning | shape |
|---|---|---|
| J, dJ | columns of motion subspaces, and their rates | (columns, 6) |
| V, A | twists and their rates; A0 relative to free fall | (steps, 6) |
| Y, D | inertia, and D = V x* Y - Y V x + (. x* Y V); Yc and Dc of the subtree of a step | (6, 6) |
| h, f | momentum and force, of the subtree of a step | (6,) |

With p the step before that of column j, which is swept by V_p x J_j:

    dA_j = A_p x J_j + V_p x (V_p x J_j)     the rate of all beyond by q_j
    dV_j = dJ_j + V_p x J_j                  the same by v_j

A torque J_i^T f_i depends on columns before it through the motion of its subtree, and on columns beyond it through
their forces. Source: Carpentier and Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018); Echeandia
and Wensing, Numerical Methods to Compute the Coriolis Matrix and Christoffel Symbols (2021), for half of D.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.world_sums import (
    cross_matrices,
    in_world,
    inertias_in_world,
    skews,
    spatial_products,
    twist_rates_of_momenta,
    wrenches_in_world,
)
from ulna.system.cached import cached_property
from ulna.typing import Floats


@final
class WorldDerivatives:
    """Derivatives at a state.

    Args:
        evaluator: The evaluator, whose parameters are loaded.
        q: Configuration (nq,) [rad or m].
        v: Velocity (nv,) [rad/s or m/s]; None for rest.
        a: Acceleration (nv,) [rad/s^2 or m/s^2]; None for none.
        F: Forces on the joints (njoints - 1, 6) [N, N m]; None for none.
    """

    def __init__(
        self, evaluator: TableEvaluator, q: Floats, v: Any = None, a: Any = None, F: Any = None
    ) -> None:
        self._evaluator = evaluator
        table = evaluator.steps.table
        self._nv, self._entries = len(evaluator.armature), table.entries
        out = evaluator.run(r.RATES, q, v, a)
        self.J, self._dJ = out.J.copy(), out.dJ.copy()
        self._V, self._A = in_world(out.T, out.V), in_world(out.T, out.A)
        self._Y = inertias_in_world(out.T, evaluator.inertias)
        self._step = np.repeat(np.arange(len(table.parents)), np.diff(table.columns))
        self._before = table.parents[self._step]
        self._crosses = cross_matrices(np.concatenate([self._V, np.zeros((1, 6))]))  # the world's is last
        self._fall = np.concatenate([evaluator.gravity, np.zeros(3)])
        self._external: Any = None
        if F is not None:
            of_steps = np.zeros((len(table.parents), 6))
            of_steps[evaluator.steps.of_joint] = F
            self._external = wrenches_in_world(out.T, of_steps)

    @cached_property
    def mass(self) -> float:
        """The mass of all [kg]."""
        return float(self._Y[:, 0, 0].sum())

    @cached_property
    def _swept(self) -> Floats:
        return spatial_products(self._crosses[self._before], self.J)

    @cached_property
    def by_velocity(self) -> Floats:
        """dV (columns, 6)."""
        return self._dJ + self._swept

    def accelerations(self, falling: bool) -> Floats:
        """dA (columns, 6), of accelerations relative to free fall where `falling` says so."""
        fall = self._fall if falling else np.zeros(6)
        A = np.concatenate([self._A - fall, -fall[None]])
        turned = spatial_products(cross_matrices(A)[self._before], self.J)
        return turned + spatial_products(self._crosses[self._before], self._swept)

    @cached_property
    def _momenta(self) -> Floats:
        return spatial_products(self._Y, self._V)

    @cached_property
    def _Yc(self) -> Floats:
        return self._evaluator.subtree_sums(self._Y)[self._step]

    @cached_property
    def coriolis_of_subtrees(self) -> Floats:
        """Half of Dc of each step (steps, 6, 6)."""
        crosses = self._crosses[:-1]
        rates = -np.swapaxes(crosses, 1, 2) @ self._Y - self._Y @ crosses + _by_motion(self._momenta)
        return self._evaluator.subtree_sums(0.5 * rates)

    @cached_property
    def _half_Dc(self) -> Floats:
        return self.coriolis_of_subtrees[self._step]

    @cached_property
    def _Dc(self) -> Floats:
        return 2.0 * self._half_Dc

    @cached_property
    def by_acceleration(self) -> Floats:
        """The change of forces by accelerations, Yc J (columns, 6)."""
        return spatial_products(self._Yc, self.J)

    def forces_by_velocity(self) -> Floats:
        """The change of forces by v (columns, 6)."""
        return spatial_products(self._Dc, self.J) + spatial_products(self._Yc, self.by_velocity)

    def forces(self, falling: bool = True) -> Floats:
        """The forces on the subtrees of steps (steps, 6), without weights unless `falling` says so."""
        A = self._A - self._fall if falling else self._A
        forces = spatial_products(self._Y, A) + twist_rates_of_momenta(self._V, self._momenta)
        if self._external is not None:
            forces = forces - self._external
        return self._evaluator.subtree_sums(forces)

    def forces_by_configuration(self, falling: bool = True) -> Floats:
        """The change of forces by q (columns, 6), of weights, too, where `falling` says so."""
        beyond = self.forces(falling)[self._step]
        moved = spatial_products(self._Dc, self._swept) + spatial_products(
            self._Yc, self.accelerations(falling)
        )
        return moved + twist_rates_of_momenta(self.J, beyond)

    def momenta_by_configuration(self) -> Floats:
        """The change of momenta about the origin by q (columns, 6)."""
        beyond = self._evaluator.subtree_sums(self._momenta)[self._step]
        return twist_rates_of_momenta(self.J, beyond) + spatial_products(self._Yc, self._swept)

    @cached_property
    def _ancestry(self) -> tuple[Any, Any]:
        """Masks (columns, columns): the step of j is that of i or an ancestor; it is a descendant."""
        parents = self._evaluator.steps.table.parents
        is_ancestor = np.eye(len(parents), dtype=bool)
        for k, parent in enumerate(parents.tolist()):
            if parent >= 0:
                is_ancestor[k] |= is_ancestor[parent]
        ancestors = is_ancestor[np.ix_(self._step, self._step)]
        return ancestors, ancestors.T & ~ancestors

    def _torques(self, rates: Floats, accelerations: Floats, velocities: Floats, forces: Floats) -> Floats:
        """Changes (nv, nv) of torques: through the motion of subtrees, and through forces (columns, 6).

        `rates` is D of the column's subtree, or half of it (columns, 6, 6).
        """
        ancestors, descendants = self._ancestry
        of_rates = spatial_products(np.swapaxes(rates, 1, 2), self.J)
        through_motion = self.by_acceleration @ accelerations.T + of_rates @ velocities.T
        changes = np.where(ancestors, through_motion, np.where(descendants, self.J @ forces.T, 0.0))
        out = np.zeros((self._nv, self._nv))
        np.add.at(out, np.ix_(self._entries, self._entries), changes)
        return out

    def torques_by_configuration(self) -> Floats:
        """Derivatives of torques by q (nv, nv)."""
        return self._torques(self._Dc, self.accelerations(True), self._swept, self.forces_by_configuration())

    def torques_by_velocity(self) -> Floats:
        """Derivatives of torques by v (nv, nv)."""
        return self._torques(self._Dc, self.by_velocity, self.J, self.forces_by_velocity())

    def coriolis(self) -> Floats:
        """The Coriolis matrix (nv, nv) of the Christoffel symbols."""
        return self._torques(self._half_Dc, self._dJ, self.J, self.coriolis_forces())

    def coriolis_forces(self) -> Floats:
        """The forces of the Coriolis matrix (columns, 6)."""
        return spatial_products(self._half_Dc, self.J) + spatial_products(self._Yc, self._dJ)


def _by_motion(forces: Floats) -> Floats:
    """The matrices of m x* f as functions of the motion m, (n, 6, 6)."""
    out = np.zeros((len(forces), 6, 6))
    out[:, :3, 3:] = out[:, 3:, :3] = -skews(forces[:, :3])
    out[:, 3:, 3:] = -skews(forces[:, 3:])
    return out
