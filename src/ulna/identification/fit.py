"""Least squares for the dynamic parameters of a robot, from logged positions, velocities, accelerations and torques.

| symbol | meaning | shape | equation |
|---|---|---|---|
| W | regressors of the log, one above the other, rows divided by the noise of their joint | (rows nv, n) | |
| y | torques of the log, likewise, without what is known | (rows nv) | |
| p, p0 | parameters sought, and those of the prior | (n) | |
| D | size of each parameter, for what counts as far from the prior | (n) | m, m r, m r^2 of the body; inf for drives |
| R, z | W and y, reduced to n rows by QR | (n, n), (n) | |
| p | what is found | (n) | least mean of (W p - y)^2 + ridge |(p - p0)/D|^2 |

Source: Siciliano, section 7.3; for the weights Gautier, Dynamic identification of robots with power model (1997).
Without ridge the parameters that the log does not tell apart stay as near to the prior as they can.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ulna.algorithms.dynamics.joint_friction import Friction, friction_torque
from ulna.checks.arrays import check_finite, finite_array, number_or_array, real_array
from ulna.errors import InputError, ShapeError
from ulna.identification.base import base_parameters_of, extended_regressor, parameter_names
from ulna.identification.convex import Problem, Progress, minimised
from ulna.identification.physical import pseudo_inertia
from ulna.identification.result import Identification
from ulna.model import Model, dynamic_parameters
from ulna.system.progress import progress as task_progress
from ulna.typing import ArrayLike, Floats


def identify(
    robot: Any,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    tau: ArrayLike,
    *,
    armature: bool = False,
    damping: bool = False,
    friction: bool = False,
    physical: bool = False,
    prior: ArrayLike | None = None,
    ridge: float | None = None,
    noise: ArrayLike | Literal["auto"] | None = None,
    width: float = 1e-2,
    progress: Callable[[Progress], object] | None = None,
) -> Identification:
    """The dynamic parameters that explain a log best.

    What is not sought of armature, damping and friction is taken from the robot's model.

    Args:
        robot: An `ulna.Robot`.
        q: Configurations, shape (rows, nq) [rad, m].
        v: Velocities, shape (rows, nv) [rad/s, m/s].
        a: Accelerations, shape (rows, nv) [rad/s^2, m/s^2].
        tau: Torques of the drives, shape (rows, nv) [N m, N].
        armature: Whether to seek the inertia of the drives.
        damping: Whether to seek viscous friction.
        friction: Whether to seek Coulomb friction.
        physical: Whether the bodies must be physically consistent (positive definite pseudo-inertia) and the
            parameters of the drives not negative. The cost found is then certain to be within 1e-8 of the least one,
            or within 1e-13 of the mean squared torque where that is more.
        prior: Dynamic parameters to stay near to, (10 nbodies,); None for the model's.
        ridge: How much staying near to the prior counts: what a deviation of every parameter by its own size costs,
            beside the mean squared residual [(N m)^2]. None for nothing, or for 1e-6 of the mean squared torque where
            `physical`; there it is 1e-10 of that at least, so that one solution is the best.
        noise: Standard deviation of each joint's torque, (nv,) [N m, N]; "auto" estimates it from the residuals of a
            first fit; None treats all joints alike.
        width: Velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].
        progress: Called with a `Progress` after each step of the iterative solver, where `physical`; its exceptions
            pass through and end the search.

    Returns:
        The parameters with their residuals, report and plot.

    Raises:
        ShapeError, NonFiniteError: The log does not fit the robot.
        InputError: `ridge` or `noise` is out of range, the log is too short, or `progress` is given without
            `physical`, where there are no steps.

    Example:
        >>> robot = ulna.load("ur5")
        >>> truth = robot.perturbed(0.3, seed=4)  # takes the place of the real robot
        >>> q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 200, 6))
        >>> fit = ulna.identification.identify(robot, q, v, a, truth.inverse_dynamics(q, v, a))
        >>> np.allclose(fit.residuals, 0.0, atol=1e-9)
        True
    """
    model: Model = robot.model
    if progress is not None and not physical:
        raise InputError(
            "`progress` reports the steps of physical=True; the linear solver has none. Leave it out."
        )
    log = _Log.checked(model, q, v, a, tau)
    sought = {"armature": armature, "damping": damping, "friction": friction}
    W = extended_regressor(robot, log.q, log.v, log.a, **sought, width=width)
    known = _known(model, log, sought, width)
    y = log.tau - known
    nominal = _present_parameters(model, sought)
    p0 = nominal.copy()
    if prior is not None:
        p0[: 10 * len(model.joints)] = _prior(model, prior)
    sigma = _noise(noise, model.nv)
    if ridge is not None and not (np.isfinite(ridge) and ridge >= 0.0):
        raise InputError(f"`ridge` is {ridge}; expected a finite number of zero or more.")
    sizes = _sizes(model, p0)

    def fitted(sigma: Floats) -> tuple[Floats, int]:
        R, z = _reduced(W / sigma[:, None], y / sigma)
        weight = (1e-6 * float(z @ z) if physical else 0.0) if ridge is None else ridge
        if physical:
            return _physical(R, z, p0, sizes, weight, len(model.joints), progress)
        return _linear(R, z, p0, sizes, weight)

    with task_progress("Fitting parameters"):
        p, count = fitted(sigma)
        if isinstance(noise, str):
            p, count = fitted(_deviations(y - W @ p, y))
            sigma = _deviations(y - W @ p, y)
    return _result(model, log, W, known, p, nominal, sought, physical, sigma, count)


@dataclass(frozen=True)
class _Log:
    """A log that fits a robot."""

    q: Floats
    v: Floats
    a: Floats
    tau: Floats

    @classmethod
    def checked(cls, model: Model, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: ArrayLike) -> _Log:
        arrays = {n: real_array(n, x) for n, x in (("q", q), ("v", v), ("a", a), ("tau", tau))}
        rows = arrays["q"].shape[0] if arrays["q"].ndim else 0
        for name, array in arrays.items():
            expected = (rows, model.nq if name == "q" else model.nv)
            if array.shape != expected:
                raise ShapeError(name, array.shape, f"{expected}, one row per sample")
            check_finite(name, array)
        if rows == 0:
            raise InputError("The log has no samples; expected one at least.")
        return cls(**arrays)


def _known(model: Model, log: _Log, sought: dict[str, bool], width: float) -> Floats:
    """The torques of what is not sought."""
    law = Friction(
        0.0 if sought["damping"] else np.array(model.damping),
        0.0 if sought["friction"] else np.array(model.friction),
        width=width,
    )
    drives = 0.0 if sought["armature"] else model.armature * log.a
    return drives - friction_torque(log.v, law)


def _deviations(residuals: Floats, y: Floats) -> Floats:
    """The standard deviation of the residuals of each joint, (nv,)."""
    return np.maximum(np.sqrt((residuals**2).mean(axis=0)), 1e-12 + 1e-9 * np.abs(y).max(initial=0.0))


def _present_parameters(model: Model, sought: dict[str, bool]) -> Floats:
    """The model's values of the parameters that are estimated."""
    return np.concatenate(
        [dynamic_parameters(model), *(getattr(model, n) for n, wanted in sought.items() if wanted)]
    )


