"""Derive, or with `--check` verify, the constants of sine and cosine in `ulna.compiler.codegen.coefficients`.

The polynomials are minimax fits of the relative error on [-pi/4, pi/4], found by the exchange algorithm of
Remez (Muller, Elementary Functions, 3rd ed., section 3.5) in 60-digit arithmetic. The coefficients are
rounded to the target format one after the other, the lowest power first, and those that remain are fitted
again each time, so that they absorb the rounding of the ones before.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

import mpmath
from mpmath import mp

mp.dps = 60

mpf: Any = mpmath.mpf
Real = Callable[[Any], Any]


def round_to(value: Any, bits: int) -> Any:
    """The value rounded to nearest with `bits` significant bits."""
    if value == 0:
        return mpf(0)
    _, exponent = mpmath.frexp(value)
    scale = mpf(2) ** (bits - exponent)
    return mpmath.nint(value * scale) / scale


def remez(f: Real, weight: Real, lower: Any, upper: Any, powers: Sequence[int]) -> tuple[list[Any], Any]:
    """The P that minimises max |weight(z) (P(z) - f(z))| on [lower, upper], and that maximum."""
    n = len(powers)
    grid = [
        lower + (upper - lower) * (1 - mpmath.cos(mp.pi * (2 * i + 1) / (2 * 40 * (n + 1)))) / 2
        for i in range(40 * (n + 1))
    ]
    values = [f(z) for z in grid]
    weights = [weight(z) for z in grid]
    reference = [(len(grid) - 1) * i // n for i in range(n + 1)]
    coefficients: list[Any] = []
    worst = mpf(0)
    for _ in range(30):
        system = mpmath.matrix(n + 1, n + 1)
        right = mpmath.matrix(n + 1, 1)
        for row, i in enumerate(reference):
            for column, power in enumerate(powers):
                system[row, column] = grid[i] ** power
            system[row, n] = (-1) ** row / weights[i]
            right[row] = values[i]
        solution = mpmath.lu_solve(system, right)
        coefficients = [solution[i] for i in range(n)]
        error = [
            w * (sum(c * z**p for c, p in zip(coefficients, powers, strict=True)) - v)
            for z, v, w in zip(grid, values, weights, strict=True)
        ]
        worst = max(abs(e) for e in error)
        if worst <= abs(solution[n]) * (1 + mpf("1e-6")):
            break
        reference = exchange(error, n + 1)
    return coefficients, worst


def exchange(error: Sequence[Any], count: int) -> list[int]:
    """The indices of `count` alternating extrema of the error, the largest ones."""
    extrema: list[int] = []
    for i, e in enumerate(error):
        if extrema and (e > 0) == (error[extrema[-1]] > 0):
            if abs(e) > abs(error[extrema[-1]]):
                extrema[-1] = i
        else:
            extrema.append(i)
    while len(extrema) > count:
        extrema.pop(0 if abs(error[extrema[0]]) < abs(error[extrema[-1]]) else -1)
    return extrema


def fit(f: Real, weight: Real, span: tuple[Any, Any], degree: int, bits: int) -> tuple[list[float], float]:
    """Rounded minimax coefficients of a polynomial in z, and its largest weighted error once rounded."""
    lower, upper = span
    fixed: list[Any] = []
    for start in range(degree + 1):

        def rest(z: Any) -> Any:
            return f(z) - sum(c * z**p for p, c in enumerate(fixed))

        coefficients, _ = remez(rest, weight, lower, upper, range(start, degree + 1))
        fixed.append(round_to(coefficients[0], bits))
    worst = mpf(0)
    for i in range(1, 201):
        z = lower + (upper - lower) * i / 200
        worst = max(worst, abs(weight(z) * (sum(c * z**p for p, c in enumerate(fixed)) - f(z))))
    return [float(c) for c in fixed], float(worst)


def sine_tail(z: Any) -> Any:
    """(sin r - r) / r^3 at z = r^2, by its series: no cancellation."""
    return sum((mpf((-1) ** (k + 1)) * z**k / mpmath.factorial(2 * k + 3) for k in range(25)), mpf(0))


def cosine_tail(z: Any) -> Any:
    """(cos r - 1 + r^2/2) / r^4 at z = r^2."""
    return sum((mpf((-1) ** k) * z**k / mpmath.factorial(2 * k + 4) for k in range(25)), mpf(0))


def sine_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the sine."""
    r = mpmath.sqrt(z)
    return z * r / mpmath.sin(r)


