"""Inertias and momenta of subtrees, in the world: centre of mass, centroidal map, energies.

| symbol | meaning | shape | unit |
|---|---|---|---|
| Y_i, dY_i | spatial inertia of step i in the world, about the origin, and its rate | (6, 6) | |
| Yc, dYc | the same of the subtree of step i | (6, 6) | |
| J, dJ | columns of motion subspaces in the world, and their rates | (columns, 6) | |
| G, dG | momentum about the origin that a unit of a column's velocity makes, Yc J, and its rate | (columns, 6) | |

Source: Orin, Goswami and Lee, Centroidal dynamics of a humanoid robot (2013); Wensing and Orin (2016) for the rate.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from ulna.system.cached import cached_property
from ulna.typing import Floats


@final
class WorldSums:
    """Sums over the bodies at a state.

    Args:
        evaluator: The evaluator, whose parameters are loaded.
        q: Configuration (nq,) [rad or m].
        v: Velocity (nv,) [rad/s or m/s]; None for rest.
        a: Acceleration (nv,) [rad/s^2 or m/s^2]; None for none.
    """

    def __init__(
        self, evaluator: TableEvaluator, q: Floats, v: Floats | None = None, a: Floats | None = None
    ) -> None:
        out = evaluator.run(r.RATES, q, v)
        self._evaluator = evaluator
        self._v: Any = v
        self._a: Any = a
        self._J, self._dJ = out.J.copy(), out.dJ.copy()
        table = evaluator.steps.table
        self._step_of_column = np.repeat(np.arange(len(table.parents)), np.diff(table.columns))
        self._entries = table.entries
        self._twists = in_world(out.T, out.V)
        self._Y = inertias_in_world(out.T, evaluator.inertias)
        self._gravity = evaluator.gravity

    @cached_property
    def _Yc(self) -> Floats:
        return self._evaluator.subtree_sums(self._Y)

    @cached_property
    def _dYc(self) -> Floats:
        twists = cross_matrices(self._twists)
        return self._evaluator.subtree_sums(-np.swapaxes(twists, 1, 2) @ self._Y - self._Y @ twists)

    @cached_property
    def _total(self) -> Floats:
        return self._Y.sum(axis=0) if len(self._Y) else np.zeros((6, 6))

    @cached_property
    def mass(self) -> float:
        """The mass of all [kg]."""
        return float(self._total[0, 0])

    @cached_property
    def center(self) -> Floats:
        """The centre of mass (3,) [m]."""
        with np.errstate(all="ignore"):
            return np.array([self._total[5, 1], self._total[3, 2], self._total[4, 0]]) / self.mass

    def _by_entries(self, columns: Floats) -> Floats:
        return self._evaluator.by_entries(columns)

    @cached_property
    def map_about_origin(self) -> Floats:
        """G by entries of v, (6, nv)."""
        return self._by_entries(_times(self._Yc[self._step_of_column], self._J))

    @cached_property
    def map_rate_about_origin(self) -> Floats:
        """dG by entries of v, (6, nv)."""
        rates = _times(self._dYc[self._step_of_column], self._J) + _times(
            self._Yc[self._step_of_column], self._dJ
        )
        return self._by_entries(rates)

    @cached_property
    def center_velocity(self) -> Floats:
        """The velocity of the centre of mass (3,) [m/s]."""
        with np.errstate(all="ignore"):
            return self.map_about_origin[:3] @ self._v / self.mass

    @cached_property
    def center_acceleration(self) -> Floats:
        """The acceleration of the centre of mass (3,) [m/s^2]."""
        with np.errstate(all="ignore"):
            total = self.map_about_origin[:3] @ self._a + self.map_rate_about_origin[:3] @ self._v
            return total / self.mass

    @cached_property
    def center_jacobian(self) -> Floats:
        """The Jacobian of the centre of mass (3, nv)."""
        with np.errstate(all="ignore"):
            return self.map_about_origin[:3] / self.mass

    def subtree_center_jacobian(self, joint: int) -> Floats:
        """The Jacobian (3, nv) of the centre of mass of what a joint, not the universe, moves."""
        evaluator = self._evaluator
        whole = evaluator.subtree_sums(self._Y)[evaluator.steps.of_joint[joint - 1]]
        own = evaluator.beyond(joint)
        before = np.maximum(evaluator.supports(joint) - own, 0.0)
        momenta = own[:, None] * _times(self._Yc[self._step_of_column], self._J)
        momenta += before[:, None] * (self._J @ whole.T)
        with np.errstate(all="ignore"):
            return self._by_entries(momenta)[:3] / whole[0, 0]

    @cached_property
    def centroidal_map(self) -> Floats:
        """The momentum about the centre of mass by velocities, (6, nv)."""
        return _about(self.map_about_origin, self.center)

    @cached_property
    def centroidal_map_rate(self) -> Floats:
        """The rate of `centroidal_map`, (6, nv)."""
        out = _about(self.map_rate_about_origin, self.center)
        out[3:] -= np.cross(self.center_velocity, self.map_about_origin[:3], axisb=0, axisc=0)
        return out

    @cached_property
    def one_body(self) -> Floats:
        """Mass, a zero lever, and the moments about the centre of mass row by row, (13,)."""
        c = self.center
        moments = self._total[3:, 3:] - self.mass * (c @ c * np.eye(3) - np.outer(c, c))
        return np.concatenate([[self.mass, 0.0, 0.0, 0.0], moments.reshape(9)])

    def about_origin(self, about_center: Floats) -> Floats:
        """A momentum about the centre of mass, or its rate, about the world's origin, (6,)."""
        return _about(about_center[:, None], -self.center)[:, 0]

    @cached_property
    def momentum(self) -> Floats:
        """The momentum about the centre of mass (6,)."""
        return self.centroidal_map @ self._v

    @cached_property
    def momentum_rate(self) -> Floats:
        """The rate of `momentum`; of free fall less gravity where no accelerations are given, (6,)."""
        if self._a is None:
            weight = np.concatenate([self.mass * self._gravity, np.zeros(3)])
            return self.centroidal_map_rate @ self._v - weight
        return self.centroidal_map @ self._a + self.centroidal_map_rate @ self._v

    @cached_property
    def kinetic_energy(self) -> Floats:
        """The kinetic energy, armature included () [J]."""
        of_rotors = self._evaluator.armature @ (self._v * self._v)
        return np.asarray(0.5 * (np.einsum("ni,nij,nj->", self._twists, self._Y, self._twists) + of_rotors))

    @cached_property
    def potential_energy(self) -> Floats:
        """The potential energy () [J]."""
        total = self._total
        return np.asarray(-self._gravity @ np.array([total[5, 1], total[3, 2], total[4, 0]]))