def _prior(model: Model, prior: ArrayLike) -> Floats:
    p = finite_array("prior", prior)
    if p.size != 10 * len(model.joints):
        raise ShapeError("prior", p.shape, f"({10 * len(model.joints)},)")
    return p.reshape(-1)


def _noise(noise: Any, nv: int) -> Floats:
    if noise is None or (isinstance(noise, str) and noise == "auto"):
        return np.ones(nv)
    if isinstance(noise, str):
        raise InputError(f"`noise` is {noise!r}; expected 'auto', or a standard deviation for each joint.")
    sigma = number_or_array("noise", noise, nv)
    if not (np.isfinite(sigma).all() and (sigma > 0.0).all()):
        raise InputError(f"`noise` is {noise}; expected finite numbers above zero.")
    return sigma.copy()


def _sizes(model: Model, p0: Floats) -> Floats:
    """D: what is a large change of each parameter."""
    bodies = np.zeros((0, 10)) if not model.joints else p0[: 10 * len(model.joints)].reshape(-1, 10)
    mass = np.abs(bodies[:, 0])
    mass = np.maximum(mass, 0.1 * mass.mean()) if mass.any() else np.ones(len(bodies))
    extent = (
        np.abs(np.trace(pseudo_inertia(bodies)[:, :3, :3], axis1=1, axis2=2)) / mass if len(bodies) else mass
    )
    square = np.maximum(extent, 0.01)  # no smaller than a decimetre
    radius = np.sqrt(square)
    out = [np.stack([mass, *[mass * radius] * 3, *[mass * square] * 6], axis=-1).ravel()]
    out.append(np.full(len(p0) - 10 * len(model.joints), np.inf))  # what is not known of drives is no prior
    return np.concatenate(out)


