"""Products of matrices by machine code: of every size what NumPy says, and nothing beside the matrix is written."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def product() -> Iterator[Any]:
    with using("pinocchio"):
        yield importlib.import_module("pinocchio._constraints._procedures.product")


@pytest.mark.parametrize("m", [1, 3, 4, 5, 12, 30, 50])
@pytest.mark.parametrize("n", [0, 1, 9])
@pytest.mark.parametrize("k", [0, 1, 15, 16, 17, 36, 76])
def test_products_are_those_of_numpy(m: int, n: int, k: int, product: Any) -> None:
    rng = np.random.default_rng(m + 100 * k)
    A, B, store = rng.normal(size=(m, n)), rng.normal(size=(n, k)), np.full((m + 2, k), 7.0)
    C = store[1:-1]
    multiply = product.bound_product(A, B, C)
    for _ in range(2):
        multiply()
        np.testing.assert_allclose(C, A @ B, rtol=0.0, atol=1e-13)
        A[:] = rng.normal(size=(m, n))
    assert (store[[0, -1]] == 7.0).all()
    if n and m >= product.ROWS and k >= product.COLUMNS:
        product.multiply.checked(A, B, C)
        np.testing.assert_allclose(C, A @ B, rtol=0.0, atol=1e-13)
