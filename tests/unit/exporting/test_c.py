"""Exported C: clean for strict compilers, equal to the interpreter, safe under sanitizers, usable from C++ and CMake."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

import ulna
from support.c_library import STRICT, call, gcc, library, needs
from support.random_functions import functions, inputs
from ulna import numeric
from ulna.compiler import Function, trace
from ulna.exporting.c.support import half_pi_parts
from ulna.quantities import QUANTITIES

mpmath = pytest.importorskip("mpmath")


def test_its_own_test_passes_with_sanitizers(exported: Path, tmp_path: Path) -> None:
    checks = ["-O1", "-Wconversion", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    done = gcc(*STRICT, *checks, *exported.glob("*.c"), "-o", tmp_path / "test", "-lm")
    assert done.returncode == 0, done.stderr[:4000]
    ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert ran.stdout.count("largest difference") == 3 and "ik: 8 of 8 goals met, 8 again" in ran.stdout


def test_its_own_test_notices_a_wrong_number(exported: Path, tmp_path: Path) -> None:
    for file in exported.iterdir():
        text = file.read_text()
        if file.name == "panda_fk.c":
            assert "0.333" in text
            text = text.replace("0.333", "0.334")
        (tmp_path / file.name).write_text(text)
    assert gcc(*STRICT, *tmp_path.glob("*.c"), "-o", tmp_path / "test", "-lm").returncode == 0
    ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 1 and "fk: largest difference" in ran.stdout
    assert next(line for line in ran.stdout.splitlines() if "WRONG" in line).startswith("fk:")


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_its_own_test_compares_infinite_results(tmp_path: Path, dtype: str) -> None:
    function = trace(lambda x: np.stack([np.exp(800.0 + x), 0.5 * x, -np.exp(800.0 + x)]), x=())
    folder = ulna.export(None, {"f": function}, to="c", path=tmp_path / "x", name="i", dtype=dtype)
    for wrong in (False, True):
        if wrong:
            file = folder / "i_f.c"
            file.write_text(file.read_text().replace("0.5", "0.6"))
        assert gcc(*STRICT, *folder.glob("*.c"), "-o", tmp_path / "test", "-lm").returncode == 0
        ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
        assert (ran.returncode == 1) == ("WRONG" in ran.stdout) == wrong, ran.stdout


def test_there_is_no_state_and_nothing_is_allocated(exported: Path, tmp_path: Path) -> None:
    needs("nm")
    for file in exported.glob("panda_*.c"):
        assert gcc(*STRICT, "-O2", "-c", file, "-o", tmp_path / "x.o").returncode == 0
        symbols = subprocess.run(["nm", tmp_path / "x.o"], capture_output=True, text=True, check=True).stdout
        kinds = [line.split()[-2:] for line in symbols.splitlines()]
        assert not [name for kind, name in kinds if kind in "BbDdCcSsGg"]
        undefined = {name for kind, name in kinds if kind == "U"} - {"_GLOBAL_OFFSET_TABLE_"}
        assert undefined <= {f + s for f in ("sin", "cos", "atan2", "floor", "sqrt") for s in ("", "f")} | {
            "memset"
        }


@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_math_is_refused(exported: Path, tmp_path: Path, flag: str) -> None:
    done = gcc("-std=c99", flag, "-c", exported / "panda_fk.c", "-o", tmp_path / "x.o")
    assert done.returncode != 0 and "Compile without -ffast-math" in done.stderr


def test_results_are_those_of_the_interpreter(panda: ulna.Robot, exported: Path) -> None:
    lib = library(exported)
    dtype, tolerance = (np.float64, 1e-13) if exported.name == "float64" else (np.float32, 2e-5)
    rng = np.random.default_rng(5)
    for name in ("fk", "jacobian", "inverse_dynamics"):
        f = panda.function(name)
        arguments = [rng.uniform(-2.0, 2.0, p.shape).astype(dtype) for p in f.inputs]
        expected = f(*arguments)
        (out,) = call(getattr(lib, f"panda_{name}"), f, arguments, dtype)
        assert abs(out - expected).max() <= tolerance * max(1.0, abs(expected).max())


def test_outputs_may_be_inputs(panda: ulna.Robot, tmp_path: Path) -> None:
    lib = library(ulna.export(panda, "inverse_dynamics", to="c", path=tmp_path / "x"))
    q, v, a = np.random.default_rng(6).uniform(-1.0, 1.0, (3, 7))
    expected = panda.function("inverse_dynamics")(q, v, a)
    lib.panda_inverse_dynamics(*(ctypes.c_void_p(x.ctypes.data) for x in (q, v, a, q)))
    assert abs(q - expected).max() < 1e-13 * abs(expected).max()


def test_arguments_may_be_named_as_the_functions_that_are_called(tmp_path: Path) -> None:
    f = trace(
        lambda exp, erf, sqrtf: np.exp(exp) + numeric.erf(erf) + np.sqrt(sqrtf),
        name="f", exp=(), erf=(), sqrtf=(),
    )  # fmt: skip
    for dtype, tolerance in ((np.float64, 1e-15), (np.float32, 1e-6)):
        lib = library(ulna.export(None, f, to="c", path=tmp_path / dtype.__name__, name="x", dtype=dtype))
        (out,) = call(lib.x_f, f, [np.array(v, dtype) for v in (0.5, -0.25, 2.0)], dtype)
        assert out == pytest.approx(f(0.5, -0.25, 2.0), rel=tolerance)


def test_sines_are_precise_everywhere(tmp_path: Path) -> None:
    f = trace(lambda x: (np.sin(x), np.cos(x)), name="waves", x=(8,))
    rng = np.random.default_rng(1)
    x = np.concatenate(
        [
            rng.uniform(-10, 10, 800),
            rng.uniform(-9e3, 9e3, 800),
            rng.uniform(-1e6, 1e6, 800),
            rng.uniform(-1e15, 1e15, 80),
        ]
    )
    x = np.concatenate(
        [x, np.arange(-400, 400) * np.pi / 2, nearest_to_quarter_turns(), 10.0 ** rng.uniform(-300, 0, 80)]
    ).reshape(-1, 8)
    for dtype, bits, place in ((np.float64, 53, "d"), (np.float32, 24, "s")):
        lib = library(ulna.export(None, f, to="c", path=tmp_path / place, name="w", dtype=dtype), ["-O2"])
        worst = 0.0
        for row in x.astype(dtype):
            results = call(lib.w_waves, f, [row], dtype)
            for out, exact in zip(results, (mpmath.sin, mpmath.cos), strict=True):
                for value, angle in zip(out, row, strict=True):
                    with mpmath.workprec(200):
                        y = exact(mpmath.mpf(float(angle)))
                        ulp = mpmath.mpf(2) ** (mpmath.floor(mpmath.log(abs(y), 2)) - bits + 1) if y else 1
                        worst = max(worst, float(abs(mpmath.mpf(float(value)) - y) / ulp))
        assert worst < 1.0
    special = np.array([np.inf, -np.inf, np.nan, 0.0, -0.0, 1.0, 1e300, 5e-324])
    lib = library(tmp_path / "d")
    sines, cosines = call(lib.w_waves, f, [special])
    assert np.isnan(sines[:3]).all() and np.isnan(cosines[:3]).all()
    assert sines[7] == 5e-324 and (cosines[3:5] == 1.0).all() and abs(sines[6] - np.sin(1e300)) < 1e-15


def nearest_to_quarter_turns() -> np.ndarray:
    """The floats, and every fifth double, that are nearest to multiples of pi/2 within the bounds of the loop."""
    with mpmath.workprec(300):
        singles = [float(np.float32(float(k * mpmath.pi / 2))) for k in range(1, 82)]
        doubles = [float(k * mpmath.pi / 2) for k in range(1, 5216, 5)]
    return np.array([*singles, *doubles, 1.0, 1.0])[: (len(singles) + len(doubles)) // 8 * 8]


def test_the_parts_of_half_pi_add_up() -> None:
    with mpmath.workprec(300):
        for real, bits in (("double", 130), ("float", 50)):
            rest = mpmath.pi / 2 - sum(mpmath.mpf(part) for part in half_pi_parts(real))  # type: ignore[arg-type]
            assert abs(rest) < mpmath.mpf(2) ** -bits


@seed(20261123)
@settings(max_examples=1, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(st.lists(functions(exact=True), min_size=60, max_size=60))
def test_random_functions_are_those_of_the_interpreter_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, made: list[Function]
) -> None:
    check_random(tmp_path_factory.mktemp("c"), made, exact=True)


@seed(20261124)
@settings(max_examples=1, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(st.lists(functions(), min_size=60, max_size=60))
def test_random_functions_with_elementary_ones_agree(
    tmp_path_factory: pytest.TempPathFactory, made: list[Function]
) -> None:
    check_random(tmp_path_factory.mktemp("c"), made, exact=False)


def check_random(folder: Path, made: list[Function], exact: bool) -> None:
    named = {f"f{k}": f for k, f in enumerate(made)}
    lib = library(ulna.export(None, named, to="c", path=folder / "x", name="r"), ["-O1"], sources="r_*.c")
    for name, f in named.items():
        columns = inputs(f, 6, special=exact)
        for k in range(6):
            arguments = [np.asarray(c)[k] for c in columns]
            for out, expected in zip(
                call(getattr(lib, f"r_{name}"), f, arguments), f(*arguments), strict=True
            ):
                if exact:
                    np.testing.assert_array_equal(out, expected)
                else:
                    np.testing.assert_allclose(out, expected, rtol=1e-9, atol=1e-9)


def test_loops_and_branches(tmp_path: Path) -> None:
    def swaps(x: Any) -> Any:
        a, b, n = numeric.loop(
            lambda a, b, n: n < x[2], lambda a, b, n: (b, a, n + 1.0), (x[0], x[1], 0.0), 100
        )
        return numeric.vector(
            a, b, n, numeric.where(a < b, numeric.minimum(a, 0.0), numeric.maximum(b, x[0]))
        )

    f = trace(swaps, x=(3,))
    lib = library(ulna.export(None, {"swaps": f}, to="c", path=tmp_path / "x", name="t"))
    for x in ([1.0, 2.0, 3.0], [2.0, 1.0, 4.0], [5.0, -1.0, 0.0], [1.0, 2.0, 1e9], [np.nan, 1.0, 2.0]):
        np.testing.assert_array_equal(call(lib.t_swaps, f, [x])[0], f(x))


def test_derivatives_of_loops(tmp_path: Path) -> None:
    def f(x: Any) -> Any:
        y, _ = numeric.loop(
            lambda y, n: n < x[1], lambda y, n: (x[0] * np.sin(y) + n, n + 1.0), (x[0], 0.0), 30
        )
        (y,) = numeric.loop(lambda y: y < 9.0, lambda y: (2.0 * y + 1.0,), (y * y,), 30)
        return y  # of the loop before, whose slopes are constants, nothing is read again

    traced = trace(f, x=(2,))
    functions = {"gradient": traced.value_and_gradient(), "hessian": traced.hessian()}
    lib = library(ulna.export(None, functions, to="c", path=tmp_path / "x", name="d"))
    for name, derived in functions.items():
        for x in ([0.3, 4.0], [1.2, 0.0], [-0.7, 20.0]):
            found, expected = call(getattr(lib, f"d_{name}"), derived, [x]), derived(x)
            for out, e in zip(found, expected if name == "gradient" else (expected,), strict=True):
                np.testing.assert_allclose(out, e, rtol=1e-10, atol=1e-12)


def test_names_of_arguments_that_mean_something_in_c(tmp_path: Path) -> None:
    text = "def f(double, v1, out, w, NULL):\n return double * v1 + out - w * NULL"
    names: dict[str, Any] = {}
    exec(text, names)
    f = trace(names["f"], double=(2,), v1=(2,), out=(2,), w=(2,), NULL=())
    lib = library(ulna.export(None, f, to="c", path=tmp_path / "x", name="n"))
    arguments = [*np.arange(8.0).reshape(4, 2), np.array(3.0)]
    np.testing.assert_array_equal(call(lib.n_f, f, arguments)[0], f(*arguments))


def test_comments_cannot_be_ended_by_documentation(tmp_path: Path) -> None:
    def f(x: Any) -> Any:
        """Ends */ #error and begins /* again; an é."""
        return x + 1.0

    library(ulna.export(None, trace(f, x=()), to="c", path=tmp_path / "x"))


