"""Derive, or with `--check` verify, the constants of the elementary functions in `ulna.compiler.codegen.coefficients`.

The fits are those of `fit_sincos`: minimax in the relative error, coefficients rounded in turn.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import mpmath
from fit_sincos import fit, half_pi_parts, mpf, print_or_check, remez, report, round_to
from mpmath import mp


def asin_tail(z: Any) -> Any:
    """(asin s - s) / s^3 at z = s^2."""
    s = mpmath.sqrt(z)
    return (mpmath.asin(s) - s) / (z * s)


def asin_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the arcsine."""
    return z * mpmath.sqrt(z) / mpmath.asin(mpmath.sqrt(z))


def atan_tail(z: Any) -> Any:
    """(atan t - t) / t^3 at z = t^2."""
    t = mpmath.sqrt(z)
    return (mpmath.atan(t) - t) / (z * t)


def atan_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the arctangent."""
    return z * mpmath.sqrt(z) / mpmath.atan(mpmath.sqrt(z))


def log_tail(z: Any) -> Any:
    """(log((1 + s) / (1 - s)) / s - 2) / s^2 at z = s^2."""
    s = mpmath.sqrt(z)
    return (2 * mpmath.atanh(s) / s - 2) / z


def log_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the logarithm."""
    s = mpmath.sqrt(z)
    return z * s / (2 * mpmath.atanh(s))


def exp_tail(r: Any) -> Any:
    """(exp r - 1 - r - r^2/2) / r^3."""
    return mpmath.fsum(r**k / mpmath.factorial(k + 3) for k in range(40))


def exp_weight(r: Any) -> Any:
    """What turns an error of the tail into a relative error of the exponential."""
    return abs(r) ** 3 / mpmath.exp(r)


def expm1_weight(r: Any) -> Any:
    """What turns an error of the tail into a relative error of the exponential less 1."""
    return abs(r) ** 3 / abs(mpmath.expm1(r)) if r else mpf(0)


ERF_BOUND = mpf(13) / 16
"""Where the form of the error function changes: it is fitted itself below, its complement above."""


def erf_tail(z: Any) -> Any:
    """(erf(x) / x - 2 / sqrt(pi)) / x^2 at z = x^2."""
    x = mpmath.sqrt(z)
    return (mpmath.erf(x) / x - 2 / mpmath.sqrt(mp.pi)) / z


def erf_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the error function."""
    x = mpmath.sqrt(z)
    return z * x / mpmath.erf(x)


def erfc_tail(u: Any) -> Any:
    """(log(erfc(b)) - log(erfc(b + u))) / u, where b is the bound."""
    return mpmath.log(mpmath.erfc(ERF_BOUND) / mpmath.erfc(ERF_BOUND + u)) / u


def erfc_weight(u: Any) -> Any:
    """What turns an error of the tail into a relative error of the error function."""
    return u * mpmath.erfc(ERF_BOUND + u) / mpmath.erf(ERF_BOUND + u)


DEGREES = {
    "F64": {"ASIN": 12, "ATAN": 11, "LOG": 6, "EXP": 8, "EXPM1": 9, "ERF": 9, "ERFC": 17},
    "F32": {"ASIN": 4, "ATAN": 4, "LOG": 2, "EXP": 3, "EXPM1": 4, "ERF": 4, "ERFC": 6},
}


def constants() -> dict[str, list[Any]]:
    """All constants, by their names in `ulna.compiler.codegen.coefficients` and the format."""
    fitted: dict[str, list[Any]] = {}
    log_upper = (3 - 2 * mpmath.sqrt(2)) ** 2
    functions = {
        "ASIN": (asin_tail, asin_weight, mpf(1) / 4),
        "ATAN": (atan_tail, atan_weight, mpf(1) / 4),
        "LOG": (log_tail, log_weight, log_upper),
        "ERF": (erf_tail, erf_weight, ERF_BOUND**2),
    }
    for suffix, bits in (("F64", 53), ("F32", 24)):
        for name, (tail, weight, end) in functions.items():
            # A little beyond the interval, since its ends are met with rounding errors.
            upper = end * (1 + mpf(2) ** -16)
            coefficients, worst = fit(tail, weight, (upper / 10**6, upper), DEGREES[suffix][name], bits)
            fitted[f"{name}_{suffix}"] = coefficients
            report(f"{name}_{suffix}", worst)
        half = mpmath.log(2) / 2 * (1 + mpf(2) ** -10)
        for name, tail, weight, lower, upper in (
            ("EXP", exp_tail, exp_weight, -half, half),
            ("EXPM1", exp_tail, expm1_weight, -half, half),
            ("ERFC", erfc_tail, erfc_weight, mpf(10) ** -6, 6 - ERF_BOUND),
        ):
            exact, worst = remez(tail, weight, lower, upper, range(DEGREES[suffix][name] + 1))
            fitted[f"{name}_{suffix}"] = [float(round_to(c, bits)) for c in exact]
            report(f"{name}_{suffix}", worst)
        # The first part leaves room for the exponent, so that its product with it is exact.
        high = round_to(mpmath.log(2), bits - 12)
        fitted[f"LN2_{suffix}"] = [float(high), float(round_to(mpmath.log(2) - high, bits))]
        fitted[f"LOG2E_{suffix}"] = [float(round_to(1 / mpmath.log(2), bits))]
        fitted[f"ERF_{suffix}"].insert(0, float(round_to(2 / mpmath.sqrt(mp.pi) - 1, bits)))
        exponent = -mpmath.log(mpmath.erfc(ERF_BOUND))
        high = round_to(exponent, bits)
        fitted[f"ERFC_EXPONENT_{suffix}"] = [float(high), float(round_to(exponent - high, bits))]
        # Short enough to be multiplied by 1, 2, 3 or 4 without rounding.
        fitted[f"QUARTER_PI_{suffix}"] = [p / 2 for p in half_pi_parts((bits - 2, bits))]
    return fitted


def main(arguments: Sequence[str]) -> int:
    """Print the constants, or compare them with the committed ones."""
    fitted = constants()
    return print_or_check(fitted, "--check" in arguments)


if __name__ == "__main__":
    mp.dps = 60
    sys.exit(main(sys.argv[1:]))
