"""The header that the sources share: errors for unsuitable compiler options, minimum, maximum, sines and cosines.

Sines and cosines are those of `ulna.compiler.codegen.sincos` without fused multiply-add: pi/2 is subtracted in three
parts (Cody & Waite; Muller, Elementary Functions, 3rd ed., section 11.2), and there is no branch, so that a compiler
can work on several angles at once. Angles beyond the bound go to the C library.
"""

from __future__ import annotations

import re
from fractions import Fraction

from ulna.compiler.codegen import coefficients
from ulna.compiler.codegen.ir_text import DType
from ulna.exporting.c.expressions import number

_BITS: dict[DType, tuple[int, int]] = {"double": (40, 53), "float": (17, 24)}
"""Bits of the first two parts of pi/2, and of the last."""

_BOUND: dict[DType, float] = {"double": 2.0**13, "float": 2.0**7}
"""The largest angle [rad]: up to it a part of pi/2 times the count of quarter turns is exact, and no floating-point
number is so near to a multiple of pi/2 that the last part would not do."""

_ROUNDER: dict[DType, float] = {"double": 1.5 * 2.0**52, "float": 1.5 * 2.0**23}


def half_pi_parts(real: DType) -> list[float]:
    """pi/2 as a sum of three numbers, the first two of few bits."""
    rest = sum((Fraction(part) for part in coefficients.HALF_PI["double"]), Fraction(0))
    bits, last = _BITS[real]
    made = []
    for count in (bits, bits, last):
        scale = Fraction(2) ** (count - 1 - _exponent(rest))
        part = Fraction(int(rest * scale)) / scale  # towards zero
        made.append(float(part))
        rest -= part
    return made


def _exponent(x: Fraction) -> int:
    """The power of two at or below a positive number."""
    e = x.numerator.bit_length() - x.denominator.bit_length()
    return e if Fraction(2) ** e <= x else e - 1


def support_header(name: str, real: DType) -> str:
    """The text of the header that the sources share.

    Args:
        name: What names of functions of the export begin with.
        real: "double" or "float".

    Returns:
        The text.
    """
    values = {f"P{k + 1}": number(part, real) for k, part in enumerate(half_pi_parts(real))}
    values |= {
        "SINE": _polynomial(coefficients.SIN[real], real),
        "COSINE": _polynomial(coefficients.COS[real], real),
    }
    values["INVERSE"] = number(coefficients.TWO_OVER_PI[real][0], real)
    values["BOUND"], values["ROUNDER"] = number(_BOUND[real], real), number(_ROUNDER[real], real)
    suffix = "f" if real == "float" else ""
    values |= {
        word: word + suffix for word in ("fabs", "sin", "cos", "0.5", "0.25", "0.375", "1.0", "1.25", "1.5")
    }
    values |= {"name": name, "NAME": name.upper(), "real": real}
    return re.sub("@([^@ ]+)@", lambda match: values[match[1]], _TEMPLATE)


def _polynomial(c: tuple[float, ...], real: DType) -> str:
    """Horner's form of a polynomial of z."""
    numbers = [number(one, real) for one in c]
    return "".join(f"({one} + z * " for one in numbers[:-1]) + numbers[-1] + ")" * (len(c) - 1)


_TEMPLATE = """\
/* What the sources of @name@ share; not for use elsewhere. */
#ifndef @NAME@_SUPPORT_H
#define @NAME@_SUPPORT_H

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Compile without -ffast-math, -Ofast, -ffinite-math-only or /fp:fast: the order of sums and nan matter here."
#endif

#include <float.h>
#include <math.h>

#if defined(__GNUC__)
#define @NAME@_PART static __attribute__((noinline))
#elif defined(_MSC_VER)
#define @NAME@_PART static __declspec(noinline)
#else
#define @NAME@_PART static
#endif

/* The smaller number; nan if one is. */
static inline @real@ @name@_min(@real@ a, @real@ b)
{
    return a < b ? a : (b <= a ? b : a + b);
}

/* The greater number; nan if one is. */
static inline @real@ @name@_max(@real@ a, @real@ b)
{
    return a > b ? a : (b >= a ? b : a + b);
}

/* Sines and cosines of the angles that the next function leaves to the C library. */
@NAME@_PART void @name@_sincos_far(int n, const @real@ *x, @real@ *s, @real@ *c)
{
    int i;
    for (i = 0; i < n; i++) {
        if (!(@fabs@(x[i]) <= @BOUND@)) {
            s[i] = @sin@(x[i]);
            c[i] = @cos@(x[i]);
        }
    }
}

/* Sines s and cosines c of n angles x [rad]; with n = 2, 4 or 8 the loop becomes vector instructions. */
static inline void @name@_sincos(int n, const @real@ *x, @real@ *s, @real@ *c)
{
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD == 0
    int i, far = 0;
    for (i = 0; i < n; i++) {
        /* x = k pi/2 + (r - e), with an exact product k p for each part p of pi/2 but the last. */
        const @real@ shifted = x[i] * @INVERSE@ + @ROUNDER@;
        const @real@ k = shifted - @ROUNDER@;
        const @real@ t = k * @P2@;
        const @real@ r1 = x[i] - k * @P1@;
        const @real@ r2 = r1 - t;
        const @real@ b = r1 - r2;
        const @real@ low = ((r1 - (r2 + b)) + (b - t)) - k * @P3@;
        const @real@ r = r2 + low;
        const @real@ e = (r - r2) - low;
        /* Polynomials of sin(r - e) and cos(r - e). */
        const @real@ z = r * r;
        const @real@ h = @0.5@ * z;
        const @real@ w = @1.0@ - h;
        const @real@ cosine = w + (((@1.0@ - w) - h) + (z * z * @COSINE@ + r * e));
        const @real@ sine = r - (e * w - r * z * @SINE@);
        /* m is k modulo 4, from 0 to 3. */
        const @real@ m = k - 4 * ((k * @0.25@ - @0.375@ + @ROUNDER@) - @ROUNDER@);
        const @real@ turned_sine = (m - 2) * (m - 2) == 1 ? cosine : sine;
        const @real@ turned_cosine = (m - 2) * (m - 2) == 1 ? sine : cosine;
        s[i] = m > @1.5@ ? -turned_sine : turned_sine;
        c[i] = turned_cosine * ((m - @1.5@) * (m - @1.5@) - @1.25@);
    }
    for (i = 0; i < n; i++) { /* apart, so that the loop above becomes vector instructions everywhere */
        far |= !(@fabs@(x[i]) <= @BOUND@);
    }
    if (far) {
        @name@_sincos_far(n, x, s, c);
    }
#else
    int i;
    for (i = 0; i < n; i++) {
        s[i] = @sin@(x[i]);
        c[i] = @cos@(x[i]);
    }
#endif
}

#endif
"""