def test_large_functions_are_split_and_zeros_written_by_a_loop(tmp_path: Path) -> None:
    g1 = ulna.load("g1")
    place = ulna.export(g1, "mass_matrix", to="c", path=tmp_path / "x", name="g", test=False)
    text = (place / "g_mass_matrix.c").read_text()
    assert text.count("_PART void") >= 4 and "M[i] = 0;" in text and not list(place.glob("test_*"))
    lib, f = library(place), g1.function("mass_matrix")
    q = np.random.default_rng(2).uniform(-1, 1, g1.nq)
    (out,) = call(lib.g_mass_matrix, f, [q])
    assert abs(out - f(q)).max() < 1e-13 * abs(out).max()


def names_of(robot: ulna.Robot) -> list[str]:
    """The quantities of a robot without constraints."""
    return [n for n, quantity in QUANTITIES.items() if "constraints" not in quantity.options]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(6))
@pytest.mark.parametrize("name", ["panda", "g1"])
def test_every_kernel_is_that_of_the_interpreter(name: str, part: int, tmp_path: Path) -> None:
    robot = ulna.load(name)
    names = names_of(robot)[part::6]
    lib = library(ulna.export(robot, names, to="c", path=tmp_path / "x", name="r", test=False), ["-O0"])
    rng = np.random.default_rng(4)
    for kernel in names:
        f = robot.function(kernel)
        arguments = [rng.uniform(-1.0, 1.0, p.shape) for p in f.inputs]
        expected, *moved = (results(f, x) for x in (arguments, *neighbours(arguments, rng)))
        for k, out in enumerate(call(getattr(lib, f"r_{kernel}"), f, arguments)):
            right = np.asarray(expected[k])
            finite = np.isfinite(right)  # a payload that does not load a joint has the multiple inf
            np.testing.assert_array_equal(out[~finite], right[~finite], kernel)
            size = np.max(abs(right[finite]), initial=1.0)
            sensitivity = max(
                np.max(abs(np.asarray(m[k])[finite] - right[finite]), initial=0.0) for m in moved
            )
            tolerance = 1e-13 * size + 10.0 * sensitivity
            assert np.max(abs(out[finite] - right[finite]), initial=0.0) <= tolerance, kernel


