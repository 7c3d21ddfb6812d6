"""Functions that hand calls with the same first arguments to bound kernels."""

from __future__ import annotations

import gc
import inspect
import pickle
import sys
import threading
import weakref
from typing import Any

import numpy as np
import pytest

from ulna.compiler import compile
from ulna.compiler.runtime.repeated_calls import RepeatedCalls, call_cache, forget, repeated_calls

_PRODUCT = compile(lambda x, factor: factor * x, x=(), factor=())


class Thing:
    """What is referred to weakly; it holds its kernel."""

    def __init__(self, factor):
        self.kernel = _PRODUCT.into(
            np.zeros(()),
            returns=(0,),
            trailing_inputs=[np.array(factor)],
            otherwise=lambda *_: NotImplemented,
        )


_calls = call_cache(3, weak=1)
asked: list[tuple] = []


@repeated_calls(_calls)
def scaled(thing: Any, place: int, name: str = "a", x: Any = 1.0) -> Any:
    """A number times the factor of a thing."""
    asked.append((thing, place, name, x))
    if isinstance(x, float):
        _calls.add(thing.kernel, 1, thing, place, name)
        return thing.kernel(x)
    return "another"


@pytest.fixture(autouse=True)
def empty():
    asked.clear()
    yield
    asked.clear()


