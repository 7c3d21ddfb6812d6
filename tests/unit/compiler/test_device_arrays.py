"""Arrays in a GPU's memory: their strides, and what is said of those that a kernel cannot take."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from ulna.compiler import Port
from ulna.compiler.language.ports import batch_shape
from ulna.compiler.runtime.cuda_kernel import view_of
from ulna.compiler.runtime.device_arrays import DeviceArray, check_array, dense_strides, two_strides
from ulna.errors import DtypeError, InputError, ShapeError

MATRIX, VECTOR = Port("T", (4, 4)), Port("q", (7,))


def described(x: np.ndarray, device: int = 0) -> DeviceArray:
    """A NumPy array's layout, as if it were on a GPU."""
    strides = tuple(s // x.itemsize for s in x.strides)
    return DeviceArray(x.ctypes.data, x.shape, strides, x.dtype.name, device, not x.flags.writeable, x)


def _loaded_value(x: np.ndarray, port: Port, batch: tuple[int, ...]) -> Any:
    """Each sample's numbers, by the strides, out of the memory that `x` is a view of."""
    sample, number = two_strides(port, described(x), batch)
    whole = np.lib.stride_tricks.as_strided(
        x, (int(np.prod(batch)), int(np.prod(port.shape))), (8 * sample, 8 * number)
    )
    return whole.reshape(*batch, *port.shape)


FLAT = np.arange(7.0 * 30).reshape(30, 7)


@pytest.mark.parametrize(
    ("array", "batch"),
    [
        (FLAT, (30,)),
        (FLAT.reshape(5, 6, 7), (5, 6)),
        (FLAT[::3], (10,)),
        (FLAT.T.copy().T, (30,)),
        (FLAT.T.copy().T.reshape(5, 6, 7), (5, 6)),
        (FLAT[0], (30,)),
        (FLAT[:1], (30,)),
        (FLAT[0], (5, 6)),
        (FLAT[:, None], (30, 1)),
        (np.broadcast_to(FLAT[0], (4, 7)), (4,)),
        (FLAT[::-1], (30,)),
    ],
)  # fmt: skip
def test_two_strides_reach_every_number(array: np.ndarray, batch: tuple[int, ...]) -> None:
    np.testing.assert_array_equal(_loaded_value(array, VECTOR, batch), np.broadcast_to(array, (*batch, 7)))


def test_matrices_of_a_transposed_array() -> None:
    x = np.arange(16.0 * 6).reshape(16, 6)
    np.testing.assert_array_equal(_loaded_value(x.T.reshape(6, 4, 4), MATRIX, (6,)), x.T.reshape(6, 4, 4))


@pytest.mark.parametrize(
    ("array", "port", "batch", "which"),
    [
        (np.zeros((3, 4, 7))[:, :2], VECTOR, (3, 2), "leading axes"),
        (np.zeros((4, 7)), VECTOR, (3, 4), "leading axes"),
        (np.zeros((3, 1, 7)), VECTOR, (3, 4), "leading axes"),
        (np.zeros((3, 4, 4)).transpose(0, 2, 1), MATRIX, (3,), "last axes"),
    ],
)
def test_others_are_refused_with_advice(array: np.ndarray, port: Port, batch: Any, which: str) -> None:
    with pytest.raises(InputError, match=rf"whose {which} cannot be counted.*contiguous\(\) makes one"):
        two_strides(port, described(array), batch)


def test_dense_strides_are_those_of_numpy() -> None:
    for shape in itertools.chain([()], itertools.product((1, 2, 3), repeat=3)):
        assert dense_strides(shape) == tuple(s // 8 for s in np.zeros(shape).strides)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"`q` is in the memory of the CPU; .* tensor.cuda\(\)"):
        check_array(VECTOR, described(FLAT, device=-1), "float64", 0)
    with pytest.raises(InputError, match="`q` is on GPU 1; expected GPU 0"):
        check_array(VECTOR, described(FLAT, device=1), "float64", 0)
    with pytest.raises(DtypeError, match=r"has dtype float64; expected float32. .*dtype='float64'\)"):
        check_array(VECTOR, described(FLAT), "float32", 0)
    with pytest.raises(ShapeError, match=r"`q` has shape \(7, 30\); expected \(\.\.\., 7\)"):
        check_array(VECTOR, described(FLAT.T.copy()), "float64", 0)
    with pytest.raises(ShapeError, match="leading axes that broadcast"):
        batch_shape([VECTOR, VECTOR], [described(FLAT).shape, described(FLAT[:2]).shape])
    check_array(VECTOR, described(FLAT), "float64", 0)
    assert batch_shape([VECTOR, VECTOR], [described(FLAT).shape, described(FLAT[0]).shape]) == (30,)


def test_arrays_of_libraries_are_described() -> None:
    pytest.importorskip("cuda.core")
    array = view_of(FLAT[::2], "q")
    assert (array.shape, array.strides, array.dtype, array.device) == ((15, 7), (14, 1), "float64", -1)
    assert array.address == FLAT.ctypes.data

    class OnDevice:
        __cuda_array_interface__ = {  # noqa: RUF012
            "shape": (3, 7), "strides": None, "typestr": "<f4", "data": (4096, True), "version": 3, "stream": None
        }  # fmt: skip

    with pytest.raises(InputError, match="`q` is of type list; expected an array on the GPU"):
        view_of([0.0] * 7, "q")