def results(f: Function, arguments: list[Any]) -> tuple[Any, ...]:
    """What the interpreter computes, always as a tuple."""
    out = f(*arguments)
    return (out,) if f.single else out


def neighbours(arguments: list[Any], rng: np.random.Generator) -> list[list[Any]]:
    """The arguments with every number moved to a neighbour: how well a kernel is conditioned."""
    return [[np.nextafter(a, rng.choice([-9.0, 9.0], a.shape)) for a in arguments] for _ in range(4)]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_conditions_pass_from_part_to_part_without_warnings(tmp_path: Path, dtype: str) -> None:
    def late(x: Any) -> Any:
        is_larger, y = x[0] > x[1], x[0]
        for k in range(1000):
            y = 0.5 * y + x[k % 2]
        return numeric.where(is_larger, y, x[1])

    folder = ulna.export(
        None, {"late": trace(late, x=(2,))}, to="c", path=tmp_path / "x", name="f", dtype=dtype
    )
    assert "(" + {"float64": "double", "float32": "float"}[dtype] + ")c" in (folder / "f_late.c").read_text()
    done = gcc(*STRICT, "-Wconversion", *folder.glob("*.c"), "-o", tmp_path / "test", "-lm")
    assert done.returncode == 0, done.stderr[:2000]
    ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stdout
