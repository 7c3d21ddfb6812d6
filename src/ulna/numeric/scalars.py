"""The few functions whose spelling differs between floats, traced scalars and symbols.

Everything else in the library is plain NumPy. A traced scalar or symbol travels in an object array; it takes part
here through hooks on the value (`_where_`, `_minimum_`, `_maximum_`), so this file knows nothing of the compiler.
"""

from __future__ import annotations

import math
import operator
from types import ModuleType
from typing import Any

import numpy as np

_ABOVE_ONE = 1.0 + 1e-10
"""A number above 1, which rounds to 1 in single precision."""


def is_symbolic(*values: Any) -> bool:
    """Whether any value is a traced scalar, a symbol, or an object array of them."""
    for value in values:  # noqa: SIM110, loading a model asks thousands of times: `any` takes twice as long
        if _is_symbolic(value):
            return True
    return False


def _is_symbolic(value: Any) -> bool:
    if isinstance(value, (float, int, np.generic)):
        return False
    if isinstance(value, np.ndarray):
        return value.dtype.char == "O"
    return is_symbolic(*value) if isinstance(value, (list, tuple)) else True


def sincos(x: Any) -> tuple[Any, Any]:
    """Sine and cosine."""
    return sin(x), cos(x)


def sin(x: Any) -> Any:
    """Sine, of numbers [rad], arrays, and numbers that are traced.

    Args:
        x: Angles [rad], shape (...).

    Returns:
        Shape (...).

    Example:
        >>> from ulna import numeric
        >>> height = ulna.compile(lambda a: 2.0 * numeric.sin(a), a=())
        >>> float(height(np.pi / 2))
        2.0
        >>> numeric.sin(np.array([0.0, np.pi / 6])).round(3)
        array([0. , 0.5])
    """
    return _elementwise(_sin, x) if is_symbolic(x) else np.sin(x)


def cos(x: Any) -> Any:
    """Cosine, of numbers [rad], arrays, and numbers that are traced.

    Args:
        x: Angles [rad], shape (...).

    Returns:
        Shape (...).

    Example:
        >>> from ulna import numeric
        >>> numeric.cos(np.array([0.0, np.pi / 3])).round(3)
        array([1. , 0.5])
    """
    return _elementwise(_cos, x) if is_symbolic(x) else np.cos(x)


def sqrt(x: Any) -> Any:
    """Square root.

    Example:
        >>> from ulna import numeric
        >>> length = ulna.compile(lambda x: numeric.sqrt(x @ x), x=(2,))
        >>> float(length([3.0, 4.0]))
        5.0
    """
    return _elementwise(_sqrt, x) if is_symbolic(x) else np.sqrt(x)


def exp(x: Any) -> Any:
    """The exponential function."""
    return _elementwise(_exp, x) if is_symbolic(x) else np.exp(x)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent."""
    return _elementwise(_tanh, x) if is_symbolic(x) else np.tanh(x)


def erf(x: Any) -> Any:
    """The error function, which NumPy lacks: 2 / sqrt(pi) times the integral of exp(-t^2) from 0 to x.

    (1 + erf(x / sqrt(2))) / 2 is the probability of less than x standard deviations above the mean.

    Args:
        x: Numbers [-], shape (...).

    Returns:
        Shape (...).

    Example:
        >>> from ulna import numeric
        >>> gelu = ulna.compile(lambda x: 0.5 * x * (1.0 + numeric.erf(x / np.sqrt(2.0))), x=(2,))
        >>> gelu([-1.0, 1.0]).round(4)
        array([-0.1587,  0.8413])
    """
    if is_symbolic(x):
        return _elementwise(_erf, x)
    x = np.asarray(x)
    return np.asarray(np.frompyfunc(math.erf, 1, 1)(x), x.dtype if x.dtype.kind == "f" else float)[()]


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

    Example:
        >>> from ulna import numeric
        >>> penalty = ulna.compile(lambda x: numeric.where(x > 0.0, x * x, 0.0), x=())
        >>> float(penalty(3.0)), float(penalty(-3.0))
        (9.0, 0.0)
    """
    if not is_symbolic(condition, a, b):
        return np.where(condition, a, b)[()]  # a number, not an array without axes, for numbers
    return _elementwise(_where, condition, a, b)


def is_double(scale: Any) -> Any:
    """Whether a function computes in double precision. Compilers know the answer in single precision.

    Args:
        scale: Numbers above zero that the function computed, shape (...) [any]; 1e-300 or more.

    Returns:
        Truth values, shape (...); false where `scale` is 0 or nan.
    """
    return less(scale, scale * _ABOVE_ONE)


def by_precision(scale: Any, double: Any, single: Any) -> Any:
    """A constant for double precision, another one for single precision.

    Args:
        scale: As for `is_double`.
        double: The number in double precision, shape (...) [any].
        single: The number in single precision, and where `scale` is 0 or nan, shape (...), the same unit.

    Returns:
        Shape (...).
    """
    return where(is_double(scale), double, single)


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
    with np.errstate(all="ignore"):  # flags that the import of SymPy raises are not errors of these values
        return np.frompyfunc(f, len(values), 1)(*values)


def _sin(x: Any) -> Any:
    return _call("sin", x)


def _cos(x: Any) -> Any:
    return _call("cos", x)


def _sqrt(x: Any) -> Any:
    return _call("sqrt", x)


def _exp(x: Any) -> Any:
    return _call("exp", x)


def _tanh(x: Any) -> Any:
    return _call("tanh", x)


def _erf(x: Any) -> Any:
    return _call("erf", x, math)


def _call(name: str, x: Any, module: ModuleType = np) -> Any:
    if not _is_symbolic(x):
        return float(getattr(module, name)(x))
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
    if isinstance(condition, (bool, int, float, np.generic)):  # numbers as NumPy takes them
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
