"""The few functions whose spelling differs between floats, traced scalars and symbols.

Everything else in the library is plain NumPy. A traced scalar or symbol travels in an object array; it takes part
here through hooks on the value (`_where_`, `_minimum_`, `_maximum_`), so this file knows nothing of the compiler.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from ulna.errors import InputError, TraceError
from ulna.typing import Array


def is_symbolic(*values: Any) -> bool:
    """Whether any value is a traced scalar, a symbol, or an object array of them."""
    return any(_is_symbolic(v) for v in values)


def _is_symbolic(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.dtype == object
    if isinstance(value, (float, int, np.generic)):
        return False
    if isinstance(value, (list, tuple)):
        return any(_is_symbolic(v) for v in value)
    return True


def check_not_masked(name: str, value: Any) -> None:
    """Refuse a masked array, or a list with one, that masks any entry: its numbers would be used as if they counted.

    Args:
        name: What the user calls it.
        value: Whatever was given.

    Raises:
        InputError: Entries of it are masked.
    """
    for part in value if isinstance(value, (list, tuple)) else (value,):
        if (
            isinstance(part, np.ndarray)
            and type(part) is not np.ndarray
            and isinstance(part, np.ma.MaskedArray)
        ):
            count = int(np.ma.count_masked(part))
            if count:
                raise InputError(
                    f"`{name}` is a masked array with {count} masked {'entry' if count == 1 else 'entries'}; expected "
                    "numbers only. Fill them with `.filled(number)`, or select the rows without any: "
                    "x[~np.ma.getmaskarray(x).any(axis=-1)].data."
                )


def vector(*components: Any) -> Array:
    """The array whose last axis holds `components` (scalars, or batches of one shape)."""
    if is_symbolic(*components):
        components = tuple(np.broadcast_arrays(*(np.asarray(c, dtype=object) for c in components)))
        return np.stack(components, axis=-1)
    if all(isinstance(c, (float, int)) for c in components):
        return np.array(components, dtype=float)
    return np.stack(np.broadcast_arrays(*components), axis=-1).astype(float, copy=False)


def matrix(rows: Any) -> Array:
    """The array whose last two axes hold `rows` (a nested sequence of scalars or batches)."""
    flat = vector(*(entry for row in rows for entry in row))
    return flat.reshape(*flat.shape[:-1], len(rows), len(rows[0]))


def cross(a: Array, b: Array) -> Array:
    """The cross product along the last axis.

    Args:
        a, b: Vectors, shape (..., 3).

    Returns:
        a x b, shape (..., 3).
    """
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    return vector(a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0)


def dot(a: Array, b: Array) -> Any:
    """The inner product along the last axis.

    Args:
        a, b: Vectors, shape (..., n).

    Returns:
        Shape (...).
    """
    return (a * b).sum(axis=-1)


def apply(m: Array, v: Array) -> Array:
    """Matrix times vector, with batch axes.

    Args:
        m: Matrix, shape (..., m, n).
        v: Vector in any unit, such as [rad/s], shape (..., n).

    Returns:
        m v, shape (..., m).
    """
    return (m @ v[..., None])[..., 0]


def skew(v: Array) -> Array:
    """The matrix of the cross product with `v`: `skew(v) @ u == cross(v, u)`."""
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    o = 0.0 * x if not is_symbolic(v) else 0.0
    return matrix([[o, -z, y], [z, o, -x], [-y, x, o]])


def sincos(x: Any) -> tuple[Any, Any]:
    """Sine and cosine."""
    return sin(x), cos(x)


def sin(x: Any) -> Any:
    """Sine."""
    return _elementwise(_sin, x) if is_symbolic(x) else np.sin(x)


def cos(x: Any) -> Any:
    """Cosine."""
    return _elementwise(_cos, x) if is_symbolic(x) else np.cos(x)


def sqrt(x: Any) -> Any:
    """Square root."""
    return _elementwise(_sqrt, x) if is_symbolic(x) else np.sqrt(x)


def exp(x: Any) -> Any:
    """The exponential function."""
    return _elementwise(_exp, x) if is_symbolic(x) else np.exp(x)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent; traced by the exponential, to an absolute error of one unit in the last place of 1."""
    return 1.0 - 2.0 / (exp(2.0 * x) + 1.0) if is_symbolic(x) else np.tanh(x)


def arctan2(y: Any, x: Any) -> Any:
    """The angle of a point in the plane, elementwise.

    Args:
        y, x: Its coordinates, shape (...).

    Returns:
        Angle in (-pi, pi], shape (...) [rad].
    """
    return _elementwise(_arctan2, y, x) if is_symbolic(y, x) else np.arctan2(y, x)


def ceil(x: Any) -> Any:
    """The least whole number that is not below `x`."""
    return _elementwise(_ceil, x) if is_symbolic(x) else np.ceil(x)


def less(a: Any, b: Any) -> Any:
    """Whether `a < b`, elementwise; on object arrays `<` itself would ask for a truth value.

    Args:
        a: Number or array, shape (...).
        b: Number or array, shape (...).

    Returns:
        Truth values, shape (...).
    """
    return _elementwise(operator.lt, a, b) if is_symbolic(a, b) else np.less(a, b)


def where(condition: Any, a: Any, b: Any) -> Any:
    """`a` where `condition`, else `b`; both are evaluated.

    Args:
        condition: Truth values, shape (...).
        a: Number or array, shape (...).
        b: Number or array, shape (...).

    Returns:
        Shape (...).
    """
    if not is_symbolic(condition, a, b):
        return np.where(condition, a, b)[()]  # a number, not an array without axes, for numbers
    return _elementwise(_where, condition, a, b)


