"""Base parameters: the combinations of dynamic parameters that torques distinguish.

| symbol | meaning | shape |
|---|---|---|
| W | regressors of many states, one above the other | (rows, n) |
| p1, p2 | parameters whose columns are independent, and the others: W2 = W1 K | (b), (n - b) |
| pi | base parameters: W p = W1 pi | (b), pi = p1 + K p2 |

Source: Gautier, Numerical calculation of the base inertial parameters of robots (1991); the columns are taken one after
the other and kept when they add something, which is the QR decomposition without pivots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.algorithms.dynamics.regressors import PARAMETERS
from ulna.checks.arrays import finite_array
from ulna.checks.values import checked_robot, flag, generator
from ulna.checks.values import count as checked_count
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.typing import ArrayLike, Floats


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """Which combinations of the parameters torques depend on.

    Attributes:
        names: Names of all parameters, (n,).
        independent: Places of the parameters that stand for a base parameter, ascending, (b,).
        matrix: The map from all parameters to the base parameters, (b, n).
    """

    names: tuple[str, ...]
    independent: tuple[int, ...]
    matrix: Floats

    @property
    def count(self) -> int:
        """b, how many there are."""
        return len(self.independent)

    def of(self, parameters: ArrayLike) -> Floats:
        """The base parameters (..., b) of parameters (..., n)."""
        p = np.asarray(parameters, dtype=float)
        if p.shape[-1:] != (len(self.names),):
            raise ShapeError("parameters", p.shape, f"(..., {len(self.names)})")
        return p @ self.matrix.T

    def columns(self, W: Floats) -> Floats:
        """W1: the columns (..., b) of a regressor (..., n) that belong to the base parameters."""
        return W[..., list(self.independent)]

    @property
    def expressions(self) -> tuple[str, ...]:
        """Each base parameter as a sum of named parameters."""
        return tuple(self._sum(row) for row in self.matrix)

    def __str__(self) -> str:
        head = f"{self.count} base parameters of {len(self.names)} parameters"
        return "\n".join([head, *(f"  {k:3d}  {text}" for k, text in enumerate(self.expressions))])

    def _sum(self, row: Floats) -> str:
        terms = [f"{_factor(x)}{self.names[j]}" for j, x in enumerate(row) if x != 0.0]
        return " ".join(terms).removeprefix("+ ")


def check_moves(model: Model) -> None:
    """Refuses a robot without joints.

    Raises:
        InputError: Nothing moves.
    """
    if not model.nv:
        raise InputError(
            f"Model {model.name!r} has no joints that move; expected one at least, whose torque shows parameters."
        )


def base_parameters(
    robot: Any,
    *,
    armature: bool = False,
    damping: bool = False,
    friction: bool = False,
    samples: int | None = None,
    seed: int = 0,
) -> BaseParameters:
    """The base parameters of a robot, from regressors at random states.

    Args:
        robot: An `ulna.Robot`.
        armature: Whether the inertia of the drives counts as a parameter.
        damping: Whether viscous friction does.
        friction: Whether Coulomb friction does.
        samples: How many states; None for enough of them.
        seed: Seed of the random states.

    Returns:
        The base parameters.

    Raises:
        InputError: An argument is no robot, flag, count or seed, or the robot has no joints.

    Example:
        >>> ulna.identification.base_parameters(ulna.load("ur5")).count
        36
    """
    model: Model = checked_robot(robot).model
    check_moves(model)
    for name, counts in {"armature": armature, "damping": damping, "friction": friction}.items():
        flag(name, counts)
    rng = generator("seed", seed)
    names = parameter_names(model, armature=armature, damping=damping, friction=friction)
    count = (
        max(50, 3 * len(names) // max(model.nv, 1)) if samples is None else checked_count("samples", samples)
    )
    q = robot.random_configuration(count, rng)
    v, a = rng.standard_normal((2, count, model.nv))
    W = extended_regressor(robot, q, v, a, armature=armature, damping=damping, friction=friction)
    return base_parameters_of(W.reshape(-1, W.shape[-1]), names)


def base_parameters_of(
    W: ArrayLike, names: Sequence[str] | None = None, noise: float = 1e-9
) -> BaseParameters:
    """The base parameters that a stack of regressors can distinguish.

    With logged states in place of random ones it says what that log excites.

    Args:
        W: Regressors one above the other, shape (rows, n).
        names: Names of the parameters; None numbers them.
        noise: A column whose part that is independent of the earlier ones is less than this fraction of it depends on
            them [-].

    Returns:
        The base parameters.

    Raises:
        ShapeError: `W` is not a matrix.
        InputError: there are not as many names as columns.
    """
    stack = finite_array("W", W)
    if stack.ndim != 2:
        raise ShapeError("W", stack.shape, "(rows, n)")
    n = stack.shape[1]
    names = tuple(f"p{j}" for j in range(n)) if names is None else tuple(names)
    if len(names) != n:
        raise InputError(f"There are {len(names)} names for {n} parameters; expected as many.")
    R: Floats = np.array(np.linalg.qr(stack, mode="r"))  # the columns keep their lengths and angles
    lengths = np.sqrt((R * R).sum(axis=0))
    least = 1e-12 * max(float(lengths.max(initial=0.0)), 1e-300)
    basis = np.zeros((R.shape[0], 0))
    chosen: list[int] = []
    for j in range(n):
        if lengths[j] <= least:
            continue
        residual = R[:, j] / lengths[j]
        for _ in range(2):  # once more, for the rounding errors of the first time
            residual = residual - basis @ (basis.T @ residual)
        size = float(np.linalg.norm(residual))
        if size > noise:
            chosen.append(j)
            basis = np.column_stack([basis, residual / size])
    scales = np.where(lengths > least, lengths, 1.0)
    K = (
        np.linalg.lstsq(R[:, chosen] / scales[chosen], R / scales, rcond=None)[0]
        if chosen
        else np.zeros((0, n))
    )
    K[np.abs(K) < 1e3 * noise] = 0.0
    matrix = K * scales / scales[chosen][:, None]
    matrix[:, lengths <= least] = 0.0
    matrix[:, chosen] = np.eye(len(chosen))
    return BaseParameters(names, tuple(chosen), matrix)


def parameter_names(
    model: Model, *, armature: bool = False, damping: bool = False, friction: bool = False
) -> tuple[str, ...]:
    """The names of the columns of `extended_regressor`.

    Args:
        model: The robot.
        armature: Whether the inertia of the drives counts as a parameter.
        damping: Whether viscous friction does.
        friction: Whether Coulomb friction does.

    Returns:
        One name a column.
    """
    names = [f"{name}({joint.name})" for joint in model.joints for name in PARAMETERS]
    for word, wanted in (("armature", armature), ("damping", damping), ("friction", friction)):
        names += [f"{word}({name})" for name in model.velocity_names] if wanted else []
    return tuple(names)


def extended_regressor(
    robot: Any,
    q: Floats,
    v: Floats,
    a: Floats,
    *,
    armature: bool = False,
    damping: bool = False,
    friction: bool = False,
    width: float = 1e-2,
) -> Floats:
    """The joint torque regressor with columns for the drives.

    The further columns, nv each, are diagonal: the acceleration, the velocity, and its sign, smooth within `width`.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        armature: Whether there are columns for the inertia of the drives.
        damping: Whether there are columns for viscous friction.
        friction: Whether there are columns for Coulomb friction.
        width: Velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].

    Returns:
        The regressor, shape (..., nv, n).
    """
    Y = robot.regressors.joint_torque(q, v, a)
    eye = np.eye(robot.nv)
    parts = [Y]
    for wanted, value in ((armature, a), (damping, v), (friction, np.tanh(v / width))):
        if wanted:
            parts.append(value[..., None] * eye)
    return np.concatenate(parts, axis=-1)


def _factor(x: float) -> str:
    sign = "-" if x < 0.0 else "+"
    size = abs(x)
    return f"{sign} " if abs(size - 1.0) < 1e-9 else f"{sign} {size:.4g} "
