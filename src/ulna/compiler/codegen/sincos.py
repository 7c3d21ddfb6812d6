"""Write the LLVM IR of a paired sine and cosine that runs in SIMD lanes without a library call.

Method: k = round(2 x / pi); r = x - k pi/2 as an unevaluated sum of two floats, by a three-part reduction
in the manner of Cody and Waite whose first step FMA makes exact, or in four parts without FMA; minimax
polynomials of sin r and cos r; the quadrant k mod 4 swaps and negates them without a branch (Muller, Elementary
Functions, 3rd ed., chapters 3, 11). Arguments beyond `BOUND` leave by a branch to a function marked cold, which
reduces them by the method of Payne and Hanek.
"""

from __future__ import annotations

from collections.abc import Callable

from ulna.compiler.codegen import coefficients, payne_hanek
from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.function_body import Body
from ulna.compiler.codegen.ir_text import DType, IRFunction, Lanes

BOUND: dict[DType, float] = {"double": 2.0**24, "float": 2.0**16}
"""The largest |x| that the branch-free path serves [rad]."""

# Added to a number well below it, this rounds that number to an integer, left in the low bits of the sum.
ROUNDER: dict[DType, float] = {"double": 1.5 * 2.0**52, "float": 1.5 * 2.0**23}


def sincos_ir(lanes: int, dtype: DType, arithmetic: Arithmetic = COMPLETE) -> IRFunction:
    """The IR of `{T, T} @ulna.sincos.<suffix>(T x)`, sine first; T is `dtype` or `<lanes x dtype>`.

    The error stays below 0.85 ULP for every x. sin(-0.0) is -0.0; inf and NaN give NaN. A lane's result does
    not depend on its neighbours. The invalid exception is raised for infinities only. No library is called:
    results are the same on all processors with FMA, and on all without; between the two they may differ
    in the last bit.

    Args:
        lanes: the number of lanes; 1 for the scalar function.
        dtype: "double" or "float".
        arithmetic: what the processor computes in one instruction.

    Returns:
        Name, text and declarations of the function.
    """
    kind = Lanes(lanes, dtype)
    return reduced_function(kind, f"ulna.sincos.{kind.suffix}", _sincos, 2, arithmetic)


def _sincos(body: Body, r: str, s: str, quadrant: str) -> tuple[str, ...]:
    """Sine and cosine from the reduced argument."""
    (sine_high, sine_low), (cosine_high, cosine_low) = arc(body, r, s)
    sine, cosine = body.sub(sine_high, sine_low), body.add(cosine_high, cosine_low)
    odd = body.integer_op("icmp ne", body.integer_op("and", quadrant, 1), 0)
    results = []
    for even_value, odd_value, flipped in (
        (sine, cosine, quadrant),
        (cosine, sine, body.integer_op("add", quadrant, 1)),
    ):
        # Bit 1 of the quadrant moves to the sign.
        sign = body.integer_op("shl", flipped, body.lanes.bits - 2)
        results.append(body.flip_sign(body.select(odd, odd_value, even_value), sign))
    return tuple(results)


def _reduce_near(body: Body, x: str) -> tuple[str, str, str]:
    """(r, s, k): x = k pi/2 + (r - s), |r| <= pi/4 nearly, |s| far below it, k mod 4; for |x| <= BOUND.

    For x = -0.0, r is -0.0 and s is +0.0, so that r - s keeps the sign. NaN gives r = NaN.
    """
    dtype = body.lanes.dtype
    part1, part2, part3 = coefficients.HALF_PI[dtype]
    (two_over_pi,) = coefficients.TWO_OVER_PI[dtype]
    shifted = body.fma(x, two_over_pi, ROUNDER[dtype])
    k = body.sub(shifted, ROUNDER[dtype])
    if not body.is_fused:
        return *_subtract_quarters(body, x, k), body.to_bits(shifted)
    first = body.fma(k, -part1, x)
    if dtype == "double":
        r = body.fma(k, -part2, first)
        s = body.fma(k, part3, body.fma(k, part2, body.sub(r, first)))
    else:
        product = body.mul(k, -part2)
        rest = body.fma(k, part2, product)
        r = body.add(first, product)
        s = body.fma(k, part3, body.add(body.sub(body.sub(r, first), product), rest))
    return r, s, body.to_bits(shifted)


