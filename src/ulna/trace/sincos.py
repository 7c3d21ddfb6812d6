"""Write the LLVM IR of a paired sine and cosine that runs in SIMD lanes without a library call.

Method: k = round(2 x / pi); r = x - k pi/2 as an unevaluated sum of two floats, by a three-part reduction in the manner
of Cody and Waite in which FMA makes the first step exact; minimax polynomials of sin r and cos r; the quadrant k mod 4
swaps and negates them without a branch (Muller, Elementary Functions, 3rd ed., chapters 11 and 3). Arguments beyond
`BOUND` leave by a branch to a function marked cold. `scripts/fit_sincos.py` derives the constants and, with `--check`,
verifies them.
"""

from __future__ import annotations

from ulna.trace.irtext import Body, DType, IRFunction, Lanes

SIN_F64 = (
    float.fromhex("-0x1.5555555555548p-3"),
    float.fromhex("0x1.111111110f731p-7"),
    float.fromhex("-0x1.a01a019be9659p-13"),
    float.fromhex("0x1.71de3555b2b21p-19"),
    float.fromhex("-0x1.ae5e4bac4a9a6p-26"),
    float.fromhex("0x1.5d8b245959c14p-33"),
)
COS_F64 = (
    float.fromhex("0x1.555555555554bp-5"),
    float.fromhex("-0x1.6c16c16c15015p-10"),
    float.fromhex("0x1.a01a019c8f256p-16"),
    float.fromhex("-0x1.27e4f7f1925e0p-22"),
    float.fromhex("0x1.1ee9dbd0ca37dp-29"),
    float.fromhex("-0x1.8fa6861e3d552p-37"),
)
SIN_F32 = (
    float.fromhex("-0x1.5555460000000p-3"),
    float.fromhex("0x1.1107780000000p-7"),
    float.fromhex("-0x1.99540a0000000p-13"),
)
COS_F32 = (
    float.fromhex("0x1.55554a0000000p-5"),
    float.fromhex("-0x1.6c0c280000000p-10"),
    float.fromhex("0x1.99e80e0000000p-16"),
)
# pi/2 in parts. For doubles the second part is short enough for its product with any k in range to be exact.
HALF_PI_F64 = (
    float.fromhex("0x1.921fb54442d18p+0"),
    float.fromhex("0x1.1a62633000000p-54"),
    float.fromhex("0x1.45c06e0e68948p-86"),
)
HALF_PI_F32 = (
    float.fromhex("0x1.921fb40000000p+0"),
    float.fromhex("0x1.4442d20000000p-24"),
    float.fromhex("-0x1.ee59da0000000p-50"),
)
TWO_OVER_PI_F64 = (float.fromhex("0x1.45f306dc9c883p-1"),)
TWO_OVER_PI_F32 = (float.fromhex("0x1.45f3060000000p-1"),)

BOUND: dict[DType, float] = {"double": 2.0**24, "float": 2.0**16}
"""The largest |x| that the branch-free path serves [rad]."""

# Added to a number below a quarter of it, this rounds that number to an integer, left in the low bits of the sum.
_ROUNDER: dict[DType, float] = {"double": 1.5 * 2.0**52, "float": 1.5 * 2.0**23}


def sincos_ir(lanes: int, dtype: DType) -> IRFunction:
    """The IR of `{T, T} @ulna.sincos.<suffix>(T x)`, sine first; T is `dtype` or `<lanes x dtype>`.

    The error stays below 1 ULP for every x. sin(-0.0) is -0.0; an infinity or a NaN gives NaN. A lane's result does not
    depend on its neighbours. Each result is the same on every processor with IEEE arithmetic.

    Args:
        lanes: the number of lanes; 1 for the scalar function.
        dtype: "double" or "float".
    """
    kind = Lanes(lanes, dtype)
    name = f"ulna.sincos.{kind.suffix}"
    body = Body(kind)
    sine, cosine = _fast(body, "%x")
    far = body.any_lane(body.compare("ogt", body.fabs("%x"), BOUND[dtype]))
    slow = _slow(kind, f"{name}.slow")
    pair, real = kind.pair, kind.real
    text = "\n".join(
        [
            slow.text,
            f"define internal {pair} @{name}({real} %x) alwaysinline nounwind willreturn memory(none) {{",
            *body.lines,
            f"  br i1 {far}, label %slow, label %done",
            "slow:",
            f"  %slow.pair = call {pair} @{slow.name}({real} %x, {real} {sine}, {real} {cosine})",
            f"  %slow.sin = extractvalue {pair} %slow.pair, 0",
            f"  %slow.cos = extractvalue {pair} %slow.pair, 1",
            "  br label %done",
            "done:",
            f"  %sin = phi {real} [ {sine}, %0 ], [ %slow.sin, %slow ]",
            f"  %cos = phi {real} [ {cosine}, %0 ], [ %slow.cos, %slow ]",
            f"  %pair.0 = insertvalue {pair} poison, {real} %sin, 0",
            f"  %pair.1 = insertvalue {pair} %pair.0, {real} %cos, 1",
            f"  ret {pair} %pair.1",
            "}",
        ]
    )
    return IRFunction(name, text, (*body.declarations, *slow.declarations))


