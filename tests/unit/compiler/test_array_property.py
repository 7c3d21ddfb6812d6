"""Properties that read and assign a part of the array that an object holds, as ordinary properties do."""

from __future__ import annotations

import contextlib
import gc
import os
import pydoc
import sys
import threading
import tracemalloc
import weakref
from typing import Any

import numpy as np
import pytest

from ulna.compiler.runtime.array_property import array_property
from ulna.compiler.runtime.object_layout import fast_call_works, has_gil

native = pytest.mark.skipif(
    not (fast_call_works() and has_gil()), reason="ordinary properties stand for these"
)
PARTS = {
    "block": lambda a: a[:3, :3],
    "column": lambda a: a[:3, 3],
    "row": lambda a: a[1],
    "whole": lambda a: a,
    "first": lambda a: a[0:1, 0].reshape(()),
    "swapped": lambda a: a[:2, 1:4].T,
}
asked: list[str] = []


def ordinary(name: str) -> property:
    """A property as one would write it in Python, which notes that it was asked."""

    def get(self):
        asked.append(name)
        view = PARTS[name](self.array)
        return view if view.ndim else float(view)

    def put(self, value):
        asked.append(name)
        part = PARTS[name](self.array)
        if np.shape(value) != part.shape:
            raise ValueError(f"shape {np.shape(value)}")
        part[...] = value

    return property(get, put, doc=f"The {name}.")


class Plain:
    """Holds one array; its properties are ordinary ones."""

    __slots__ = ("array",)

    def __init__(self, array: Any = None) -> None:
        self.array = np.arange(16.0).reshape(4, 4) if array is None else array


class Holder(Plain):
    """Holds one array; its properties are those of this module."""

    __slots__ = ()


class Derived(Holder):
    __slots__ = ()


for _name, _part in PARTS.items():
    setattr(Plain, _name, ordinary(_name))
    setattr(Holder, _name, array_property(getattr(Plain, _name), Holder, (4, 4), _part))


def outcome(kind: type, name: str, array: Any, value: Any) -> Any:
    """What an assignment leads to: the array afterwards, or the class and text of the error."""
    one = kind(array)
    try:
        setattr(one, name, value)
    except Exception as error:
        return type(error), str(error)
    return one.array.tobytes()


@pytest.mark.parametrize("name", PARTS)
def test_reading_gives_what_a_slice_gives(name: str) -> None:
    for array in (np.random.default_rng(0).normal(size=(4, 4)), np.zeros((9, 4, 4))[3]):
        for writes in (True, False):
            array.flags.writeable = writes
            one, other = getattr(Plain(array), name), getattr(Holder(array), name)
            assert type(one) is type(other)
            if name != "first":
                assert (one.shape, one.strides, one.dtype) == (other.shape, other.strides, other.dtype)
                assert one.__array_interface__["data"] == other.__array_interface__["data"]
                assert other.base is one.base or name == "whole"
                assert one.flags.num == other.flags.num or name == "whole"
            np.testing.assert_array_equal(one, other)


@native
def test_reads_and_usual_assignments_run_no_python() -> None:
    one = Holder()
    asked.clear()
    for name in PARTS:
        setattr(one, name, getattr(one, name))
    one.first = np.float64(2.0)
    one.block = np.asfortranarray(np.ones((3, 3)))[::-1]
    assert asked == [] and one.block.tolist() == np.ones((3, 3)).tolist()
    one.first = 3
    one.column = [1, 2, 3]
    assert asked == ["first", "column"]


@pytest.mark.parametrize("name", PARTS)
def test_assigning_does_what_the_ordinary_property_does(name: str) -> None:
    shape, rng = PARTS[name](np.zeros((4, 4))).shape, np.random.default_rng(1)
    plain = rng.normal(size=shape)
    wide = rng.normal(size=[2 * n for n in shape])
    values = [
        plain,
        plain * np.nan,
        np.full(shape, -np.inf),
        -0.0 * plain,
        5e-324 * np.ones(shape),
        plain.astype(np.float32),
        np.ones(shape, int),
        np.ones(shape, bool),
        np.asfortranarray(plain),
        wide[tuple(slice(None, None, 2) for _ in shape)],
        plain[tuple(slice(None, None, -1) for _ in shape)],
        np.broadcast_to(2.0, shape),
        plain.astype(">f8"),
        plain.tolist(),
        plain.view(np.matrix) if len(shape) == 2 else plain,
        np.ma.masked_array(plain),
        plain.astype(complex),
        plain.astype(object),
        np.zeros((*shape, 2)),
        np.zeros(0),
        np.zeros((7, 7)),
        *(None, "text", (), {}, object(), 1, 2.5, np.float64(3.5), np.float32(3.5), True),
    ]
    readable = plain.copy()
    readable.flags.writeable = False
    shifted = np.frombuffer(bytearray(8 * plain.size + 1), dtype=float, offset=1).reshape(
        shape
    )  # not aligned
    for value in [*values, readable, shifted]:
        for make in (np.zeros, lambda s: np.zeros((3, *s))[1], lambda s: np.zeros(s, order="F")):
            arrays = [make((4, 4)) for _ in range(2)]
            with np.errstate(all="ignore"):
                a, b = (
                    outcome(kind, name, x, value) for kind, x in zip((Plain, Holder), arrays, strict=True)
                )
            assert a == b, (name, value)