def cosine_weight(z: Any) -> Any:
    """What turns an error of the tail into a relative error of the cosine."""
    return z * z / mpmath.cos(mpmath.sqrt(z))


def half_pi_parts(bits: Sequence[int]) -> list[float]:
    """pi/2 as a sum of floats of the given numbers of bits."""
    rest, parts = mp.pi / 2, []
    for n in bits:
        parts.append(round_to(rest, n))
        rest -= parts[-1]
    return [float(p) for p in parts]


def constants() -> dict[str, list[Any]]:
    """All constants, by their names in `ulna.compiler.codegen.coefficients` and the format."""
    upper = (mp.pi / 4 * (1 + mpf(2) ** -16)) ** 2
    lower = upper * mpf(10) ** -8
    found: dict[str, list[Any]] = {}
    for suffix, bits, degree in (("F64", 53, 5), ("F32", 24, 2)):
        for name, tail, weight in (("SIN", sine_tail, sine_weight), ("COS", cosine_tail, cosine_weight)):
            coefficients, worst = fit(tail, weight, (lower, upper), degree, bits)
            found[f"{name}_{suffix}"] = coefficients
            report(f"{name}_{suffix}", worst)
    found["HALF_PI_F64"] = half_pi_parts((53, 31, 53))
    found["HALF_PI_F32"] = half_pi_parts((23, 24, 24))
    found["SHORT_HALF_PI"] = half_pi_parts((29, 27, 29, 53))
    found["TWO_OVER_PI_F64"] = [float(round_to(2 / mp.pi, 53))]
    found["TWO_OVER_PI_F32"] = [float(round_to(2 / mp.pi, 24))]
    found["HALF_PI_PAIR"] = half_pi_parts((53, 53))
    found["TWO_OVER_PI_BITS"] = words_of_two_over_pi(20)
    return found


def report(name: str, worst: Any) -> None:
    """Say how good a fit is."""
    print(f"# {name}: relative error 2^{float(mpmath.log(worst, 2)):.1f}", file=sys.stderr)


def words_of_two_over_pi(count: int) -> list[int]:
    """The bits of 2/pi after the binary point, in words of 64."""
    with mp.workprec(64 * count + 64):
        whole = int(mpmath.floor(2 / mp.pi * mpf(2) ** (64 * count)))
    return [(whole >> (64 * (count - 1 - k))) & (2**64 - 1) for k in range(count)]


def print_or_check(found: dict[str, list[Any]], check: bool) -> int:
    """Print the constants, or compare them with the committed ones; the status to exit with."""
    if not check:
        for name, values in found.items():
            print(f"{name}: {' '.join(v.hex() if isinstance(v, float) else f'0x{v:016X}' for v in values)}")
        return 0
    wrong = [name for name, values in found.items() if committed(name) != tuple(values)]
    for name in wrong:
        print(f"{name}: ulna.compiler holds {committed(name)}, the fit yields {tuple(found[name])}")
    return 1 if wrong else 0


def committed(name: str) -> tuple[Any, ...]:
    """The constants that the compiler uses."""
    from ulna.compiler.codegen import coefficients, payne_hanek

    kind = {"F64": "double", "F32": "float"}.get(name[-3:])
    if kind is not None:
        return getattr(coefficients, name[:-4])[kind]
    return getattr(coefficients if hasattr(coefficients, name) else payne_hanek, name)


def main(arguments: Sequence[str]) -> int:
    """Print the constants, or compare them with the committed ones."""
    return print_or_check(constants(), "--check" in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
