"""The target "wasm", in node: results of the interpreter and of native searches, and what is refused."""

from __future__ import annotations

import gzip
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import numeric
from ulna.compiler import compile
from ulna.compiler.codegen.module import emit_library
from ulna.compiler.runtime.cross_compile import cross_compile
from ulna.errors import CompileError, InputError, TooLargeError
from ulna.exporting import TARGETS
from ulna.exporting.wasm.code import LANES, TARGET
from ulna.exporting.wasm.linking import linked
from ulna.ik import search
from ulna.ik.arguments import problem_of, shift_of
from ulna.ik.solve import search_settings
from ulna.quantities import QUANTITIES

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
KERNELS = ["fk", "jacobian", "inverse_dynamics", "mass_matrix", "ik"]


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


@pytest.fixture(scope="module")
def folder(panda: ulna.Robot, tmp_path_factory: Any) -> Path:
    return ulna.export(panda, KERNELS, to="wasm", path=tmp_path_factory.mktemp("wasm") / "panda")


def node(folder: Path, script: str, *arguments: Any) -> Any:
    """What a script prints as JSON; `robot` are the loaded functions, `given` the arguments."""
    assert NODE is not None
    begin = (
        f"import {{ load, loadSync, description }} from {json.dumps(folder.as_uri() + '/panda.js')};"
        "import { readFileSync } from 'node:fs';"
        "const given = JSON.parse(readFileSync(0, 'utf-8')); const robot = await load();"
        "const show = (x) => console.log(JSON.stringify(x, (k, v) => ArrayBuffer.isView(v) ? Array.from(v) : v));"
    )
    done = subprocess.run(
        [NODE, "--input-type=module", "-e", begin + script],
        input=json.dumps(arguments), capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@needs_node
@pytest.mark.parametrize("name", KERNELS[:-1])
def test_functions_equal_the_interpreter(panda: ulna.Robot, folder: Path, name: str) -> None:
    function = panda.kernel(name).function
    rng = np.random.default_rng(3)
    samples = [[rng.uniform(-2.5, 2.5, p.shape) for p in function.inputs] for _ in range(20)]
    samples.append([np.full(p.shape, 1e9) for p in function.inputs])  # beyond the branch-free reduction
    given = [[x.tolist() for x in sample] for sample in samples]
    got = node(folder, f"show(given[0].map((values) => robot.{name}(...values)))", given)
    for sample, values in zip(samples, got, strict=True):
        expected = function(*sample)
        tolerance = 1e-14 * max(1.0, float(np.abs(expected).max()))
        np.testing.assert_allclose(np.reshape(values, expected.shape), expected, rtol=1e-14, atol=tolerance)


@needs_node
@pytest.mark.parametrize("is_near", [False, True])
def test_searches_equal_the_native_kernel_with_the_same_lanes(
    panda: ulna.Robot, folder: Path, is_near: bool
) -> None:
    problem = problem_of(panda.model, [panda.tool], None, None)
    kernel = compile(search.multi_start(problem, LANES))
    settings = search_settings(1e-6, 1e-6, 400, not is_near, LANES)
    goals = panda.fk(panda.random_configuration(40, seed=2))
    starts = panda.random_configuration(40, seed=3)
    call = "robot.ik(T, given[1][k])" if is_near else "robot.ik(T)"
    got = node(folder, f"show(given[0].map((T, k) => {call}))", goals.tolist(), starts.tolist())
    start = description(folder)["searches"]["ik"]["start"]
    for k, solution in enumerate(got):
        q0 = starts[k] if is_near else np.array(start)
        raw = kernel(goals[k], q0, shift_of(0, problem), settings)
        assert solution["success"] and raw[panda.nq] == 1.0
        assert solution["iterations"] == raw[panda.nq + 1]
        np.testing.assert_allclose(solution["q"], raw[: panda.nq], atol=1e-9)
        np.testing.assert_allclose(panda.fk(np.array(solution["q"])), goals[k], atol=3e-6)


def description(folder: Path) -> Any:
    text = (folder / "panda.js").read_text()
    return json.loads(text[text.index("{", text.index("description =")) :].split(";\n", 1)[0])


@needs_node
def test_a_goal_out_of_reach_yields_the_nearest_configuration(panda: ulna.Robot, folder: Path) -> None:
    T = np.eye(4)
    T[:3, 3] = 3.0, 0.0, 0.3
    solution = node(folder, "show(robot.ik(given[0]))", T.tolist())
    native = panda.ik(T)
    assert not solution["success"] and not native.success
    q = np.array(solution["q"])
    assert (panda.model.lower_position <= q).all() and (q <= panda.model.upper_position).all()
    np.testing.assert_allclose(
        solution["positionError"], np.linalg.norm(panda.fk(q)[:3, 3] - T[:3, 3]), rtol=1e-9
    )
    assert solution["positionError"] == pytest.approx(float(native.position_error), rel=0.2)


@needs_node
@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        ("robot.fk([1, 2])", "TypeError", "fk: `q` is an array of 2; expected 7 numbers [rad or m]."),
        ("robot.fk()", "TypeError", "fk(q) takes 1 argument"),
        ("robot.fk(null)", "TypeError", "`q` is null; expected 7 numbers"),
        ("robot.fk('abcdefg')", "TypeError", "`q` is a string; expected 7 numbers"),
        ("robot.fk([0, 0, 0, NaN, 0, 0, 0])", "RangeError", "`q`[3] is NaN; expected a finite number."),
        ("robot.fk([0, 0, 0, '1', 0, 0, 0])", "RangeError", "`q`[3] is a string; expected a finite number."),
        ("robot.fk(given[0], [])", "TypeError", "`out` is an array of 0; expected a Float64Array of 16."),
        (
            "robot.fk(given[0], new Float32Array(16))",
            "TypeError",
            "`out` is a Float32Array of 16; expected a Float64Array of 16.",
        ),
        ("robot.ik(given[1].map((x) => 2 * x))", "RangeError", "ik: `T` is no pose; expected a rotation"),
        ("robot.ik([1])", "TypeError", "expected 16 numbers (4 x 4, row after row) or rows of them"),
        ("robot.ik(given[1], given[0], { tolerance: 1 })", "TypeError", 'ik has no option "tolerance"; its options'),
        ("robot.ik(given[1], null, { attempts: -1 })", "RangeError", "`attempts` is the number -1; expected"),
        ("robot.ik(given[1], null, { attempts: 1.5 })", "RangeError", "expected a whole number above 0"),
        ("loadSync(new Uint8Array(8))", "CompileError", "WebAssembly.Module()"),
    ],
)  # fmt: skip
def test_what_is_refused(folder: Path, call: str, error: str, message: str) -> None:
    script = f"try {{ {call}; show('accepted') }} catch (e) {{ show([e.name, e.message]) }}"
    name, text = node(folder, script, [0.0] * 7, np.eye(4).ravel().tolist())
    assert name == error
    assert message in text