@pytest.mark.parametrize(
    "held",
    [
        np.zeros((4, 4), np.float32),
        np.zeros((4, 5)),
        np.zeros(16),
        None,
        "text",
        np.zeros((4, 4)).astype(">f8"),
    ],
)
def test_other_things_in_the_slot_are_left_to_python(held: Any) -> None:
    for name, part in PARTS.items():
        value = np.ones(part(np.zeros((4, 4))).shape) if name != "first" else 1.0
        results = []
        for kind in (Plain, Holder):
            one = kind.__new__(kind)
            one.array = held.copy() if hasattr(held, "copy") else held
            try:
                setattr(one, name, value)
                results.append(np.array(getattr(one, name)).tolist())
            except Exception as error:
                results.append((type(error), str(error)))
        assert results[0] == results[1]
    empty = Holder.__new__(Holder)
    for access in (lambda: empty.block, lambda: setattr(empty, "block", np.eye(3))):
        with pytest.raises(AttributeError):
            access()


def test_arrays_that_cannot_be_written_to_refuse() -> None:
    array = np.zeros((4, 4))
    array.flags.writeable = False
    one = Holder(array)
    for name, part in PARTS.items():
        with pytest.raises(ValueError, match="read-only"):
            setattr(one, name, np.ones(part(array).shape) if name != "first" else 1.0)
    assert not array.any() and not one.block.flags.writeable


def test_overlapping_parts_are_read_before_they_are_written() -> None:
    one = Holder()
    one.block = one.block.T
    assert one.block.tolist() == Plain().block.T.tolist()
    one.row = one.row[::-1]
    assert one.row.tolist()[::-1] == [1.0, 5.0, 9.0, 7.0]
    one.whole = one.whole.T
    one.column = one.row[:3]
    assert one.column.tolist() == one.array[:3, 3].tolist()


def test_attributes_cannot_be_deleted() -> None:
    one = Holder()
    for name in PARTS:
        with pytest.raises(AttributeError, match="deleter"):
            delattr(one, name)
    assert one.block.shape == (3, 3)


def test_derived_classes_and_subclasses_of_arrays_are_left_to_python() -> None:
    class Array(np.ndarray):
        pass

    asked.clear()
    derived = Derived()
    derived.column = np.ones(3)
    assert derived.column.tolist() == [1.0, 1.0, 1.0] and asked == ["column", "column"]
    one = Holder(np.zeros((4, 4)).view(Array))
    one.block = np.eye(3)
    assert type(one.block) is Array and asked[2:] == ["block", "block"]
    with pytest.raises(AttributeError):
        Holder.block.__set__(3, np.eye(3))  # type: ignore[attr-defined]
    with pytest.raises(AttributeError):
        Holder.block.__get__("text")  # type: ignore[attr-defined]


def test_it_is_a_property() -> None:
    member: Any = Holder.__dict__["block"]
    assert isinstance(member, property) and Holder.block is member  # type: ignore[attr-defined]
    assert member.__doc__ == "The block." and member.fget is Plain.block.fget  # type: ignore[attr-defined]
    assert "The block." in pydoc.render_doc(Holder)
    assert member.__get__(None, Holder) is member
    for make in (type(member), property.__new__):
        with pytest.raises(TypeError):
            make(type(member)) if make is property.__new__ else make(None)


def test_parts_that_do_not_fit_are_refused() -> None:
    if not (fast_call_works() and has_gil()):
        pytest.skip("ordinary properties stand for these")
    for part in (lambda a: a.copy(), lambda a: a.reshape(2, 2, 4)):
        with pytest.raises(ValueError, match="expected a view"):
            array_property(ordinary("block"), Holder, (4, 4), part)


def test_nothing_leaks() -> None:
    one, value, array = Holder(), np.eye(3), np.zeros((4, 4))
    one.array = array
    descriptor = np.dtype(float)
    wrong = np.eye(2)

    def work(count: int) -> None:
        for _ in range(count):
            one.block = value
            one.first = 2.5
            one.column = one.column
            one.block = one.block
            one.whole.sum()
            with contextlib.suppress(ValueError):
                one.block = wrong

    work(100)
    asked.clear()
    counted = [sys.getrefcount(x) for x in (one, value, array, wrong)]
    of_descriptor = sys.getrefcount(descriptor)
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    work(2000)
    asked.clear()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert [sys.getrefcount(x) for x in (one, value, array, wrong)] == counted
    assert abs(sys.getrefcount(descriptor) - of_descriptor) < 50 and grown < 20_000


def test_views_keep_the_array_and_nothing_else() -> None:
    one = Holder(np.random.default_rng(2).normal(size=(4, 4)))
    wanted, block, column = one.array.copy(), one.block, one.column
    gone = weakref.ref(one.array)
    one.array = np.zeros((4, 4))
    assert gone() is not None
    del one
    gc.collect()
    np.testing.assert_array_equal(block, wanted[:3, :3])
    np.testing.assert_array_equal(column, wanted[:3, 3])
    del block, column
    gc.collect()
    assert gone() is None


def test_threads_that_replace_the_array_meanwhile() -> None:
    one, stop = Holder(np.full((4, 4), 1.0)), threading.Event()
    ones, wrong = np.ones((3, 3)), []

    def replace() -> None:
        while not stop.is_set():
            one.array = np.full((4, 4), 1.0)
            one.array = np.ones((4, 4), np.float32)

    def use() -> None:
        for _ in range(20_000):
            one.block = ones
            if one.block.sum() != 9.0 or one.first != 1.0:
                wrong.append(one.array)

    replacing = threading.Thread(target=replace)
    users = [threading.Thread(target=use) for _ in range(3)]
    for thread in (replacing, *users):
        thread.start()
    for thread in users:
        thread.join()
    stop.set()
    replacing.join()
    asked.clear()
    assert not wrong


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks")
def test_forked_children_read_and_assign() -> None:
    one = Holder()
    child = os.fork()
    if not child:
        one.block = np.full((3, 3), 7.0)
        os._exit(0 if one.block.sum() == 63.0 and one.first == 7.0 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert one.first == 0.0
