"""Methods that run a procedure of their object without running Python."""

from __future__ import annotations

import gc
import inspect
import weakref
from typing import Any, NamedTuple

import numpy as np
import pytest

from ulna.compiler.procedures import Array1, Array2, f64, procedure
from ulna.compiler.runtime.procedure_method import Calls, Slot, has_machine_code, procedure_method
from ulna.errors import InputError


class Given(NamedTuple):
    A: Array2[f64]
    x: Array1[f64]
    out: Array1[f64]


@procedure
def scaled_product(given: Given, scale: Array1[f64]) -> int:
    """out = scale A x; whether its first entry is above zero, 2 where it is zero."""
    for i in range(len(given.out)):
        given.out[i] = 0.0
        for k in range(len(given.x)):
            given.out[i] += scale[0] * given.A[i, k] * given.x[k]
    if given.out[0] == 0.0:
        return 2
    return 1 if given.out[0] > 0.0 else 0


class Matrix:
    __slots__ = ("A", "scale")

    def __init__(self, A: Any, scale: Any = 1.0) -> None:
        self.A, self.scale = A, scale


class Product:
    __slots__ = ("calls", "counted", "out", "run", "scale", "table")

    def __init__(self) -> None:
        self.calls, self.counted, self.out, self.scale = None, 0, np.zeros(2), np.zeros(1)
        dummies = Given(np.zeros((2, 3)), np.zeros(3), np.zeros(2))
        self.run = scaled_product.bind(dummies, self.scale, are_arrays_private=True)

    def apply(self, matrix: Any, x: Any, tags: Any = (), others: Any = ()) -> Any:
        """Whether the product begins with a number above zero."""
        self.counted += 1
        self.out[:] = matrix.scale * np.asarray(matrix.A) @ np.asarray(x)
        return "in Python"

    def learn(self, matrix: Any, x: Any, tags: Any, others: Any) -> None:
        calls = Calls(self.run, (self, matrix, x, tags, others))
        calls.expect_kind(1)
        calls.expect_entries(3)
        calls.expect_length(4)
        calls.take_array(Slot(1, "A"), "given.A")
        calls.take_array(Slot(2), "given.x")
        calls.take_array(Slot(0, "out"), "given.out", is_written=True)
        calls.take_float(matrix, "scale", self.scale)
        self.table = calls.table()
        self.calls = self.table[0]


Product.apply = procedure_method(Product.apply, Product, "calls")  # type: ignore[method-assign]
pytestmark = pytest.mark.skipif(
    not has_machine_code(Product, "apply"), reason="machine code cannot be called in this way here"
)


def _learned() -> tuple[Product, list[Any]]:
    product, rng = Product(), np.random.default_rng(0)
    arguments = [Matrix(rng.normal(size=(2, 3)), 2.0), rng.normal(size=3), ["a", "b"], [1]]
    assert product.apply(*arguments) == "in Python" and product.counted == 1
    product.learn(*arguments)
    return product, arguments


def test_the_procedure_answers() -> None:
    product, (matrix, x, tags, others) = _learned()
    for scale in (0.5, -0.25, 3.0):
        matrix.scale = scale
        other, y = Matrix(matrix.A.T.copy().T.copy(), 100.0), np.array(x + 1.0)
        answer = product.apply(other, y, list(tags), [None])  # the scale is that of the matrix that was there
        assert np.allclose(product.out, scale * matrix.A @ y, rtol=1e-14)
        assert answer is bool(product.out[0] > 0.0)
        assert product.apply(matrix, x, tags, others) is bool((scale * matrix.A @ x)[0] > 0.0)
    assert product.counted == 1


@pytest.mark.parametrize(
    "change",
    [
        lambda a: a.__setitem__(0, type("Other", (Matrix,), {"__slots__": ()})(a[0].A)),
        lambda a: setattr(a[0], "A", np.asfortranarray(a[0].A)),
        lambda a: setattr(a[0], "A", a[0].A.astype(np.float32)),
        lambda a: setattr(a[0], "A", np.zeros((3, 3))[:2].astype(">f8")),
        lambda a: setattr(a[0], "A", a[0].A.tolist()),
        lambda a: setattr(a[0], "scale", 2),
        lambda a: setattr(a[0], "scale", np.float64(2.0)),
        lambda a: a.__setitem__(1, np.zeros(6)[::2]),
        lambda a: a.__setitem__(1, [1.0, 2.0, 3.0]),
        lambda a: a.__setitem__(1, np.arange(3)),
        lambda a: a[2].__setitem__(1, "c"),
        lambda a: a[2].append("c"),
        lambda a: a[2].clear(),
        lambda a: a.__setitem__(2, ("a", "b")),
        lambda a: a[3].append(2),
        lambda a: a.__setitem__(3, (1,)),
        lambda a: a.pop(),
        lambda a: a.__setitem__(1, np.zeros(3)),  # the procedure returns 2
    ],
)
def test_the_method_answers_where_anything_is_different(change: Any) -> None:
    product, arguments = _learned()
    change(arguments)
    assert product.apply(*arguments) == "in Python" and product.counted == 2


