"""Code for GPUs: the same text run on the CPU equals the kernels, ptxas accepts it, bad targets are refused."""

from __future__ import annotations

import re
import shutil
import subprocess
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.compiler import trace
from ulna.compiler.codegen.register_pressure import low_pressure_steps, register_pressure
from ulna.compiler.codegen.scheduling import parts
from ulna.compiler.runtime.cuda_kernel import cuda_core
from ulna.compiler.runtime.ptx import ptx, run_on_cpu
from ulna.errors import DeviceError, InputError, MissingExtra, UnknownName
from ulna.numeric import loop, where

ROBOT = ulna.load("panda", visuals="simple")
Q = ROBOT.random_configuration(9, seed=1)
V, A = np.random.default_rng(1).normal(size=(2, 9, 7))
QUANTITIES = [
    ("fk", 1),
    ("jacobian", 1),
    ("inverse_dynamics", 3),
    ("forward_dynamics", 3),
    ("mass_matrix", 1),
    ("inverse_dynamics_derivatives", 3),
]
TOLERANCE = {"float64": 1e-13, "float32": 1e-5}


def _close(found: Any, expected: Any, dtype: str) -> None:
    size = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(found / size, expected / size, rtol=0, atol=TOLERANCE[dtype])


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize(("name", "count"), QUANTITIES)
def test_the_code_of_the_threads_equals_the_kernel(name: str, count: int, dtype: str) -> None:
    arrays = (Q, V, A)[:count]
    expected = ROBOT.kernel(name)(*arrays)
    found = run_on_cpu(ROBOT.function(name), arrays, dtype)
    for a, b in zip(found, expected if isinstance(expected, tuple) else (expected,), strict=True):
        assert a.dtype == dtype
        _close(a, b, dtype)


def test_any_strides_and_repeated_inputs() -> None:
    f = ROBOT.function("inverse_dynamics")
    columns = np.asfortranarray(Q)
    (found,) = run_on_cpu(f, (columns, V[0], np.zeros(7)), "float64", rows=False)
    np.testing.assert_allclose(found, ROBOT.inverse_dynamics(Q, V[0], np.zeros(7)), atol=1e-13)
    (found,) = run_on_cpu(f, (Q[::3], V[::3], A[::3]), "float64")
    np.testing.assert_allclose(found, ROBOT.inverse_dynamics(Q[::3], V[::3], A[::3]), atol=1e-12)


def test_loops_branches_and_large_angles() -> None:
    def f(x: Any) -> Any:
        (y,) = loop(lambda y: abs(y) > 1.0, lambda y: (0.5 * y,), (x[0],), 60)
        return np.stack(
            [y, where(x[1] > 0.0, np.sin(x[1]), np.arctan2(x[0], x[1])), np.tan(x[1]), np.exp(y), 2.0]
        )

    traced = trace(f, x=(2,))
    x = np.array([[5.0, 1e15], [-700.0, -0.5], [0.25, 1e300], [3.0, np.nan]])
    (found,) = run_on_cpu(traced, (x,), "float64")
    np.testing.assert_allclose(found, ulna.compile(f, x=(2,))(x), rtol=1e-15)


def test_derivatives_of_loops() -> None:
    def f(x: Any) -> Any:
        return loop(lambda y, n: n < x[1], lambda y, n: (x[0] * np.sin(y) + n, n + 1.0), (x[0], 0.0), 30)[0]

    derived = trace(f, x=(2,)).hessian()
    x = np.stack([np.linspace(-1.0, 1.0, 9), np.arange(9.0)], axis=-1)
    (found,) = run_on_cpu(derived, (x,), "float64")
    np.testing.assert_allclose(found, derived(x), rtol=1e-10, atol=1e-12)


def test_a_search_in_one_thread_meets_its_goals() -> None:
    from ulna.exporting.selection import entries, records
    from ulna.ik.solve import search_settings

    ((), (search,)) = records(ROBOT.model, entries("ik"), {})
    f, settings = search.function(1), search_settings(1e-6, 1e-6, 400, True, 1)
    (found,) = run_on_cpu(f, (search.goals, search.start, search.shift, settings), "float64")
    assert (found[:, 7] == 1.0).all()
    np.testing.assert_allclose(ROBOT.fk(found[:, :7]), search.goals, atol=2e-6)


