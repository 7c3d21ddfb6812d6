"""Least squares for dynamic parameters in one pass over a log, which need not fit in memory.

| symbol | meaning | shape |
|---|---|---|
| W_j, y_j | regressor and torques of joint j, without what is known | (rows, n), (rows) |
| R_j | the triangle of a QR decomposition of [W_j, y_j]: it has the same products of columns | (n + 1, n + 1) |

Triangles of two blocks, one above the other, are reduced to that of both. Torques are weighed joint by joint, so the
triangles of all joints, each divided by its joint's noise, are all that a fit needs, with `noise="auto"`, too. Source:
Golub & Van Loan, Matrix Computations (2013), section 5.2; the products of columns themselves (normal equations) would
lose half of the digits, and with them the base parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np

from ulna.checks.values import flag, number
from ulna.errors import InputError
from ulna.identification.convex import Progress
from ulna.identification.identifiable_parameters import extended_regressor, parameter_names
from ulna.identification.result import FittedParameters, explained_part
from ulna.identification.solve import (
    NO_SAMPLES,
    Log,
    checked_noise,
    checked_prior,
    checked_ridge,
    fitted_fields,
    known_torques,
    parameter_sizes,
    present_parameters,
    reduced,
    solved,
)
from ulna.model import Model
from ulna.system.progress import Report, silent
from ulna.typing import Array, ArrayLike, Floats

Sums = dict[str, Array]
"""What is kept of a log: "rows" (1,), "triangles" (nv, n + 1, n + 1), and "tau", "tau2" and "most" (nv,)."""

_ROWS = 512  # samples at a time
_SINGLE = 5000  # entries of a matrix that BLAS takes in one thread; several would wait more than compute


@final
@dataclass(frozen=True)
class Sought:
    """Which parameters are sought.

    Attributes:
        armature: Whether the inertia of the drives is.
        damping: Whether viscous friction is.
        friction: Whether Coulomb friction is.
        width: Velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].
    """

    armature: bool = False
    damping: bool = False
    friction: bool = False
    width: float = 1e-2

    def __post_init__(self) -> None:
        for name, wanted in self.drives.items():
            flag(name, wanted)
        number("width", self.width, "a velocity above zero [rad/s, m/s]", above=0.0)

    @property
    def drives(self) -> dict[str, bool]:
        """The same for the drives, by name."""
        return {"armature": self.armature, "damping": self.damping, "friction": self.friction}


def no_rows(model: Model, sought: Sought) -> Sums:
    """The sums of a log without samples.

    Args:
        model: The robot.
        sought: Which parameters are sought.

    Returns:
        The sums.
    """
    n, nv = len(parameter_names(model, **sought.drives)), model.nv
    return {
        "rows": np.zeros(1, np.int64),
        "triangles": np.zeros((nv, n + 1, n + 1)),
        **{name: np.zeros(nv) for name in ("tau", "tau2", "most")},
    }


def sums_of(
    robot: Any,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    tau: ArrayLike,
    sought: Sought,
    report: Report = silent,
) -> Sums:
    """The sums of a log, or of a block of it.

    Args:
        robot: An `ulna.Robot`.
        q: Configurations, (rows, nq) [rad, m].
        v: Velocities, (rows, nv) [rad/s, m/s].
        a: Accelerations, (rows, nv) [rad/s^2, m/s^2].
        tau: Torques of the drives, (rows, nv) [N m, N].
        sought: Which parameters are sought.
        report: Called after each part of the block with how many samples are done, and of how many.

    Returns:
        The sums.
    """
    log, total = Log.checked(robot.model, q, v, a, tau), no_rows(robot.model, sought)
    for here, part in _parts(log):
        W = extended_regressor(robot, part.q, part.v, part.a, **sought.drives, width=sought.width)
        y = part.tau - known_torques(robot.model, part, sought.drives, sought.width)
        block = {
            "rows": np.array([len(y)]),
            "triangles": np.concatenate([W, y[..., None]], axis=-1).transpose(1, 0, 2),
            "tau": part.tau.sum(axis=0),
            "tau2": (part.tau**2).sum(axis=0),
            "most": np.abs(y).max(axis=0),
        }
        add(total, block)
        report(here.stop, len(log.q))
    return total


def torques(robot: Any, log: Log, sought: Sought, parameters: ArrayLike) -> Floats:
    """The torques that parameters explain, with what is known.

    Args:
        robot: An `ulna.Robot`.
        log: The log.
        sought: Which parameters are sought.
        parameters: The parameters sought, one set in a row, (k, n).

    Returns:
        Torques of the drives, (k, rows, nv) [N m, N].
    """
    p = np.asarray(parameters, dtype=float)
    out = np.empty((len(p), *log.tau.shape))
    for here, part in _parts(log):
        W = extended_regressor(robot, part.q, part.v, part.a, **sought.drives, width=sought.width)
        known = known_torques(robot.model, part, sought.drives, sought.width)
        out[:, here] = np.moveaxis(W @ p.T, -1, 0) + known
    return out


def _parts(log: Log) -> Iterator[tuple[slice, Log]]:
    """A log in parts, with their places: small ones stay in the processor's cache, and Ctrl-C is heard in between."""
    for first in range(0, len(log.q), _ROWS):
        here = slice(first, min(first + _ROWS, len(log.q)))
        yield here, Log(log.q[here], log.v[here], log.a[here], log.tau[here])