def _reduced(W: Floats, y: Floats) -> tuple[Floats, Floats]:
    """R and z, divided by the root of the number of rows, so that sums of squares are means."""
    n = W.shape[-1]
    whole = np.concatenate([W.reshape(-1, n), y.reshape(-1, 1)], axis=1) / np.sqrt(y.size)
    R: Floats = np.array(np.linalg.qr(whole, mode="r"))
    return R[:, :n], R[:, n]


def _linear(R: Floats, z: Floats, p0: Floats, sizes: Floats, ridge: float) -> tuple[Floats, int]:
    units = np.where(np.isinf(sizes), 1.0, sizes)
    rows, right = R * units, z - R @ p0
    if ridge > 0.0:
        rows = np.concatenate([rows, np.sqrt(ridge) * np.diag(units / sizes)])
        right = np.concatenate([right, np.zeros(len(p0))])
    step = np.linalg.lstsq(rows, right, rcond=1e-10)[0]
    return p0 + units * step, 1


def _physical(
    R: Floats,
    z: Floats,
    p0: Floats,
    sizes: Floats,
    ridge: float,
    count: int,
    progress: Callable[[Progress], object] | None,
) -> tuple[Floats, int]:
    """As `_linear`, over bodies that can exist and drives whose numbers are not negative."""
    lengths, whole = np.sqrt((R * R).sum(axis=0)), float(np.sqrt(z @ z)) or 1.0
    known = np.isinf(sizes) & (lengths == 0.0)  # drives that the log does not move keep the prior's numbers
    identifiable = ~known
    units = np.where(np.isinf(sizes), whole / np.where(lengths == 0.0, 1.0, lengths), sizes)
    w = np.where(np.isinf(sizes), 1e-12 * whole**2, max(ridge, 1e-10 * whole**2))
    u, steps = minimised(
        Problem((R * units)[:, identifiable], z, w[identifiable], (p0 / units)[identifiable], count), progress
    )
    p = np.maximum(p0, 0.0)
    p[identifiable] = units[identifiable] * u
    return p, steps


def _result(
    model: Model,
    log: _Log,
    W: Floats,
    known: Floats,
    p: Floats,
    nominal: Floats,
    sought: dict[str, bool],
    physical: bool,
    sigma: Floats,
    iterations: int,
) -> Identification:
    n = len(p)
    rows = (W / sigma[:, None]).reshape(-1, n)
    base = base_parameters_of(rows, parameter_names(model, **sought))
    W1 = base.columns(rows)
    lengths = np.sqrt((W1 * W1).sum(axis=0))
    values = np.linalg.svd(W1 / lengths, compute_uv=False) if base.count else np.ones(1)
    misfit = (((log.tau - known - W @ p) / sigma) ** 2).sum() / max(len(rows) - base.count, 1)
    variances = np.diag(np.linalg.pinv((W1 / lengths).T @ (W1 / lengths))) if base.count else np.zeros(0)
    drives, at = {}, 10 * len(model.joints)
    for name, wanted in sought.items():
        drives[name] = p[at : at + model.nv] if wanted else np.array(getattr(model, name))
        at += model.nv * wanted
    return Identification(
        model=model,
        parameters=p[: 10 * len(model.joints)],
        **drives,
        physical=physical,
        base=base,
        base_values=base.of(p),
        base_deviations=np.sqrt(misfit * np.maximum(variances, 0.0)) / lengths,
        condition=float(values[0] / values[-1]) if values[-1] > 0.0 else np.inf,
        measured=log.tau,
        fitted=W @ p + known,
        before=W @ nominal + known,
        iterations=iterations,
    )