def test_the_kernel_of_a_search_is_for_one_goal_or_near_a_configuration() -> None:
    from ulna.ik.thread_search import thread_search

    T = ROBOT.fk(Q)
    q, is_met, steps, position, rotation = run_on_cpu(thread_search(ROBOT.model), (T,), "float64")
    assert (is_met == 1.0).all() and (steps >= 1.0).all() and position.max() < 1e-6 and rotation.max() < 1e-6
    np.testing.assert_allclose(ROBOT.fk(q), T, atol=2e-6)
    assert ROBOT.limits.contains(q).all()
    near = thread_search(
        ROBOT.model, near=True, frame=["panda_hand", "panda_link5"], mask=["pose", "position"]
    )
    goals = np.stack([ROBOT.fk(Q, "panda_hand"), ROBOT.fk(Q, "panda_link5")], axis=1)
    start = ROBOT.limits.clip(Q + 0.02)
    q, is_met, _, position, _ = run_on_cpu(near, (goals, start), "float64")
    assert (is_met == 1.0).all() and position.max() < 1e-6
    assert np.abs(q - start).max() < 0.2
    far = ROBOT.fk(Q[0])
    far[0, 3] += 3.0
    _, is_met, *_ = run_on_cpu(thread_search(ROBOT.model, attempts=3), (far,), "float64")
    assert is_met != 1.0
    kernel = ROBOT.kernel("ik", device="cuda")
    assert repr(kernel).startswith("<CUDA kernel ik(4,4)->(7),(),(),(),() float64")
    with pytest.raises(UnknownName, match="No option of kernel 'ik' named 'frme'. Did you mean 'frame'"):
        ROBOT.kernel("ik", device="cuda", frme="panda_hand")
    with pytest.raises(UnknownName, match="a method that searches"):
        ROBOT.kernel("ik")


def test_a_search_in_single_precision_meets_what_it_can() -> None:
    from ulna.ik.thread_search import thread_search

    T = ROBOT.fk(ROBOT.random_configuration(200, seed=3))
    f = thread_search(ROBOT.model, position_tolerance=1e-4, rotation_tolerance=1e-4)
    q, is_met, *_ = run_on_cpu(f, (T,), "float32")
    assert q.dtype == np.float32 and (is_met == 1.0).all()
    np.testing.assert_allclose(ROBOT.fk(q.astype(float))[:, :3], T[:, :3], atol=2e-4)
    kernel = ROBOT.kernel("ik", device="cuda", dtype="float32")
    assert repr(kernel).startswith("<CUDA kernel ik(4,4)->(7),(),(),(),() float32")
    with pytest.raises(
        InputError, match=r"`rotation_tolerance` is 1e-06; expected at least 1e-05 with dtype float32"
    ):
        ROBOT.kernel("ik", device="cuda", dtype="float32", rotation_tolerance=1e-6)
    with pytest.raises(InputError, match="position_tolerance"):
        ROBOT.kernel("ik", device="cuda", dtype="float32", position_tolerance="small")


def test_collisions_of_spheres() -> None:
    from ulna.collision import World, link_pairs, sphere_clearance
    from ulna.geometry import Sphere

    world = World().add("ball", Sphere(0.1), (0.5, 0.0, 0.4))
    pairs = link_pairs(ROBOT.model)[::8]  # all of them compile ten times as long, and show no more
    clearance = sphere_clearance(ROBOT.model, world, pairs=pairs)
    f = trace(clearance, q=(7,))
    (found,) = run_on_cpu(f, (Q,), "float64")
    np.testing.assert_allclose(found, ulna.compile(clearance, ROBOT)(Q), atol=1e-13)


def _assembler() -> str | None:
    """ptxas of a CUDA toolkit, or of the package nvidia-cuda-nvcc."""
    with suppress(PackageNotFoundError):
        for file in files("nvidia-cuda-nvcc") or ():
            if file.name in ("ptxas", "ptxas.exe"):
                return str(file.locate())
    return shutil.which("ptxas")


ASSEMBLER = _assembler()


