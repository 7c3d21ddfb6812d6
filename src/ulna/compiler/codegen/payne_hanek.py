"""Write the LLVM IR that reduces one huge double modulo pi/2, exactly enough for every double.

Method of Payne and Hanek (Muller, Elementary Functions, 3rd ed., section 11.4): of the product of x with
the bits of 2/pi only a window of 192 bits matters, since those above make multiples of 2 pi and those below
vanish. C libraries do not always serve here: glibc 2.36 was found wrong by thousands of ULP for large
arguments near a multiple of pi/2. `scripts/fit_sincos.py --check` verifies the bits.
"""

from __future__ import annotations

from collections.abc import Callable

from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import Lanes

TWO_OVER_PI_BITS = (
    0xA2F9836E4E441529, 0xFC2757D1F534DDC0, 0xDB6295993C439041, 0xFE5163ABDEBBC561,
    0xB7246E3A424DD2E0, 0x06492EEA09D1921C, 0xFE1DEB1CB129A73E, 0xE88235F52EBB4484,
    0xE99C7026B45F7E41, 0x3991D639835339F4, 0x9C845F8BBDF9283B, 0x1FF897FFDE05980F,
    0xEF2F118B5A0A6D1F, 0x6D367ECF27CB09B7, 0x4F463F669E5FEA2D, 0x7527BAC7EBE5F17B,
    0x3D0739F78A5292EA, 0x6BFB5FB11F8D5D08, 0x56033046FC7B6BAB, 0xF0CFBC209AF4361D,
)  # fmt: skip
"""The first 1280 bits of 2/pi after the binary point."""

HALF_PI_PAIR = (float.fromhex("0x1.921fb54442d18p+0"), float.fromhex("0x1.1a62633145c07p-54"))

NAME = "ulna.reduce.huge"
_DOUBLE = Lanes(1, "double")


_FMA = "declare double @llvm.fma.f64(double, double, double)"
_MODULE = (
    "declare i64 @llvm.fshl.i64(i64, i64, i64)",
    "declare i64 @llvm.ctlz.i64(i64, i1)",
)
_RESULT = "{ double, double, i64 }"


def huge_reduction(arithmetic: Arithmetic = COMPLETE) -> tuple[str, ...]:
    """Module-level texts: a table, declarations, and `{double, double, i64} @ulna.reduce.huge(double x)`.

    For |x| >= 2^16 the results are r, s and k of x = k pi/2 + (r - s), with |r| <= pi/4, |s| below an ULP
    of r, and k right modulo 4. An infinity or a NaN gives r = NaN.

    Args:
        arithmetic: What the processor computes in one instruction.

    Returns:
        The texts, each to be written once in a module.
    """
    # One word of zeros in front: the window of the smallest arguments begins above the binary point.
    table = ", ".join(f"i64 {word}" for word in (0, *TWO_OVER_PI_BITS))
    size = len(TWO_OVER_PI_BITS) + 1
    is_fused = arithmetic.fused_multiply_add and arithmetic.double_precision
    w = Instructions()
    w.lines.append(f"define internal {_RESULT} @{NAME}(double %x) noinline cold nounwind {{")
    _window(w)
    _product(w, _wide_product if arithmetic.wide_integers else _long_product)
    _distance(w)
    _scaled_distance(w, arithmetic.wide_integers)
    (_times_half_pi if is_fused else _times_half_pi_in_halves)(w)
    _signs_and_return(w)
    w.lines.append("}")
    return (
        f"@{NAME}.table = internal unnamed_addr constant [{size} x i64] [{table}], align 8",
        *((_FMA,) if is_fused else ()),
        *_MODULE,
        w.text(),
    )


def _window(w: Instructions) -> None:
    """The significand m of |x| = m 2^e, and three words t of 2/pi, from the bit on that matters."""
    w.write(
        "%bits = bitcast double %x to i64",
        "%shifted = lshr i64 %bits, 52",
        "%biased = and i64 %shifted, 2047",
        "%fraction = and i64 %bits, 4503599627370495",
        "%m = or i64 %fraction, 4503599627370496",
        # e = biased - 1075. Bits of weight 2^-j count from j = e - 1 on; 64 zeros precede j = 1.
        "%start = sub i64 %biased, 1013",
        "%word = lshr i64 %start, 6",
        "%shift = and i64 %start, 63",
    )
    for k in range(4):
        w.let(f"i{k}", f"add i64 %word, {k}")
        w.let(f"p{k}", f"getelementptr i64, ptr @{NAME}.table, i64 %i{k}")
        w.let(f"w{k}", f"load i64, ptr %p{k}, align 8")
    for k in range(3):
        w.let(f"t{k}", f"call i64 @llvm.fshl.i64(i64 %w{k}, i64 %w{k + 1}, i64 %shift)")


