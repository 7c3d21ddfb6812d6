"""Exponentials and logarithms in SIMD lanes: exp and log; expm1, log1p and sinh, precise for small arguments, too."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan, sqrt
from typing import NamedTuple

from ulna.compiler.codegen import coefficients
from ulna.compiler.codegen.function_body import Body
from ulna.compiler.codegen.ir_text import bits_of
from ulna.compiler.codegen.sincos import ROUNDER


def add_small(body: Body, base: str | float, t: str, p: str) -> str:
    """The sum base + t + p, where base is zero or larger than t, and p is small, with nearly one rounding.

    Args:
        body: The body of a function in which the instructions are written.
        base, t, p: The names of the terms in it; the base may be a number.

    Returns:
        The name of the result.
    """
    high = body.add(base, t)
    low = body.add(body.sub(base, high), t)
    return body.add(high, body.add(low, p))


class _Reduced(NamedTuple):
    """x = k ln 2 + r + missing, so that exp(x) = 2^k (1 + r + missing + z/2 + r z cubic), z = r^2."""

    k: str
    shifted: str
    """k + ROUNDER, whose last bits are k."""
    r: str
    missing: str
    """The low-order part: exact minus rounded r."""
    z: str
    cubic: str


def _reduced(body: Body, x: str, lowest: float, highest: float, polynomial: coefficients.Numbers) -> _Reduced:
    """The reduction of the exponential; x is clipped to where it matters, NaN passes."""
    dtype = body.lanes.dtype
    ln2 = coefficients.LN2[dtype]
    (log2e,) = coefficients.LOG2E[dtype]
    bounded = body.select(body.compare("ogt", x, highest), highest, x)
    bounded = body.select(body.compare("olt", x, lowest), lowest, bounded)
    shifted = body.fma(bounded, log2e, ROUNDER[dtype])
    k = body.sub(shifted, ROUNDER[dtype])
    first = body.fma(k, -ln2[0], bounded)
    r = body.fma(k, -ln2[1], first)
    missing = body.fma(k, -ln2[1], body.sub(first, r))
    z = body.mul(r, r)
    return _Reduced(k, shifted, r, missing, z, body.polynomial(r, z, polynomial[dtype]))


def _times_power(body: Body, value: str, x: _Reduced) -> str:
    """2^k value in two factors, both normal: the last product rounds once, to a denormal or an infinity if need be."""
    half_bits = body.to_bits(body.fma(x.k, 0.5, ROUNDER[body.lanes.dtype]))
    rest_bits = body.integer_op("sub", body.to_bits(x.shifted), half_bits)
    for exponent in (half_bits, rest_bits):
        value = body.mul(value, _power_of_two(body, exponent))
    return value


def _power_of_two(body: Body, exponent: str) -> str:
    """2^n, normal, of an integer n."""
    bias, mantissa = (1023, 52) if body.lanes.dtype == "double" else (127, 23)
    return body.from_bits(body.integer_op("shl", body.integer_op("add", exponent, bias), mantissa))


def _inverse_power(body: Body, k: str, most: float) -> str:
    """2^-k; 2^-most where k is larger."""
    bounded = body.select(body.compare("ogt", k, most), most, k)
    return _power_of_two(body, body.to_bits(body.sub(ROUNDER[body.lanes.dtype], bounded)))


def _exp(body: Body, x: str) -> str:
    """The exponential of x."""
    # Beyond these the result is infinite or zero.
    lowest, highest = (-746.0, 710.0) if body.lanes.dtype == "double" else (-104.0, 89.0)
    e = _reduced(body, x, lowest, highest, coefficients.EXP)
    tail = body.fma(e.r, e.cubic, 0.5)
    high = body.add(e.r, 1.0)
    low = body.add(body.add(body.sub(1.0, high), e.r), e.missing)
    return _times_power(body, body.add(high, body.fma(e.z, tail, low)), e)


def _expm1(body: Body, x: str) -> str:
    """2^k ((1 - 2^-k) + r + rest): the sum begins with its largest part, and nothing cancels that is not exact."""
    dtype = body.lanes.dtype
    # Below the lowest the result is -1; 2^-k counts up to the precision of 1 only.
    lowest, highest, most = (-40.0, 710.0, 60.0) if dtype == "double" else (-20.0, 89.0, 30.0)
    e = _reduced(body, x, lowest, highest, coefficients.EXPM1)
    minus_inverse = body.neg(_inverse_power(body, e.k, most))
    above = body.compare("ogt", e.k, 0.0)
    large, small = body.select(above, 1.0, minus_inverse), body.select(above, minus_inverse, 1.0)
    base = body.add(large, small)
    base_missing = body.add(body.sub(large, base), small)
    z_missing = body.cancelling_fma(e.r, e.r, body.neg(e.z))
    rest = body.fma(body.mul(e.r, e.z), e.cubic, body.fma(e.missing, e.r, e.missing))
    rest = body.add(body.fma(z_missing, 0.5, rest), base_missing)
    first = body.add(base, e.r)
    rest = body.add(body.add(body.sub(base, first), e.r), rest)
    value = _times_power(body, add_small(body, first, body.mul(e.z, 0.5), rest), e)
    return body.call("copysign", value, x)


def _sinh(body: Body, x: str) -> str:
    """2^(k-1) (e^r - w e^-r), w = 2^-2k, of |x| = k ln 2 + r: no sum cancels that is not exact, as in `_expm1`."""
    dtype = body.lanes.dtype
    highest, most = (711.0, 60.0) if dtype == "double" else (90.0, 30.0)
    e = _reduced(body, body.fabs(x), 0.0, highest, coefficients.EXPM1)
    inverse = _inverse_power(body, e.k, most)
    w = body.mul(inverse, inverse)
    base, both = body.sub(1.0, w), body.add(w, 1.0)
    base_missing = body.sub(body.sub(1.0, base), w)
    # base + r both + z base / 2 + r z (cubic(r) + w cubic(-r)), and what the rounded parts lack.
    linear = body.mul(e.r, both)
    linear_missing = body.fma(e.missing, both, body.cancelling_fma(e.r, both, body.neg(linear)))
    mirrored = body.polynomial(body.neg(e.r), e.z, coefficients.EXPM1[dtype])
    half_base = body.mul(base, 0.5)
    z_missing = body.fma(body.mul(e.missing, e.r), 2.0, body.cancelling_fma(e.r, e.r, body.neg(e.z)))
    rest = body.fma(z_missing, half_base, body.add(linear_missing, base_missing))
    rest = body.fma(body.mul(e.r, e.z), body.fma(w, mirrored, e.cubic), rest)
    first = body.add(base, linear)
    rest = body.add(body.add(body.sub(base, first), linear), rest)
    value = add_small(body, first, body.mul(e.z, half_base), rest)
    return body.call("copysign", _times_power(body, body.mul(value, 0.5), e), x)


class _Split(NamedTuple):
    """value = 2^k (1 + f), 1 + f from sqrt(1/2) to sqrt(2)."""

    biased: str
    """k + 1023, or k + 127, an integer."""
    k: str
    f: str


def _split(body: Body, value: str, lifted: str | None = None, lift: int = 0) -> _Split:
    """The exponent and mantissa of a positive normal number, which is 2^lift times too large where `lifted`."""
    dtype = body.lanes.dtype
    bias, mantissa = (1023, 52) if dtype == "double" else (127, 23)
    bits, one = body.to_bits(value), bits_of(1.0, dtype)
    biased = body.integer_op("lshr", body.integer_op("add", bits, one - bits_of(sqrt(0.5), dtype)), mantissa)
    m_bits = body.integer_op("sub", bits, body.integer_op("shl", biased, mantissa))
    m_bits = body.integer_op("add", m_bits, one)
    integer = 2.0**mantissa  # its last bit counts ones
    k_shifted = body.from_bits(body.integer_op("or", biased, bits_of(integer, dtype)))
    excess = integer + bias if lifted is None else body.select(lifted, integer + bias + lift, integer + bias)
    k = body.sub(k_shifted, excess)
    return _Split(biased, k, body.sub(body.from_bits(m_bits), 1.0))


def _log_of(body: Body, x: _Split, low: str | None = None) -> str:
    """log(2^k (1 + f)) + low: log(1 + f) = f - f^2/2 + s (f^2/2 + z L(z)), s = f/(2 + f), z = s^2."""
    ln2, f = coefficients.LN2[body.lanes.dtype], x.f
    s = body.div(f, body.add(f, 2.0))
    z = body.mul(s, s)
    half = body.mul(f, 0.5)
    inner = body.mul(z, body.polynomial(z, body.mul(z, z), coefficients.LOG[body.lanes.dtype]))
    inner = body.fma(s, body.fma(half, f, inner), body.mul(x.k, ln2[1]))
    if low is not None:
        inner = body.add(inner, low)
    rest = body.fma(body.neg(half), f, inner)
    return add_small(body, body.mul(x.k, ln2[0]), f, rest)


def _log(body: Body, x: str) -> str:
    """The natural logarithm of x."""
    lift, least = (54, 2.0**-1022) if body.lanes.dtype == "double" else (25, 2.0**-126)
    positive = body.compare("ogt", x, 0.0)
    value = body.select(positive, x, 1.0)
    tiny = body.compare("olt", value, least)
    value = body.select(tiny, body.mul(value, 2.0**lift), value)
    result = _log_of(body, _split(body, value, tiny, lift))
    result = body.select(body.compare("oeq", x, inf), inf, result)
    return body.select(positive, result, body.select(body.compare("oeq", x, 0.0), -inf, nan))


def _log1p(body: Body, x: str) -> str:
    """log(1 + x) = log(s) + (1 + x - s)/s to first order, s = 1 + x rounded."""
    bias, mantissa = (1023, 52) if body.lanes.dtype == "double" else (127, 23)
    total = body.add(x, 1.0)
    positive = body.compare("ogt", total, 0.0)
    large = body.compare("ogt", x, 2.0**mantissa * 4.0)  # where 1 does not count
    value = body.select(positive, total, 1.0)
    # The sum of the larger of 1 and x and the smaller one is exact with this.
    above = body.compare("ogt", x, 1.0)
    left_out = body.sub(body.select(above, 1.0, x), body.sub(total, body.select(above, x, 1.0)))
    split = _split(body, value)
    inverse = body.from_bits(body.integer_op("shl", body.integer_op("sub", 2 * bias, split.biased), mantissa))
    low = body.div(body.mul(left_out, inverse), body.add(split.f, 1.0))
    result = _log_of(body, split, body.select(large, 0.0, low))
    result = body.call("copysign", result, x)
    result = body.select(body.compare("oeq", x, inf), inf, result)
    return body.select(positive, result, body.select(body.compare("oeq", x, -1.0), -inf, nan))


EXPONENTIALS: dict[str, Callable[[Body, str], str]] = {
    "exp": _exp,
    "log": _log,
    "expm1": _expm1,
    "log1p": _log1p,
    "sinh": _sinh,
}
"""What writes each function into the body of another, of the name of its argument there; returns that of the result."""
