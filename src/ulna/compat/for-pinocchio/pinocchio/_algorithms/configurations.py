"""The space of configurations: neutral, random, integrate, difference and their derivatives."""

from __future__ import annotations

import functools
import itertools
from typing import Any

import numpy as np

from pinocchio._containers.arguments import (
    OMITTED,
    ArgumentError,
    checked,
    checks_itself,
    wrong_model,
)
from pinocchio._containers.arrays import StdVec, exact, is_float_array, not_applicable, rows_of
from pinocchio._containers.enums import ArgumentPosition
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.lie_group import first_or_second
from pinocchio._model.live_parameters import FREE
from pinocchio._model.model import Model
from pinocchio._model.quaternion_signs import quaternion_starts, with_continuous_signs
from pinocchio._spatial.random_numbers import STATE, drawn, normal_deviates
from ulna import algorithms, numeric
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
from ulna.errors import InputError
from ulna.model import Model as CoreModel
from ulna.model.joints.joint_kind import Coordinate
from ulna.numeric import less, minimum, where
from ulna.typing import Array, Floats

__all__ = [
    "compactTangentMap",
    "dDifference",
    "dIntegrate",
    "dIntegrateTransport",
    "difference",
    "distance",
    "getTangentToConfigurationSparsitySegment",
    "integrate",
    "interpolate",
    "isNormalized",
    "isSameConfiguration",
    "neutral",
    "normalize",
    "randomConfiguration",
    "squaredDistance",
    "tangentMap",
    "tangentMapProduct",
    "tangentMapTransposeProduct",
]


def neutral(model: Model) -> Floats:
    """The configuration (nq,) in which nothing is turned or slid."""
    try:
        return model._new_neutral()  # pyright: ignore[reportAttributeAccessIssue]
    except AttributeError:  # asked for the first time, or of no model
        if not isinstance(model, Model):
            raise wrong_model("neutral", model) from None
    q = np.array(algorithms.neutral(model._compiled_structure().model))
    model._new_neutral = q.copy  # pyright: ignore[reportAttributeAccessIssue]
    return q.copy()


_PRECISION = 1e-12
_random_calls = call_cache(1, weak=1)


@repeated_calls(_random_calls)
@checks_itself
def randomConfiguration(model: Model, lower_bound: Any = OMITTED, upper_bound: Any = OMITTED) -> Floats:
    """A configuration (nq,) drawn evenly within the limits; where there is none, from [-pi, pi] or [-1, 1] m.

    Args:
        lower_bound: Least values (nq,); those of the model where neither is given.
        upper_bound: Greatest values (nq,).

    Returns:
        Configuration (nq,) [rad or m].

    Raises:
        ArgumentError: One of the limits is given without the other.
        InputError: A lower limit is above the upper one.
    """
    if not isinstance(model, Model):
        raise wrong_model("randomConfiguration", model)
    own_limits = lower_bound is OMITTED and upper_bound is OMITTED
    if own_limits:
        q = model._random_within_own_limits()
    else:
        if lower_bound is None or lower_bound is OMITTED or upper_bound is None or upper_bound is OMITTED:
            raise ArgumentError(
                "randomConfiguration was given one of lower_bound and upper_bound; expected both, or neither."
            )
        q = model._random(lower_bound, upper_bound)
    if q is NotImplemented:
        return _random_bound_anew(model, lower_bound, upper_bound)
    if own_limits:
        _random_calls.add(model._random_within_own_limits, 0, model)
    else:
        _random_calls.add(model._random, 2, model)
    return q


def _random_bound_anew(model: Model, low: Any, high: Any) -> Floats:
    """A random configuration where the bound kernel did not apply: converts the limits, and binds it."""
    sizes: dict[str, Any] = dict.fromkeys(("low", "high"), model.nq)
    kernel = model._compiled_structure().compile("random", _within, **sizes, state=STATE.shape)
    others = [np.zeros(()), STATE]
    if low is OMITTED:
        read = model.lowerPositionLimit, model.upperPositionLimit, STATE
        step = model._random_within_own_limits = BoundKernel(
            kernel, others=others, trailing_inputs=read, condition=1
        ).call
        q = step()
    else:
        low, high = exact(low, model.nq, "lower_bound"), exact(high, model.nq, "upper_bound")
        step = model._random = BoundKernel(kernel, others=others, trailing_inputs=[STATE], condition=1).call
        q = step(low, high)
    if q is NotImplemented:
        raise InputError(
            "randomConfiguration: a lower limit is above the upper one; expected lower_bound <= upper_bound."
        )
    return q