def _product(w: Instructions, multiply: Callable[[Instructions], None]) -> None:
    """The product m t modulo 2^192, words a0 (high), a1, low2; its value is a 2^-190 quarter turns."""
    multiply(w)
    w.write(
        "%low0 = mul i64 %m, %t0",
        "%a1 = add i64 %low1, %high2",
        "%carry = icmp ult i64 %a1, %low1",
        "%carry.word = zext i1 %carry to i64",
        "%a0.part = add i64 %low0, %high1",
        "%a0 = add i64 %a0.part, %carry.word",
    )


def _wide_product(w: Instructions) -> None:
    """The words low and high of m t1 and of m t2."""
    w.let("m.wide", "zext i64 %m to i128")
    for k in (1, 2):
        w.let(f"t{k}.wide", f"zext i64 %t{k} to i128")
        w.let(f"product{k}", f"mul nuw i128 %m.wide, %t{k}.wide")
        w.let(f"low{k}", f"trunc i128 %product{k} to i64")
        w.let(f"high{k}.wide", f"lshr i128 %product{k}, 64")
        w.let(f"high{k}", f"trunc i128 %high{k}.wide to i64")


def _long_product(w: Instructions) -> None:
    """The same from products of 32-bit halves (Warren, Hacker's Delight, 2nd ed., section 8-2)."""
    w.write("%m.low = and i64 %m, 4294967295", "%m.high = lshr i64 %m, 32")
    for k in (1, 2):
        w.write(
            f"%low{k} = mul i64 %m, %t{k}",
            f"%t{k}.low = and i64 %t{k}, 4294967295",
            f"%t{k}.high = lshr i64 %t{k}, 32",
            f"%p{k}.00 = mul i64 %m.low, %t{k}.low",
            f"%p{k}.10 = mul i64 %m.high, %t{k}.low",
            f"%p{k}.01 = mul i64 %m.low, %t{k}.high",
            f"%p{k}.11 = mul i64 %m.high, %t{k}.high",
            f"%p{k}.00.high = lshr i64 %p{k}.00, 32",
            f"%p{k}.middle = add i64 %p{k}.10, %p{k}.00.high",
            f"%p{k}.middle.low = and i64 %p{k}.middle, 4294967295",
            f"%p{k}.middle.high = lshr i64 %p{k}.middle, 32",
            f"%p{k}.sum = add i64 %p{k}.01, %p{k}.middle.low",
            f"%p{k}.sum.high = lshr i64 %p{k}.sum, 32",
            f"%p{k}.top = add i64 %p{k}.11, %p{k}.middle.high",
            f"%high{k} = add i64 %p{k}.top, %p{k}.sum.high",
        )


def _distance(w: Instructions) -> None:
    """Without the two whole bits the rest is, in two's complement, the distance to the next quarter turn."""
    w.write(
        "%whole = lshr i64 %a0, 62",
        "%f0 = call i64 @llvm.fshl.i64(i64 %a0, i64 %a1, i64 2)",
        "%f1 = call i64 @llvm.fshl.i64(i64 %a1, i64 %low2, i64 2)",
        "%f2 = shl i64 %low2, 2",
        "%minus = ashr i64 %f0, 63",
        "%k.magnitude = sub i64 %whole, %minus",
        *(f"%g{k} = xor i64 %f{k}, %minus" for k in range(3)),
    )


