"""Functions whose calls with arguments of known types go to bound kernels."""

from __future__ import annotations

import copy
import inspect
import pickle
import sys
import threading
from typing import Any

import numpy as np
import pytest

from ulna import numeric
from ulna.compiler import compile
from ulna.compiler.runtime.object_layout import has_gil
from ulna.compiler.runtime.repeated_calls import RepeatedCalls
from ulna.compiler.runtime.typed_calls import TypedCalls, typed_calls
from ulna.errors import InputError

asked: list[tuple[str, tuple[Any, ...]]] = []


class Pair:
    """Two numbers in the one slot of an object."""

    __slots__ = ("values",)

    def __init__(self, *values):
        self.values = np.array(values, dtype=float)

    def __add__(self, other):
        """The sum."""
        asked.append(("sum", (self, other)))
        if isinstance(other, np.ndarray):
            return Pair(*(self.values + other))
        return Pair(*(self.values + other.values)) if isinstance(other, Pair) else NotImplemented

    def scaled(self, factor=2.0):
        """The pair, so many times."""
        asked.append(("scaled", (self, factor)))
        return Pair(*(factor * self.values))

    def __iadd__(self, other):
        """The sum in place."""
        asked.append(("change", (self, other)))
        self.values += other.values
        return self


class Derived(Pair):
    __slots__ = ()


def kernel(function, *holders, holder: Any = Pair, **shapes):
    def make():
        compiled = compile(function, **shapes)
        return compiled.into(
            np.zeros(compiled.function.outputs[0].shape),
            returns=(0,),
            otherwise=lambda *_: NotImplemented,
            holder=holder,
            input_holders=holders,
        )

    return make


_SUM = {
    (Pair, Pair): kernel(lambda a, b: a + b, Pair, Pair, a=(2,), b=(2,)),
    (Pair, np.ndarray): kernel(lambda a, b: a + b, Pair, a=(2,), b=(2,)),
}
Pair.__add__ = typed_calls(Pair.__add__, _SUM, is_method=True)
Pair.scaled = typed_calls(
    Pair.scaled,
    {
        (Pair,): kernel(lambda a: 2.0 * a, Pair, a=(2,)),
        (Pair, float): kernel(lambda a, x: x * a, Pair, a=(2,), x=()),
        (Pair, int): kernel(lambda a, x: x * a, Pair, a=(2,), x=()),
    },
    is_method=True,
)
Pair.__iadd__ = typed_calls(
    Pair.__iadd__,
    {(Pair, Pair): kernel(lambda a, b: a + b, Pair, Pair, a=(2,), b=(2,))},
    is_method=True,
    in_place=16,
)


def length(pair: Any) -> float:
    """The length of a pair."""
    asked.append(("length", (pair,)))
    return float(np.linalg.norm(pair.values))


length: Any = typed_calls(  # type: ignore[no-redef]
    length, {(Pair,): kernel(lambda a: numeric.sqrt(a @ a), Pair, holder=float, a=(2,))}
)


@pytest.fixture(autouse=True)
def empty():
    asked.clear()
    yield
    asked.clear()


def is_native():
    return isinstance(length, RepeatedCalls)


def test_known_types_run_no_python():
    a, b, x = Pair(1.0, 2.0), Pair(3.0, 4.0), np.array([5.0, 6.0])
    for _ in range(3):
        assert (a + b).values.tolist() == [4.0, 6.0] and (a + x).values.tolist() == [6.0, 8.0]
        twice, thrice = a.scaled(), a.scaled(3.0)  # no attributes, which pytest would make of it
        assert twice.values.tolist() == [2.0, 4.0] and thrice.values.tolist() == [3.0, 6.0]
    if is_native():
        assert [name for name, _ in asked] == ["sum", "sum", "scaled", "scaled"]  # the first call of each


def test_whole_numbers_are_taken_as_floats():
    a = Pair(1.0, 2.0)
    a.scaled(3)
    asked.clear()
    for factor in (0, -3, 2**53 + 1, 10**300):
        once = a.scaled(factor)
        assert once.values.tolist() == [float(factor), 2.0 * float(factor)]
    assert not is_native() or not asked
    with pytest.raises(OverflowError):
        a.scaled(10**400)
    with pytest.raises(TypeError, match="unsupported operand"):
        a.scaled(3) + 2
    assert a.scaled(True).values.tolist() == [1.0, 2.0]
    before = sys.getrefcount(a), sys.getrefcount(10**300)
    for _ in range(100):
        a.scaled(10**300)
    assert (sys.getrefcount(a), sys.getrefcount(10**300)) == before


