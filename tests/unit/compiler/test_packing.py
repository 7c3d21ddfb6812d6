"""Kernels whose matrices are packed: the same numbers as in whole matrices, at the places that the pattern has."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna.compiler import compile, trace
from ulna.errors import InputError, NonFiniteError, ShapeError


def _matrices(x):
    """A symmetric matrix with zeros, a vector, one of other shape with zeros, one that is zero at some inputs only."""
    a, b, c = x
    zero = 0.0 * a
    symmetric = np.array([[a * b, zero, c], [zero, np.sin(a), b + c], [c, b + c, zero]])
    wide = np.array([[a, zero, zero, b * c], [zero, zero, c, 1.0 + zero]])
    return symmetric, np.array([a, zero]), wide, np.array([[a - b, b], [c, a]])


FUNCTION = trace(_matrices, x=(3,))


@pytest.fixture(scope="module")
def kernel():
    return compile(FUNCTION)


@pytest.mark.parametrize("zeros", [False, True])
@pytest.mark.parametrize("batch", [(), (1,), (5,), (3, 7)])
def test_packed_entries_are_those_of_the_whole_matrices(kernel, zeros, batch):
    x = np.random.default_rng(1).uniform(-1, 1, (*batch, 3))
    packed, patterns = kernel.packed(zeros), kernel.pattern(zeros)
    for values, pattern, whole in zip(packed(x), patterns, kernel(x), strict=True):
        if pattern is None:
            np.testing.assert_array_equal(values, whole)
            continue
        assert values.shape == (*batch, pattern.count)
        np.testing.assert_array_equal(values, whole[..., pattern.rows, pattern.columns])
        np.testing.assert_array_equal(pattern.unpack(values), whole)


def test_patterns_have_the_nonzeros_column_by_column(kernel):
    symmetric, vector, wide, general = kernel.pattern()
    assert vector is None
    assert (symmetric.shape, symmetric.is_symmetric) == ((3, 3), True)
    assert list(zip(symmetric.rows, symmetric.columns, strict=True)) == [(0, 0), (2, 0), (1, 1), (2, 1)]
    assert symmetric.starts.tolist() == [0, 2, 4, 4]
    assert list(zip(wide.rows, wide.columns, strict=True)) == [(0, 0), (1, 2), (0, 3), (1, 3)]
    assert wide.starts.tolist() == [0, 1, 1, 2, 4]
    assert not wide.is_symmetric and not general.is_symmetric
    assert general.count == 4  # a - b is zero only where a is b
    assert repr(symmetric) == "<pattern of a symmetric 3 x 3 matrix, 4 entries stored>"


def test_with_zeros_symmetric_matrices_are_in_packed_storage_of_lapack(kernel):
    from scipy.linalg import get_lapack_funcs

    robot = ulna.load("panda")
    mass = robot.kernel("mass_matrix")
    q = robot.configurations["ready"]
    (cholesky,) = get_lapack_funcs(("pptrf",), dtype=np.float64)  # reads that storage
    factor, info = cholesky(7, mass.packed(zeros=True)(q), lower=1)
    assert info == 0
    L = np.zeros((7, 7))
    columns, rows = np.triu_indices(7)
    L[rows, columns] = factor
    np.testing.assert_allclose(L @ L.T, mass(q), rtol=0, atol=1e-14)


def test_patterns_are_those_of_compressed_columns(kernel):
    from scipy.sparse import csc_array

    x = np.array([0.2, -0.4, 0.7])
    pattern = kernel.pattern()[2]
    whole = csc_array((kernel.packed()(x)[2], pattern.rows, pattern.starts), pattern.shape)
    np.testing.assert_array_equal(whole.toarray(), kernel(x)[2])


def test_packed_kernels_are_kernels(kernel):
    x = np.random.default_rng(2).uniform(-1, 1, (40, 3))
    packed = kernel.packed()
    expected = packed(x)
    out = tuple(np.full_like(values, np.nan) for values in expected)
    packed(x, out=out, threads=2)
    again = pickle.loads(pickle.dumps(packed))
    for values, wanted, copied in zip(out, expected, again(x), strict=True):
        np.testing.assert_array_equal(values, wanted)
        np.testing.assert_array_equal(copied, wanted)
    single = compile(FUNCTION, "float32").packed()
    assert single.dtype == np.float32 and single(x)[0].dtype == np.float32
    np.testing.assert_allclose(single(x)[0], expected[0], rtol=1e-5, atol=1e-6)


def test_a_packed_kernel_checks_its_inputs_as_before():
    checked = compile(FUNCTION, checked=True).packed()
    with pytest.raises(NonFiniteError):
        checked(np.array([0.0, np.nan, 0.0]))


@pytest.mark.parametrize("name", ["mass_matrix", "inverse_mass_matrix", "coriolis_matrix"])
def test_matrices_of_a_tree_are_sparse(name):
    kinds = ("revolute", "prismatic")
    model = random_model(np.random.default_rng(3), kinds, 6, root="free_flyer", mimics=0, branching=0.6)
    robot, rng = ulna.Robot(model), np.random.default_rng(3)
    whole = robot.kernel(name)
    inputs = [np.array([robot.random_configuration(seed=k) for k in range(9)])]
    inputs += [rng.uniform(-1, 1, (9, port.size)) for port in whole.function.inputs[1:]]
    pattern = whole.pattern()
    expected = whole(*inputs)
    assert pattern.is_symmetric == (name != "coriolis_matrix")
    assert pattern.count < expected[0].size
    np.testing.assert_allclose(
        pattern.unpack(whole.packed()(*inputs)), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
    )


def test_an_invalid_matrix_is_refused():
    with pytest.raises(InputError, match=r"returns out \(3,\); expected a matrix among its outputs"):
        compile(np.sin, x=(3,)).packed()
    with pytest.raises(InputError, match="expected a matrix"):
        trace(np.sin, x=(3,)).pattern()


def test_values_of_another_size_are_refused(kernel):
    with pytest.raises(ShapeError, match=r"\(\.\.\., 4\)"):
        kernel.pattern()[0].unpack(np.zeros((2, 5)))