def _within(model: CoreModel) -> Any:
    """What evenly drawn numbers make within limits, 1 where there is room in all of them, and the generator's state.

    Normal deviates, scaled to unit length, are even over all rotations.
    """
    coordinates = [
        (k, c)
        for joint in model.joints
        for k, c in enumerate(() if joint.mimic else joint.kind.coordinates, start=joint.idx_q)
    ]
    units = [k for k, c in coordinates if c.unit == ""]

    def run(low: Array, high: Array, state: Array) -> tuple[Array, Array, Array]:
        draws, state = drawn(model.nq - len(units) + 2 * ((len(units) + 1) // 2), state)
        deviates, parts = iter(normal_deviates(draws[model.nq - len(units) :])), iter(draws)
        q = batch_zeros((model.nq,), low)
        for k, c in coordinates:
            q[k] = next(deviates) if c.unit == "" else _drawn(c, next(parts), low[k], high[k])
        narrowest = functools.reduce(minimum, high - low, np.inf)
        return normalized(q), where(less(-_SMALLEST, narrowest), 1.0, 0.0), state

    def normalized(q: Array) -> Array:
        unit = algorithms.normalize(model, q)
        free = [c.unit == "" for j in model.joints if not j.mimic for c in j.kind.coordinates]
        return np.where(free, unit, q)

    return run


def _drawn(c: Coordinate, part: Any, low: Any, high: Any) -> Any:
    """A part of the way from one limit to the other; where one is missing, from an interval of the usual width."""
    bounded_below, bounded_above, width = less(-FREE, low), less(high, FREE), c.high - c.low
    first = where(bounded_below, low, where(bounded_above, high - width, c.low))
    last = where(bounded_above, high, where(bounded_below, low + width, c.high))
    return first + (last - first) * part


_integrate_calls = call_cache(1, weak=1)


@repeated_calls(_integrate_calls)
@checks_itself
def integrate(model: Model, q: Any, v: Any) -> Floats:
    """The configuration (nq,) reached from q in one second with v.

    Args:
        v: Velocity times duration (nv,) [rad or m].

    Returns:
        Configuration (nq,) [rad or m].
    """
    try:
        result = model._integrate(q, v)
    except AttributeError:
        raise wrong_model("integrate", model) from None
    if result is NotImplemented:
        return _bound(model, "integrate", exact(q, model.nq, "q"), exact(v, model.nv, "v"))
    _integrate_calls.add(model._integrate, 2, model)
    return result


_difference_calls = call_cache(1, weak=1)


@repeated_calls(_difference_calls)
@checks_itself
def difference(model: Model, q1: Any, q2: Any) -> Floats:
    """The velocity (nv,) that leads from q1 to q2 in one second.

    Returns:
        Velocity (nv,) times one second [rad or m].
    """
    try:
        result = model._difference(q1, q2)
    except AttributeError:
        raise wrong_model("difference", model) from None
    if result is NotImplemented:
        return _bound(model, "difference", exact(q1, model.nq, "q1"), exact(q2, model.nq, "q2"))
    _difference_calls.add(model._difference, 2, model)
    return result


def _bound(model: Model, name: str, *state: Any) -> Any:
    """What the bound function of a model says, such as `integrate`, which is bound where it does not apply."""
    result = getattr(model, f"_{name}")(*state)
    if result is NotImplemented:
        maker = _OWN_KERNELS.get(name)
        kernel = model._compiled_structure().core_kernel(name) if maker is None else maker(model)
        setattr(model, f"_{name}", BoundKernel(kernel, holder=_NUMBERS.get(name)).call)
        result = getattr(model, f"_{name}")(*state)
    return result


_NUMBERS = {"distance": float, "is_normalized": bool, "is_normalized_within": bool}
"""What is one number, or a truth value."""


def _integration(model: Model) -> Any:
    """The kernel of `integrate`; free flyers keep the signs of their quaternions, as in Pinocchio."""
    compiled = model._compiled_structure()
    starts = quaternion_starts((j.idx_q, j.kind) for j in compiled.model.joints if not j.mimic)
    if not starts:
        return compiled.core_kernel("integrate")

    def build(core: CoreModel) -> Any:
        return with_continuous_signs(functools.partial(algorithms.integrate, core), starts)

    return compiled.compile("integrate", build, q=(model.nq,), v=(model.nv,))


def _squared_distances(model: Model) -> Any:
    shapes: dict[str, Any] = {"q1": (model.nq,), "q2": (model.nq,)}
    return model._compiled_structure().compile("squared", _squared_parts, **shapes)


def _normalization(model: Model) -> Any:
    """The kernel of `normalize`; what has no length stays as it is, as in Pinocchio."""
    return model._compiled_structure().compile("normalize", _normalized_lengths, q=(model.nq,))


def _normalized_lengths(model: CoreModel) -> Any:
    def run(q: Array) -> Array:
        out, unit = [*q], algorithms.normalize(model, q)
        for joint in model.joints:
            coordinates = () if joint.mimic else joint.kind.coordinates
            places = [joint.idx_q + k for k, c in enumerate(coordinates) if c.unit == ""]
            length = sum(q[k] * q[k] for k in places)
            for k in places:
                out[k] = where(less(0.0, length), unit[k], q[k])
        return np.array(out)

    return run


def _compact_tangent_map(model: Model) -> Any:
    """The kernel of `compactTangentMap`."""
    sizes, starts = getTangentToConfigurationSparsitySegment(model)
    columns = max([_LEAST_COLUMNS, *sizes])

    def build(core: CoreModel) -> Any:
        def run(q: Array) -> Array:
            whole = _tangent_map(core)(q)
            rows = [
                [*whole[i, start : start + size], *[0.0] * (columns - size)]
                for i, (size, start) in enumerate(zip(sizes, starts, strict=True))
            ]
            return np.array(rows)

        return run

    return model._compiled_structure().compile("compact tangent map", build, q=(model.nq,))


_OWN_KERNELS = {
    "integrate": _integration,
    "squared_distance": _squared_distances,
    "normalize": _normalization,
    "tangent_map": lambda model: model._compiled_structure().compile(
        "tangent map", _tangent_map, q=(model.nq,)
    ),
    "compact_tangent_map": _compact_tangent_map,
    "is_normalized": lambda model: _lengths(model, ()),
    "is_normalized_within": lambda model: _lengths(model, ("prec",)),
}
"""What is no kernel of Ulna as it is."""


_interpolate_calls = call_cache(1, weak=1)


@repeated_calls(_interpolate_calls)
@checked
def interpolate(model: Model, q1: Any, q2: Any, alpha: float) -> Floats:
    """The configuration (nq,) a part `alpha` of the way from q1 to q2.

    Args:
        alpha: Fraction of the way, 0 at q1 and 1 at q2 [-].

    Returns:
        Configuration (nq,) [rad or m].
    """
    result = model._interpolate(q1, q2, float(alpha) if type(alpha) is int else alpha)
    if result is NotImplemented:
        return _bound(model, "interpolate", *_exact_pair(model, q1, q2), float(alpha))
    if type(alpha) is float:
        _interpolate_calls.add(model._interpolate, 3, model)
    return result


_distance_calls = call_cache(1, weak=1)


@repeated_calls(_distance_calls)
@checks_itself
def distance(model: Model, q1: Any, q2: Any) -> float:
    """The length of the difference.

    Returns:
        The length [rad or m].
    """
    try:
        result = model._distance(q1, q2)
    except AttributeError:
        raise wrong_model("distance", model) from None
    if result is NotImplemented:
        return _bound(model, "distance", exact(q1, model.nq, "q1"), exact(q2, model.nq, "q2"))
    _distance_calls.add(model._distance, 2, model)
    return result


_squared_calls = call_cache(1, weak=1)


@repeated_calls(_squared_calls)
@checked
def squaredDistance(model: Model, q1: Any, q2: Any) -> Floats:
    """For each joint, the squared length of its part of the difference.

    Returns:
        Squared lengths (njoints - 1,), joints that follow others left out.
    """
    result = model._squared_distance(q1, q2)
    if result is NotImplemented:
        return _bound(model, "squared_distance", *_exact_pair(model, q1, q2))
    _squared_calls.add(model._squared_distance, 2, model)
    return result


def _squared_parts(model: CoreModel) -> Any:
    def run(q1: Array, q2: Array) -> Array:
        d = algorithms.difference(model, q1, q2)
        parts = [d[j.idx_v : j.idx_v + j.kind.nv] for j in model.joints if not j.mimic]
        return np.stack([part @ part for part in parts]) if parts else np.zeros(0)

    return run


_normalize_calls = call_cache(1, weak=1)


@repeated_calls(_normalize_calls)
@checks_itself
def normalize(model: Model, q: Any) -> Floats:
    """The same configuration with quaternions, and pairs of cosine and sine, of unit length.

    Returns:
        Configuration (nq,).
    """
    try:
        result = model._normalize(q)
    except AttributeError:
        raise wrong_model("normalize", model) from None
    if result is NotImplemented:
        return _bound(model, "normalize", exact(q, model.nq, "q"))
    _normalize_calls.add(model._normalize, 1, model)
    return result


_normalized_calls, _normalized_within_calls = (call_cache(1, weak=1) for _ in range(2))


@repeated_calls(_normalized_calls, _normalized_within_calls)
@checked
def isNormalized(model: Model, q: Any, prec: float = _PRECISION) -> bool:
    """Whether quaternions, and pairs of cosine and sine, have unit length.

    Args:
        prec: What each length differs from 1 by less than [-].

    Returns:
        Whether they are.

    Raises:
        InputError: `prec` is below zero, or nan.
    """
    if prec is _PRECISION:
        result = model._is_normalized(q)
        if result is NotImplemented:
            return _bound(model, "is_normalized", exact(q, model.nq, "q"))
        _normalized_calls.add(model._is_normalized, 1, model)
        return result
    entries = exact(q, model.nq, "q")
    if not prec >= 0.0:
        raise InputError(f"isNormalized: `prec` is {prec}; expected 0 or more.")
    result = _bound(model, "is_normalized_within", entries, float(prec))
    _normalized_within_calls.add(model._is_normalized_within, 2, model)
    return result


def _lengths(model: Model, more: tuple[str, ...]) -> Any:
    """The kernel of `isNormalized`; without an answer, nan, for a tolerance below 0, and for nan."""
    parts = tuple(part for part in _compared_together(model) if part[-1])
    shapes: dict[str, Any] = {"q": (model.nq,)} | dict.fromkeys(more, ())

    def run(q: Array, prec: Any = _PRECISION) -> Any:
        same = 1.0
        for first, end, _ in parts:
            gap = numeric.sqrt(q[first:end] @ q[first:end]) - 1.0
            same = where(less(where(less(gap, 0.0), -gap, gap), prec), same, 0.0)
        return where(less(prec, 0.0), np.nan, where(less(-1.0, prec), same, np.nan))

    return model._compiled_structure().compile(("normalized", parts, more), lambda _: run, **shapes)


_same_calls = call_cache(1, weak=1)


@repeated_calls(_same_calls)
@checked
def isSameConfiguration(model: Model, q1: Any, q2: Any, prec: float) -> bool:
    """Whether two configurations are the same place.

    Args:
        prec: Largest difference of the entries of a joint, as a part of their length [-]. Those of a quaternion may
            have either sign; position and rotation of a free flyer, and of a planar joint, are compared apart.

    Returns:
        Whether they are.

    Raises:
        InputError: `prec` is below zero, or nan.
    """
    if not prec >= 0.0:
        raise InputError(f"isSameConfiguration: `prec` is {prec}; expected 0 or more.")
    try:
        result = model._is_same(q1, q2, prec)
    except AttributeError:
        raise wrong_model("isSameConfiguration", model) from None
    if result is NotImplemented:
        result = _is_same_bound_anew(model, *_exact_pair(model, q1, q2), float(prec))
    else:
        _same_calls.add(model._is_same, 3, model)
    return result


def _is_same_bound_anew(model: Model, *arguments: Any) -> bool:
    result = model._is_same(*arguments)
    if result is NotImplemented:
        shapes: dict[str, Any] = {"q1": (model.nq,), "q2": (model.nq,), "prec": ()}
        parts = _compared_together(model)
        kernel = model._compiled_structure().compile(
            ("is same", parts), lambda _: _agreement(parts), **shapes
        )
        model._is_same = BoundKernel(kernel, holder=bool).call
        result = model._is_same(*arguments)
    return result


def _compared_together(model: Model) -> tuple[tuple[int, int, bool], ...]:
    """Which entries of q are compared together: the first, the one behind the last, and whether of unit length."""
    groups: list[tuple[int, int, bool]] = []
    for joint in list(model.joints)[1:]:
        k = joint.idx_q
        for part in () if joint.mimic else joint.parts or (joint,):
            kind: Any = part.kind
            for is_unit, row in itertools.groupby(kind.coordinates, lambda c: c.unit == ""):
                count = len(list(row))
                groups.append((k, k + count, is_unit))
                k += count
    return tuple(groups)


def _agreement(parts: tuple[tuple[int, int, bool], ...]) -> Any:
    """1 where all parts agree, 0 where one does not; nan, which no truth is made of, for a tolerance below 0."""

    def run(q1: Array, q2: Array, prec: Array) -> Array:
        same = 1.0 + 0.0 * prec
        for first, end, is_unit in parts:
            a, b = q1[first:end], q2[first:end]
            gap = (a - b) @ (a - b)
            if is_unit and end - first == 4:  # a quaternion: the other sign is the same rotation
                gap = minimum(gap, (a + b) @ (a + b))
            excess = gap - prec * prec * minimum(a @ a, b @ b)
            same = where(less(excess, _SMALLEST), same, 0.0)
        return where(less(prec, 0.0), np.nan, same)

    return run


_SMALLEST = 5e-324
"""What is less than it is at most 0."""


_integrate_derivative_calls, _difference_derivative_calls = (call_cache(1, weak=1) for _ in range(2))


@repeated_calls(_integrate_derivative_calls)
@checked
def dIntegrate(model: Model, q: Any, v: Any, argument_position: Any = None) -> Any:
    """The derivatives (nv, nv) of `integrate` by q and v; one of them for ARG0 or ARG1.

    Args:
        v: Velocity times duration (nv,) [rad or m].
        argument_position: ARG0 or ARG1 for one of the derivatives; both where it is left out.

    Returns:
        A pair of matrices (nv, nv), or one.
    """
    which = _which(argument_position)
    result = model._integrate_derivatives[which](q, v)
    if result is NotImplemented:
        state = exact(q, model.nq, "q"), exact(v, model.nv, "v")
        return _bound_derivatives(model, "integrate_derivatives", which, *state)
    if which == _BOTH:
        _integrate_derivative_calls.add(model._integrate_derivatives[which], 2, model)
    return result


@repeated_calls(_difference_derivative_calls)
@checked
def dDifference(model: Model, q1: Any, q2: Any, argument_position: Any = None) -> Any:
    """The derivatives (nv, nv) of `difference` by q1 and q2; one of them for ARG0 or ARG1.

    Args:
        argument_position: ARG0 or ARG1 for one of the derivatives; both where it is left out.

    Returns:
        A pair of matrices (nv, nv), or one.
    """
    which = _which(argument_position)
    result = model._difference_derivatives[which](q1, q2)
    if result is NotImplemented:
        return _bound_derivatives(model, "difference_derivatives", which, *_exact_pair(model, q1, q2))
    if which == _BOTH:
        _difference_derivative_calls.add(model._difference_derivatives[which], 2, model)
    return result


_BOTH = 2


def _which(position: Any) -> int:
    """The argument that a derivative is by: 0 or 1; 2 for both, where it is left out."""
    if position is ArgumentPosition.ARG0:
        return 0
    if position is ArgumentPosition.ARG1:
        return 1
    return _BOTH if position is None else first_or_second(position)


def _bound_derivatives(model: Model, name: str, which: int, *state: Any) -> Any:
    """The derivatives, by kernels that are bound where they do not apply."""
    result = getattr(model, f"_{name}")[which](*state)
    if result is NotImplemented:
        kernel = model._compiled_structure().core_kernel(name)
        bound = []
        for returns in ((0,), (1,), (0, 1)):
            targets = [np.zeros(output.shape) for output in kernel.function.outputs]
            bound.append(kernel.into(*targets, returns=returns, otherwise=not_applicable))
        setattr(model, f"_{name}", tuple(bound))
        result = bound[which](*state)
    return result


def dIntegrateTransport(model: Model, q: Any, v: Any, Jin: Any, argument_position: Any) -> Floats:
    """A matrix (nv, n) at integrate(q, v), carried by the derivative of `integrate`.

    Args:
        v: Velocity times duration (nv,) [rad or m].
        Jin: Matrix (nv, n) at integrate(q, v).
        argument_position: ARG0 or ARG1: by which argument the derivative is taken.

    Returns:
        Matrix (nv, n).

    Raises:
        ArgumentError: `argument_position` is something else.
    """
    return dIntegrate(model, q, v, ArgumentPosition(first_or_second(argument_position))) @ rows_of(
        Jin, model.nv, "Jin"
    )


_tangent_calls = call_cache(1, weak=1)


@repeated_calls(_tangent_calls)
@checked
def tangentMap(model: Model, q: Any) -> Floats:
    """The matrix (nq, nv) from velocities to the rates of the entries of q.

    Returns:
        Matrix (nq, nv).
    """
    result = model._tangent_map(q)
    if result is NotImplemented:
        return _bound(model, "tangent_map", exact(q, model.nq, "q"))
    _tangent_calls.add(model._tangent_map, 1, model)
    return result


def _tangent_map(model: Any) -> Any:
    units = np.eye(model.nv)
    return lambda q: np.stack([algorithms.coordinate_rates(model, q, unit) for unit in units], axis=-1)


def tangentMapProduct(model: Model, q: Any, mat_in: Any) -> Floats:
    """`tangentMap` times a vector (nv,) or a matrix (nv, n).

    Args:
        mat_in: Vector (nv,) or matrix (nv, n).

    Returns:
        Array (nq,) or (nq, n).
    """
    return tangentMap(model, q).dot(_rows(mat_in, model.nv))


def tangentMapTransposeProduct(model: Model, q: Any, mat_in: Any) -> Floats:
    """`tangentMap` transposed times a vector (nq,) or a matrix (nq, n).

    Args:
        mat_in: Vector (nq,) or matrix (nq, n).

    Returns:
        Array (nv,) or (nv, n).
    """
    return tangentMap(model, q).T.dot(_rows(mat_in, model.nq))


def _rows(mat_in: Any, rows: int) -> Floats:
    """A vector, or a matrix, of so many rows; see `rows_of`."""
    if is_float_array(mat_in) and mat_in.ndim in (1, 2) and len(mat_in) == rows:
        return mat_in
    return rows_of(mat_in, rows, "mat_in")


_LEAST_COLUMNS = 6
"""The most velocities of a joint that is not composite."""


_compact_calls = call_cache(1, weak=1)


@repeated_calls(_compact_calls)
@checked
def compactTangentMap(model: Model, q: Any) -> Floats:
    """`tangentMap` without most of its zeros: row i begins at the velocity that segment i names.

    Returns:
        Matrix (nq, k), zero beyond the velocities of a row's joint; k is 6, or more for composite joints of more.
    """
    result = model._compact_tangent_map(q)
    if result is NotImplemented:
        return _bound(model, "compact_tangent_map", exact(q, model.nq, "q"))
    _compact_calls.add(model._compact_tangent_map, 1, model)
    return result


def getTangentToConfigurationSparsitySegment(model: Model) -> tuple[StdVec[int], StdVec[int]]:
    """For each entry of q, how many velocities its joint has, and where they begin."""
    joints = sorted((j for j in list(model.joints)[1:] if not j.mimic), key=lambda j: j.idx_q)
    rows = [j for j in joints for _ in range(j.nq)]
    return StdVec(j.nv for j in rows), StdVec(j.idx_v for j in rows)


def _exact_pair(model: Model, q1: Any, q2: Any) -> tuple[Floats, Floats]:
    return exact(q1, model.nq, "q1"), exact(q2, model.nq, "q2")
