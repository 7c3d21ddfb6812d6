"""Methods that machine code hands to kernels: the same answers and errors as the Python function beneath them."""

from __future__ import annotations

import gc
import inspect
import pickle
import pydoc
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ulna.compiler import compile
from ulna.compiler.runtime.kernel import native_type
from ulna.compiler.runtime.method_call import Parameters, Tables, method_call

pytestmark = pytest.mark.skipif(native_type() is None, reason="kernels are not called by machine code here")

A, B = np.array([1.0, 2.0]), np.array([-0.5, 4.0])
_TIMES = {
    (factor, power): compile(lambda x, y, f=factor, p=power: f * x**p + y, x=(2,), y=(2,))
    for factor in (1.0, 3.0)
    for power in (1, 2)
}
RUNS: list[tuple] = []
"""The calls that reached Python."""


class Key:
    """An option whose hash is computed by Python."""

    def __init__(self, error: type[BaseException] | None = None) -> None:
        self.error = error

    def __hash__(self) -> int:
        if self.error is not None:
            raise self.error("asked for the hash")
        return hash(3.0)

    def __eq__(self, other: object) -> bool:
        return other == 3.0


def total(
    self, x: Any, y: Any, factor: Any = 1.0, power: Any = 1, out: Any = None, threads: Any = None
) -> Any:
    """A power, scaled, and a sum."""
    RUNS.append((factor, power))
    return self.by_options["total"][factor][power](x, y, out=out, threads=threads)


class Names:
    __slots__ = ("other", "total")


class Things:
    __slots__ = ("by_name", "by_options", "name")

    def __init__(self, made: bool = True) -> None:
        self.by_name = Names()
        self.by_options = {"total": {f: {p: k for (g, p), k in _TIMES.items() if g == f} for f in (1.0, 3.0)}}
        if made:
            self.by_name.total = _TIMES[1.0, 1]


class Derived(Things):
    """With attributes of its own."""


def called_directly(owner: type, has_tables: bool = True) -> Any:
    names = total.__code__.co_varnames[1 : total.__code__.co_argcount]
    parameters = Parameters(names, 2, total.__defaults__ or (), has_tables, has_tables)
    tables = Tables("by_name", Names, "by_options")
    return method_call(total, owner, owner, tables, "total", parameters)


Things.total = called_directly(Things)  # type: ignore[attr-defined]
METHOD: Any = vars(Things)["total"]
"""What a call `things.total(...)` goes to; `things.total` alone, and so `things.total(*args)`, is the function."""
KEY, OUT = Key(), np.zeros(2)
FACTOR = 3.0
CALLS: list[tuple[tuple, dict[str, Any]]] = [
    ((A, B), {}), ((A, B, 3.0), {}), ((A, B, FACTOR, 2), {}), ((A, B), {"power": 2}), ((A, B), {"power": 2, "factor": 3.0}),
    ((A, B, 1.0), {"power": 1}), ((A,), {"y": B}), ((), {"y": B, "x": A, "power": 2}), ((A, B, KEY), {}),
    ((A, B, 3), {}), ((A, B), {"out": OUT}), ((A, B, 3.0, 2, OUT), {}), ((A, B, 3.0, 2, OUT, None), {}),
    ((A, B), {"out": OUT, "factor": 3.0, "threads": None}), ((A, B), {"out": None}),
]  # fmt: skip
"""What machine code answers."""
SLOWLY: list[tuple[tuple, dict[str, Any]]] = [
    ((), {}), ((A,), {}), ((A,), {"x": A}), ((A, B), {"x": A}), ((A, B), {"size": 3}), ((A, B), {"threads": 2}),
    ((A, B, 5.0), {}), ((A, B, [1.0]), {}), ((A, B, 3.0, "square"), {}), ((A, B, 1.0, 1, None, None, 0), {}),
    ((A, B), {"factor": 1.0, "nothing": None}), ((A, B, Key(ValueError)), {}), ((A, B, Key(TypeError)), {}),
]  # fmt: skip
"""What Python answers or refuses."""
KERNEL_REFUSES: list[tuple[tuple, dict[str, Any]]] = [
    ((A, np.zeros(3)), {}), ((None, B), {}), ((A, B), {"out": np.zeros(3)}), (("no", B, 3.0), {}),
]  # fmt: skip


def outcome(f: Callable[..., Any], *args: Any, **named: Any) -> Any:
    """The bytes of the result, or the type and text of the error."""
    try:
        return np.asarray(f(*args, **named)).tobytes()
    except Exception as error:
        return type(error), str(error)


@pytest.mark.parametrize("owner", [Things, Derived])
@pytest.mark.parametrize("call", [*CALLS, *SLOWLY, *KERNEL_REFUSES])
def test_every_call_has_the_outcome_of_the_function(owner: type, call: tuple[tuple, dict[str, Any]]) -> None:
    things: Any = owner()
    args, named = call
    expected = outcome(lambda *a, **n: total(things, *a, **n), *args, **named)
    assert outcome(METHOD, things, *args, **named) == expected


