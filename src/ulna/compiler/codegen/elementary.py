"""Write the LLVM IR of elementary functions that LLVM would otherwise hand, lane by lane, to the C library.

Tangent, arcsine, arccosine, two-argument arctangent, hyperbolic sine, exponentials, logarithms and the error function,
in SIMD lanes, without branches (but for the tangent of huge arguments). Each reduces its argument to a small interval,
evaluates a minimax polynomial there, and keeps the rounding error of the leading term, to add it back before the last
rounding (Muller, Elementary Functions, 3rd ed.). Values at zeros, infinities and NaN are those of NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from ulna.compiler.codegen import coefficients
from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.exponentials import EXPONENTIALS, add_small
from ulna.compiler.codegen.function_body import Body
from ulna.compiler.codegen.ir_text import DType, IRFunction, Lanes
from ulna.compiler.codegen.sincos import arc, by_double, reduced_function


def elementary_ir(op: str, lanes: int, dtype: DType, arithmetic: Arithmetic = COMPLETE) -> IRFunction:
    """The IR of `T @ulna.<op>.<suffix>(T x)`, of `(T y, T x)` for atan2; T is `dtype` or `<lanes x dtype>`.

    The error stays below 1 ULP. No library is called: results are the same on all processors with FMA, and on all
    without; between the two they may differ in the last bit.

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
    # Rounding errors: rounded sum minus exact sum.
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
    """(is_above_half, t, p), p small: t + p is the arcsine of sqrt((1 - a)/2) where a = |x| > 1/2, else that of a."""
    a = body.fabs(x)
    is_above_half = body.compare("ogt", a, 0.5)
    z = body.select(is_above_half, body.fma(a, -0.5, 0.5), body.mul(a, a))
    root = body.call("sqrt", z)
    t = body.select(is_above_half, root, a)
    # The root's rounding error, to first order.
    twice = body.add(root, root)
    twice = body.select(body.compare("oeq", twice, 0.0), 1.0, twice)
    missing = body.div(body.cancelling_fma(body.neg(root), root, z), twice)
    z2 = body.mul(z, z)
    polynomial = body.polynomial(z, z2, coefficients.ASIN[body.lanes.dtype])
    p = body.fma(body.mul(t, z), polynomial, body.select(is_above_half, missing, 0.0))
    return is_above_half, t, p


def _asin(body: Body, x: str) -> str:
    quarter_pi = coefficients.QUARTER_PI[body.lanes.dtype]
    is_above_half, t, p = _half_arc(body, x)
    # arcsin a = pi/2 - 2 arcsin sqrt((1 - a)/2).
    base = body.select(is_above_half, 2 * quarter_pi[0], 0.0)
    t = body.select(is_above_half, body.mul(t, -2.0), t)
    p = body.select(is_above_half, body.fma(p, -2.0, 2 * quarter_pi[1]), p)
    return body.call("copysign", add_small(body, base, t, p), x)


