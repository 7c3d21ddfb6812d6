"""Write the LLVM IR of elementary functions that LLVM would otherwise hand, lane by lane, to the C library.

Tangent, arcsine, arccosine, two-argument arctangent, exponentials and logarithms, in SIMD lanes, without
branches (but for the tangent of huge arguments). Each reduces its argument to a small interval, evaluates a
minimax polynomial there, and keeps the rounding error of the leading term, to add it back before the last
rounding (Muller, Elementary Functions, 3rd ed.). Values at zeros, infinities and NaN are those of NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan, sqrt
from typing import NamedTuple

from ulna.compiler.codegen import coefficients
from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.function_body import Body
from ulna.compiler.codegen.ir_text import DType, IRFunction, Lanes, bits_of
from ulna.compiler.codegen.sincos import ROUNDER, arc, by_double, reduced_function


def elementary_ir(op: str, lanes: int, dtype: DType, arithmetic: Arithmetic = COMPLETE) -> IRFunction:
    """The IR of `T @ulna.<op>.<suffix>(T x)`, of `(T y, T x)` for atan2; T is `dtype` or `<lanes x dtype>`.

    The error stays below 1 ULP. No library is called: results are the same on every processor.

    Args:
        op: one of `OPERATIONS`.
        lanes: the number of lanes; 1 for the scalar function.
        dtype: "double" or "float".
        arithmetic: what the processor computes in one instruction.

    Returns:
        Name, text and declarations of the function.

    Raises:
        ValueError: for an operation that is not offered.
    """
    kind = Lanes(lanes, dtype)
    name = f"ulna.{op}.{kind.suffix}"
    if op == "tan":
        return reduced_function(kind, name, _tan, 1, arithmetic)
    if op not in _WRITERS:
        raise ValueError(f"no elementary function {op!r}: one of {', '.join(OPERATIONS)} expected")
    write, parameters = _WRITERS[op]
    if dtype == "float" and not arithmetic.fused_multiply_add:
        return by_double(elementary_ir(op, lanes, "double", arithmetic), kind, name, parameters, 1)
    body = Body(kind, "t", arithmetic)
    result = write(body, *parameters)
    signature = ", ".join(f"{kind.real} {p}" for p in parameters)
    text = [
        f"define internal {kind.real} @{name}({signature}) alwaysinline nounwind willreturn memory(none) {{",
        *body.lines,
        f"  ret {kind.real} {result}",
        "}",
    ]
    return IRFunction(name, "\n".join(text), tuple(body.declarations))


def _tan(body: Body, r: str, s: str, quadrant: str) -> tuple[str, ...]:
    """Sine over cosine, or minus cosine over sine: one division, then a correction for all roundings."""
    (sine_high, sine_low), (cosine_high, cosine_low) = arc(body, r, s)
    sine = body.sub(sine_high, sine_low)
    cosine = body.add(cosine_high, cosine_low)
    # What each rounded sum has too much.
    sine_excess = body.add(body.sub(sine, sine_high), sine_low)
    cosine_excess = body.sub(body.sub(cosine, cosine_high), cosine_low)
    odd = body.integer_op("icmp ne", body.integer_op("and", quadrant, 1), 0)
    top, top_excess = body.select(odd, cosine, sine), body.select(odd, cosine_excess, sine_excess)
    bottom, bottom_excess = body.select(odd, sine, cosine), body.select(odd, sine_excess, cosine_excess)
    reciprocal = body.div(1.0, bottom)
    quotient = body.mul(top, reciprocal)
    excess = body.add(body.cancelling_fma(quotient, bottom, body.neg(top)), top_excess)
    excess = body.fma(body.neg(quotient), bottom_excess, excess)
    result = body.fma(body.neg(excess), reciprocal, quotient)
    return (body.flip_sign(result, body.integer_op("shl", quadrant, body.lanes.bits - 1)),)


def _half_arc(body: Body, x: str) -> tuple[str, str, str]:
    """(far, t, p), a = |x|, far: a > 1/2. The arcsine of (far ? sqrt((1 - a)/2) : a) is t + p, p small."""
    a = body.fabs(x)
    far = body.compare("ogt", a, 0.5)
    z = body.select(far, body.fma(a, -0.5, 0.5), body.mul(a, a))
    root = body.call("sqrt", z)
    t = body.select(far, root, a)
    # The root's rounding error, to first order.
    twice = body.add(root, root)
    twice = body.select(body.compare("oeq", twice, 0.0), 1.0, twice)
    missing = body.div(body.cancelling_fma(body.neg(root), root, z), twice)
    z2 = body.mul(z, z)
    polynomial = body.polynomial(z, z2, coefficients.ASIN[body.lanes.dtype])
    p = body.fma(body.mul(t, z), polynomial, body.select(far, missing, 0.0))
    return far, t, p


def _asin(body: Body, x: str) -> str:
    quarter = coefficients.QUARTER_PI[body.lanes.dtype]
    far, t, p = _half_arc(body, x)
    # arcsin a = pi/2 - 2 arcsin sqrt((1 - a)/2).
    base = body.select(far, 2 * quarter[0], 0.0)
    t = body.select(far, body.mul(t, -2.0), t)
    p = body.select(far, body.fma(p, -2.0, 2 * quarter[1]), p)
    return body.call("copysign", _sum(body, base, t, p), x)


def _acos(body: Body, x: str) -> str:
    quarter = coefficients.QUARTER_PI[body.lanes.dtype]
    far, t, p = _half_arc(body, x)
    negative = body.compare("olt", x, 0.0)
    # Near: pi/2 - arcsin x. Far: 2 arcsin sqrt((1 - a)/2), or pi less that. Multiples of pi/4: 2, 0, 4.
    eighths = body.select(far, body.select(negative, 4.0, 0.0), 2.0)
    factor = body.select(far, body.select(negative, -2.0, 2.0), body.select(negative, 1.0, -1.0))
    base = body.mul(eighths, quarter[0])
    return _sum(body, base, body.mul(t, factor), body.fma(p, factor, body.mul(eighths, quarter[1])))


def _atan2(body: Body, y: str, x: str) -> str:
    double = body.lanes.dtype == "double"
    a, b = body.fabs(y), body.fabs(x)
    steep = body.compare("ogt", a, b)
    large, small = body.select(steep, a, b), body.select(steep, b, a)
    # Infinities and zeros become ratios of 0 and 1.
    infinite = body.compare("oeq", large, inf)
    small = body.select(infinite, body.select(body.compare("oeq", small, inf), 1.0, 0.0), small)
    large = body.select(infinite, 1.0, body.select(body.compare("oeq", large, 0.0), 1.0, large))
    # Away from overflow of the sum and underflow of the remainder.
    top, bottom, lift = (2.0**1000, 2.0**-900, 2.0**120) if double else (2.0**120, 2.0**-90, 2.0**40)
    lifted = body.select(body.compare("olt", large, bottom), lift, 1.0)
    scale = body.select(body.compare("ogt", large, top), 0.25, lifted)
    large, small = body.mul(large, scale), body.mul(small, scale)
    # arctan(small/large) = pi/4 + arctan((small - large)/(small + large)), for ratios beyond 1/2.
    diagonal = body.compare("ogt", small, body.mul(large, 0.5))
    total = body.add(large, small)
    total_missing = body.add(body.sub(large, total), small)
    top_value = body.select(diagonal, body.sub(small, large), small)
    bottom_value = body.select(diagonal, total, large)
    reciprocal = body.div(1.0, bottom_value)
    t = body.mul(top_value, reciprocal)
    minus_t = body.neg(t)
    remainder = body.cancelling_fma(minus_t, bottom_value, top_value)
    remainder = body.fma(minus_t, body.select(diagonal, total_missing, 0.0), remainder)
    missing = body.mul(remainder, reciprocal)
    z = body.mul(t, t)
    polynomial = body.polynomial(z, body.mul(z, z), coefficients.ATAN[body.lanes.dtype])
    p = body.fma(body.mul(t, z), polynomial, body.fma(body.neg(missing), z, missing))
    # The angle is eighths * pi/4 + (t + p) or minus (t + p).
    backward = body.integer_op("icmp slt", body.to_bits(x), 0)
    eighths = body.select(diagonal, 1.0, 0.0)
    eighths = body.select(steep, body.sub(2.0, eighths), eighths)
    eighths = body.select(backward, body.sub(4.0, eighths), eighths)
    turned = body.emit(f"xor {body.lanes.truth} {steep}, {backward}")
    factor = body.select(turned, -1.0, 1.0)
    quarter = coefficients.QUARTER_PI[body.lanes.dtype]
    rest = body.fma(eighths, quarter[1], body.mul(p, factor))
    angle = _sum(body, body.mul(eighths, quarter[0]), body.mul(t, factor), rest)
    angle = body.call("copysign", angle, y)
    return body.select(body.compare("uno", x, y), body.add(x, y), angle)


def _sum(body: Body, base: str, t: str, p: str) -> str:
    """The sum base + t + p, where base is zero or larger than t, and p is small, with nearly one rounding."""
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
    """What the rounded r lacks."""
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


def _exp(body: Body, x: str) -> str:
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
    counted = body.select(body.compare("ogt", e.k, most), most, e.k)
    minus_inverse = body.neg(_power_of_two(body, body.to_bits(body.sub(ROUNDER[dtype], counted))))
    above = body.compare("ogt", e.k, 0.0)
    large, small = body.select(above, 1.0, minus_inverse), body.select(above, minus_inverse, 1.0)
    base = body.add(large, small)
    base_missing = body.add(body.sub(large, base), small)
    z_missing = body.cancelling_fma(e.r, e.r, body.neg(e.z))
    rest = body.fma(body.mul(e.r, e.z), e.cubic, body.fma(e.missing, e.r, e.missing))
    rest = body.add(body.fma(z_missing, 0.5, rest), base_missing)
    first = body.add(base, e.r)
    rest = body.add(body.add(body.sub(base, first), e.r), rest)
    value = _times_power(body, _sum(body, first, body.mul(e.z, 0.5), rest), e)
    return body.call("copysign", value, x)


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
    return _sum(body, body.mul(x.k, ln2[0]), f, rest)


def _log(body: Body, x: str) -> str:
    lift, least = (54, 2.0**-1022) if body.lanes.dtype == "double" else (25, 2.0**-126)
    positive = body.compare("ogt", x, 0.0)
    value = body.select(positive, x, 1.0)
    tiny = body.compare("olt", value, least)
    value = body.select(tiny, body.mul(value, 2.0**lift), value)
    result = _log_of(body, _split(body, value, tiny, lift))
    result = body.select(body.compare("oeq", x, inf), inf, result)
    return body.select(positive, result, body.select(body.compare("oeq", x, 0.0), -inf, nan))


def _log1p(body: Body, x: str) -> str:
    """The logarithm of the rounded 1 + x, and what the rounding left out, over it."""
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


_WRITERS: dict[str, tuple[Callable[..., str], tuple[str, ...]]] = {
    "asin": (_asin, ("%x",)),
    "acos": (_acos, ("%x",)),
    "atan2": (_atan2, ("%y", "%x")),
    "exp": (_exp, ("%x",)),
    "log": (_log, ("%x",)),
    "expm1": (_expm1, ("%x",)),
    "log1p": (_log1p, ("%x",)),
}

OPERATIONS = ("tan", *_WRITERS)
"""What `elementary_ir` offers."""