def _scaled_distance(w: Instructions, converts_words: bool) -> None:
    """The distance in quarter turns, y + y.low = (top + next 2^-53) 2^(-53 - zeros)."""
    w.write(
        # No double is nearer than 2^-62 quarter turns to a multiple: the leading one lies in the first word.
        "%zeros = call i64 @llvm.ctlz.i64(i64 %g0, i1 false)",
        "%h0 = call i64 @llvm.fshl.i64(i64 %g0, i64 %g1, i64 %zeros)",
        "%h1 = call i64 @llvm.fshl.i64(i64 %g1, i64 %g2, i64 %zeros)",
        "%top = lshr i64 %h0, 11",
        "%next.word = call i64 @llvm.fshl.i64(i64 %h0, i64 %h1, i64 53)",
        "%next = lshr i64 %next.word, 11",
    )
    for name in ("top", "next"):
        if converts_words:
            w.let(f"{name}.float", f"uitofp i64 %{name} to double")
            continue
        # In two exact parts, for processors of 32 bits, which would call a library.
        w.write(
            f"%{name}.low.word = trunc i64 %{name} to i32",
            f"%{name}.high.long = lshr i64 %{name}, 32",
            f"%{name}.high.word = trunc i64 %{name}.high.long to i32",
            f"%{name}.low.float = uitofp i32 %{name}.low.word to double",
            f"%{name}.high.float = uitofp i32 %{name}.high.word to double",
            f"%{name}.high.scaled = fmul double %{name}.high.float, {_DOUBLE.constant(2.0**32)}",
            f"%{name}.float = fadd double %{name}.high.scaled, %{name}.low.float",
        )
    w.write(
        "%exponent = sub i64 970, %zeros",
        "%scale.bits = shl i64 %exponent, 52",
        "%scale = bitcast i64 %scale.bits to double",
        "%y = fmul double %top.float, %scale",
        f"%next.scaled = fmul double %next.float, {_DOUBLE.constant(2.0**-53)}",
        "%y.low = fmul double %next.scaled, %scale",
    )


def _times_half_pi(w: Instructions) -> None:
    """r - s = (y + y.low) pi/2, in twice the precision."""
    high, low = map(_DOUBLE.constant, HALF_PI_PAIR)
    w.write(
        f"%r0 = fmul double %y, {high}",
        "%r0.minus = fneg double %r0",
        f"%r1 = call double @llvm.fma.f64(double %y, double {high}, double %r0.minus)",
        f"%r2 = call double @llvm.fma.f64(double %y, double {low}, double %r1)",
        f"%r3 = call double @llvm.fma.f64(double %y.low, double {high}, double %r2)",
        "%r = fadd double %r0, %r3",
        "%r4 = fsub double %r, %r0",
        "%s = fsub double %r4, %r3",
    )


def _times_half_pi_in_halves(w: Instructions) -> None:
    """The same without FMA: the error of the first product from halves of its factors (Dekker 1971)."""
    high, low = HALF_PI_PAIR
    upper = float.fromhex("0x1.921fb54p+0")
    factor, factor_low, top, rest = map(_DOUBLE.constant, (high, low, upper, high - upper))
    w.write(
        f"%r0 = fmul double %y, {factor}",
        "%y.bits = bitcast double %y to i64",
        "%y.upper.bits = and i64 %y.bits, -134217728",
        "%y.upper = bitcast i64 %y.upper.bits to double",
        "%y.rest = fsub double %y, %y.upper",
        f"%e0 = fmul double %y.upper, {top}",
        "%e1 = fsub double %e0, %r0",
        f"%e2 = fmul double %y.upper, {rest}",
        "%e3 = fadd double %e1, %e2",
        f"%e4 = fmul double %y.rest, {top}",
        "%e5 = fadd double %e3, %e4",
        f"%e6 = fmul double %y.rest, {rest}",
        "%r1 = fadd double %e5, %e6",
        f"%m2 = fmul double %y, {factor_low}",
        "%r2 = fadd double %r1, %m2",
        f"%m3 = fmul double %y.low, {factor}",
        "%r3 = fadd double %r2, %m3",
        "%r = fadd double %r0, %r3",
        "%r4 = fsub double %r, %r0",
        "%s = fsub double %r4, %r3",
    )


def _signs_and_return(w: Instructions) -> None:
    """Signs of r, s and k: those of the distance, and of x; nan where x is not finite."""
    w.write(
        "%negative = ashr i64 %bits, 63",
        "%flip = xor i64 %negative, %minus",
        "%flip.sign = shl i64 %flip, 63",
    )
    for name in ("r", "s"):
        w.let(f"{name}.bits", f"bitcast double %{name} to i64")
        w.let(f"{name}.flipped", f"xor i64 %{name}.bits, %flip.sign")
        w.let(f"{name}.signed", f"bitcast i64 %{name}.flipped to double")
    w.write(
        "%k.not = xor i64 %k.magnitude, %negative",
        "%k = sub i64 %k.not, %negative",
        "%finite = icmp ult i64 %biased, 2047",
        "%nan = fsub double %x, %x",
        "%r.final = select i1 %finite, double %r.signed, double %nan",
        f"%result.0 = insertvalue {_RESULT} poison, double %r.final, 0",
        f"%result.1 = insertvalue {_RESULT} %result.0, double %s.signed, 1",
        f"%result.2 = insertvalue {_RESULT} %result.1, i64 %k, 2",
        f"ret {_RESULT} %result.2",
    )