def _assembled(text: str, folder: Path) -> str:
    """What ptxas says of PTX."""
    assert ASSEMBLER is not None
    source = folder / "code.ptx"
    source.write_text(text)
    command = [ASSEMBLER, "-v", "-arch=sm_90", str(source), "-o", str(folder / "code.cubin")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return done.stderr


@pytest.mark.skipif(ASSEMBLER is None, reason="ptxas is not installed")
@pytest.mark.parametrize(
    "name", ["fk", "jacobian", "inverse_dynamics", "forward_dynamics", "mass_matrix", "ik"]
)
def test_the_assembler_accepts_it_and_registers_suffice(name: str, tmp_path: Path) -> None:
    from ulna.ik.thread_search import thread_search

    function = thread_search(ROBOT.model) if name == "ik" else ROBOT.function(name)
    said = _assembled(ptx([("k", function)], "float32"), tmp_path)
    assert re.findall(r"(\d+) bytes spill", said)
    assert set(re.findall(r"(\d+) bytes spill", said)) == {"0"}


def _spheres(pairs: tuple[Any, ...] | None) -> Any:
    """How far the Panda's spheres are from a ball and a box, and from each other."""
    from ulna.collision import World, sphere_clearance
    from ulna.geometry import Box, Sphere

    world = (
        World().add("ball", Sphere(0.1), (0.5, 0.0, 0.3)).add("box", Box((0.2, 0.3, 0.4)), (0.0, 0.5, 0.3))
    )
    return trace(sphere_clearance(ROBOT.model, world, pairs=pairs), q=(7,))


@pytest.mark.slow
@pytest.mark.skipif(ASSEMBLER is None, reason="ptxas is not installed")
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_registers_suffice_for_collisions_of_spheres(dtype: str, tmp_path: Path) -> None:
    said = _assembled(ptx([("k", _spheres(()))], dtype), tmp_path)
    assert set(re.findall(r"(\d+) bytes spill", said)) == {"0"}


@pytest.mark.slow
def test_few_values_wait_at_once_though_all_spheres_are_checked() -> None:
    """A thread has 255 registers; the 101 spheres that move have 303 coordinates."""
    f = _spheres(None)
    assert register_pressure(f.graph, low_pressure_steps(f)) < 200
    assert register_pressure(f.graph, [step for part in parts(f, 1, 1) for step in part]) > 300


@pytest.mark.skipif(ASSEMBLER is None, reason="ptxas is not installed")
@pytest.mark.parametrize("name", ["fk", "forward_dynamics"])
def test_the_assembler_accepts_doubles(name: str, tmp_path: Path) -> None:
    assert "registers" in _assembled(ptx([("k", ROBOT.function(name))], "float64", "sm_90"), tmp_path)


def test_the_text_has_entry_points_and_calls_no_library() -> None:
    text = ptx([("first", ROBOT.function("fk")), ("second", ROBOT.function("jacobian"))], "float64")
    assert re.findall(r"\.entry (\w+)", text) == ["first", "second"]
    assert ".target sm_75" in text and ".extern" not in text
    assert "ld.global" in text and "st.global" in text and "fma.rn.f64" in text
    assert "//" not in text


def test_refusals_say_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UnknownName, match="No GPU architecture named 'sm_70'. Did you mean 'sm_"):
        ptx([("k", ROBOT.function("fk"))], "float64", "sm_70")
    with pytest.raises(UnknownName, match="No device named 'cudda'. Did you mean 'cuda'"):
        ROBOT.kernel("fk", device="cudda")
    with pytest.raises(UnknownName, match="No device named 'gpu'"):
        ulna.compile(lambda q: q, ROBOT, device="gpu")
    with pytest.raises(InputError, match="`checked` is True; expected False with device='cuda'"):
        ROBOT.kernel("fk", device="cuda", checked=True)
    kernel = ROBOT.kernel("fk", device="cuda")
    assert repr(kernel) == "<CUDA kernel fk(7)->(4,4) float64, 147 operations>"
    assert kernel is ROBOT.kernel("fk", device="cuda") and kernel is not ROBOT.kernel("fk")
    with pytest.raises(TypeError, match="takes 1 arguments; 2 were given"):
        kernel(Q, Q)


def test_without_the_package_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    import builtins

    original = builtins.__import__

    def absent(name: str, *rest: Any) -> Any:
        if name.partition(".")[0] == "cuda":
            raise ImportError(name)
        return original(name, *rest)

    cuda_core.cache_clear()
    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(MissingExtra, match="needs the package 'cuda-core'"):
        ROBOT.kernel("fk", device="cuda")(Q)


def test_without_a_gpu_it_says_so() -> None:
    core = pytest.importorskip("cuda.core")
    try:
        core.Device().set_current()
    except Exception:
        with pytest.raises(DeviceError, match=r"no usable NVIDIA GPU: .* leave out device=\"cuda\""):
            ROBOT.kernel("fk", device="cuda")(Q)
    else:
        pytest.skip("there is a GPU")