def _subtract_quarters(body: Body, x: str, k: str) -> tuple[str, str]:
    """(r, s): x - k pi/2 = r - s without FMA. Products of short parts are exact, and so is the first difference."""
    first, second, third, last = coefficients.SHORT_HALF_PI
    r, s = body.sub(x, body.mul(k, first)), body.mul(k, last)
    for part in (second, third):
        product = body.mul(k, part)
        following = body.sub(r, product)
        s = body.sub(s, body.sub(body.sub(r, following), product))  # what the difference was rounded by
        r = following
    return r, s


def arc(body: Body, r: str, s: str) -> tuple[tuple[str, str], tuple[str, str]]:
    """sin(r - s) as the first pair's difference, cos(r - s) as the second pair's sum; |r| <= pi/4 nearly.

    Args:
        body: Where the instructions are written.
        r: The name of the reduced argument [rad].
        s: The name of its correction [rad].

    Returns:
        Names of the pairs (large, small) of the sine and of the cosine.
    """
    sine, cosine = coefficients.SIN[body.lanes.dtype], coefficients.COS[body.lanes.dtype]
    z = body.mul(r, r)
    z2 = body.mul(z, z)
    # w = 1 - r^2/2 rounded; cos(r - s) = w + ((1 - r^2/2 - w) + r s + r^4 C(r^2)).
    half = body.mul(r, -0.5)
    w = body.fma(half, r, 1.0)
    error = body.fma(r, s, body.fma(half, r, body.sub(1.0, w)))
    cosine_low = body.fma(z2, body.polynomial(z, z2, cosine), error)
    # sin(r - s) = r - (s cos r - r^3 S(r^2)).
    tail = body.polynomial(z, z2, tuple(-c for c in sine))
    sine_low = body.fma(body.mul(r, z), tail, body.mul(s, w))
    return (r, sine_low), (w, cosine_low)


def _reduce_far(body: Body, x: str, far: str, near: tuple[str, str, str]) -> tuple[str, str, str]:
    """(r, s, k) with the lanes that are `far` reduced one by one, for every x: a loop, which compiles in no time."""
    kind = body.lanes
    types = (kind.real, kind.real, kind.of(f"i{kind.bits}"))
    if kind.lanes == 1:
        huge = _reduce_huge(body, body.select(far, x, 2.0 * BOUND[kind.dtype]))
        r, s, k = (
            body.emit(f"select i1 {far}, {of} {part}, {of} {current}")
            for of, part, current in zip(types, huge, near, strict=True)
        )
        return r, s, k
    elements = (kind.dtype, kind.dtype, f"i{kind.bits}")
    body.jump("lane")
    body.open_block("lane")
    index = body.emit("phi i32 [ 0, %start ], [ %following, %merged ]")
    now = [
        body.emit(f"phi {of} [ {value}, %start ], [ %next.{n}, %merged ]")
        for n, (of, value) in enumerate(zip(types, near, strict=True))
    ]
    flag = body.emit(f"extractelement {kind.truth} {far}, i32 {index}")
    body.write(f"br i1 {flag}, label %far, label %merged")
    body.open_block("far")
    huge = _reduce_huge(body, body.emit(f"extractelement {kind.real} {x}, i32 {index}"))
    changed = [
        body.emit(f"insertelement {of} {current}, {element} {part}, i32 {index}")
        for of, element, current, part in zip(types, elements, now, huge, strict=True)
    ]
    body.jump("merged")
    body.open_block("merged")
    r, s, k = (
        body.let(f"next.{n}", f"phi {of} [ {current}, %lane ], [ {other}, %far ]")
        for n, (of, current, other) in enumerate(zip(types, now, changed, strict=True))
    )
    body.let("following", f"add i32 {index}, 1")
    more = body.emit(f"icmp ult i32 %following, {kind.lanes}")
    body.write(f"br i1 {more}, label %lane, label %done")
    body.open_block("done")
    return r, s, k


def _reduce_huge(body: Body, value: str) -> tuple[str, str, str]:
    """(r, s, k) of one number, however large."""
    single = body.lanes.dtype == "float"
    if single:
        value = body.emit(f"fpext float {value} to double")
    pair = "{ double, double, i64 }"
    whole = body.emit(f"call {pair} @{payne_hanek.NAME}(double {value})")
    r, s, k = (body.emit(f"extractvalue {pair} {whole}, {i}") for i in range(3))
    if not single:
        return r, s, k
    exact = body.emit(f"fsub double {r}, {s}")
    r = body.emit(f"fptrunc double {exact} to float")
    back = body.emit(f"fpext float {r} to double")
    s = body.emit(f"fptrunc double {body.emit(f'fsub double {back}, {exact}')} to float")
    return r, s, body.emit(f"trunc i64 {k} to i32")