@pytest.mark.parametrize("call", CALLS)
def test_python_does_not_run_where_the_kernel_is_there(call: tuple[tuple, dict[str, Any]]) -> None:
    things: Any = Things()
    args, named = call
    RUNS.clear()
    METHOD(things, *args, **named)
    assert not RUNS


def test_results_are_written_to_out_and_it_is_returned() -> None:
    things: Any = Things()
    for named in ({"out": OUT}, {"out": OUT, "factor": 3.0}):
        OUT[:] = 0.0
        assert things.total(A, B, **named) is OUT
        np.testing.assert_array_equal(OUT, total(things, A, B, named.get("factor", 1.0)))


def test_kernels_that_are_not_made_yet_and_tables_that_are_not_there_are_left_to_python() -> None:
    things: Any = Things(made=False)
    RUNS.clear()
    np.testing.assert_array_equal(things.total(A, B), A + B)
    assert RUNS == [(1.0, 1)]
    things.by_name.total = _TIMES[1.0, 1].gufunc  # no kernel of this library
    np.testing.assert_array_equal(things.total(A, B), A + B)
    assert RUNS == [(1.0, 1)] * 2
    del things.by_name
    np.testing.assert_array_equal(things.total(A, B), A + B)
    del things.by_options
    for f in (lambda: things.total(A, B, 3.0), lambda: total(things, A, B, 3.0)):
        with pytest.raises(AttributeError, match="by_options"):
            f()


def test_errors_that_are_no_type_errors_of_an_option_are_passed_on() -> None:
    things: Any = Things()
    RUNS.clear()
    with pytest.raises(KeyboardInterrupt):
        things.total(A, B, Key(KeyboardInterrupt))
    assert not RUNS


def test_other_options_go_to_the_function_where_it_has_a_body_of_its_own() -> None:
    method = called_directly(Things, has_tables=False)
    things = Things()
    RUNS.clear()
    method(things, A, B)
    assert not RUNS
    np.testing.assert_array_equal(method(things, A, B, 3.0), 3.0 * A + B)
    method(things, A, B, out=OUT)
    assert RUNS == [(3.0, 1), (1.0, 1)]


def test_objects_of_other_classes_are_left_to_python() -> None:
    for other in (5, None, object(), "things"):
        assert outcome(METHOD, other, A, B) == outcome(total, other, A, B)
    with pytest.raises(TypeError, match="missing 3 required positional arguments"):
        METHOD()


def test_as_an_attribute_it_is_the_function() -> None:
    things: Any = Things()
    assert Things.total is total  # type: ignore[attr-defined]
    assert things.total.__func__ is total and things.total.__self__ is things
    assert inspect.signature(things.total) == inspect.signature(total.__get__(things))
    assert pydoc.render_doc(things.total) == pydoc.render_doc(total.__get__(things))
    np.testing.assert_array_equal(things.total(A, B, 3.0), next(map(things.total, [A], [B], [3.0])))
    assert pickle.loads(pickle.dumps(Things.total)) is total  # type: ignore[attr-defined]


def test_a_derived_class_may_replace_it_and_call_it() -> None:
    class More(Things):
        def total(self, x: Any, y: Any) -> Any:
            return super().total(x, y, 3.0) + 1.0  # type: ignore[misc]

    np.testing.assert_array_equal(More().total(A, B), 3.0 * A + B + 1.0)


def test_calls_keep_nothing_and_lose_nothing() -> None:
    things: Any = Things()
    watched = [A, B, OUT, things, _TIMES[3.0, 2], FACTOR, None]
    for args, named in [*CALLS, *SLOWLY, *KERNEL_REFUSES]:
        outcome(METHOD, things, *args, **named)

    def references() -> list[int]:
        RUNS.clear()
        gc.collect()
        return [sys.getrefcount(x) for x in watched]

    def changes() -> list[int]:
        before = references()
        for _ in range(500):
            for args, named in [*CALLS, *KERNEL_REFUSES, *SLOWLY]:
                outcome(METHOD, things, *args, **named)
        return [abs(y - x) for x, y in zip(before, references(), strict=True)]

    # What calls keep they keep each of 500 times; other threads of the process may drop some references to None meanwhile.
    assert min(max(changes()) for _ in range(3)) < 250


def test_kernels_may_be_added_while_threads_call_others() -> None:
    """A dictionary moves its entries when it grows; without a global lock calls look into it meanwhile."""
    things: Any = Things()
    errors: list[BaseException] = []

    def call() -> None:
        try:
            for _ in range(300):
                np.testing.assert_array_equal(METHOD(things, A, B, 3.0, 2), 3.0 * A**2 + B)
                np.testing.assert_array_equal(METHOD(things, A, B, power=2), A**2 + B)
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=call) for _ in range(4)]
    for thread in threads:
        thread.start()
    for k in range(2000):
        things.by_options["total"].setdefault(5.0 + k, {}).setdefault(1, _TIMES[1.0, 1])
        things.by_options["total"][3.0].setdefault(3 + k, _TIMES[3.0, 1])
    for thread in threads:
        thread.join()
    assert not errors
