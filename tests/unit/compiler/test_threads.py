"""Many threads compile and call the same and different kernels: each value is that of one thread, with the GIL or without.

On a free-threaded Python the children run without the GIL, also where an extension module would turn it on again.
"""

from __future__ import annotations

import os
import pickle
import random
import subprocess
import sys
import sysconfig
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.callers import call_at_once
from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.runtime.repeated_calls import call_cache, forget, repeated_calls
from ulna.errors import ShapeError

THREADS, ROWS = 8, 37


def _waves(q):
    x = q
    for k in range(12):
        x = np.sin(x + 0.1 * k) * x[::-1] + q
    return x


def _two(a, b):
    return a @ b, nm.where(b[0] < a[0, 0], np.exp(-b), np.arctan2(b, 1.0 + b * b))


def _root(x):
    return nm.loop(lambda v: abs(v * v - x) > 1e-12, lambda v: (0.5 * (v + x / v),), (1.0 + x,), 60)[0]


FUNCTIONS: list[tuple[Callable[..., Any], dict[str, tuple[int, ...]]]] = [
    (_waves, {"q": (5,)}),
    (_two, {"a": (3, 3), "b": (3,)}),
    (_root, {"x": ()}),
]


def _flat(results: Any) -> list[np.ndarray]:
    return [np.asarray(r) for r in (results if isinstance(results, tuple) else (results,))]


def _equal(results: Any, expected: list[np.ndarray]) -> None:
    for result, wanted in zip(_flat(results), expected, strict=True):
        np.testing.assert_array_equal(result, wanted)


class Shared:
    """One kernel for all threads, with arguments and the values that one thread computed and NumPy confirmed."""

    def __init__(self, f: Callable[..., Any], shapes: dict[str, tuple[int, ...]]) -> None:
        rng = np.random.default_rng(len(shapes))
        self.f, self.shapes = f, shapes
        self.kernel = compile(f, **shapes)
        self.rows = [rng.uniform(0.1, 0.9, (ROWS, *shape)) for shape in shapes.values()]
        self.one = [_flat(self.kernel(*(a[k] for a in self.rows))) for k in range(ROWS)]
        self.all = _flat(self.kernel(*self.rows))
        interpreted = trace(f, **shapes)
        for k in range(ROWS):
            for result, batch, wanted in zip(
                self.one[k], self.all, _flat(interpreted(*self.row(k))), strict=True
            ):
                np.testing.assert_allclose(result, wanted, rtol=1e-12)
                np.testing.assert_allclose(batch[k], wanted, rtol=1e-12)

    def row(self, k: int) -> list[np.ndarray]:
        return [a[k] for a in self.rows]


def _single(shared: Shared, chance: random.Random) -> None:
    for k in chance.choices(range(ROWS), k=50):
        _equal(shared.kernel(*shared.row(k)), shared.one[k])


def _batch(shared: Shared, chance: random.Random) -> None:
    _equal(shared.kernel(*shared.rows), shared.all)


def _named_lists(shared: Shared, chance: random.Random) -> None:
    k = chance.randrange(ROWS)
    values = [row.tolist() for row in shared.row(k)]
    _equal(shared.kernel(**dict(zip(shared.shapes, values, strict=True))), shared.one[k])


def _out(shared: Shared, chance: random.Random) -> None:
    k = chance.randrange(ROWS)
    targets = tuple(np.full(a.shape, np.nan) for a in shared.one[k])
    shared.kernel(*shared.row(k), out=targets if len(targets) > 1 else targets[0])
    _equal(targets, shared.one[k])


def _bound(shared: Shared, chance: random.Random) -> None:
    targets = [np.full(a.shape, np.nan) for a in shared.one[0]]
    step = shared.kernel.into(*targets)
    for k in chance.choices(range(ROWS), k=20):
        step(*shared.row(k))
        _equal(tuple(targets), shared.one[k])


def _compiled_again(shared: Shared, chance: random.Random) -> None:
    k, kernel = chance.randrange(ROWS), compile(shared.f, **shared.shapes)
    _equal(kernel(*shared.row(k)), shared.one[k])
    _equal(kernel(*shared.rows), shared.all)