def test_methods_change_their_instance():
    a, b = Pair(1.0, 2.0), Pair(3.0, 4.0)
    same, array = a, a.values
    a += b
    asked.clear()
    a += b
    a += a
    assert a is same and a.values is array and array.tolist() == [14.0, 20.0]
    assert not (isinstance(length, RepeatedCalls) and has_gil()) or not asked
    array.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        a += b
    assert array.tolist() == [14.0, 20.0]
    wide = Pair(0.0, 0.0)
    wide.values = np.zeros(4)[::2]
    wide += b
    assert wide.values.tolist() == [3.0, 4.0]
    with pytest.raises(AttributeError):
        a += 2
    derived = Derived(1.0, 1.0)
    derived += b
    assert type(derived) is Derived and derived.values.tolist() == [4.0, 5.0]
    counts = [sys.getrefcount(x) for x in (a, b)]
    array.flags.writeable = True
    for _ in range(100):
        a += b
    assert [sys.getrefcount(x) for x in (a, b)] == counts


def test_other_calls_reach_the_function():
    a = Pair(1.0, 2.0)
    a + a
    asked.clear()
    with pytest.raises(TypeError, match="unsupported operand"):
        a + "text"
    assert (Derived(1.0, 2.0) + a).values.tolist() == [2.0, 4.0]
    assert (a + np.arange(4)[::2]).values.tolist() == [1.0, 4.0]  # no float64
    assert a.scaled(factor=3.0).values.tolist() == [3.0, 6.0] and a.scaled(np.int64(3)).values.tolist() == [
        3.0,
        6.0,
    ]
    assert len(asked) == 5
    with pytest.raises(TypeError, match="takes from 1 to 2 positional arguments but 4 were given"):
        a.scaled(1.0, 2.0, 3.0)
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        Pair.scaled()  # type: ignore[call-arg]


def test_an_empty_slot_reaches_the_function():
    empty, a = object.__new__(Pair), Pair(1.0, 2.0)
    a + a
    with pytest.raises(AttributeError):
        a + empty
    a.values = np.zeros(3)  # another shape
    assert (a + Pair(1.0, 1.0, 1.0)).values.tolist() == [1.0, 1.0, 1.0]


def test_it_looks_like_the_function():
    a = Pair(1.0, 2.0)
    assert inspect.isfunction(Pair.scaled) and Pair.scaled.__doc__ == "The pair, so many times."
    assert list(inspect.signature(Pair.scaled).parameters) == ["self", "factor"]
    assert inspect.ismethod(a.scaled) and a.scaled().values.tolist() == [2.0, 4.0]
    assert Pair.scaled(a, 4.0).values.tolist() == [4.0, 8.0]
    assert inspect.isroutine(length) and length.__doc__ == "The length of a pair."
    assert [length(Pair(3.0, 4.0)) for _ in range(3)] == [5.0] * 3
    assert pickle.loads(pickle.dumps(length)) is length and copy.copy(length) is length


def test_calls_leave_no_references():
    a, b, text = Pair(1.0, 2.0), Pair(3.0, 4.0), "text that is used here only"
    a + b
    before = [sys.getrefcount(x) for x in (a, b, text, NotImplemented)]
    for _ in range(1000):
        a + b
        with pytest.raises(TypeError):
            a + text
        asked.clear()
    after = [sys.getrefcount(x) for x in (a, b, text, NotImplemented)]
    assert all(abs(x - y) <= 2 for x, y in zip(before, after, strict=True))


def test_threads_share_a_function():
    wrong = []

    def work(first):
        for k in range(first, first + 500):
            if (Pair(k, 1.0) + Pair(1.0, k)).values.tolist() != [k + 1.0, k + 1.0]:
                wrong.append(k)

    threads = [threading.Thread(target=work, args=(1000 * k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_rows_of_more_types_than_machine_code_compares_are_refused() -> None:
    with pytest.raises(InputError, match="has 5 types; expected at most 4"):
        TypedCalls(((float,) * 5,))