def _acos(body: Body, x: str) -> str:
    quarter_pi = coefficients.QUARTER_PI[body.lanes.dtype]
    is_above_half, t, p = _half_arc(body, x)
    negative = body.compare("olt", x, 0.0)
    # Near: pi/2 - arcsin x. Far: 2 arcsin sqrt((1 - a)/2), or pi less that. Multiples of pi/4: 2, 0, 4.
    octants = body.select(is_above_half, body.select(negative, 4.0, 0.0), 2.0)
    factor = body.select(is_above_half, body.select(negative, -2.0, 2.0), body.select(negative, 1.0, -1.0))
    base = body.mul(octants, quarter_pi[0])
    return add_small(body, base, body.mul(t, factor), body.fma(p, factor, body.mul(octants, quarter_pi[1])))


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
    top, bottom, scale_up = (2.0**1000, 2.0**-900, 2.0**120) if double else (2.0**120, 2.0**-90, 2.0**40)
    lifted = body.select(body.compare("olt", large, bottom), scale_up, 1.0)
    scale = body.select(body.compare("ogt", large, top), 0.25, lifted)
    large, small = body.mul(large, scale), body.mul(small, scale)
    # arctan(small/large) = pi/4 + arctan((small - large)/(small + large)), for ratios beyond 1/2.
    diagonal = body.compare("ogt", small, body.mul(large, 0.5))
    total = body.add(large, small)
    total_missing = body.add(body.sub(large, total), small)
    numerator = body.select(diagonal, body.sub(small, large), small)
    denominator = body.select(diagonal, total, large)
    t, missing = _quotient(body, numerator, denominator, lambda: body.select(diagonal, total_missing, 0.0))
    z = body.mul(t, t)
    polynomial = body.polynomial(z, body.mul(z, z), coefficients.ATAN[body.lanes.dtype])
    p = body.fma(body.mul(t, z), polynomial, body.fma(body.neg(missing), z, missing))
    # The angle is octants * pi/4 + (t + p) or minus (t + p).
    x_is_negative = body.integer_op("icmp slt", body.to_bits(x), 0)
    octants = body.select(diagonal, 1.0, 0.0)
    octants = body.select(steep, body.sub(2.0, octants), octants)
    octants = body.select(x_is_negative, body.sub(4.0, octants), octants)
    is_reflected = body.emit(f"xor {body.lanes.truth} {steep}, {x_is_negative}")
    factor = body.select(is_reflected, -1.0, 1.0)
    quarter_pi = coefficients.QUARTER_PI[body.lanes.dtype]
    rest = body.fma(octants, quarter_pi[1], body.mul(p, factor))
    angle = add_small(body, body.mul(octants, quarter_pi[0]), body.mul(t, factor), rest)
    angle = body.call("copysign", angle, y)
    return body.select(body.compare("uno", x, y), body.add(x, y), angle)


def _quotient(
    body: Body, numerator: str, denominator: str, denominator_error: Callable[[], str]
) -> tuple[str, str]:
    """The quotient and its error term (exact minus rounded); `denominator_error` writes the denominator's."""
    reciprocal = body.div(1.0, denominator)
    t = body.mul(numerator, reciprocal)
    minus_t = body.neg(t)
    remainder = body.cancelling_fma(minus_t, denominator, numerator)
    remainder = body.fma(minus_t, denominator_error(), remainder)
    return t, body.mul(remainder, reciprocal)


def _erf(body: Body, x: str) -> str:
    """x + x E(x^2) up to b = 13/16; beyond, 1 - exp(-c - u C(u)), u = x - b, where exp(-c) = 1 - erf(b)."""
    dtype, bound = body.lanes.dtype, 0.8125
    most = 6.0 if dtype == "double" else 4.0  # from here on the result is 1
    a = body.fabs(x)
    bounded = body.select(body.compare("ogt", a, most), most, a)
    z, u = body.mul(bounded, bounded), body.sub(bounded, bound)
    near = body.polynomial(z, body.mul(z, z), coefficients.ERF[dtype])
    near = body.fma(bounded, near, bounded)
    slope = body.polynomial(u, body.mul(u, u), coefficients.ERFC[dtype])
    high, low = coefficients.ERFC_EXPONENT[dtype]
    exponent = body.fma(u, slope, high)
    missing = body.add(body.fma(u, slope, body.sub(high, exponent)), low)
    complement = EXPONENTIALS["exp"](body, body.neg(exponent))
    far = add_small(body, 1.0, body.neg(complement), body.mul(complement, missing))
    return body.call("copysign", body.select(body.compare("ogt", a, bound), far, near), x)


_WRITERS: dict[str, tuple[Callable[..., str], tuple[str, ...]]] = {
    "asin": (_asin, ("%x",)),
    "acos": (_acos, ("%x",)),
    "atan2": (_atan2, ("%y", "%x")),
    "erf": (_erf, ("%x",)),
    **{name: (write, ("%x",)) for name, write in EXPONENTIALS.items()},
}

OPERATIONS = ("tan", *_WRITERS)
"""What `elementary_ir` offers."""
