"""Procedures: the language, its errors, and the machine code beside the interpreter."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from tests.support.procedure_ways import all_ways
from tests.support.random_procedures import arguments, random_procedure

import ulna
from ulna import numeric
from ulna.compiler.procedures import (
    Array1,
    Array2,
    Array3,
    Kernel,
    aligned,
    all_of,
    any_of,
    broadcast,
    count_of,
    f32,
    f64,
    first_of,
    greatest_of,
    lane_numbers,
    lanes_kernel,
    least_of,
    procedure,
    sum_of,
)  # fmt: skip
from ulna.compiler.runtime.jit import target
from ulna.errors import DivisionByZero, DtypeError, InputError, OutOfBounds, ProcedureError, ShapeError

INT = np.int64


@procedure
def nearest(points: Array2[f64], q: Array1[f64]) -> int:
    best, least = -1, np.inf
    for i in range(len(points)):
        distance = 0.0
        for k in range(len(q)):
            distance += (points[i, k] - q[k]) ** 2
        if distance < least:
            best, least = i, distance
    return best


def test_a_search_returns_what_numpy_finds() -> None:
    random = np.random.default_rng(1)
    points, q = random.normal(size=(100, 7)), random.normal(size=7)
    assert all_ways(nearest, points, q) == np.argmin(((points - q) ** 2).sum(axis=1))
    assert all_ways(nearest, points[:0], q) == -1
    assert repr(nearest) == "<procedure nearest(points, q)>"


@procedure
def arithmetic(a: int, b: int) -> Any:
    return a + b, a - b, a * b, a // b, a % b, -a, abs(a), ~a, a & b, a | b, a ^ b, a << 2, a >> 1


@pytest.mark.parametrize("a", [7, -7, 0, 2**63 - 1, -(2**63)])
@pytest.mark.parametrize("b", [3, -3, 1, -1, 2**62])
def test_integers_divide_as_in_python_and_wrap(a: int, b: int) -> None:
    def wrap(x: int) -> int:
        return (x + 2**63) % 2**64 - 2**63

    expected = (a + b, a - b, a * b, a // b, a % b, -a, abs(a), ~a, a & b, a | b, a ^ b, a << 2, a >> 1)
    assert all_ways(arithmetic, a, b) == tuple(map(wrap, expected))


def test_division_of_integers_by_zero_raises_with_its_line() -> None:
    for call in (arithmetic, arithmetic.checked, arithmetic.interpret):
        with pytest.raises(DivisionByZero, match=r"test_procedures.py:\d+: an integer is divided by zero"):
            call(1, 0)
    with pytest.raises(ZeroDivisionError):
        arithmetic(1, 0)


@procedure
def functions(x: f64, y: f64) -> Any:
    return (
        math.sqrt(x), math.sin(y), math.cos(y), math.tan(y), math.asin(y), math.acos(y), math.atan2(y, x),
        math.exp(y), math.log(x), math.expm1(y), np.log1p(y), math.sinh(y),
        math.erf(y), numeric.erf(x), np.floor(y), np.ceil(y), math.floor(y),
    )  # fmt: skip


def test_elementary_functions_agree_with_python() -> None:
    x, y = 2.5, -0.75
    expected = [
        math.sqrt(x),
        math.sin(y),
        math.cos(y),
        math.tan(y),
        math.asin(y),
        math.acos(y),
        math.atan2(y, x),
    ]
    expected += [math.exp(y), math.log(x), math.expm1(y), math.log1p(y), math.sinh(y), math.erf(y)]
    expected += [math.erf(x), -1.0, 0.0, -1]
    for call in (functions, functions.checked, functions.interpret):
        np.testing.assert_allclose(call(x, y), expected, rtol=4e-16)
    assert type(functions(x, y)[-1]) is int


@procedure
def conversions(x: f64) -> Any:
    return int(x), f32(x), f64(f32(x)), int(f32(x)), x > 0.0


@pytest.mark.parametrize("x", [1.9, -1.9, math.inf, -math.inf, math.nan, 1e300, 9.3e18, -0.0])
def test_conversions_saturate(x: float) -> None:
    whole, single, _, _, positive = all_ways(conversions, x)
    limits = {math.inf: 2**63 - 1, -math.inf: -(2**63), 1e300: 2**63 - 1, 9.3e18: 2**63 - 1}
    assert whole == (0 if math.isnan(x) else limits.get(x, int(x) if math.isfinite(x) else 0))
    assert type(single) is np.float32 and type(positive) is bool


@procedure(constants={"W": 8})
def lane_conversions(x: Array1[f64], y: Array1[f32], whole: Array1[INT], single: Array1[INT], W: int) -> None:
    for i in range(0, len(x), W):
        whole[i : i + W] = int(x[i : i + W])
        single[i : i + W] = int(y[i : i + W])


@pytest.mark.parametrize("lanes", [2, 8, 16])
def test_conversions_of_lanes_are_those_of_numbers(lanes: int) -> None:
    edge, below = 2.0**63, float(np.nextafter(2.0**63, 0.0))
    values = [math.nan, math.inf, -math.inf, 1e300, -1e300, edge, -edge, below, -below, 1.9, -1.9, -0.0]
    values += [2.5**k * (-1) ** k for k in range(20)]
    x = np.array(values)
    with np.errstate(over="ignore"):
        y = x.astype(np.float32)
    whole, single = np.zeros((2, len(x)), INT)
    all_ways(lane_conversions.specialized(W=lanes), x, y, whole, single)
    np.testing.assert_array_equal(whole, [conversions(v)[0] for v in x.tolist()])
    np.testing.assert_array_equal(single, [conversions(float(v))[0] for v in y])


class Spheres(NamedTuple):
    centres: Array2[f32]
    radii: Array1[f32]


@procedure
def first_hit(spheres, x, y, z, radius, W):
    for i in range(0, len(spheres.radii), W):
        dx, dy, dz = spheres.centres[0, i : i + W] - x, spheres.centres[1, i : i + W] - y, 0.0
        dz = f64(z)
        ez = spheres.centres[2, i : i + W] - f32(dz)
        r = spheres.radii[i : i + W] + radius
        touches = dx * dx + dy * dy + ez * ez < r * r
        if any_of(touches):
            return i + first_of(touches)
    return -1


@procedure(constants={"W": 8})
def hits(spheres: Spheres, points: Array2[f32], out: Array1[INT], W: int) -> int:
    count = 0
    for k in range(len(points)):
        out[k] = first_hit(spheres, points[k, 0], points[k, 1], points[k, 2], points[k, 3], W)
        if out[k] >= 0:
            count += 1
    return count


def scene(spheres: int = 64, points: int = 40) -> tuple[Spheres, Any]:
    random = np.random.default_rng(3)
    centres = random.normal(size=(3, spheres)).astype(np.float32)
    p = np.concatenate([random.normal(size=(points, 3)), np.full((points, 1), 0.2)], axis=1)
    return Spheres(centres, np.full(spheres, 0.2, np.float32)), p.astype(np.float32)


def test_records_lanes_and_calls_find_spheres() -> None:
    spheres, points = scene()
    outs = [np.zeros(len(points), INT) for _ in range(3)]
    counts = [f(spheres, points, o) for f, o in zip((hits, hits.checked, hits.interpret), outs, strict=True)]
    d = np.linalg.norm(spheres.centres.T[None] - points[:, None, :3], axis=2)
    touches = d < 0.4
    expected = np.where(touches.any(axis=1), touches.argmax(axis=1), -1)
    for count, out in zip(counts, outs, strict=True):
        np.testing.assert_array_equal(out, expected)
        assert count == (expected >= 0).sum()
    wider = hits.specialized(W=16)
    assert wider(spheres, points, outs[0]) == counts[0]


def test_checked_code_and_interpreter_name_line_index_and_extent() -> None:
    spheres, points = scene(60)
    out = np.zeros(len(points), INT)
    for call in (hits.checked, hits.interpret):
        with pytest.raises(
            OutOfBounds, match=r"test_procedures.py:\d+: index 63 of an axis of length 60"
        ) as caught:
            call(spheres, points, out)
        assert (caught.value.index, caught.value.extent) == (63, 60)
    with pytest.raises(IndexError):
        hits.checked(scene()[0], points, out[:3])


@procedure
def every_access(i: int, a: Array3[f64], k: Array1[INT]) -> None:
    kind = k[0]
    if kind == 0:
        a[0, i, 0] = 1.0
    elif kind == 1:
        a[0, 0, i : i + 4] = broadcast(2.0, 4)
    elif kind == 2:
        a[0, 0, lane_numbers(4) + i] = broadcast(3.0, 4)
    elif kind == 3:
        fill(a[i], 4.0)
    elif kind == 4:
        a[0, 0, 0] = a[1, 1, lane_numbers(4) * 2][i]
    else:
        a[0, 1, 1] = sum_of(a[i, 1, 0:4])


@procedure
def fill(a, value):
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[i, j] = value


@pytest.mark.parametrize("kind", range(6))
@pytest.mark.parametrize("i", [0, 1, -1, 2, 3, 7, 100, 2**62])
def test_every_kind_of_access_is_checked(kind: int, i: int) -> None:
    arrays = [np.arange(16.0).reshape(2, 2, -1).repeat(2, axis=2) for _ in range(2)]
    results = []
    for call, a in zip((every_access.checked, every_access.interpret), arrays, strict=True):
        try:
            call(i, a, np.array([kind]))
            results.append("fine")
        except OutOfBounds as error:
            results.append(str(error))
    assert results[0] == results[1]
    np.testing.assert_array_equal(arrays[0], arrays[1])
    if results[0] == "fine":
        again = np.arange(16.0).reshape(2, 2, -1).repeat(2, axis=2)
        every_access(i, again, np.array([kind]))
        np.testing.assert_array_equal(arrays[0], again)
    assert (results[0] == "fine") == (i in {0: (0, 1), 1: (0, 1, 2, 3), 2: (0, 1, 2, 3), 3: (0, 1),
                                            4: (0, 1, 2, 3), 5: (0, 1)}[kind])  # fmt: skip


@procedure
def reductions(a: Array1[f32], k: Array1[INT]) -> Any:
    x = a[0:8]
    m = x > 0
    n = k[0:4]
    return (
        sum_of(x), least_of(x), greatest_of(x), any_of(m), all_of(m), count_of(m), first_of(m), first_of(x > 99),
        sum_of(n), least_of(n), greatest_of(n), np.where(m, x, -x), x[3], m, min(1.0, 2.0, f64(x[0])),
    )  # fmt: skip


def test_reductions_of_lanes() -> None:
    a = np.array([-1, -2, 3, 4, -5, 6, -7, 8], np.float32)
    result = all_ways(reductions, a, np.array([4, -9, 2, 5]))
    assert result[:11] == (6.0, -7.0, 8.0, True, False, 4, 2, 8, 2, -9, 5)
    np.testing.assert_array_equal(result[11], abs(a))
    assert result[12] == 4.0 and list(result[13]) == list(a > 0) and result[14] == -1.0


@procedure
def storage(n: int) -> Any:
    table = np.zeros((4, 8), f64)
    stack = np.empty(16, int)
    for i in range(4):
        table[i, 0:8] = lane_numbers(8, f64) * i
        stack[i] = i * n
    total = 0.0
    for i in range(4):
        total += sum_of(table[i, 0:8])
    return total, stack[3]


def test_storage_of_a_procedure() -> None:
    assert all_ways(storage, 5) == (28.0 * 6, 15)


@procedure
def control(limit: int) -> int:
    total, i = 0, 0
    while True:
        i += 1
        if i % 2 == 0:
            continue
        if i > limit:
            break
        total += i
        for k in range(10, 0, -3):
            if k == 4:
                break
            total += 0 if k > 8 else k
    return total


def test_loops_with_break_and_continue() -> None:
    expected, i = 0, 1
    while i <= 9:
        expected += i + 7
        i += 2
    assert all_ways(control, 9) == expected


@procedure
def only_read_if(n: int, a: Array1[f64]) -> bool:
    return (n < len(a) and a[n] > 0) or n == 100


def test_conditions_are_lazy() -> None:
    assert [all_ways(only_read_if, n, np.array([1.0, -1.0])) for n in (0, 1, 5, 100)] == [
        True,
        False,
        False,
        True,
    ]


@procedure
def swap(a: int, b: int) -> Any:
    a, b = b, a
    x, y = pair(a, b)
    return a, b, x, y


@procedure
def pair(a, b):
    return a - b, f32(a + b)


def test_several_values_at_once() -> None:
    assert all_ways(swap, 1, 2) == (2, 1, 1, 3.0)


# kernels --------------------------------------------------------------------------------------------------


@procedure
def highest(fk: Kernel, samples: Array3[f32], poses: Array2[f32], W: int) -> f32:
    best = f32(-1e30)
    for k in range(len(samples)):
        fk(samples[k], poses)
        best = max(best, greatest_of(poses[11, 0:W]))
    return best


def test_a_procedure_calls_a_traced_function_of_a_robot() -> None:
    robot = ulna.load("panda")
    fk = lanes_kernel(robot.function("fk"), 8)
    random = np.random.default_rng(5)
    q = random.uniform(robot.limits.lower, robot.limits.upper, size=(10, 8, robot.nq))
    samples = np.ascontiguousarray(q.transpose(0, 2, 1).astype(np.float32))
    poses = np.zeros((16, 8), np.float32)
    found = highest.specialized(W=8)
    z = robot.fk(q)[..., 2, 3].max()
    for call in (found, found.checked, found.interpret):
        assert call(fk, samples, poses) == pytest.approx(z, abs=2e-6)
    fk(samples[-1], poses)
    np.testing.assert_allclose(poses.reshape(4, 4, 8).transpose(2, 0, 1), robot.fk(q[-1]), atol=3e-6)
    for call in (found.checked, found.interpret):
        with pytest.raises(OutOfBounds, match=r"test_procedures.py:\d+: index 127 of an axis of length 96;"):
            call(fk, samples, poses[:12].copy())


def test_kernels_for_procedures_refuse_what_they_cannot_do() -> None:
    fk = ulna.load("panda").function("fk")
    with pytest.raises(InputError, match="`lanes` is 6; expected a power of two"):
        lanes_kernel(fk, 6)
    with pytest.raises(DtypeError, match="float32 or float64"):
        lanes_kernel(fk, 8, int)
    kernel = lanes_kernel(fk, dtype=np.float64)
    assert kernel.lanes == target().lanes("double")
    inputs, outputs = np.zeros((7, kernel.lanes)), np.zeros((16, kernel.lanes))
    with pytest.raises(DtypeError, match="float32"):
        kernel(inputs.astype(np.float32), outputs)
    with pytest.raises(ShapeError, match="numbers"):
        kernel(inputs, outputs[:4])
    other = outputs.copy()
    kernel(inputs, outputs)
    kernel.interpret(inputs, other)
    np.testing.assert_allclose(outputs, other, atol=1e-15)
    with pytest.raises(InputError, match=r"expected a kernel made by lanes_kernel"):
        highest.specialized(W=8)(fk, np.zeros((1, 7, 8), np.float32), np.zeros((16, 8), np.float32))


# arguments ------------------------------------------------------------------------------------------------


def test_arguments_that_do_not_fit_are_refused() -> None:
    points, q = np.zeros((3, 2)), np.zeros(2)
    cases: list[tuple[type[Exception], str, tuple[Any, ...]]] = [
        (TypeError, r"nearest\(points, q\) takes 2 arguments; 1 were given", (points,)),
        (DtypeError, "`points` has dtype float32; expected float64", (points.astype(np.float32), q)),
        (ShapeError, r"`q` has shape \(1, 2\)", (points, q[None])),
        (InputError, "has gaps; expected a C-contiguous array", (points.T, q)),
        (InputError, "`q` is a list; expected a NumPy array, Array1", (points, [0.0, 0.0])),
        (InputError, "`q` is a MaskedArray", (points, np.ma.array(q))),
    ]
    for kind, text, args in cases:
        for call in (nearest, nearest.checked, nearest.interpret):
            with pytest.raises(kind, match=text):
                call(*args)
    with pytest.raises(InputError, match="`n` is a float; expected int"):
        storage(1.5)
    with pytest.raises(InputError, match="`n` is a bool; expected int"):
        storage(True)
    with pytest.raises(InputError, match="64 bits"):
        storage(2**63)


def test_read_only_arrays_are_refused_only_where_they_may_be_written_to() -> None:
    points, q = np.zeros((3, 2)), np.zeros(2)
    points.flags.writeable = q.flags.writeable = False
    assert nearest(points, q) == 0
    a = np.zeros((2, 2, 8))
    a.flags.writeable = False
    with pytest.raises(InputError, match="`a` is read-only, and the procedure may write to it"):
        every_access(0, a, np.array([3]))


def test_bound_arrays_are_read_anew_and_must_stay_as_they_are() -> None:
    points, q = np.zeros((3, 2)), np.zeros(2)
    bound = nearest.bind(points, q)
    points[:] = [[5, 5], [1, 1], [3, 3]]
    assert bound() == 1
    points.resize((1000, 2), refcheck=False)
    with pytest.raises(InputError, match="resized"):
        bound()


@procedure(contract=True)
def _fused(a, b, c):
    return a * b + c


@procedure
def _product_of_sums(a: float, b: float, c: float) -> float:
    return (a + c) * _fused(a, b, c)


def test_products_and_sums_are_fused_only_in_the_procedures_that_allow_it() -> None:
    definitions = _product_of_sums.ir().split("define ")
    fused, plain = (
        next(text for text in definitions if f"@{name}." in text.split("(")[0])
        for name in ("_fused", "_product_of_sums")
    )
    assert "fmul contract" in fused and "fadd contract" in fused
    assert "fmul" in plain and "contract" not in plain
    assert _product_of_sums(2.0, 3.0, 4.0) == _product_of_sums.interpret(2.0, 3.0, 4.0) == 60.0


@pytest.mark.parametrize("shape", [(3, 16), (5,), (2, 7, 3), (0, 4)])
def test_aligned_arrays_begin_at_a_line_of_the_cache(shape: tuple[int, ...]) -> None:
    for dtype in (np.float32, np.float64, np.int64):
        values = np.arange(np.prod(shape), dtype=dtype).reshape(shape)
        for given in (values, values.T):
            copies = [aligned(given) for _ in range(4)]
            for copy in copies:
                assert copy.size == 0 or copy.ctypes.data % 64 == 0
                assert copy.flags.c_contiguous and copy.flags.writeable
                assert copy.dtype == dtype
                np.testing.assert_array_equal(copy, given)


@procedure(constants={"W": 4})
def _filled(values: Array1[f64], W: int) -> int:
    for i in range(0, len(values), W):
        values[i : i + W] = lane_numbers(W, f64)
    return W


@procedure(constants={"W": 8})
def _filled_by_another(values: Array1[f64], W: int) -> int:
    return _filled(values, W)


def test_a_procedure_with_constants_takes_those_of_its_caller() -> None:
    values = np.zeros(16)
    for run in (_filled_by_another, _filled_by_another.checked, _filled_by_another.interpret):
        assert run(values) == 8
        np.testing.assert_array_equal(values, np.tile(np.arange(8.0), 2))
    assert _filled(values) == 4


def test_constants_must_be_parameters() -> None:
    with pytest.raises(InputError, match="`constants` names V; hits has the parameters"):
        hits.specialized(V=3)


def test_threads_run_procedures_side_by_side() -> None:
    spheres, points = scene()
    expected = hits(spheres, points, np.zeros(len(points), INT))
    results: list[int] = []

    def work() -> None:
        results.extend(hits(spheres, points, np.zeros(len(points), INT)) for _ in range(50))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 200


# what cannot be compiled ----------------------------------------------------------------------------------


def _f32_meets_f64(a: f32, b: f64):
    return a + b


def _unknown_name(a: int):
    return a + unknown_thing  # type: ignore[name-defined]  # noqa: F821


def _unassigned(a: int):
    if a > 0:
        b = 1
    return b


def _list(a: int):
    b = [a]
    return b


def _comprehension(a: Array1[f64]):
    return sum(x for x in a)


def _no_annotation(a):
    return a


def _other_annotation(a: list[int]):
    return a


def _recursive(a: int) -> int:
    return recursive(a - 1)


recursive = procedure(_recursive)


def _slice_of_unknown_width(a: Array1[f64], n: int):
    return sum_of(a[0:n])


def _odd_slice(a: Array1[f64]):
    return sum_of(a[0:3])


def _changes_type(a: int):
    b = a
    b = 1.5
    return b


def _not_every_path(a: int):
    if a:
        return 1


def _no_return(a: int):
    if a > 0:
        return 1


def _mask_as_condition(a: Array1[f64]):
    if a[0:4] > 0:
        return 1
    return 0


def _float_index(a: Array1[f64], x: f64):
    return a[x]  # type: ignore[index]


def _too_many_indices(a: Array1[f64]):
    return a[0, 1]


def _unknown_function(a: f64):
    return math.gamma(a)


def _large_storage(a: int):
    b = np.zeros((1000, 1000), f64)
    return b[0, a]


def _keyword_only(a: int):
    return nearest(a, wrong=1)  # type: ignore[call-arg]


def _power(a: f64):
    return a**3


def _with(a: int):
    with open("x"):
        return 1


def _assign_constant(W: int):
    W = 3
    return W


def _unknown_field(s: Spheres):
    return s.radius[0]  # type: ignore[attr-defined]


def _other_kind_of_return(n: int) -> int:
    if n > 0:
        return n
    return n * 0.5


def _different_returns(a: int):
    if a > 0:
        return 1
    return 1, 2


def _slice_before_an_index(a: Array2[f32]) -> float:
    return a[0:8, 0]


def _unassigned_in_a_tuple(n: int) -> int:
    if n > 0:
        a = 1
    a, b = 2, a
    return b


@procedure
def _pair() -> tuple[int, int]:
    return 1, 2


def _three_of_a_pair() -> int:
    a, b, c = _pair()
    return a + b + c


def _no_array_to_measure() -> int:
    return len()


def _too_much_to_measure(a: Array1[f32]) -> int:
    return len(a, 3)


def _broadcast_without_a_width(x: f32) -> f32:
    return broadcast(x)


NOTHING, LIST = None, [1]


def _none_outside(a: int) -> int:
    return a + NOTHING  # type: ignore[operator]


def _list_outside(a: int) -> int:
    return a + LIST  # type: ignore[operator]


def _passed_twice(a: Array2[f64], q: Array1[f64]) -> int:
    return nearest(a, q, points=a)  # type: ignore[call-arg]


def _keywords(a: int) -> int:
    return nearest(**LIST)  # type: ignore[arg-type]


def _variable_lanes(n: int) -> int:
    return sum_of(lane_numbers(n))


def _float_lanes(n: int) -> int:
    return sum_of(lane_numbers(4.0))  # type: ignore[arg-type]


def _three_lanes(n: int) -> int:
    return sum_of(lane_numbers(3))


REFUSED: dict[Callable[..., Any], str] = {
    _slice_before_an_index: "Slice expressions cannot be compiled",
    _unassigned_in_a_tuple: "`a` may have no value here",
    _three_of_a_pair: "_pair returns 2 values, not 3",
    _no_array_to_measure: r"len\(...\) takes 1 argument, not 0",
    _too_much_to_measure: r"len\(...\) takes 1 argument, not 2",
    _broadcast_without_a_width: r"broadcast\(...\) takes 2 arguments, not 1",
    _f32_meets_f64: "f32 and f64 meet. Convert one of them",
    _unknown_name: "`unknown_thing` is not defined, or is None",
    _none_outside: "`NOTHING` is not defined, or is None",
    _list_outside: "`LIST` is a list; a procedure can use only numbers, procedures and functions of the language from",
    _passed_twice: "`points` is passed twice to nearest",
    _keywords: r"\*\*arguments cannot be compiled",
    _variable_lanes: "a number of lanes must be an integer constant; this is a variable",
    _float_lanes: "a number of lanes must be an integer constant, not f64",
    _three_lanes: "a number of lanes must be a power of two from 1 to 64, not 3",
    _unassigned: "`b` may have no value here",
    _list: "List expressions cannot be compiled",
    _comprehension: "`sum` is not in the language",
    _no_annotation: "the parameter `a` has no type",
    _other_annotation: "the annotation of `a` names no type of the language",
    _recursive: "a procedure cannot call itself",
    _slice_of_unknown_width: "a slice has a constant power of two of lanes",
    _odd_slice: "not 3",
    _changes_type: "`b` holds int since its first assignment, not f64",
    _not_every_path: "a condition must be a bool, not int",
    _no_return: "not every path returns a value",
    _mask_as_condition: r"Reduce the mask: any_of",
    _float_index: "an index must be an integer, not f64",
    _too_many_indices: "takes 1 indices, not 2",
    _unknown_function: "`math.gamma` is not in the language",
    _large_storage: "8,000,000 bytes of the stack",
    _keyword_only: r"nearest has no parameter `wrong`\. It has points, q\.",
    _power: r"powers other than \*\* 2",
    _with: "`with` statements cannot be compiled",
    _unknown_field: "Spheres has no field `radius`; it has centres, radii",
    _different_returns: "2 values are returned here, 1 elsewhere",
    _other_kind_of_return: "f64 is returned here, int elsewhere. Convert it",
}


@pytest.mark.parametrize("function", REFUSED, ids=lambda f: f.__name__)
def test_what_cannot_be_compiled_is_refused_with_its_line(function: Callable[..., Any]) -> None:
    with pytest.raises(ProcedureError, match=REFUSED[function]) as caught:
        _ = procedure(function).instances
    first = function.__code__.co_firstlineno
    assert first <= caught.value.line <= first + 4
    assert f"test_procedures.py:{caught.value.line}, in " in str(caught.value)


def test_constants_cannot_be_assigned_to() -> None:
    with pytest.raises(ProcedureError, match="`W` is a constant here"):
        procedure(
            _assign_constant,
        ).specialized(W=4).instances


def test_a_function_without_source_is_refused() -> None:
    names: dict[str, Any] = {}
    exec("def f(a: int): return a", names)
    with pytest.raises(ProcedureError, match="its source cannot be read"):
        procedure(names["f"])(1)
    with pytest.raises(ProcedureError, match="made with `def`"):
        procedure(lambda a: a).instances


# random programs ------------------------------------------------------------------------------------------


def same(a: Any, b: Any) -> bool:
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype.kind != "f":
        return bool(np.array_equal(a, b))
    signs = np.signbit(np.nan_to_num(a, nan=0.0)) == np.signbit(np.nan_to_num(b, nan=0.0))
    return a.dtype == b.dtype and bool(np.array_equal(a, b, equal_nan=True) and signs.all())


def compare(seed: int) -> None:
    """Compares the three ways of running a random procedure, bit for bit."""
    p, text = random_procedure(seed)
    for k in range(3):
        results = []
        for call in (p, p.checked, p.interpret):
            args = arguments(100 * seed + k)
            results.append((*call(*args), *args[3:]))
        for a, b, c in zip(*results, strict=True):
            assert same(a, b) and same(a, c), text


@pytest.mark.parametrize("seed", range(4))
def test_random_procedures_equal_the_interpreter(seed: int) -> None:
    compare(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1000, 1060))
def test_many_random_procedures_equal_the_interpreter(seed: int) -> None:
    compare(seed)


def test_numbers_that_were_bound_can_be_set() -> None:
    @procedure
    def scaled(a: Array1[f64], factor: f64, count: int) -> float:
        total = 0.0
        for k in range(count):
            total += factor * a[k]
        return total

    bound = scaled.bind(np.arange(4.0), 2.0, 2, are_arrays_private=True)
    assert bound() == 2.0
    bound.set("count", 4)
    assert bound() == 12.0
    bound.set("factor", 0.5)
    assert bound() == 3.0
    bound.set("count", np.int64(3))
    assert bound() == 1.5
    with pytest.raises(InputError, match="expected a parameter that is a number: factor, count"):
        bound.set("a", 1.0)
    with pytest.raises(InputError, match="`count` is a float; expected int"):
        bound.set("count", 1.0)
    with pytest.raises(InputError, match="expected an integer of 64 bits"):
        bound.set("count", 2**70)


@procedure(constants={"W": 8})
def _scaled_sum(x: Array1[f64], out: Array1[f64], W: int) -> None:
    total = broadcast(1.0, W)
    for i in range(0, len(x), W):
        total = total + x[i : i + W] * (lane_numbers(W, f64) + 1.0)
    out[0:W] = total


@pytest.mark.parametrize("width", [1, 2, 8])
def test_one_source_serves_numbers_and_lanes(width: int) -> None:
    one = _scaled_sum.specialized(W=width)
    x = np.arange(16.0)
    expected = 1.0 + x.reshape(-1, width).sum(axis=0) * (np.arange(width) + 1.0)
    for run in (one, one.checked, one.interpret):
        out = np.zeros(width)
        run(x, out)
        assert np.array_equal(out, expected)


@procedure
def _named_like_the_code(start: int, fault: int, result: f64) -> Any:
    return start + fault, result * 2.0


def test_parameters_may_be_named_like_parts_of_the_code() -> None:
    assert _named_like_the_code(3, 4, 1.5) == (7, 3.0)