def test_the_method_answers_without_a_table_and_with_names() -> None:
    product, (matrix, x, tags, others) = _learned()
    assert product.apply(matrix, x, tags, others=others) == "in Python"
    product.out = np.zeros(3)[:2]
    product.out.setflags(write=False)
    with pytest.raises(ValueError, match="read-only"):
        product.apply(matrix, x, tags, others)
    product.out, product.calls = np.zeros(2), None
    assert product.apply(matrix, x, tags, others) == "in Python"
    assert type("Derived", (Product,), {})().apply(matrix, x, tags, others) == "in Python"
    with pytest.raises(TypeError):
        Product.apply()  # type: ignore[call-arg]
    with pytest.raises(TypeError):
        product.apply(matrix)  # type: ignore[call-arg]


def test_it_looks_like_the_method() -> None:
    product, arguments = _learned()
    assert inspect.isfunction(Product.apply) and Product.apply.__doc__ == Product().apply.__doc__
    assert list(inspect.signature(product.apply).parameters) == ["matrix", "x", "tags", "others"]
    bound = product.apply
    assert bound(*arguments) in (True, False) and product.counted == 1


def test_what_a_table_leads_to_stays_alive_and_goes_with_it() -> None:
    class Text(str):
        pass

    product, arguments = _learned()
    arguments[2][:] = [Text("a"), Text("b")]
    product.learn(*arguments)
    entry = weakref.ref(arguments[2][0])
    matrix, x, _, others = arguments
    del arguments[2][0], arguments
    gc.collect()
    assert entry() is not None and product.apply(matrix, x, ["a", "b"], others) == "in Python"
    product.calls = product.table = None
    gc.collect()
    assert entry() is None


def test_what_is_no_slot_is_refused() -> None:
    product, arguments = _learned()
    calls = Calls(product.run, (product, *arguments))
    with pytest.raises(InputError, match="no slot"):
        calls.take_float(type("Plain", (), {})(), "scale", product.scale)


class Doubling:
    """Fills an array with another one, times a scale where there is one; calls answer None."""

    __slots__ = ("calls", "counted")

    def __init__(self) -> None:
        self.calls, self.counted = None, 0

    def apply(self, out: Any, x: Any, scale: Any = None) -> None:
        """out = x, or scale x."""
        self.counted += 1


@procedure
def _filled(x: Array1[f64], scale: Array1[f64], out: Array1[f64]) -> int:
    for i in range(len(out)):
        out[i] = scale[0] * x[i]
    return 1


def test_calls_with_other_numbers_of_arguments_have_tables_of_their_own_and_may_return_none() -> None:
    Doubling.apply = procedure_method(Doubling.apply, Doubling, "calls")  # type: ignore[method-assign]
    if not has_machine_code(Doubling, "apply"):
        pytest.skip("needs machine code")
    one, out, x, scale = Doubling(), np.zeros(3), np.arange(3.0), np.array([2.0])
    table, kept = None, []
    for arguments in ((out, x), (out, x, scale)):
        run = _filled.bind(np.zeros(3), np.ones(1), np.zeros(3), are_arrays_private=True)
        calls = Calls(run, (one, *arguments), returns_none=True)
        for k, name in enumerate(("out", "x", "scale")[: len(arguments)], start=1):
            calls.take_array(Slot(k), name, name == "out")
        kept.append(table)
        table, alive = calls.table(table)
        kept.append(alive)
    one.calls = table
    assert one.apply(out, x) is None and out.tolist() == [0.0, 1.0, 2.0]
    assert one.apply(out, x, scale) is None and out.tolist() == [0.0, 2.0, 4.0]
    assert one.counted == 0
    one.apply(out, x[:2])
    one.apply(out, x, None)
    assert one.counted == 2
