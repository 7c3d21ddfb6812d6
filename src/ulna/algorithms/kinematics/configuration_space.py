"""The space of configurations: moving in it, measuring in it, drawing from it, and the derivatives of that.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| q | configuration: for each joint a point of its Lie group | (..., nq) | [rad], [m], quaternion | |
| v | tangent vector at q, in the moving frames | (..., nv) | [rad], [m] | |
| integrate | q (+) v, the configuration reached | (..., nq) | | q exp(v), joint by joint |
| difference | q1 (-) q0, the tangent vector that leads there | (..., nv) | | log(q0^-1 q1) |
| dq/dt | d integrate(q, t v) / dt at t = 0 | (..., nq) | [q] per second | |
| d integrate | its derivatives with respect to q and v | (..., nv, nv) | | Ad(exp(v))^-1 and J_r(v), in blocks |

Source: Sola, Deray & Atchuthan, A micro Lie theory (2018), sections II and III. A mimic joint has no
separate coordinate, so it does not appear here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.model import Joint, Model
from ulna.numeric import sqrt
from ulna.typing import Array, Floats


def integrate(model: Model, q: Array, v: Array) -> Array:
    """The configuration reached from `q` by moving along `v` for one unit of time.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Tangent vector at `q`, in the moving frames, shape (..., nv) [rad, m].

    Returns:
        Configuration, shape (..., nq) [rad, m].
    """
    return _join(model, (q, v), lambda joint: joint.kind.integrate(_q(joint, q), _v(joint, v)))


def coordinate_rates(model: Model, q: Array, v: Array) -> Array:
    """The rates of the coordinates at a velocity: `v` itself for plain joints, quaternion rates for ball joints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        dq/dt, shape (..., nq) [rad/s, m/s, 1/s].
    """
    return _join(model, (q, v), lambda joint: joint.kind.coordinate_rates(_q(joint, q), _v(joint, v)))


def difference(model: Model, q0: Array, q1: Array) -> Array:
    """The tangent vector that leads from `q0` to `q1` on the shortest path: `integrate(q0, difference(q0, q1))` is
    q1.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].

    Returns:
        Tangent vector at `q0`, shape (..., nv) [rad, m].
    """
    d = batch_zeros((model.nv,), q0, q1)
    for joint in _independent(model):
        d[..., _rows(joint)] = joint.kind.difference(_q(joint, q0), _q(joint, q1))
    return d


def interpolate(model: Model, q0: Array, q1: Array, t: Any) -> Array:
    """The configuration at a fraction of the shortest path from `q0` to `q1`.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].
        t: The fraction, shape (...) [-]: 0 at `q0`, 1 at `q1`.

    Returns:
        Configuration, shape (..., nq) [rad, m].
    """
    inputs = (q0, q1, np.asarray(t)[..., None])
    return _join(model, inputs, lambda joint: joint.kind.interpolate(_q(joint, q0), _q(joint, q1), t))


def neutral(model: Model) -> Floats:
    """The configuration in which every joint is at its neutral position (`JointKind.neutral`), shape (nq,)."""
    return _join(model, (np.zeros(0),), lambda joint: joint.kind.neutral())


def normalize(model: Model, q: Array) -> Array:
    """The same pose with quaternions of unit length and free angles in (-pi, pi].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        Configuration, shape (..., nq) [rad, m].
    """
    return _join(model, (q,), lambda joint: joint.kind.normalize(_q(joint, q)))


def random(
    model: Model,
    rng: np.random.Generator,
    size: tuple[int, ...] = (),
    lower: Floats | None = None,
    upper: Floats | None = None,
) -> Floats:
    """Configurations drawn evenly within the limits.

    Where there are no limits `JointKind.random` says what is drawn from.

    Args:
        model: The robot.
        rng: The source of random numbers.
        size: Shape of the batch.
        lower: Lower limits, shape (nq,) [rad, m]; None for the model's.
        upper: Upper limits, shape (nq,) [rad, m]; None for the model's.

    Returns:
        Configurations, shape (*size, nq) [rad, m].
    """
    low = model.lower_position if lower is None else lower
    high = model.upper_position if upper is None else upper
    return _join(
        model,
        (np.zeros((*size, 0)),),
        lambda joint: joint.kind.random(rng, _q(joint, low), _q(joint, high), size),
    )


def squared_distance(model: Model, q0: Array, q1: Array) -> Any:
    """The squared length of `difference(q0, q1)`; adds rad^2 and m^2 as they are.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].

    Returns:
        Shape (...) [rad^2, m^2].
    """
    d = difference(model, q0, q1)
    return (d * d).sum(axis=-1)


def distance(model: Model, q0: Array, q1: Array) -> Any:
    """The length of `difference(q0, q1)`; adds rad^2 and m^2 as they are.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].

    Returns:
        Shape (...) [rad, m].
    """
    return sqrt(squared_distance(model, q0, q1))


def is_same(model: Model, q0: Floats, q1: Floats, tolerance: float = 1e-9) -> Any:
    """Whether two configurations are equal within a tolerance; numbers only.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].
        tolerance: The largest component of `difference(q0, q1)` that is accepted [rad, m].

    Returns:
        Truth values, shape (...).
    """
    return (np.abs(difference(model, q0, q1)) <= tolerance).all(axis=-1)


def integrate_derivatives(model: Model, q: Array, v: Array) -> tuple[Array, Array]:
    """The derivatives of `integrate` with respect to q and v.

    Both map a change of the argument, a tangent vector, to the change of the result, a tangent vector at the result.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Tangent vector at `q`, in the moving frames, shape (..., nv) [rad, m].

    Returns:
        Two block-diagonal matrices, each of shape (..., nv, nv) [-].
    """
    return _blocks(model, (q, v), lambda joint: joint.kind.integrate_derivatives(_q(joint, q), _v(joint, v)))


def difference_derivatives(model: Model, q0: Array, q1: Array) -> tuple[Array, Array]:
    """The derivatives of `difference` with respect to q0 and q1, each along its tangent space.

    Args:
        model: The robot.
        q0: Configuration, shape (..., nq) [rad, m].
        q1: Configuration, shape (..., nq) [rad, m].

    Returns:
        Two block-diagonal matrices, each of shape (..., nv, nv) [-].
    """
    return _blocks(
        model, (q0, q1), lambda joint: joint.kind.difference_derivatives(_q(joint, q0), _q(joint, q1))
    )


def _independent(model: Model) -> Iterator[Joint]:
    return (joint for joint in model.joints if joint.mimic is None)


def _q(joint: Joint, q: Array) -> Array:
    return q[..., joint.idx_q : joint.idx_q + joint.kind.nq]


def _v(joint: Joint, v: Array) -> Array:
    return v[..., _rows(joint)]


def _rows(joint: Joint) -> slice:
    return slice(joint.idx_v, joint.idx_v + joint.kind.nv)


def _join(model: Model, inputs: tuple[Array, ...], f: Callable[[Joint], Array]) -> Array:
    """The configuration whose part for each joint is f(joint)."""
    q = batch_zeros((model.nq,), *inputs)
    for joint in _independent(model):
        _q(joint, q)[...] = f(joint)
    return q


def _blocks(
    model: Model, inputs: tuple[Array, ...], f: Callable[[Joint], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """The two matrices whose diagonal blocks are f(joint)."""
    first, second = (batch_zeros((model.nv, model.nv), *inputs) for _ in range(2))
    for joint in _independent(model):
        rows = _rows(joint)
        first[..., rows, rows], second[..., rows, rows] = f(joint)
    return first, second