def test_only_the_first_of_equal_calls_runs_python():
    if not isinstance(scaled, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    thing = Thing(3.0)
    assert [scaled(thing, 5, "b", float(k)) for k in range(10)] == [3.0 * k for k in range(10)]
    assert len(asked) == 1
    assert scaled(thing, 6, "b", 2.0) == 6.0 and len(asked) == 2
    assert scaled(thing, 5, "c", 2.0) == 6.0 and len(asked) == 3
    assert scaled(Thing(4.0), 5, "b", 2.0) == 8.0 and len(asked) == 4


def test_other_calls_reach_the_function():
    thing = Thing(3.0)
    for _ in range(3):
        assert scaled(thing, 5, "b", 2.0) == 6.0
        assert scaled(thing, 5, x=2.0) == 6.0
        assert scaled(thing, 5, "b", x=2.0) == 6.0
        assert scaled(thing, 5, "b", "no number") == "another"
        assert scaled(thing, 5) == 3.0
    anyhow: Any = scaled
    with pytest.raises(TypeError, match="missing 2 required positional arguments"):
        anyhow()
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'place'"):
        anyhow(thing)
    with pytest.raises(TypeError, match="takes from 2 to 4 positional arguments but 5 were given"):
        anyhow(thing, 5, "b", 1.0, 2.0)


def test_what_is_forgotten_is_asked_again():
    thing = Thing(3.0)
    scaled(thing, 5, "b", 1.0)
    thing.kernel = Thing(7.0).kernel
    forget(thing)
    assert scaled(thing, 5, "b", 1.0) == 7.0


def test_weak_arguments_and_their_kernels_go():
    thing = Thing(3.0)
    scaled(thing, 5, "b", 1.0)
    scaled(thing, 5, "b", 1.0)
    asked.clear()
    gone, kernel = weakref.ref(thing), weakref.ref(thing.kernel)
    del thing
    gc.collect()
    assert gone() is None and kernel() is None
    for k in range(200):  # at the same address, as a rule
        one = Thing(float(k))
        assert scaled(one, 5, "b", 1.0) == k
        asked.clear()


def test_large_numbers_are_different_objects():
    thing = Thing(2.0)
    for k in range(250, 2000):
        assert scaled(thing, int(str(k)), "b", 1.0) == 2.0
    before = len(asked)
    assert scaled(thing, int("1000"), "b", 1.0) == 2.0 and len(asked) == before + 1


def test_calls_leave_no_references():
    thing, name = Thing(3.0), "a name that is used here only"
    scaled(thing, 5, name, 1.0)
    asked.clear()
    before = [sys.getrefcount(x) for x in (thing, thing.kernel, name, NotImplemented)]
    for _ in range(1000):
        scaled(thing, 5, name, 1.0)
        scaled(thing, 5, name, "no number")
        asked.clear()
    after = [sys.getrefcount(x) for x in (thing, thing.kernel, name, NotImplemented)]
    assert all(abs(a - b) <= 2 for a, b in zip(before, after, strict=True))


def test_errors_pass():
    thing = Thing(3.0)
    scaled(thing, 5, "b", 1.0)
    with pytest.raises(AttributeError):
        scaled(None, 5, "b", 1.0)


def test_it_looks_like_the_function():
    assert scaled.__name__ == "scaled" and scaled.__doc__ == "A number times the factor of a thing."
    assert list(inspect.signature(scaled).parameters) == ["thing", "place", "name", "x"]
    assert inspect.isroutine(scaled)
    assert pickle.loads(pickle.dumps(scaled)) is scaled
    assert "scaled" in repr(scaled)


def test_threads_may_share_a_table():
    wrong = []

    def work(first):
        for k in range(first, first + 60):
            thing = Thing(float(k))
            for place in range(20):
                if [scaled(thing, place, "b", 1.0) for _ in range(3)] != [float(k)] * 3:
                    wrong.append(k)

    threads = [threading.Thread(target=work, args=(100 * k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


_calls_around = call_cache(2, weak=1, kernel_argument=1, kernel_arguments=2)


@repeated_calls(_calls_around)
def sum_between(thing: Any, x: float, y: float, name: str) -> Any:
    """A sum of two numbers between the keys."""
    asked.append((thing, x, y, name))
    _calls_around.add(thing.sum, 2, thing, name)
    return thing.sum(x, y) if isinstance(x, float) else "another"


def test_several_arguments_between_the_others_may_be_passed():
    if not isinstance(sum_between, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    thing: Any = Thing(3.0)
    kernel = compile(lambda x, y: x + 2.0 * y, x=(), y=())
    thing.sum = kernel.into(np.zeros(()), returns=(0,), otherwise=lambda *_: NotImplemented)
    asked.clear()
    assert [sum_between(thing, 0.5 * k, 1.0, "a") for k in range(5)] == [0.5 * k + 2.0 for k in range(5)]
    assert len(asked) == 1
    assert sum_between(thing, 1.0, 2.0, "b") == 5.0
    assert sum_between(thing, 1.0, 2.0, name="b") == sum_between(thing, x=1.0, y=2.0, name="b") == 5.0
    assert len(asked) == 4
    assert sum_between(thing, "x", 1.0, "a") == "another"
    with pytest.raises(TypeError):
        sum_between(thing, 1.0, "a")


_forms_calls = call_cache(1, weak=1)


@repeated_calls(_forms_calls)
def scaled_or_doubled(thing: Any, x: float, y: Any = None) -> Any:
    asked.append((thing, x, y))
    kernel = thing.kernel if y is None else thing.sum
    _forms_calls.add(kernel, 1 if y is None else 2, thing)
    return kernel(x) if y is None else kernel(x, y)


def test_calls_with_other_numbers_of_arguments_do_not_displace_each_other():
    if not isinstance(scaled_or_doubled, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    thing: Any = Thing(3.0)
    thing.sum = compile(lambda x, y: x + y, x=(), y=()).into(np.zeros(()), returns=(0,))
    for k in range(20):
        assert scaled_or_doubled(thing, float(k)) == 3.0 * k
        assert scaled_or_doubled(thing, float(k), 1.0) == k + 1.0
    assert len(asked) == 2


_calls_between = call_cache(3, weak=1, kernel_argument=1)
_calls_all = call_cache(3, weak=1)


@repeated_calls(_calls_all, _calls_between)
def scaled_between(thing: Any, x: Any, name: str = "a", more: int = 0) -> Any:
    """A number, the second argument, times the factor of a thing."""
    asked.append((thing, x, name, more))
    if isinstance(x, float) and more == 0:
        _calls_between.add(thing.kernel, 1, thing, *([name] if name != "a" else []))
        return thing.kernel(x)
    return "another"


def test_an_argument_between_the_others_may_be_passed():
    if not isinstance(scaled_between, RepeatedCalls):
        pytest.skip("machine code cannot be called in this way here")
    things: list[Thing] = []

    def each_is_asked_once() -> bool:
        things[:] = Thing(3.0), Thing(5.0)
        counts = set()
        for name in ([], ["b"], ["c"]):
            for thing, factor in zip(things, (3.0, 5.0), strict=True):
                asked.clear()
                numbers = [scaled_between(thing, k * 0.5, *name) for k in range(9)]
                assert numbers == [factor * 0.5 * k for k in range(9)]
                counts.add(len(asked))
        return counts == {1}

    assert any(each_is_asked_once() for _ in range(8)), "addresses of two of six may lead to one of 256 rows"
    asked.clear()
    assert scaled_between(things[0], 2, "b") == "another"
    assert scaled_between(things[0], 1.0, "b", 1) == scaled_between(things[0], "x", "b") == "another"
    assert scaled_between(things[0], x=1.0, name="b") == 3.0
    assert [call[1:] for call in asked] == [(2, "b", 0), (1.0, "b", 1), ("x", "b", 0), (1.0, "b", 0)][
        -len(asked) :
    ]
    with pytest.raises(TypeError):
        scaled_between(things[0])
    forget(things[0])
    asked.clear()
    assert scaled_between(things[0], 2.0, "b") == 6.0
    assert len(asked) == 1
