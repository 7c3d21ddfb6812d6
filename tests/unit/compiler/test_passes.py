"""What LLVM does with a kernel depends on how long its text is and whether it has loops; the numbers do not."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.jit import Passes


def mixed(x, y, rounds: int):
    """Numbers that stay between -2 and 2, by about 5 operations in each of so many rounds."""
    for k in range(rounds):
        x, y = 0.6 * x + 0.01 * k / rounds * y, 0.7 * y - 0.3 * x * x
    return x, y


def looped(rounds: int):
    """A function with a loop of 5 iterations; an iteration has so many rounds."""

    def value(x):
        state = (0.0 * x[0], x[0], x[1])
        end = nm.loop(lambda n, *_: n < 5.0, lambda n, x, y: (n + 1.0, *mixed(x, y, rounds)), state, 5)
        return nm.vector(*end[1:])

    return value


def straight(rounds: int):
    """The same function of one iteration, without a loop."""
    return lambda x: nm.vector(*mixed(x[0], x[1], rounds))


CASES = [
    (looped(3), Passes.LEVEL_1),
    (looped(700), Passes.COMBINING),
    (looped(3_000), Passes.INLINING),
    (straight(3), Passes.COMBINING),
    (straight(700), Passes.INLINING),
]


@pytest.fixture
def seen(monkeypatch):
    """The passes of what LLVM compiles, the shared parts of kernels aside."""
    made: list[Passes] = []
    original = jit.optimised

    def spy(ir: str, passes: Passes, machine):
        made.append(passes)
        return original(ir, passes, machine)

    compile(np.cos, x=(2,))(np.zeros((9, 2)))  # what kernels share is compiled
    monkeypatch.setenv("ULNA_CACHE", "0")
    monkeypatch.setattr(jit, "optimised", spy)
    return made


@pytest.mark.parametrize(("function", "passes"), CASES)
def test_long_loops_and_long_code_get_fewer_passes(seen, function, passes):
    rows = np.random.default_rng(0).uniform(-1.0, 1.0, (20, 2))
    expected = np.array([function(row) for row in rows])
    kernel = compile(function, x=(2,))
    found = kernel(rows)
    assert seen
    assert seen[-1] is passes
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose([kernel(row) for row in rows], expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("function", "passes"), CASES)
def test_compiled_quickly_the_numbers_are_the_same(seen, monkeypatch, function, passes):
    rows = np.random.default_rng(7100).uniform(-1.0, 1.0, (20, 2))
    usual = compile(function, x=(2,))
    expected, single = usual(rows), [usual(row) for row in rows]
    assert Passes.QUICK not in seen
    seen.clear()
    monkeypatch.setenv("ULNA_OPTIMISE", "0")
    quick = compile(lambda x: function(x), x=(2,))
    np.testing.assert_allclose(quick(rows), expected, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose([quick(row) for row in rows], single, rtol=1e-13, atol=1e-13)
    assert set(seen) == {Passes.QUICK}


def test_both_ways_of_compiling_are_stored_side_by_side(seen, monkeypatch, tmp_path):
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "kernels"))
    made = []
    for level in ("0", "1", "0", "1"):
        monkeypatch.setenv("ULNA_OPTIMISE", level)
        compile(lambda x: np.exp(0.123 * x) * x, x=(2,))(np.ones((9, 2)))
        made.append(list(seen))
        seen.clear()
    assert Passes.QUICK in made[0]
    assert made[1]
    assert Passes.QUICK not in made[1]
    assert made[2:] == [[], []]
