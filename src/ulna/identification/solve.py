"""Least squares for dynamic parameters, once a log is reduced by QR; the table of symbols is in `fit`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.algorithms.dynamics.joint_friction import Friction, friction_torque
from ulna.checks.arrays import check_finite, finite_array, number_or_array, real_array
from ulna.checks.labels import in_order
from ulna.checks.values import number
from ulna.errors import InputError, ShapeError
from ulna.identification.convex import Problem, Progress, minimised
from ulna.identification.identifiable_parameters import (
    BaseParameters,
    base_parameters_of,
    check_moves,
    parameter_names,
)
from ulna.identification.physical import pseudo_inertia
from ulna.model import Model, dynamic_parameters
from ulna.typing import ArrayLike, Floats

NO_SAMPLES = (
    "The log has no samples; expected one at least. If rows were selected, the condition holds for none: a joint that "
    "never moves, say, makes `(abs(v) > 0.02).all(axis=1)` false everywhere."
)
"""What is said of a log without rows."""


@dataclass(frozen=True)
class Log:
    """A log that fits a robot."""

    q: Floats
    v: Floats
    a: Floats
    tau: Floats

    @classmethod
    def checked(cls, model: Model, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: ArrayLike) -> Log:
        """A log, if it fits the robot.

        Args:
            model: The robot.
            q: Configurations, (rows, nq) [rad, m].
            v: Velocities, (rows, nv) [rad/s, m/s].
            a: Accelerations, (rows, nv) [rad/s^2, m/s^2].
            tau: Torques, (rows, nv) [N m, N].

        Returns:
            The log.

        Raises:
            ShapeError, NonFiniteError: If it does not.
            InputError: If it has no samples, or labels that are not those of the robot, or the robot has no joints.
        """
        check_moves(model)
        names = {"q": model.position_names} | dict.fromkeys(("v", "a", "tau"), model.velocity_names)
        given = {"q": q, "v": v, "a": a, "tau": tau}
        arrays = {n: real_array(n, in_order(n, x, names[n])) for n, x in given.items()}
        rows = arrays["q"].shape[0] if arrays["q"].ndim else 0
        for name, array in arrays.items():
            expected = (rows, model.nq if name == "q" else model.nv)
            if array.shape != expected:
                raise ShapeError(name, array.shape, f"{expected}, one row per sample")
            check_finite(name, array)
        if rows == 0:
            raise InputError(NO_SAMPLES)
        return cls(**arrays)


def known_torques(model: Model, log: Log, sought: dict[str, bool], width: float) -> Floats:
    """The torques of what is not sought.

    Args:
        model: The robot.
        log: The log.
        sought: Which of armature, damping and friction are sought.
        width: Velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].

    Returns:
        Torques, (rows, nv) [N m, N].
    """
    law = Friction(
        0.0 if sought["damping"] else np.array(model.damping),
        0.0 if sought["friction"] else np.array(model.friction),
        width=width,
    )
    drives = 0.0 if sought["armature"] else model.armature * log.a
    return drives - friction_torque(log.v, law)


def present_parameters(model: Model, sought: dict[str, bool]) -> Floats:
    """The model's values of the parameters that are estimated.

    Args:
        model: The robot.
        sought: Which of armature, damping and friction are sought.

    Returns:
        Parameters, (n,).
    """
    return np.concatenate(
        [dynamic_parameters(model), *(getattr(model, n) for n, wanted in sought.items() if wanted)]
    )


def checked_prior(model: Model, prior: ArrayLike) -> Floats:
    """`prior`, if it can be one.

    Args:
        model: The robot.
        prior: Dynamic parameters, (10 nbodies,).

    Returns:
        The same, (10 nbodies,).

    Raises:
        ShapeError: If it has a wrong length.
    """
    p = finite_array("prior", prior)
    if p.size != 10 * len(model.joints):
        raise ShapeError("prior", p.shape, f"({10 * len(model.joints)},)")
    return p.reshape(-1)


def checked_noise(noise: Any, model: Model) -> Floats:
    """The deviations of the torques that a first fit takes.

    Args:
        noise: As for `identify`.
        model: The robot.

    Returns:
        Deviations, (nv,) [N m, N]; ones where none are known.

    Raises:
        InputError: If `noise` is out of range.
    """
    if noise is None or (isinstance(noise, str) and noise == "auto"):
        return np.ones(model.nv)
    if isinstance(noise, str):
        raise InputError(f"`noise` is {noise!r}; expected 'auto', or a standard deviation for each joint.")
    sigma = number_or_array("noise", in_order("noise", noise, model.velocity_names), model.nv)
    if not (np.isfinite(sigma).all() and (sigma > 0.0).all()):
        raise InputError(f"`noise` is {noise}; expected finite numbers above zero.")
    return sigma.copy()


def parameter_sizes(model: Model, p0: Floats) -> Floats:
    """D: what is a large change of each parameter.

    Args:
        model: The robot.
        p0: Parameters of about the right size, (n,).

    Returns:
        Sizes, (n,); inf for drives.
    """
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


def reduced(W: Floats, y: Floats) -> tuple[Floats, Floats]:
    """R and z, divided by the root of the number of rows, so that sums of squares are means.

    Args:
        W: The regressor, (..., n).
        y: The torques, (...).

    Returns:
        R, (k, n), and z, (k,).
    """
    n = W.shape[-1]
    stacked = np.concatenate([W.reshape(-1, n), y.reshape(-1, 1)], axis=1) / np.sqrt(y.size)
    R: Floats = np.array(np.linalg.qr(stacked, mode="r"))
    return R[:, :n], R[:, n]


def linear_fit(R: Floats, z: Floats, p0: Floats, sizes: Floats, ridge: float) -> tuple[Floats, int]:
    """The least squares solution that is nearest to the prior.

    Args:
        R: The regressor, reduced, (k, n).
        z: The torques, reduced, (k,).
        p0: The prior, (n,).
        sizes: D of the table, (n,).
        ridge: How much staying near counts [any].

    Returns:
        The parameters (n,), and 1 for one step.
    """
    units = np.where(np.isinf(sizes), 1.0, sizes)
    rows, right = R * units, z - R @ p0
    if ridge > 0.0:
        rows = np.concatenate([rows, np.sqrt(ridge) * np.diag(units / sizes)])
        right = np.concatenate([right, np.zeros(len(p0))])
    step = np.linalg.lstsq(rows, right, rcond=1e-10)[0]
    return p0 + units * step, 1


def physical_fit(
    R: Floats,
    z: Floats,
    p0: Floats,
    sizes: Floats,
    ridge: float,
    count: int,
    progress: Callable[[Progress], object] | None,
) -> tuple[Floats, int]:
    """As `linear_fit`, over bodies that can exist and drives whose numbers are not negative.

    Args:
        R: The regressor, reduced, (k, n).
        z: The torques, reduced, (k,).
        p0: The prior, (n,).
        sizes: D of the table, (n,).
        ridge: How much staying near counts [any].
        count: How many bodies there are.
        progress: Called after each step.

    Returns:
        The parameters (n,), and the number of steps.
    """
    lengths, norm = np.sqrt((R * R).sum(axis=0)), float(np.sqrt(z @ z)) or 1.0
    undetermined = np.isinf(sizes) & (
        lengths == 0.0
    )  # drives that the log does not move keep the prior's numbers
    identifiable = ~undetermined
    units = np.where(np.isinf(sizes), norm / np.where(lengths == 0.0, 1.0, lengths), sizes)
    w = np.where(np.isinf(sizes), 1e-12 * norm**2, max(ridge, 1e-10 * norm**2))
    u, steps = minimised(
        Problem((R * units)[:, identifiable], z, w[identifiable], (p0 / units)[identifiable], count), progress
    )
    p = np.maximum(p0, 0.0)
    p[identifiable] = units[identifiable] * u
    return p, steps


def checked_ridge(ridge: float | None) -> float | None:
    """`ridge`, if it can be one."""
    return None if ridge is None else number("ridge", ridge, "a finite number of zero or more", least=0.0)


def solved(
    R: Floats,
    z: Floats,
    p0: Floats,
    sizes: Floats,
    ridge: float | None,
    bodies: int | None,
    progress: Callable[[Progress], object] | None = None,
) -> tuple[Floats, int]:
    """The parameters of least cost, and the steps of the solver.

    Args:
        R: The regressor, reduced, (k, n).
        z: The torques, reduced, (k,).
        p0: Parameters to stay near to, (n,).
        sizes: D of the table, (n,).
        ridge: How much staying near counts; None for what `identify` says [any].
        bodies: How many bodies must be such as can exist; None for no such condition.
        progress: Called after each step.

    Returns:
        The parameters (n,), and the number of steps.
    """
    if bodies is None:
        return linear_fit(R, z, p0, sizes, ridge or 0.0)
    weight = 1e-6 * float(z @ z) if ridge is None else ridge
    return physical_fit(R, z, p0, sizes, weight, bodies, progress)


def drive_parameters(model: Model, p: Floats, sought: dict[str, bool]) -> dict[str, Floats]:
    """Armature, damping and friction by name: what was found, and of what was not sought the model's.

    Args:
        model: The robot.
        p: What was found, (n,).
        sought: Which of them were sought.

    Returns:
        Arrays (nv,) by name.
    """
    drives, at = {}, 10 * len(model.joints)
    for name, wanted in sought.items():
        drives[name] = p[at : at + model.nv] if wanted else np.array(getattr(model, name))
        at += model.nv * wanted
    return drives


def base_statistics(base: BaseParameters, rows: Floats, squares: float, count: int) -> tuple[Floats, float]:
    """How well a log determines its base parameters.

    Args:
        base: The base parameters.
        rows: The regressor, weighed, (k, n), or any matrix of the same products of columns.
        squares: The sum of the squared residuals, weighed [-].
        count: How many torques the log has.

    Returns:
        Standard deviations of the base parameters, (b,), inf where the log has no more torques than there are base
        parameters; and the condition number of their regressor.
    """
    W1 = base.columns(rows)
    lengths = np.sqrt((W1 * W1).sum(axis=0))
    values = np.linalg.svd(W1 / lengths, compute_uv=False) if base.count else np.ones(1)
    surplus = count - base.count  # as many torques as parameters fit whatever the noise
    misfit = squares / surplus if surplus > 0 else np.inf
    variances = np.diag(np.linalg.pinv((W1 / lengths).T @ (W1 / lengths))) if base.count else np.zeros(0)
    condition = float(values[0] / values[-1]) if values[-1] > 0.0 else np.inf
    return np.sqrt(misfit * np.maximum(variances, 0.0)) / lengths, condition


def fitted_fields(
    model: Model, p: Floats, sought: dict[str, bool], rows: Floats, squares: float, count: int
) -> dict[str, Any]:
    """The fields of a result that describe its parameters and how well the log determines them.

    Args:
        model: The robot.
        p: The parameters, (n,).
        sought: Which parameters of the drives were sought.
        rows: The regressor, weighed, (k, n), or any matrix of the same products of columns.
        squares: The sum of the squared residuals, weighed [-].
        count: How many torques the log has.

    Returns:
        Fields of `FittedParameters` by name.
    """
    base = base_parameters_of(rows, parameter_names(model, **sought))
    deviations, condition = base_statistics(base, rows, squares, count)
    return {
        "model": model,
        "parameters": p[: 10 * len(model.joints)],
        **drive_parameters(model, p, sought),
        "base": base,
        "base_values": base.of(p),
        "base_deviations": deviations,
        "condition": condition,
    }
