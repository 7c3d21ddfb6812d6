"""Forward dynamics: the accelerations by torques, by whichever algorithm is cheaper for the tree.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M, h | mass matrix; torques that give no acceleration | (nv, nv), (nv) | | crba.py, rnea.py |
| tau | joint torques | (nv) | [N m] or [N] | |
| a | joint accelerations | (nv) | [rad/s^2] or [m/s^2] | M a = tau - h |
| n_k | number of columns of S between the world and column k, itself included | () | | |

Either M is factored within the tree's zeros (mass_matrix_factors.py), at a cost that grows as the sum of n_k^2, or
articulated inertias are passed through the tree (aba_relative_accelerations.py), at a cost that grows as nv. Counted
in traced operations the first is cheaper while the mean of n_k^2 is below about 30 (Panda 20: 1207 against 1299), the
second beyond (Solo12 48: 2623 against 2953; G1 on a free flyer 109: 8242 against 11503). With mimic joints only the
first holds.

Cotangents pass backwards in closed form: differentiating M a = tau - h, that of tau is mu = M^-1 bar_a, that of q and v
minus the one that mu gives at the torques of inverse dynamics, with a constant [Carpentier & Mansard 2018, section V,
transposed]. M is factored already, and inverse dynamics has a third of the operations of articulated bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ulna.algorithms.dynamics.aba_relative_accelerations import articulated_body_dynamics
from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.algorithms.dynamics.rnea_point_accelerations import bias_forces, inverse_dynamics
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External
from ulna.algorithms.multibody.tree import shares_velocities, steps
from ulna.compiler.language.custom_vjp import with_vjp
from ulna.compiler.language.function import trace
from ulna.data_classes import dataclass
from ulna.model import Model
from ulna.typing import Array

_MEAN_SQUARE_DEPTH = 30.0


def forward_dynamics(model: Model, q: Array, v: Array, tau: Array, external: External = None) -> Array:
    """The joint accelerations, by the algorithm that takes fewer operations for the model.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: Forces on the bodies, which `external_forces.at_joints` makes of forces at frames [N, N m]; None for
            none.

    Returns:
        Joint accelerations, shape (..., nv) [rad/s^2, m/s^2].
    """
    a = _accelerations(model, q, v, tau, external)
    # M a = tau - h holds beside unit quaternions, too, for articulated bodies; not for crba.py, and what cotangents of
    # quaternions have along these would be others.
    is_exact = model.nq == model.nv or not prefers_mass_matrix(model)
    return with_vjp(a, (q, v, tau), _Vjp(model)) if external is None and is_exact else a


def _accelerations(model: Model, q: Array, v: Array, tau: Array, external: External) -> Array:
    if prefers_mass_matrix(model):
        return by_mass_matrix(model, q, v, tau, external)
    return articulated_body_dynamics(model, q, v, tau, external)


@dataclass(frozen=True)
class _Vjp:
    """The reverse derivative of forward dynamics; see above."""

    model: Model

    def __call__(
        self, arguments: Sequence[Array], a: Array, bar_a: Array, is_wanted: Sequence[bool]
    ) -> tuple[Any, Any, Any]:
        """Cotangents of q, v and tau by those of the accelerations."""
        model, (q, v, _) = self.model, arguments
        at_rest = replace(model, gravity=np.zeros(3))
        bar_tau = _accelerations(at_rest, q, np.zeros(model.nv), bar_a, None)
        if not any(is_wanted[:2]):
            return None, None, bar_tau
        torques = trace(partial(inverse_dynamics, model), q=q.shape, v=v.shape, a=a.shape)
        bar_q, bar_v, _ = torques.vjp()(q, v, a, bar_tau)
        return -bar_q, -bar_v, bar_tau


def by_mass_matrix(model: Model, q: Array, v: Array, tau: Array, external: External = None) -> Array:
    """The joint accelerations, by the factors of the mass matrix; takes mimic joints.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint accelerations, shape (..., nv) [rad/s^2, m/s^2].
    """
    h = bias_forces(model, q, v, external)
    a = batch_zeros((model.nv,), q, v, tau, external)
    solution = Factors(mass_matrix(model, q)).solve([(tau - h)[..., k] for k in range(model.nv)])
    for k, value in enumerate(solution):
        a[..., k] = value
    return a


def prefers_mass_matrix(model: Model) -> bool:
    """Whether the mass matrix is the cheaper way, or the only one."""
    if shares_velocities(model):
        return True
    depths: list[int] = []
    squares = 0
    for step in steps(model):
        before = depths[step.parent] if step.parent >= 0 else 0
        squares += sum((before + k + 1) ** 2 for k in range(step.kind.nv))
        depths.append(before + step.kind.nv)
    return squares <= _MEAN_SQUARE_DEPTH * max(model.nv, 1)