def _fast(body: Body, x: str) -> tuple[str, str]:
    """Sine and cosine of |x| <= BOUND; anything, without a trap, elsewhere; NaN of NaN."""
    dtype = body.lanes.dtype
    double = dtype == "double"
    sin_coefficients, cos_coefficients = (SIN_F64, COS_F64) if double else (SIN_F32, COS_F32)
    part1, part2, part3 = HALF_PI_F64 if double else HALF_PI_F32
    (two_over_pi,) = TWO_OVER_PI_F64 if double else TWO_OVER_PI_F32

    shifted = body.fma(x, two_over_pi, _ROUNDER[dtype])
    k = body.sub(shifted, _ROUNDER[dtype])
    # r - s is the reduced argument, |s| far below |r|. The sign of s keeps sin(-0.0) = -0.0 - (+0.0) = -0.0.
    first = body.fma(k, -part1, x)
    if double:
        r = body.fma(k, -part2, first)
        s = body.fma(k, part3, body.fma(k, part2, body.sub(r, first)))
    else:
        product = body.mul(k, -part2)
        rest = body.fma(k, part2, product)
        r = body.add(first, product)
        s = body.fma(k, part3, body.add(body.sub(body.sub(r, first), product), rest))

    z = body.mul(r, r)
    z2 = body.mul(z, z)
    # cos(r - s) = w + ((1 - r^2/2 - w) + r s + r^4 C(r^2)), where w = 1 - r^2/2 rounded.
    half = body.mul(r, -0.5)
    w = body.fma(half, r, 1.0)
    # sin(r - s) = r - (s - r^3 S(r^2)): one rounding at full size.
    tail = body.polynomial(z, z2, tuple(-c for c in sin_coefficients))
    sine = body.sub(r, body.fma(body.mul(r, z), tail, body.mul(s, w)))
    error = body.fma(r, s, body.fma(half, r, body.sub(1.0, w)))
    cosine = body.add(w, body.fma(z2, body.polynomial(z, z2, cos_coefficients), error))

    quadrant = body.to_bits(shifted)
    odd = body.integer_op("icmp ne", body.integer_op("and", quadrant, 1), 0)
    sign = -(2 ** (body.lanes.bits - 1))
    to_sign = body.lanes.bits - 2
    sine_sign = body.integer_op("and", body.integer_op("shl", quadrant, to_sign), sign)
    next_quadrant = body.integer_op("add", quadrant, 1)
    cosine_sign = body.integer_op("and", body.integer_op("shl", next_quadrant, to_sign), sign)
    results = []
    for value, flip in ((body.select(odd, cosine, sine), sine_sign), (body.select(odd, sine, cosine), cosine_sign)):
        results.append(body.from_bits(body.integer_op("xor", body.to_bits(value), flip)))
    return results[0], results[1]


def _slow(kind: Lanes, name: str) -> IRFunction:
    """The function that corrects the lanes beyond BOUND, one by one; it takes x and the sine and cosine so far."""
    body = Body(kind)
    far = body.compare("ogt", body.fabs("%x"), BOUND[kind.dtype])
    results = {"sin": "poison", "cos": "poison"}
    real, element = kind.real, kind.dtype
    for lane in range(kind.lanes):
        value = "%x" if kind.lanes == 1 else body.emit(f"extractelement {real} %x, i32 {lane}")
        if element == "float":
            value = body.emit(f"fpext float {value} to double")
        for function, collected in results.items():
            result = body.emit(f"call double @{function}(double {value})")
            if element == "float":
                result = body.emit(f"fptrunc double {result} to float")
            if kind.lanes > 1:
                result = body.emit(f"insertelement {real} {collected}, {element} {result}, i32 {lane}")
            results[function] = result
    sine, cosine = body.select(far, results["sin"], "%sin"), body.select(far, results["cos"], "%cos")
    text = "\n".join(
        [
            f"define internal {kind.pair} @{name}({real} %x, {real} %sin, {real} %cos) noinline cold nounwind {{",
            *body.lines,
            f"  %pair.0 = insertvalue {kind.pair} poison, {real} {sine}, 0",
            f"  %pair.1 = insertvalue {kind.pair} %pair.0, {real} {cosine}, 1",
            f"  ret {kind.pair} %pair.1",
            "}",
        ]
    )
    library = tuple(f"declare double @{function}(double) nounwind memory(none)" for function in results)
    return IRFunction(name, text, (*body.declarations, *library))