def reduced_function(
    kind: Lanes,
    name: str,
    finish: Callable[[Body, str, str, str], tuple[str, ...]],
    results: int,
    arithmetic: Arithmetic,
) -> IRFunction:
    """A function of x = k pi/2 + (r - s): inlined where |x| <= BOUND in every lane, else a cold call.

    Args:
        kind: type of the argument and of each result.
        name: of the function, without the `@`.
        finish: writes the results from r, s and k.
        results: how many there are, 1 or 2.
        arithmetic: what the processor computes in one instruction.

    Returns:
        Name, text and declarations of the function.
    """
    if kind.dtype == "float" and not arithmetic.fused_multiply_add:
        wide = Lanes(kind.lanes, "double")
        function = reduced_function(wide, name.replace(kind.suffix, wide.suffix), finish, results, arithmetic)
        return by_double(function, kind, name, ("%x",), results)
    real = kind.real
    returned = real if results == 1 else kind.pair
    test = Body(kind)
    far = test.any_lane(test.compare("ogt", test.fabs("%x"), BOUND[kind.dtype]))
    fast = Body(kind, "fast", arithmetic)
    fast_results = finish(fast, *_reduce_near(fast, "%x"))
    slow = Body(kind, "t", arithmetic)
    mask = slow.compare("ogt", slow.fabs("%x"), BOUND[kind.dtype])
    near = _reduce_near(slow, slow.select(mask, 0.0, "%x"))
    slow_results = finish(slow, *_reduce_far(slow, "%x", mask, near))
    text = [
        f"define internal {returned} @{name}.slow({real} %x) noinline cold nounwind {{",
        "start:",
        *slow.lines,
        *_return(kind, slow_results),
        "}",
        f"define internal {returned} @{name}({real} %x) alwaysinline nounwind {{",
        *test.lines,
        f"  br i1 {far}, label %slow, label %fast",
        "fast:",
        *fast.lines,
        *_return(kind, fast_results),
        "slow:",
        f"  %slow.value = tail call {returned} @{name}.slow({real} %x)",
        f"  ret {returned} %slow.value",
        "}",
    ]
    needed = dict.fromkeys((*slow.declarations, *payne_hanek.huge_reduction(arithmetic)))
    return IRFunction(name, "\n".join(text), tuple(needed))


def by_double(
    function: IRFunction, kind: Lanes, name: str, parameters: tuple[str, ...], results: int
) -> IRFunction:
    """A function of floats by the same function of doubles, for processors without FMA.

    Args:
        function: The function of doubles, in the same lanes.
        kind: The type of arguments and results.
        name: Of the function, without the `@`.
        parameters: Their names.
        results: How many there are, 1 or 2.

    Returns:
        Name, text and declarations of the function.
    """
    wide, body = Lanes(kind.lanes, "double"), Body(kind)
    returned, inner = (kind.real, wide.real) if results == 1 else (kind.pair, wide.pair)
    arguments = [f"{wide.real} {body.emit(f'fpext {kind.real} {p} to {wide.real}')}" for p in parameters]
    whole = body.emit(f"call {inner} @{function.name}({', '.join(arguments)})")
    parts = [whole] if results == 1 else [body.emit(f"extractvalue {inner} {whole}, {k}") for k in range(2)]
    values = tuple(body.emit(f"fptrunc {wide.real} {part} to {kind.real}") for part in parts)
    signature = ", ".join(f"{kind.real} {p}" for p in parameters)
    head = f"define internal {returned} @{name}({signature}) alwaysinline nounwind {{"
    text = "\n".join([head, *body.lines, *_return(kind, values), "}"])
    return IRFunction(name, text, (*function.declarations, function.text))


def _return(kind: Lanes, values: tuple[str, ...]) -> list[str]:
    """The lines that return one value or a pair."""
    if len(values) == 1:
        return [f"  ret {kind.real} {values[0]}"]
    return [
        f"  %result.0 = insertvalue {kind.pair} poison, {kind.real} {values[0]}, 0",
        f"  %result.1 = insertvalue {kind.pair} %result.0, {kind.real} {values[1]}, 1",
        f"  ret {kind.pair} %result.1",
    ]
