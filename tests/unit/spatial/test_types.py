"""What all spatial types share: construction, batches, comparison, text, pickling."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest

from ulna.errors import InputError, ShapeError
from ulna.spatial import SE3, SO3, Force, Inertia, Motion

RNG = np.random.default_rng(1)
SINGLES: list[Any] = [
    SO3.random(RNG),
    SE3.random(RNG),
    Motion([1, 2, 3], [4, 5, 6]),
    Force([1.0, 2.0, 3.0], np.zeros(3)),
    Inertia.from_box(2.0, [1, 2, 3]),
]
BATCHES: list[Any] = [
    SO3.random(RNG, (2, 4)),
    SE3(SO3.random(RNG, (4,)).matrix, RNG.standard_normal((2, 1, 3))),
    Motion(RNG.standard_normal((2, 4, 3)), np.zeros(3)),
    Force(np.zeros((4, 3)), RNG.standard_normal((2, 1, 3))),
    Inertia(np.arange(8.0).reshape(2, 4), np.zeros(3), np.eye(3)),
]


def name(item: Any) -> str:
    return type(item).__name__


@pytest.mark.parametrize("item", SINGLES + BATCHES, ids=name)
def test_copies_are_equal_and_hash_alike(item: Any) -> None:
    for other in (pickle.loads(pickle.dumps(item)), copy.deepcopy(item), copy.copy(item)):
        assert other == item
        assert hash(other) == hash(item)
    assert item != 3


def test_different_numbers_and_types_are_unequal() -> None:
    assert SE3.rx(0.1) != SE3.rx(0.2)
    assert Motion.zero() != Force.zero()
    assert Motion.zero() != Motion.zero((1,))
    assert hash(Motion([0.0, 0, 0], [0, 0, 0])) == hash(Motion([-0.0, 0, 0], [0, 0, 0]))


@pytest.mark.parametrize("item", BATCHES, ids=name)
def test_batches_index_like_arrays(item: Any) -> None:
    dense = np.asarray(item)
    own = dense.shape[2:]
    assert item.batch_shape == (2, 4)
    assert len(item) == 2
    for index in (
        0,
        -1,
        (1, 2),
        slice(1),
        (slice(None), 0),
        [1, 0],
        ...,
        (..., 3),
        (None, 0),
        np.array([True, False]),
    ):
        picked = np.arange(8).reshape(2, 4)[index]
        np.testing.assert_array_equal(np.asarray(item[index]), dense.reshape(8, *own)[picked])
        assert item[index].batch_shape == picked.shape
    assert [part.batch_shape for part in item] == [(4,), (4,)]
    with pytest.raises(IndexError):
        item[0, 0, 0]
    with pytest.raises(IndexError):
        item[5]
    assert item and not item[:0]


@pytest.mark.parametrize("item", SINGLES, ids=name)
def test_singles_have_no_length(item: Any) -> None:
    assert item.batch_shape == ()
    with pytest.raises(TypeError, match="no length"):
        len(item)
    assert item, "is there, as a list of one would be"
    with pytest.raises(IndexError):
        item[0]


@pytest.mark.parametrize("item", SINGLES, ids=name)
def test_stack_makes_a_batch(item: Any) -> None:
    batch = type(item).stack([item, item, item])
    assert batch.batch_shape == (3,)
    assert batch[1] == item
    with pytest.raises(InputError, match="at least one"):
        type(item).stack([])


@pytest.mark.parametrize("item", SINGLES + BATCHES, ids=name)
def test_is_close_to_itself(item: Any) -> None:
    assert np.shape(item.is_close(item)) == item.batch_shape
    assert np.all(item.is_close(item))


def test_is_close_sees_each_of_a_batch() -> None:
    turned = SE3.rx(np.array([0.0, 1e-12, 1e-3]))
    np.testing.assert_array_equal(turned.is_close(SE3.identity()), [True, True, False])
    assert turned.is_close(SE3.identity(), tolerance=1e-2).all()


def test_lists_become_arrays() -> None:
    assert Motion([1, 2, 3], [0, 0, 0]) + Motion([1, 1, 1], [0, 0, 1]) == Motion([2.0, 3, 4], [0, 0, 1.0])
    np.testing.assert_array_equal(SE3([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [1, 2, 3]) @ [1, 1, 1], [2, 3, 4])


def test_instances_are_frozen() -> None:
    with pytest.raises(AttributeError):
        SE3.identity().translation = np.ones(3)  # type: ignore[misc]
    with pytest.raises((AttributeError, TypeError)):
        SE3.identity().colour = "red"  # type: ignore[attr-defined]


def test_text_is_aligned() -> None:
    assert repr(SE3.trans(0.5, -12.25, 1e-17)) == (
        "SE3([[  1.  ,   0.  ,   0.  ,   0.5 ],\n"
        "     [  0.  ,   1.  ,   0.  , -12.25],\n"
        "     [  0.  ,   0.  ,   1.  ,   0.  ],\n"
        "     [  0.  ,   0.  ,   0.  ,   1.  ]])"
    )
    assert repr(Motion([0, 0, -0.0], [0, 0.25, 1])) == (
        "Motion(linear=[0., 0., 0.],\n       angular=[0.  , 0.25, 1.  ])"
    )
    assert repr(Inertia.from_point(2.0)).startswith(
        "Inertia(mass=2.,\n        com=[0., 0., 0.],\n        inertia=[["
    )


def test_text_of_batches() -> None:
    text = repr(SO3.rx(np.zeros(5)))
    assert text.startswith("SO3 batch of shape (5,):\n")
    assert text.endswith("\n  ... 5 in all")
    assert repr(SO3.rx(np.zeros((0,)))) == "SO3 batch of shape (0,):"


def test_text_of_symbols() -> None:
    sympy = pytest.importorskip("sympy")
    assert "cos(q)" in repr(SO3.rz(sympy.Symbol("q")))


def test_numpy_leaves_products_to_the_types() -> None:
    m = Motion([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])
    assert np.float64(2.0) * m == m * 2.0 == m + m
    assert m / 2.0 * 2.0 == m
    batch = np.array([1.0, 2.0]) * m
    assert batch.batch_shape == (2,)
    assert batch[1] == 2.0 * m
    assert np.eye(4) @ SE3.rx(1.0) == SE3.rx(1.0)
    for wrong in (lambda: m + Force.zero(), lambda: m * m, lambda: m / m, lambda: SE3.identity() @ m):
        with pytest.raises(TypeError):
            wrong()  # type: ignore[no-untyped-call]


def test_a_list_of_numbers_is_a_batch() -> None:
    m = Motion([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])
    assert m * [1.0, 2.0, 3.0] == m * np.array([1.0, 2.0, 3.0])
    assert m / (1.0, 2.0) == m / np.array([1.0, 2.0])
    a, b = SE3.rx(1.0) @ SE3.trans(1, 2, 3), SE3.rz(0.5)
    part = np.array([0.0, 0.5, 1.0])
    assert a.interpolate(b, [0, 0.5, 1]) == a.interpolate(b, part)
    assert a.interpolate(b, [0, 0.5, 1], straight=True) == a.interpolate(b, part, straight=True)
    turn, end = SO3(a.rotation), SO3(b.rotation)
    assert turn.interpolate(end, [0, 0.5, 1]) == turn.interpolate(end, part)


def test_equal_batches_are_equal_however_they_are_stored() -> None:
    """A translation without batch axes is that of the whole batch: `SE3.rx(angles)` stores one."""
    turned = SE3.rx([0.1, 0.2])
    stacked = SE3.stack(SE3.rx(angle) for angle in (0.1, 0.2))
    assert turned.translation.shape != stacked.translation.shape
    assert turned == stacked and hash(turned) == hash(stacked)
    assert turned != SE3.rx([0.1, 0.3]) and turned != turned[0] and turned != SE3.rx([[0.1, 0.2]])
    assert SE3.trans([1.0, 2.0], 0.0, 0.0) != turned


def test_what_cannot_be_stacked_is_refused() -> None:
    one, two = SE3.rx([0.1, 0.2]), SE3.rx([0.1, 0.2, 0.3])
    for wrong in ([], None, iter(())):
        with pytest.raises(InputError, match="`items` is empty"):
            SE3.stack(wrong)  # type: ignore[arg-type]
    for wrong in ([np.eye(4)], [one, one.rotation]):
        with pytest.raises(InputError, match="expected objects of SE3 only"):
            SE3.stack(wrong)  # type: ignore[list-item]
    with pytest.raises(ShapeError, match=r"`items` has shape \(3,\)"):
        SE3.stack([one, two])


@pytest.mark.parametrize("kind", [np.int8, np.uint8, np.uint64, bool])
def test_small_whole_numbers_become_floats_and_neither_wrap_nor_lose_their_sign(kind: Any) -> None:
    a, b = np.array([1, 2, 3]).astype(kind), np.array([100, 100, 50]).astype(kind)
    eye, m = np.eye(3).astype(kind), b[0]
    twice: list[Any] = [
        lambda a, b, eye, m: (Motion(a, b) + Motion(b, b)).vector(),
        lambda a, b, eye, m: (-Motion(a, b)).vector(),
        lambda a, b, eye, m: (3 * Force(a, b)).vector(),
        lambda a, b, eye, m: Motion(a, b).cross(Motion(b, a)).vector(),
        lambda a, b, eye, m: Motion(b, b).dot(Force(b, b)),
        lambda a, b, eye, m: (SE3(eye, b) @ SE3(eye, b)).matrix(),
        lambda a, b, eye, m: SE3(eye, b).inverse().matrix(),
        lambda a, b, eye, m: SO3(eye).inverse() @ -SE3(eye, b).translation,
        lambda a, b, eye, m: (Inertia(m, b, eye) + Inertia(m, a, eye)).matrix(),
        lambda a, b, eye, m: Inertia(m, b, eye).apply(Motion(a, b)).vector(),
    ]
    for use in twice:
        floats = use(*(np.asarray(x, dtype=float)[()] for x in (a, b, eye, m)))
        np.testing.assert_array_equal(use(a, b, eye, m), floats)
    pairs = Inertia(np.array([m, m]), np.stack([a, b]), np.stack([eye, eye]))
    assert (pairs + pairs).mass.tolist() == [2.0 * float(m)] * 2