def add(total: Sums, block: Sums) -> None:
    """Adds the sums of a block to those of what came before it.

    Args:
        total: The sums, which are changed.
        block: The sums of the block; its triangles may have any number of rows.
    """
    for name in ("rows", "tau", "tau2"):
        total[name] += block[name]
    total["most"] = np.maximum(total["most"], block["most"])
    for k, (triangle, more) in enumerate(zip(total["triangles"], block["triangles"], strict=True)):
        moves = np.flatnonzero((triangle != 0.0).any(axis=0) | (more != 0.0).any(axis=0))
        R, left = triangle[:, moves], more[:, moves]  # a torque depends on some bodies only
        rows = max(_SINGLE // max(len(moves), 1) - len(moves), len(moves), 1)
        for first in range(0, len(left), rows):
            R = np.linalg.qr(np.concatenate([R, left[first : first + rows]]), mode="r")
        total["triangles"][k] = 0.0
        total["triangles"][k][: len(R), moves] = R


@final
@dataclass(frozen=True, eq=False, repr=False)
class LogFit(FittedParameters):
    """The parameters that explain a large log best; as `Identification`, without the torques themselves.

    Attributes:
        rows: How many samples the log has.
        rms: Root mean square of the residuals of each joint, (nv,) [N m, N].
        rms_before: The same with the parameters of the model that was started from, (nv,) [N m, N].
        explained: What part of each joint's variance of torque the fit explains, (nv,); at most 1.
    """

    rows: int
    rms: Floats
    rms_before: Floats
    explained: Floats

    def report(self) -> str:
        """The residuals joint by joint, and how well the log determines the parameters, as text."""
        lines = [
            *self._heading(f"{self.rows:,} samples"),
            f"  {'joint':24s} {'rms before':>12s} {'rms after':>12s} {'explained':>10s}",
        ]
        numbers = zip(self.model.velocity_names, self.rms_before, self.rms, self.explained, strict=True)
        lines += [f"  {name:24s} {a:12.4g} {b:12.4g} {100 * c:9.2f}%" for name, a, b, c in numbers]
        return "\n".join(lines)

    def __repr__(self) -> str:
        rms = np.sqrt((self.rms**2).mean())
        return f"<identification of {self.model.name!r}: {self.rows:,} samples, rms {rms:.4g}>"


def fit_sums(
    model: Model,
    sums: Sums,
    sought: Sought,
    *,
    physical: bool = False,
    prior: ArrayLike | None = None,
    ridge: float | None = None,
    noise: ArrayLike | Literal["auto"] | None = None,
) -> LogFit:
    """The parameters that explain a log best, from its sums: what `identify` finds in memory.

    Args:
        model: The robot.
        sums: The sums of all blocks.
        sought: Which parameters are sought.
        physical: As for `identify`.
        prior: As for `identify`, (10 nbodies,).
        ridge: As for `identify` [(N m)^2].
        noise: As for `identify`, (nv,) [N m or N].

    Returns:
        The parameters with their residuals.

    Raises:
        InputError: If the log has no samples, or `ridge` or `noise` is out of range.
    """
    p, fields = fitted(model, sums, sought, physical=physical, prior=prior, ridge=ridge, noise=noise)
    rows, rms = int(sums["rows"][0]), _residuals(sums, p)
    mean_square = sums["tau2"] / rows
    variance = mean_square - (sums["tau"] / rows) ** 2
    return LogFit(
        **fields,
        rows=rows,
        rms=rms,
        rms_before=_residuals(sums, present_parameters(model, sought.drives)),
        explained=explained_part(rms, variance, mean_square),
    )


def fitted(
    model: Model,
    sums: Sums,
    sought: Sought,
    *,
    physical: bool,
    prior: ArrayLike | None,
    ridge: float | None,
    noise: ArrayLike | Literal["auto"] | None,
    progress: Callable[[Progress], object] | None = None,
) -> tuple[Floats, dict[str, Any]]:
    """The parameters that explain a log best, from its sums.

    Args:
        model: The robot.
        sums: The sums of the whole log.
        sought: Which parameters are sought.
        physical: As for `identify`.
        prior: As for `identify`, (10 nbodies,).
        ridge: As for `identify` [(N m)^2].
        noise: As for `identify`, (nv,) [N m or N].
        progress: As for `identify`.

    Returns:
        The parameters sought, (n,), and the fields of `FittedParameters` by name.

    Raises:
        InputError: If the log has no samples, or `ridge` or `noise` is out of range.
    """
    rows, triangles = int(sums["rows"][0]), sums["triangles"]
    if not rows:
        raise InputError(NO_SAMPLES)
    p0 = present_parameters(model, sought.drives)
    if prior is not None:
        p0[: 10 * len(model.joints)] = checked_prior(model, prior)
    flag("physical", physical)
    sigma, ridge, sizes = checked_noise(noise, model), checked_ridge(ridge), parameter_sizes(model, p0)
    bodies, scale = len(model.joints) if physical else None, np.sqrt(triangles.shape[1] / rows)

    def solution(sigma: Floats) -> tuple[Floats, int]:
        weighed = (
            triangles / sigma[:, None, None] * scale
        )  # means over the rows; `reduced` takes those of fewer
        return solved(*reduced(weighed[..., :-1], weighed[..., -1]), p0, sizes, ridge, bodies, progress)

    p, count = solution(sigma)
    if isinstance(noise, str):
        least = 1e-12 + 1e-9 * float(sums["most"].max(initial=0.0))
        p, count = solution(np.maximum(_residuals(sums, p), least))
        sigma = np.maximum(_residuals(sums, p), least)
    stack = (triangles[..., :-1] / sigma[:, None, None]).reshape(-1, len(p))
    squares = float(rows * ((_residuals(sums, p) / sigma) ** 2).sum())
    fields = fitted_fields(model, p, sought.drives, stack, squares, rows * model.nv)
    return p, {**fields, "physical": physical, "iterations": count}


def _residuals(sums: Sums, p: Floats) -> Floats:
    """The root mean square of the residuals of each joint, (nv,)."""
    return np.sqrt(((sums["triangles"] @ np.append(-p, 1.0)) ** 2).sum(axis=1) / sums["rows"][0])