def minimum(a: Any, b: Any) -> Any:
    """The smaller, elementwise; nan where either is nan.

    Args:
        a: Number or array, shape (...).
        b: Number or array, shape (...).

    Returns:
        Shape (...).
    """
    return _elementwise(_minimum, a, b) if is_symbolic(a, b) else np.minimum(a, b)


def maximum(a: Any, b: Any) -> Any:
    """The larger, elementwise; nan where either is nan.

    Args:
        a: Number or array, shape (...).
        b: Number or array, shape (...).

    Returns:
        Shape (...).
    """
    return _elementwise(_maximum, a, b) if is_symbolic(a, b) else np.maximum(a, b)


def clip(x: Any, low: Any, high: Any) -> Any:
    """A value clipped between two bounds, elementwise.

    Args:
        x: Number or array, shape (...).
        low, high: The bounds, shape (...).

    Returns:
        Shape (...).
    """
    return minimum(maximum(x, low), high)


def _elementwise(f: Any, *values: Any) -> Any:
    out = np.frompyfunc(f, len(values), 1)(*values)
    return out


def _sin(x: Any) -> Any:
    return _call("sin", x)


def _cos(x: Any) -> Any:
    return _call("cos", x)


def _sqrt(x: Any) -> Any:
    return _call("sqrt", x)


def _exp(x: Any) -> Any:
    return _call("exp", x)


def _call(name: str, x: Any) -> Any:
    if not _is_symbolic(x):
        return float(getattr(np, name)(x))
    method = getattr(x, name, None)
    if method is not None:
        return method()
    import sympy

    return getattr(sympy, name)(x)


def _arctan2(y: Any, x: Any) -> Any:
    if not is_symbolic(y, x):
        return float(np.arctan2(y, x))
    if hasattr(y, "arctan2"):
        return y.arctan2(x)
    if hasattr(x, "arctan2"):
        return (y + 0.0 * x).arctan2(x)  # lifts the number `y` beside the traced `x`; the zero folds away
    import sympy

    return sympy.atan2(y, x)


def _ceil(x: Any) -> Any:
    if isinstance(x, (float, int, np.generic)):
        return float(np.ceil(x))
    if hasattr(x, "ceil"):
        return x.ceil()
    import sympy

    return sympy.ceiling(x)


def _where(condition: Any, a: Any, b: Any) -> Any:
    if isinstance(condition, (bool, np.bool_)):
        return a if condition else b
    hook = getattr(condition, "_where_", None)
    if hook is not None:
        return hook(a, b)
    import sympy

    if condition in (sympy.true, sympy.false):
        return a if condition else b
    return sympy.Piecewise((a, condition), (b, True), evaluate=False)


def _minimum(a: Any, b: Any) -> Any:
    return _extremum("_minimum_", "Min", a, b)


def _maximum(a: Any, b: Any) -> Any:
    return _extremum("_maximum_", "Max", a, b)


def _extremum(hook: str, symbolic: str, a: Any, b: Any) -> Any:
    if hasattr(a, hook):
        return getattr(a, hook)(b)
    if hasattr(b, hook):
        return getattr(b, hook)(a)
    import sympy

    return getattr(sympy, symbolic)(a, b)


def loop(condition: Any, body: Any, state: tuple[Any, ...], limit: int) -> tuple[Any, ...]:
    """Iterates `state = body(*state)` while `condition(*state)`, at most `limit` times.

    The state is a tuple of numbers, or of arrays of one batch shape; each element of the batch stops separately and
    then keeps its state. `body` returns a tuple of the same length. Traced, this becomes a loop in the SIMD lanes.

    Args:
        condition: Takes the numbers of the state, returns a truth value.
        body: Takes the numbers of the state, returns the next state.
        state: The numbers, or arrays of shape (...), to start from.
        limit: The largest number of iterations.

    Returns:
        The last state.

    Raises:
        TraceError: the state of a traced loop holds an array.
    """
    if any(isinstance(s, np.ndarray) and s.dtype == object for s in state):
        raise TraceError(
            "The state of a traced loop holds an array; expected numbers. Unpack it: loop(..., state=(*q, x), ...), "
            "with a body and a condition that take that many numbers."
        )
    traced = next((s for s in state if hasattr(s, "_loop_")), None)
    if traced is not None:
        return traced._loop_(condition, body, state, limit)
    values = [np.asarray(s, dtype=float)[()] for s in np.broadcast_arrays(*state)]
    active = np.ones(np.shape(values[0]), dtype=bool)
    for _ in range(limit):
        holds = condition(*values)
        if is_symbolic(holds):  # the state starts from numbers, and the values around the loop are traced
            return _loop_hook(holds)(condition, body, state, limit)
        active = active & holds
        if not active.any():
            break
        following = body(*values)
        traced = next((v for v in following if is_symbolic(v)), None)
        if traced is not None:
            return _loop_hook(traced)(condition, body, state, limit)
        values = [np.where(active, new, old)[()] for new, old in zip(following, values, strict=True)]
    return tuple(values)


def _loop_hook(traced: Any) -> Any:
    value = traced.reshape(-1)[0] if isinstance(traced, np.ndarray) else traced
    hook = getattr(value, "_loop_", None)
    if hook is None:
        raise TypeError(
            f"A loop cannot run on values of type {type(value).__name__}; pass numbers or traced scalars."
        )
    return hook