def _pickled(shared: Shared, chance: random.Random) -> None:
    k = chance.randrange(ROWS)
    _equal(pickle.loads(pickle.dumps(shared.kernel))(*shared.row(k)), shared.one[k])


def _compiled_new(shared: Shared, chance: random.Random) -> None:
    shift, x = chance.random(), np.linspace(-1.0, 1.0, 20)
    kernel = compile(lambda x: np.sin(x + shift) * shift, x=())
    np.testing.assert_allclose(kernel(x), np.sin(x + shift) * shift, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(kernel(x[3]), np.sin(x[3] + shift) * shift, rtol=1e-12, atol=1e-15)


def _refused(shared: Shared, chance: random.Random) -> None:
    with pytest.raises(TypeError, match=f"takes {len(shared.shapes)} arguments"):
        shared.kernel(*shared.row(0), 1.0)
    if shared.shapes != {"x": ()}:
        with pytest.raises(ShapeError):
            shared.kernel(*(np.ones((*row.shape, 7)) for row in shared.row(0)))


WORKS = (_single, _batch, _named_lists, _out, _bound, _compiled_again, _pickled, _compiled_new, _refused)


def in_threads(work: Callable[[int], None]) -> None:
    """Runs `work` in all threads from the same moment on; raises what one of them raised."""
    barrier, numbers = threading.Barrier(THREADS), iter(range(THREADS))

    def run() -> None:
        number = next(numbers)
        barrier.wait(600)
        work(number)

    call_at_once(run, THREADS)


def call_and_compile(rounds: int) -> None:
    """All kinds of calls and compilations, in another order in each thread."""
    shared = [Shared(f, shapes) for f, shapes in FUNCTIONS]

    def work(seed: int) -> None:
        chance = random.Random(seed)
        for _ in range(rounds):
            for task in chance.sample(WORKS, len(WORKS)):
                task(chance.choice(shared), chance)

    in_threads(work)


def first_calls_of_a_robot() -> None:
    """A robot compiles its methods at their first call, which here comes from all threads at once."""
    calls = {
        "fk": lambda robot, q: robot.fk(q),
        "jacobian": lambda robot, q: robot.jacobian(q),
        "mass_matrix": lambda robot, q: robot.mass_matrix(q),
        "inverse_dynamics": lambda robot, q: robot.inverse_dynamics(q, q, -q),
        "forward_dynamics": lambda robot, q: robot.forward_dynamics(q, q, -q),
    }
    alone, q = ulna.load("ur5"), np.linspace(-1.0, 1.0, 6)
    rows = np.outer(np.linspace(0.2, 1.0, 9), q)
    expected = {name: (call(alone, q), call(alone, rows)) for name, call in calls.items()}
    robot = ulna.load("ur5")

    def work(seed: int) -> None:
        names = random.Random(seed).sample(sorted(calls), len(calls))
        for name in names:
            one, many = expected[name]
            np.testing.assert_array_equal(calls[name](robot, q), one)
            np.testing.assert_array_equal(calls[name](robot, rows), many)

    in_threads(work)


class Held:
    """Holds an array in its one slot."""

    __slots__ = ("array",)
    array: np.ndarray


def _held(array: np.ndarray) -> Held:
    held = object.__new__(Held)
    held.array = array
    return held


def call_the_same_bound_kernels() -> None:
    """Calls that write into the same arrays return what belongs to their own arguments."""
    shared = Shared(_two, {"a": (3, 3), "b": (3,)})
    step = shared.kernel.into(*(np.zeros_like(a) for a in shared.one[0]), returns=(0, 1))
    product = compile(lambda x: x[0] * x[1], x=(2,)).into(np.zeros(()), returns=(0,), holder=float)
    sys.setswitchinterval(1e-5)  # with a global lock

    def work(seed: int) -> None:
        for k in random.Random(seed).choices(range(ROWS), k=300):
            _equal(step(*shared.row(k)), shared.one[k])
            _equal(step(*(row.tolist() for row in shared.row(k))), shared.one[k])
            assert product(np.array([float(k), seed])) == k * seed
            assert product([float(k), seed]) == k * seed

    in_threads(work)


def replace_held_arrays() -> None:
    """An argument holds another array from one moment to the next: a call reads one of them to the end."""
    size = 64
    double = compile(lambda x: 2.0 * x, x=(size,))
    step = double.into(np.zeros(size), returns=(0,), holder=Held, input_holders=[Held], otherwise=lambda x: x)
    common = _held(np.zeros(size))

    def work(seed: int) -> None:
        for k in range(2000):
            common.array = np.full(size, float(seed + 8 * k))
            doubled = step(common).array
            assert doubled[0] % 2.0 == 0.0 and np.all(doubled == doubled[0])
            assert step(None) is None

    in_threads(work)


_calls = call_cache(2, weak=1)


@repeated_calls(_calls)
def scaled(thing: Any, place: int, x: float) -> Any:
    """A number times the factor of a thing."""
    _calls.add(thing.kernel, 1, thing, place)
    return thing.kernel(x)


class Scale:
    """A factor, with its kernel."""

    def __init__(self, factor: float) -> None:
        product = compile(lambda x, factor: x * factor, x=(), factor=())
        self.kernel = product.into(
            np.zeros(()),
            returns=(0,),
            trailing_inputs=[np.array(factor)],
            otherwise=lambda *_: NotImplemented,
        )


def call_while_rows_change() -> None:
    """Rows of a table of repeated calls are filled and emptied, and what they refer to is freed, during calls."""
    known = [Scale(float(k)) for k in range(4)]

    def work(seed: int) -> None:
        chance = random.Random(seed)
        for _ in range(60):
            own, factor = Scale(seed + 0.5), seed + 0.5
            for _ in range(30):
                k, place = chance.randrange(len(known)), chance.randrange(5)
                assert scaled(known[k], place, 2.0) == 2.0 * k
                assert scaled(own, place, 2.0) == 2.0 * factor
            forget(chance.choice(known))

    in_threads(work)


def drop_robots() -> None:
    """Robots come and go, with the kernels that threads call, while one is called by all and gets new kernels."""
    q = np.linspace(-1.0, 1.0, 6)
    shared = ulna.load("ur5")
    frames = [frame.name for frame in shared.model.frames]
    alone = ulna.load("ur5")
    expected = {frame: alone.fk(q, frame) for frame in frames}
    mass = alone.mass_matrix(q)

    def work(seed: int) -> None:
        chance = random.Random(seed)
        for _ in range(8):
            own, pose = ulna.load("ur5"), np.empty((4, 4))
            for frame in chance.choices(frames, k=12):
                for robot in (own, shared):
                    np.testing.assert_array_equal(robot.fk(q, frame), expected[frame])
                    assert robot.fk(q, frame, out=pose) is pose
                    np.testing.assert_array_equal(pose, expected[frame])
                    np.testing.assert_array_equal(robot.mass_matrix(q), mass)

    in_threads(work)


_CHILD = """
import sys, sysconfig
sys.path[:0] = sys.argv[1:]
import test_threads
test_threads.{what}
if sysconfig.get_config_var("Py_GIL_DISABLED"):
    assert not sys._is_gil_enabled()
print("done")
"""

_HERE = Path(__file__).resolve().parent
_IMPORTED = str(_HERE), str(_HERE.parents[1])


TOGETHER = (
    "call_and_compile(6)", "first_calls_of_a_robot()", "call_the_same_bound_kernels()", "replace_held_arrays()",
    "call_while_rows_change()", "drop_robots()",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fast", ["", "0"], ids=["fast calls", "general calls"])
@pytest.mark.parametrize("what", TOGETHER)
def test_each_thread_gets_the_values_of_a_single_thread(what: str, fast: str, tmp_path: Any) -> None:
    environment = os.environ | {"ULNA_CACHE": str(tmp_path), "ULNA_QUIET": "1"}
    environment |= {"ULNA_FAST": fast} if fast else {}
    environment |= {"PYTHON_GIL": "0"} if sysconfig.get_config_var("Py_GIL_DISABLED") else {}
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", _CHILD.format(what=what), *_IMPORTED],
        capture_output=True, text=True, env=environment, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0 and done.stdout == "done\n", done.stderr[-4000:]
