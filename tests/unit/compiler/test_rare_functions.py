"""Kernels share what they rarely call: it is compiled once, found again, and gives the same results."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import disk_cache
from ulna.compiler import compile
from ulna.compiler.codegen.payne_hanek import NAME
from ulna.compiler.codegen.rare_functions import rare_functions_of, with_rare_functions_apart
from ulna.compiler.runtime import gufunc, jit
from ulna.compiler.runtime.kernel import native_type

HUGE = np.array([2.0**25, -1e17, 1e300, np.inf])
DEFINITION = f"@{NAME}(double %x)"


@pytest.fixture
def modules(monkeypatch, tmp_path):
    """The modules that LLVM compiles, from an empty cache, in a process that has compiled none before."""
    seen: list[str] = []
    original = jit.optimised

    def spy(ir: str, passes: jit.Passes, machine):
        seen.append(ir)
        return original(ir, passes, machine)

    monkeypatch.setattr(jit, "optimised", spy)
    monkeypatch.setattr(jit, "_rare_functions", {})
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "kernels"))
    return seen


def check(kernel, factor: float) -> None:
    """Single calls and batches of sines of huge arguments, beside mpmath; infinities have none."""
    mpmath = pytest.importorskip("mpmath")
    with mpmath.workdps(400):
        expected = [factor * float(mpmath.sin(mpmath.mpf(float(x)))) for x in HUGE[:3]]
    for found in (kernel(HUGE), *kernel(np.stack([HUGE] * 9))):
        np.testing.assert_allclose(found[:3], expected, rtol=4e-16)
        assert np.isnan(found[3])


def test_kernels_share_the_reduction_of_huge_arguments(modules):
    for factor in (2.0, 3.0, 5.0):
        check(compile(lambda x, c=factor: np.sin(x) * c, x=(4,)), factor)
    definitions = [ir for ir in modules if DEFINITION in ir]
    assert len(modules) > len(definitions)
    assert len(set(definitions)) == len(definitions) <= 2  # by the widths of single calls and of batches


def test_a_kernel_from_the_cache_compiles_what_is_shared_where_that_is_missing(modules):
    def use() -> None:
        check(compile(lambda x: np.sin(x) * 7.0, x=(4,)), 7.0)

    use()
    jit._rare_functions.clear()
    count = len(modules)
    use()
    assert len(modules) == count
    names = list(jit._rare_functions)
    assert names
    folder = disk_cache.folder()
    for name in names:
        (folder / jit._key(name, jit.Passes.COMBINING)).unlink()
    jit._rare_functions.clear()
    use()
    assert len(modules) - count == len(names)
    assert all("@ulna.rare." in ir for ir in modules[count:])


def test_modules_are_taken_apart_where_they_have_rare_functions():
    kernel = compile(lambda x: np.sin(x) + np.tan(x), x=(4,))
    apart, shared = with_rare_functions_apart(kernel.ir(batch=True))
    assert len(shared) == 3  # the copying of rows is the third
    assert DEFINITION not in apart and " cold nounwind {" not in apart
    assert sum(f"define internal {{ double, double, i64 }} {DEFINITION}" in t for t in shared.values()) == 2
    for name, text in shared.items():
        assert apart.count(f"@{name}(") >= 2  # declared, and called
        assert f"@{name}(" in text
        assert with_rare_functions_apart(text) == (text, {})
        assert rare_functions_of(f"xx{name}\0yy{name}".encode()) == [name]
    again = compile(lambda x: np.tan(x) * 2.0, x=(4,)).ir(batch=True)
    assert with_rare_functions_apart(again)[1].keys() < shared.keys()
    plain = compile(lambda x: x * 2.0, x=(4,)).ir()
    assert with_rare_functions_apart(plain) == (plain, {})


def test_a_function_that_changes_variables_stays_in_its_module():
    shared = """
define internal void @rare(ptr %p) noinline cold nounwind {
  store i64 1, ptr @seen
  ret void
}
define void @f(ptr %p) nounwind {
  call void @rare(ptr %p)
  ret void
}
"""
    variable = "@seen = internal global i64 0\n" + shared
    assert with_rare_functions_apart(variable) == (variable, {})
    constant = variable.replace("global i64", "constant i64")
    apart, modules = with_rare_functions_apart(constant)
    assert list(modules) == rare_functions_of(apart.encode()) and "@rare(" not in apart


@pytest.mark.skipif(native_type() is None, reason="kernels are not called by machine code here")
def test_calls_with_out_are_compiled_at_the_first_of_them(modules):
    gufunc._fast_call.cache_clear()
    kernel = compile(lambda x: 2.0 * x, x=(4,))
    x, y = np.arange(4.0), np.zeros(4)
    assert kernel(x).tolist() == [0.0, 2.0, 4.0, 6.0]
    assert not any("@with_out" in ir for ir in modules)
    for _ in range(2):
        assert kernel(x, out=y) is y
    assert y.tolist() == [0.0, 2.0, 4.0, 6.0]
    assert sum("@with_out" in ir for ir in modules) == 1
