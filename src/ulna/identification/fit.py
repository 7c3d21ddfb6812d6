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
Without ridge the parameters that the log does not distinguish stay as near to the prior as they can.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from ulna.checks.values import checked_robot
from ulna.checks.values import function as checked_function
from ulna.errors import InputError
from ulna.identification.blocks import Sought, fitted, sums_of, torques
from ulna.identification.convex import Progress
from ulna.identification.result import Identification
from ulna.identification.solve import Log, present_parameters
from ulna.model import Model
from ulna.system.progress import progress as task_progress
from ulna.typing import ArrayLike


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
        tau: Torques of the drives, shape (rows, nv) [N m, N]: with the friction of the joints, so those of another
            model are `inverse_dynamics(q, v, a, friction=True)`.
        armature: Whether to seek the inertia of the drives.
        damping: Whether to seek viscous friction.
        friction: Whether to seek Coulomb friction.
        physical: Whether the bodies must be physically consistent (positive definite pseudo-inertia) and the
            parameters of the drives not negative. The cost found is then certain to be within 1e-8 of the least one,
            or within 1e-13 of the mean squared torque where that is more.
        prior: Dynamic parameters to stay near to, (10 nbodies,); None for the model's.
        ridge: How much staying near to the prior counts: what a deviation of every parameter by its own size costs,
            beside the mean squared residual [(N m)^2]. None for nothing, or for 1e-6 of the mean squared torque where
            `physical`; there it is 1e-10 of that at least, so that one solution is the best. The
            default makes fits of noisy logs predict better, and leaves residuals of about 1e-4 of the torques where
            data are exact; 0 leaves none.
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
    model: Model = checked_robot(robot).model
    if progress is not None:
        checked_function("progress", progress)
    if progress is not None and not physical:
        raise InputError(
            "`progress` reports the steps of physical=True; the linear solver has none. Leave it out."
        )
    log, sought = Log.checked(model, q, v, a, tau), Sought(armature, damping, friction, width)
    with task_progress("Identifying") as report:
        sums = sums_of(robot, log.q, log.v, log.a, log.tau, sought, report)
        p, fields = fitted(
            model, sums, sought, physical=physical, prior=prior, ridge=ridge, noise=noise, progress=progress
        )
        after, before = torques(robot, log, sought, [p, present_parameters(model, sought.drives)])
    rms = np.sqrt((log.v**2).mean(axis=0))
    unmoved = tuple(name for name, size in zip(model.velocity_names, rms, strict=True) if size < width)
    return Identification(**fields, measured=log.tau, fitted=after, before=before, unmoved=unmoved)