def in_world(T: Floats, twists: Floats) -> Floats:
    """Twists of moving frames, in the world.

    Args:
        T: Placements of the moving frames, rotation by rows and translation (n, 12).
        twists: Twists (n, 6).

    Returns:
        Twists (n, 6).
    """
    R, p = T[:, :9].reshape(-1, 3, 3), T[:, 9:]
    linear, angular = _times(R, twists[:, :3]), _times(R, twists[:, 3:])
    return np.concatenate([linear + np.cross(p, angular), angular], axis=1)


def wrenches_in_world(T: Floats, wrenches: Floats) -> Floats:
    """Wrenches of moving frames, in the world.

    Args:
        T: Placements of the moving frames, rotation by rows and translation (n, 12).
        wrenches: Wrenches (n, 6).

    Returns:
        Wrenches (n, 6).
    """
    R, p = T[:, :9].reshape(-1, 3, 3), T[:, 9:]
    linear, angular = _times(R, wrenches[:, :3]), _times(R, wrenches[:, 3:])
    return np.concatenate([linear, angular + np.cross(p, linear)], axis=1)


def inertias_in_world(T: Floats, inertias: Floats) -> Floats:
    """Inertias of moving frames, as matrices about the world's origin.

    Args:
        T: Placements of the moving frames, rotation by rows and translation (n, 12).
        inertias: Mass, mass times centre, and moments about each frame's origin (n, 10).

    Returns:
        Matrices (n, 6, 6).
    """
    R, p = T[:, :9].reshape(-1, 3, 3), T[:, 9:]
    mass, moments = inertias[:, 0], inertias[:, [4, 5, 6, 5, 7, 8, 6, 8, 9]].reshape(-1, 3, 3)
    rotated = _times(R, inertias[:, 1:4])
    h = rotated + mass[:, None] * p
    out = np.zeros((len(T), 6, 6))
    out[:, [0, 1, 2], [0, 1, 2]] = mass[:, None]
    out[:, 3:, :3] = skews(h)
    out[:, :3, 3:] = -out[:, 3:, :3]
    p_, r_ = skews(p), skews(rotated)
    shifted = mass[:, None, None] * (p_ @ p_) + r_ @ p_ + p_ @ r_
    out[:, 3:, 3:] = R @ moments @ np.swapaxes(R, 1, 2) - shifted
    return out


def skews(vectors: Floats) -> Floats:
    """The matrices [x] of vectors (n, 3), with [x] y = x cross y, (n, 3, 3)."""
    out = np.zeros((len(vectors), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, k, j], out[:, j, k] = vectors[:, i], -vectors[:, i]
    return out


def cross_matrices(twists: Floats) -> Floats:
    """The matrices of the vector product of twists with twists, (n, 6, 6)."""
    out = np.zeros((len(twists), 6, 6))
    out[:, :3, :3] = out[:, 3:, 3:] = skews(twists[:, 3:])
    out[:, :3, 3:] = skews(twists[:, :3])
    return out


def twist_rates_of_momenta(twists: Floats, momenta: Floats) -> Floats:
    """V x* h: how momenta change as their bodies move.

    Args:
        twists: Twists V (n, 6).
        momenta: Momenta h (n, 6).

    Returns:
        Rates (n, 6).
    """
    return -spatial_products(np.swapaxes(cross_matrices(twists), 1, 2), momenta)


def spatial_products(matrices: Floats, vectors: Floats) -> Floats:
    """Products of matrices with vectors.

    Args:
        matrices: Matrices (n, 6, 6).
        vectors: Vectors (n, 6).

    Returns:
        Vectors (n, 6).
    """
    return _times(matrices, vectors)


def _times(matrices: Floats, vectors: Floats) -> Floats:
    return (matrices @ vectors[:, :, None])[:, :, 0]


def _about(momenta: Any, point: Floats) -> Floats:
    """Momenta about the origin, one a column, about a point."""
    out = np.array(momenta)
    out[3:] -= np.cross(point, out[:3], axisb=0, axisc=0)
    return out
