"""Other widths of registers, run here; other processors, up to their assembly."""

from __future__ import annotations

import re
from dataclasses import replace
from importlib import import_module

import llvmlite.binding as llvm
import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.codegen.elementary import OPERATIONS
from ulna.compiler.codegen.module import emit_batch
from ulna.compiler.codegen.target import Target, arithmetic_of, wide_from
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.entry_point import entry_ir


def _everything(q, x):
    """Every kind of code: functions, choices, a loop, wide and narrow ports."""
    y = np.sin(q) * np.exp(-q[0]) + np.arctan2(q[1], x) * np.tan(0.1 * q) + np.log(1.0 + q * q)
    root = nm.loop(lambda v: abs(v * v - 3.0) > 1e-5, lambda v: (0.5 * (v + 3.0 / v),), (1.0 + x * x,), 40)[0]
    return nm.where(q[0] < x, y, np.arcsin(np.sin(q)) * root), np.floor(root * 7.0) + np.arccos(
        0.5 * np.cos(x)
    )


FUNCTION = trace(_everything, q=(7,), x=())


@pytest.mark.parametrize("lanes", [2, 4, 8, 16, 32])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_every_number_of_lanes_computes_the_same(monkeypatch, lanes, dtype):
    target = replace(jit.target(), register_bytes=lanes * np.dtype(dtype).itemsize)
    monkeypatch.setattr(jit, "target", lambda: target)
    kernel = compile(FUNCTION, dtype)
    rng = np.random.default_rng(lanes)
    assert f"<{lanes} x " in kernel.ir(batch=True)
    for rows in (1, lanes - 1, lanes, lanes + 1, 2 * lanes + 3):
        q, x = rng.uniform(-1, 1, (rows, 7)), rng.uniform(-1, 1, rows)
        for given in (q, np.asfortranarray(q), q[::-1, ::-1]):
            for got, expected in zip(
                kernel(given.astype(dtype), x.astype(dtype)), FUNCTION(given, x), strict=True
            ):
                tolerance = 1e-13 if dtype is np.float64 else 2e-5
                np.testing.assert_allclose(got, expected, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize(
    ("triple", "lanes"),
    [("aarch64-unknown-linux-gnu", 2), ("x86_64-unknown-linux-gnu", 4), ("wasm32-unknown-unknown", 2)],
)
@pytest.mark.parametrize("element", ["double", "float"])
def test_other_processors_accept_the_code(triple, lanes, element):
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    try:
        machine = llvm.Target.from_triple(triple).create_target_machine()
    except RuntimeError:
        pytest.skip(f"this LLVM does not know {triple}")
    target = Target(triple, "generic", "", "", register_bytes=8 * lanes)
    for text in (entry_ir(FUNCTION, target, element), emit_batch(FUNCTION, target, element)):
        module = llvm.parse_assembly(text)
        module.triple = triple
        module.data_layout = str(machine.target_data)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=1)
        llvm.create_pass_builder(machine, options).getModulePassManager().run(
            module, llvm.create_pass_builder(machine, options)
        )
        assembly = machine.emit_assembly(module)
        called = {name.strip("_") for name in re.findall(r"\b(?:call\w*|bl?|jmp)\s+(\w+)", assembly)}
        assert called & {"ulna", "block", "feclearexcept", "one"} or len(assembly) > 5000
        library = {"sin", "cos", *OPERATIONS}
        assert not called & (library | {f"{name}f" for name in library})


@pytest.mark.parametrize(
    ("triple", "features", "fused"),
    [
        ("x86_64-unknown-linux-gnu", "+avx2,+fma,+sse4.2", True),
        ("x86_64-unknown-linux-gnu", "+avx,-fma,+sse4.2", False),
        ("aarch64-unknown-linux-gnu", "+neon", True),
    ],
)
def test_what_this_processor_computes_in_one_instruction(triple, features, fused):
    assert arithmetic_of(triple, features).fused_multiply_add is fused


@pytest.mark.parametrize(
    ("cpu", "features", "is_held_back"),
    [
        ("sapphirerapids", "+avx2,+avx512f", True),
        ("rocketlake", "+avx2,+avx512f", True),
        ("znver4", "+avx2,+avx512f", False),
        ("skylake", "+avx2,-avx512f", False),
    ],
)
def test_short_code_leaves_out_registers_that_hold_back_single_numbers(cpu, features, is_held_back):
    target = replace(jit.target(), wide_from=wide_from(cpu, features))
    assert target.sines_at_once(100, "double") == (4 if is_held_back else target.packed_sines)
    assert (
        target.sines_at_once(100, "float") == target.sines_at_once(100_000, "double") == target.packed_sines
    )


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_sines_in_narrower_registers_are_the_same(monkeypatch, dtype):
    """Of 11 angles, one of them huge; results are equal bit for bit."""
    f = trace(lambda q: np.stack([np.sin(q), np.cos(q), np.sin(q) * 2.0]), q=(11,))
    q = np.random.default_rng(4).uniform(-9.0, 9.0, (50, 11)).astype(dtype)
    q[::7, 3] = 1e18
    made = []
    for least in (0, 10_000):
        target = replace(jit.target(), wide_from=least)
        monkeypatch.setattr(jit, "target", lambda target=target: target)
        kernel = compile(f, dtype)
        assert ("<8 x double>" in kernel.ir()) == (least == 0 and dtype is np.float64)
        made.append(np.stack([kernel(x) for x in q]))
    np.testing.assert_array_equal(*made)
    np.testing.assert_allclose(made[0][1:7, 0], np.sin(q[1:7]), rtol=1e-12 if dtype is np.float64 else 1e-5)


def test_a_processor_without_fused_products_computes_the_same(monkeypatch):
    target = replace(jit.target(), arithmetic=arithmetic_of("x86_64-pc-windows-msvc", "+sse4.1"))
    monkeypatch.setattr(jit, "target", lambda: target)
    kernel = compile(FUNCTION)
    assert "llvm.fma" not in kernel.ir() and "llvm.fma" not in kernel.ir(batch=True)
    rng = np.random.default_rng(3)
    q, x = rng.uniform(-1, 1, (9, 7)), rng.uniform(-1, 1, 9)
    for got, expected in zip(kernel(q, x), FUNCTION(q, x), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-13, atol=1e-13)


def test_a_scratch_too_large_for_the_stack_holds_one_row(monkeypatch):

    monkeypatch.setattr(import_module("ulna.compiler.codegen.batch_loop"), "_SCRATCH", 64)
    kernel = compile(trace(lambda q, x: (q[::-1] * x, q[0] + x), q=(7,), x=()))
    for rows in (1, 2, 7, 8, 9, 17, 20):
        q, x = np.arange(rows * 7.0).reshape(rows, 7), np.arange(float(rows))
        for a in (q, np.asfortranarray(q), q[:, ::-1], q[::-1]):
            got = kernel(a, x)
            np.testing.assert_array_equal(got[0], a[:, ::-1] * x[:, None])
            np.testing.assert_array_equal(got[1], a[:, 0] + x)
        expected = q[:, ::-1] * x[:, None]
        kernel(q, x, out=(q, x))
        np.testing.assert_array_equal(q, expected)