@needs_node
def test_the_test_script_passes_and_sees_errors(folder: Path, tmp_path: Path) -> None:
    command = [NODE, "test_panda.mjs"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (
        "ik: 8 of 8 goals met, 8 again from their solutions" in done.stdout and "mass_matrix" in done.stdout
    )
    shutil.copytree(folder, tmp_path / "copy")
    script = tmp_path / "copy" / "test_panda.mjs"
    script.write_text(script.read_text().replace('"outputs":[[', '"outputs":[[9', 1))
    done = subprocess.run(
        command, cwd=script.parent, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 1 and "which is too much" in done.stdout


@needs_node
def test_results_go_into_arrays_that_are_given(folder: Path) -> None:
    script = "const T = new Float64Array(16); show(robot.fk(given[0], T) === T && T[15] === 1)"
    assert node(folder, script, [0.0] * 7) is True


@needs_node
def test_the_module_has_no_imports_and_loads_from_bytes(folder: Path) -> None:
    script = (
        "const bytes = readFileSync(given[0]); const module = new WebAssembly.Module(bytes);"
        "const again = [loadSync(bytes), await load(bytes), await load(module), await load(new Response(bytes))];"
        "show([WebAssembly.Module.imports(module), again.map((r) => r.fk(given[1])[15])])"
    )
    assert node(folder, script, str(folder / "panda.wasm"), [0.0] * 7) == [[], [1, 1, 1, 1]]


def test_forward_and_inverse_kinematics_of_the_panda_are_small(panda: ulna.Robot, tmp_path: Path) -> None:
    place = ulna.export(panda, ["fk", "ik"], to="wasm", path=tmp_path / "x")
    sizes = [len(gzip.compress((place / f"panda.{end}").read_bytes(), 9, mtime=0)) for end in ("wasm", "js")]
    assert sum(sizes) <= 15_000


def test_the_types_name_functions_units_and_frames(folder: Path) -> None:
    text = (folder / "panda.d.ts").read_text()
    assert "fk(q: Numeric, out?: Float64Array): Float64Array;" in text
    assert "ik(T: Numeric, q0?: Numeric | null, options?: SearchOptions): Solution;" in text
    assert "[rad or m]" in text and "panda_hand_tcp" in text


@needs_node
def test_rows_of_equal_numbers_need_no_library(tmp_path: Path) -> None:
    def moved(x: Any) -> Any:
        rows = np.zeros((40, 64), dtype=object)
        rows[5], rows[6], rows[7, 3] = x, x, x[0] * 2.0
        return rows

    def halve(x: Any) -> Any:  # with loops, all of level 1 is used
        return numeric.loop(lambda v: v > 1.0, lambda v: (0.5 * v,), (x,), 40)[0]

    kernels = {"moved": ulna.compile(moved, x=(64,)), "halve": ulna.compile(halve, x=())}
    place = ulna.export(None, kernels, to="wasm", path=tmp_path, name="panda")
    assert node(place, "show(robot.halve(5))") == 0.625
    x = np.arange(64.0)
    np.testing.assert_array_equal(node(place, "show(robot.moved(given[0]))", x.tolist()), moved(x).ravel())


@needs_node
def test_derivatives_of_loops_keep_their_records_on_the_stack(tmp_path: Path) -> None:
    def f(x: Any) -> Any:
        return numeric.loop(
            lambda y, n: n < x[1], lambda y, n: (x[0] * np.sin(y) + n, n + 1.0), (x[0], 0.0), 1000
        )[0]

    kernel = ulna.compile(f, x=(2,)).hessian()
    place = ulna.export(None, {"hessian": kernel}, to="wasm", path=tmp_path, name="panda")
    assert kernel.function.tape_size == 6000  # three tapes
    for n in (4.0, 900.0):
        got = node(place, "show(robot.hessian(given[0]))", [0.3, n])
        np.testing.assert_allclose(got, kernel([0.3, n]).ravel(), rtol=1e-9, atol=1e-12)


@needs_node
def test_own_functions_numbers_and_float32(tmp_path: Path) -> None:
    both = ulna.compile(lambda x, y: (np.sin(x) * y, x[0] + y), x=(3,), y=(), dtype=np.float32)
    place = ulna.export(None, {"both": both}, to="wasm", path=tmp_path / "x", name="panda")
    array, number = node(place, "show(robot.both([1, 2, 1e9], 0.5))")
    np.testing.assert_allclose(array, both([1, 2, 1e9], 0.5)[0], rtol=2e-7)
    assert number == 1.5
    assert (
        "both(x: Numeric, y: number, out0?: Float32Array, out1?: Float32Array): [Float32Array, number];"
        in (place / "panda.d.ts").read_text()
    )


def test_arguments_with_names_that_javascript_reserves(tmp_path: Path) -> None:
    kernel = ulna.compile(lambda new, function: new + function, new=(2,), function=())
    place = ulna.export(None, {"sum": kernel}, to="wasm", path=tmp_path / "x", name="panda", test=False)
    text = (place / "panda.d.ts").read_text()
    assert "sum(new_: Numeric, function_: number, out?: Float64Array): Float64Array;" in text
    assert not (place / "test_panda.mjs").exists()


def test_code_that_calls_others_and_code_that_is_too_large() -> None:
    outside = "declare void @elsewhere()\ndefine void @f() {\n call void @elsewhere()\n ret void\n}\n"
    with pytest.raises(CompileError, match="calls elsewhere"):
        linked(cross_compile(outside, TARGET, False, position_independent=False), {"f": "f"}, 1024, 1024)
    function = ulna.compile(lambda x: np.cumsum(np.sin(x)), x=(40,)).function
    content = cross_compile(
        emit_library([("f", function)], TARGET), TARGET, False, position_independent=False
    )
    assert linked(content, {"f": "f"}, 1024, 1024).pages == 1
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ulna.exporting.wasm.linking._MOST_LOCALS", 10)
        with pytest.raises(TooLargeError, match=r"variables and .* bytes; browsers accept 10 and"):
            linked(content, {"f": "f"}, 1024, 1024)


@needs_node
def test_quaternions_of_a_floating_base_are_checked(tmp_path: Path) -> None:
    robot = ulna.load("panda", root="free_flyer")
    place = ulna.export(robot, "fk", to="wasm", path=tmp_path / "x", name="panda")
    q = robot.random_configuration(seed=1)
    np.testing.assert_allclose(
        node(place, "show(robot.fk(given[0]))", q.tolist()), robot.fk(q).ravel(), atol=1e-14
    )
    q[3:7] *= 1.1
    script = "try { robot.fk(given[0]) } catch (e) { show(e.message) }"
    assert "`q`[3] to [6] is no unit quaternion x, y, z, w: its length is 1.1" in node(
        place, script, q.tolist()
    )


@needs_node
def test_names_in_a_model_cannot_end_the_script(tmp_path: Path) -> None:
    def f(x: Any) -> Any:
        """Ends </script> and has __NAME__ in it."""
        return 2.0 * x

    place = ulna.export(None, {"f": ulna.compile(f, x=(2,))}, to="wasm", path=tmp_path / "x", name="panda")
    assert "</script>" not in (place / "panda.js").read_text()
    summary = node(place, "show(description.functions.f.summary)")
    assert summary == "Ends </script> and has __NAME__ in it."


def test_exports_that_are_refused(panda: ulna.Robot, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'ik' is a search, which needs float64"):
        ulna.export(panda, "ik", to="wasm", path=tmp_path / "x", dtype="float32")
    with pytest.raises(InputError, match="'memory', which the JavaScript module uses itself"):
        ulna.export(panda, {"memory": "fk"}, to="wasm", path=tmp_path / "x")
    assert list(tmp_path.iterdir()) == []
    assert "wasm" in TARGETS


@needs_node
@pytest.mark.slow
def test_every_quantity_of_the_panda(panda: ulna.Robot, tmp_path: Path) -> None:
    names = [name for name, quantity in QUANTITIES.items() if "constraints" not in quantity.options]
    place = ulna.export(panda, names, to="wasm", path=tmp_path / "x")
    done = subprocess.run(
        [str(NODE), "test_panda.mjs"], cwd=place, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("largest difference") == len(names) > 40
