"""Dynamics under constraints that are given by their Jacobian."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._algorithms.all_terms import computeAllTerms
from pinocchio._algorithms.dynamics import crba
from pinocchio._constraints.factorization import Factorization, kernels_for, no_factors_error
from pinocchio._constraints.proximal_settings import damping_of
from pinocchio._containers.arguments import WrongShape
from pinocchio._containers.arrays import exact, not_applicable, numbers
from pinocchio._containers.enums import Convention
from pinocchio._containers.keywords import overloads, without_overloads
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.errors import InputError
from ulna.system.cached import cached_property
from ulna.typing import Floats

__all__ = [
    "computeKKTContactDynamicMatrixInverse",
    "forwardDynamics",
    "getKKTContactDynamicMatrixInverse",
]


@final
class BoundJacobianDynamics:
    """Dynamics under a Jacobian of so many rows, bound to a Data.

    Each answers NotImplemented where an argument is not exactly an array of its size, or forces are not unique.
    """

    def __init__(self, model: Model, data: Data, rows: int) -> None:
        self.kernels = kernels_for(data._attach(model), np.ones((rows, model.nv)))
        self.factored = known = Factorization(self.kernels, model._watched("structure"))
        self.entries, self.r, self.flag = known.entries, known.r, known.flag
        self.blocks, self.M, self.nle = data._arrays, data._arrays["M"], data._arrays["nle"]
        self.mu, self.forces, self.impulses = np.zeros(rows), np.zeros(rows), np.zeros(rows)
        self.damping = 0.0
        self._jacobian = b""

    def _factored(self, J: Any, damping: float, mass: Any = None) -> bool:
        """Factors K, with `data.M` where no mass is passed; whether that applies, and its factors are unique."""
        if damping != self.damping:
            self.damping = damping
            self.mu.fill(damping)
        self._jacobian = J.tobytes()
        return (
            self.factored.factor(self.M if mass is None else mass, J, self.mu) is None and self.flag[0] > 0.0
        )

    def motion(self, J: Any, damping: float, tau: Any, drift: Any) -> Any:
        """Accelerations; their forces lie in `forces`.

        Args:
            drift: Drift of the constraints (m,) [m/s^2].

        Returns:
            Accelerations (nv,); NotImplemented where it does not apply.
        """
        if self._factored(J, damping):
            return self._motion(self.entries, self.r, tau, self.nle, drift)
        return NotImplemented

    def impact(self, J: Any, damping: float, v: Any, restitution: float) -> Any:
        """The velocity after an impact; its impulses lie in `impulses`.

        Args:
            restitution: Coefficient of restitution [-].

        Returns:
            Velocity (nv,); NotImplemented where it does not apply.
        """
        if self._factored(J, damping):
            return self._impact(self.entries, self.r, J, v, restitution)
        return NotImplemented

    def inverse(self, J: Any, damping: float, mass: Any) -> Any:
        """The inverse of [[M, J^T], [J, -damping 1]].

        Args:
            mass: M (nv, nv); None for `data.M`.

        Returns:
            Matrix (nv + m, nv + m); NotImplemented where it does not apply.
        """
        if self._factored(J, damping, mass):
            return self.factored.inverse(J, self.mu, joints_first=True)
        return NotImplemented

    def inverse_again(self, J: Floats) -> Any:
        """The inverse for the mass matrix and damping that were factored last.

        Args:
            J: Jacobian (m, nv).

        Returns:
            Matrix (nv + m, nv + m); NotImplemented where another Jacobian was factored.
        """
        if J.tobytes() == self._jacobian:
            return self.factored.inverse(J, self.mu, joints_first=True)
        return NotImplemented

    @cached_property
    def _motion(self) -> Any:
        targets = self.blocks["ddq"], self.forces
        return self.kernels.motion.into(*targets, returns=(0,), otherwise=not_applicable)

    @cached_property
    def _impact(self) -> Any:
        targets = self.blocks["dq_after"], self.impulses
        return self.kernels.impact.into(*targets, returns=(0,), otherwise=not_applicable)


def _run(
    model: Model, data: Data, name: str, J: Any, damping: Any, *state: Any
) -> tuple[BoundJacobianDynamics, Any]:
    """The result of a method of `BoundJacobianDynamics` for arguments as users pass them.

    Raises:
        InputError: the mass matrix and J have no factors.
        WrongShape: J has another number of columns, or an argument another size.
    """
    mu = damping_of(damping) if damping else 0.0
    bound, result, bound_by_rows = None, NotImplemented, data._bound_at
    if data._model is model and type(J) is np.ndarray and J.ndim == 2:
        bound = bound_by_rows.get(len(J))
        if bound is not None:
            result = getattr(bound, name)(J, mu, *state)
    if bound is None or result is NotImplemented:
        data._attach(model)
        J = np.require(numbers(J, "constraint_jacobian"), float, ["C", "A"])
        if J.ndim != 2 or J.shape[1] != model.nv:
            raise WrongShape("constraint_jacobian", J.shape, f"(m, {model.nv})")
        sizes = {"tau": model.nv, "constraint_drift": len(J), "v_before": model.nv}
        arrays = [
            exact(x, sizes[what], what) if what else x for x, what in zip(state, _STATE[name], strict=True)
        ]
        bound_by_rows = data._bound_at
        bound = bound_by_rows.get(len(J))
        if bound is None or getattr(bound, name)(J, mu, *arrays) is NotImplemented:
            bound = bound_by_rows[len(J)] = BoundJacobianDynamics(model, data, len(J))
        result = getattr(bound, name)(J, mu, *arrays)
        if result is NotImplemented:
            data._damped = None
            raise no_factors_error(bound.M, J)
    data._damped = bound, mu
    _invalidate_factors(data)
    return bound, result


def _invalidate_factors(data: Data) -> None:
    """Has `pinocchio.cholesky` factor the mass matrix again before its factors are used."""
    factors = data._bound_at.get("cholesky")
    if factors is not None:
        factors.outdated[0] = 1.0


_STATE = {"motion": ("tau", "constraint_drift"), "impact": ("v_before", None), "inverse": (None,)}
"""What methods of `BoundJacobianDynamics` take after J and its damping: names of vectors, None for anything else."""


def _motion_directly(model: Any, data: Any, *state: Any) -> Any:
    """forwardDynamics of arrays under a Jacobian that is known, without damping; else NotImplemented."""
    *configuration, tau, J, drift = state
    bound = data._bound_at[len(J)] if len(configuration) in (0, 2) else None
    if bound is None or data._model is not model:
        return NotImplemented
    if configuration:
        computeAllTerms(model, data, *configuration)
    a = bound.motion(J, 0.0, tau, drift)
    if a is not NotImplemented:
        data._arrays["lambda_c"], data._damped = bound.forces, (bound, 0.0)
        _invalidate_factors(data)
    return a


@without_overloads(_motion_directly)
@overloads(
    "model data q v tau constraint_jacobian constraint_drift damping?",
    "model data tau constraint_jacobian constraint_drift damping?",
)
def forwardDynamics(
    model: Model,
    data: Data,
    q: Any = None,
    v: Any = None,
    tau: Any = None,
    constraint_jacobian: Any = None,
    constraint_drift: Any = None,
    damping: float = 0.0,
) -> Floats:
    """The accelerations under J a + drift = 0 (nv,); kept in `data.ddq`, the forces in `data.lambda_c`.

    Args:
        q: Configuration (nq,); without q and v those of the last computeAllTerms.
        v: Velocity (nv,).
        tau: Torques (nv,).
        constraint_jacobian: J (m, nv).
        constraint_drift: The drift (m,).
        damping: What is taken off the diagonal of the constraints [1/kg].

    Returns:
        Accelerations (nv,) [rad/s^2 or m/s^2].
    """
    if q is not None:
        computeAllTerms(model, data, q, v)
    state = tau, constraint_drift
    bound, a = _run(model, data, "motion", constraint_jacobian, damping, *state)
    data._arrays["lambda_c"] = bound.forces
    return a


def impact_directly(model: Any, data: Any, *state: Any) -> Any:
    """impulseDynamics of arrays under a Jacobian that is known, without damping; else NotImplemented.

    Args:
        *state: Configuration (nq,), or nothing, velocity (nv,), Jacobian (m, nv).

    Returns:
        Velocity (nv,).
    """
    *configuration, v, J = state
    bound = data._bound_at[len(J)] if len(configuration) < 2 else None
    if bound is None or data._model is not model or type(J) is not np.ndarray or J.ndim != 2:
        return NotImplemented
    if configuration:
        crba(model, data, configuration[0], Convention.WORLD)
    after = bound.impact(J, 0.0, v, 0.0)
    if after is not NotImplemented:
        data._arrays["impulse_c"], data._damped = bound.impulses, (bound, 0.0)
        _invalidate_factors(data)
    return after


def impact_with_jacobian(
    model: Model, data: Data, q: Any, v: Any, J: Any, restitution_coefficient: float, damping: float
) -> Floats:
    """The velocity after an impact on what a Jacobian describes; see `impulseDynamics`.

    Args:
        q: Configuration (nq,) [rad or m]; None after crba.
        restitution_coefficient: Coefficient of restitution, 0 to 1 [-].

    Returns:
        Velocity (nv,) [rad/s or m/s].
    """
    if q is not None:
        crba(model, data, q, Convention.WORLD)
    bound, after = _run(model, data, "impact", J, damping, v, float(restitution_coefficient))
    data._arrays["impulse_c"] = bound.impulses
    return after


def computeKKTContactDynamicMatrixInverse(
    model: Model, data: Data, q: Any, constraint_jacobian: Any, damping: float = 0.0
) -> Floats:
    """The inverse of [[M, J^T], [J, -damping 1]], (nv + m, nv + m).

    Args:
        constraint_jacobian: Jacobian (m, nv).

    Returns:
        Matrix (nv + m, nv + m).
    """
    crba(model, data, q, Convention.WORLD)
    return _run(model, data, "inverse", constraint_jacobian, damping, None)[1]


def getKKTContactDynamicMatrixInverse(model: Model, data: Data, constraint_jacobian: Any) -> Floats:
    """The same with mass matrix and damping of the last forwardDynamics or impulseDynamics with a Jacobian.

    Args:
        data: Its data, after one of these.
        constraint_jacobian: Jacobian (m, nv).

    Returns:
        Matrix (nv + m, nv + m).

    Raises:
        InputError: The Jacobian has another shape than in that call.
    """
    if type(constraint_jacobian) is not np.ndarray or constraint_jacobian.dtype != float:
        constraint_jacobian = numbers(constraint_jacobian, "constraint_jacobian")
    bound, damping = data._require(data._damped, "forwardDynamics or impulseDynamics with a Jacobian")
    shape = bound.kernels.rows.shape
    if constraint_jacobian.shape != shape:
        raise InputError(
            f"The Jacobian is {constraint_jacobian.shape}; that of forwardDynamics or impulseDynamics was {shape}."
        )
    result = bound.inverse_again(constraint_jacobian) if data._model is model else NotImplemented
    if result is not NotImplemented:
        return result
    return _run(model, data, "inverse", constraint_jacobian, damping, bound.factored.mass())[1]
