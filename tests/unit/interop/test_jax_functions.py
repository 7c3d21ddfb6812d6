"""Kernels as JAX functions: values, jit, vmap, derivatives of every order, sizes of batches, refusals."""

from __future__ import annotations

import itertools
import pickle
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import numeric
from ulna.errors import DtypeError, InputError, ShapeError, TraceError
from ulna.interop import to_jax

jax = pytest.importorskip("jax")
jnp = jax.numpy

ROBOT = ulna.load("panda")
Q = ROBOT.random_configuration(5, seed=1)
V = np.random.default_rng(1).normal(size=(5, 7))


@pytest.fixture(autouse=True)
def _float64() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_values_are_those_of_the_kernel_bit_for_bit(dtype: str) -> None:
    fk, kernel = to_jax(ROBOT.kernel("fk")), ROBOT.kernel("fk", dtype=dtype)
    for q in (Q.astype(dtype), Q[0].astype(dtype), Q.astype(dtype).reshape(5, 1, 7), Q[:0].astype(dtype)):
        for f in (fk, jax.jit(fk)):
            T = f(q)
            assert T.dtype == dtype
            np.testing.assert_array_equal(T, kernel(q))


def test_batch_axes_broadcast_and_several_outputs() -> None:
    inverse = to_jax(ROBOT.kernel("inverse_dynamics"))
    expected = ROBOT.inverse_dynamics(Q, V, np.ones(7))
    np.testing.assert_array_equal(inverse(Q, V, np.ones(7)), expected)
    np.testing.assert_array_equal(inverse(Q[:, None], V, np.ones(7))[2, 3], inverse(Q[2], V[3], np.ones(7)))
    both = to_jax(ulna.compile(lambda q: (q * q, q[0]), q=(2,)))
    squares, first = jax.jit(both)(np.array([[1.0, 2.0], [3.0, 4.0]]))
    assert squares.tolist() == [[1, 4], [9, 16]] and first.tolist() == [1, 3]


def test_types_follow_the_arguments() -> None:
    fk = to_jax(ROBOT.kernel("fk"))
    assert fk([0] * 7).dtype == np.float64
    assert fk(Q.astype(np.float16)).dtype == np.float32
    inverse = to_jax(ROBOT.kernel("inverse_dynamics"))
    assert inverse(Q.astype(np.float32), V, V).dtype == np.float64
    with jax.enable_x64(False):
        assert fk(Q).dtype == np.float32


def test_vmap_over_any_axis() -> None:
    inverse = to_jax(ROBOT.kernel("inverse_dynamics"))
    a = np.zeros(7)
    expected = ROBOT.inverse_dynamics(Q, V, a)
    np.testing.assert_array_equal(jax.vmap(inverse, (0, 0, None))(Q, V, a), expected)
    np.testing.assert_array_equal(jax.jit(jax.vmap(inverse, (1, 0, None), 1))(Q.T, V, a), expected.T)
    pairs = jax.vmap(jax.vmap(inverse, (None, 0, None)), (0, None, None))(Q, V, a)
    np.testing.assert_array_equal(pairs[1, 2], inverse(Q[1], V[2], a))


@pytest.mark.parametrize(
    ("name", "count"), [("fk", 1), ("jacobian", 1), ("inverse_dynamics", 3), ("forward_dynamics", 3)]
)
def test_derivatives_equal_finite_differences(name: str, count: int) -> None:
    from jax.test_util import check_grads

    f = to_jax(ROBOT.kernel(name))
    arguments = (Q[:2], V[:2], np.ones(7))[:count]
    size = float(jnp.abs(f(*arguments)).max())
    check_grads(lambda *x: f(*x) / size, arguments, order=1, rtol=1e-4, atol=1e-4)


def _agree(modes: Sequence[Any]) -> None:
    """Whether derivatives that are nested so are those of JAX's own functions."""
    f = to_jax(ulna.compile(lambda q, x: np.sin(q[0]) * x * x + q[1] ** 3 * x, q=(2,), x=()))
    arguments = jnp.array([0.3, -0.7]), jnp.array(1.7)
    ours: Any = f
    theirs: Any = lambda q, x: jnp.sin(q[0]) * x * x + q[1] ** 3 * x  # noqa: E731
    for mode in modes:
        ours, theirs = mode(ours, (0, 1)), mode(theirs, (0, 1))
    jax.tree.map(
        lambda a, b: np.testing.assert_allclose(a, b, atol=1e-13), ours(*arguments), theirs(*arguments)
    )


@pytest.mark.parametrize("second", ["jacfwd", "jacrev"])
@pytest.mark.parametrize("first", ["jacfwd", "jacrev"])
def test_second_derivatives_in_every_mode(first: str, second: str) -> None:
    _agree([getattr(jax, first), getattr(jax, second)])


@pytest.mark.slow
@pytest.mark.parametrize("modes", list(itertools.product(["jacfwd", "jacrev"], repeat=3)), ids="-".join)
def test_third_derivatives_in_every_mode(modes: tuple[str, ...]) -> None:
    _agree([getattr(jax, name) for name in modes])


def test_derivatives_in_batches_and_along_tangents() -> None:
    fk = to_jax(ROBOT.kernel("fk"))
    J = ROBOT.kernel("fk").jacobian()(Q)
    np.testing.assert_allclose(jax.vmap(jax.jacrev(fk))(Q), J, atol=1e-14)
    np.testing.assert_allclose(jax.jit(jax.vmap(jax.jacfwd(fk)))(Q), J, atol=1e-14)
    y, along = jax.linearize(fk, Q[0])
    np.testing.assert_allclose(along(V[0]), J[0] @ V[0], atol=1e-14)
    np.testing.assert_array_equal(y, ROBOT.fk(Q[0]))


def test_it_works_inside_of_loops_and_checkpoints() -> None:
    forward = to_jax(ROBOT.kernel("forward_dynamics"))

    def fall(q: Any) -> Any:
        def step(state: Any, _: Any) -> Any:
            q, v = state
            v = v + 1e-3 * forward(q, v, jnp.zeros(7))
            return (q + 1e-3 * v, v), None

        return jax.lax.scan(jax.checkpoint(step), (q, jnp.zeros(7)), None, length=5)[0][0].sum()

    g = jax.jit(jax.grad(fall))(Q[0])
    step = 1e-6 * np.eye(7)
    differences = [(fall(Q[0] + h) - fall(Q[0] - h)) / 2e-6 for h in step]
    np.testing.assert_allclose(g, differences, rtol=1e-6, atol=1e-8)


def test_derivatives_pass_through_loops_of_the_function() -> None:
    """JAX transposes forward derivatives, which Ulna does not offer for loops: the reverse one takes their place."""

    def swing(x: Any, a: Any) -> Any:
        def body(i: Any, y: Any, z: Any) -> Any:
            return i + 1.0, np.sin(y) * a + z, y

        return numeric.loop(lambda i, y, z: i < 5.0, body, (0.0, x[0], x[1]), 9)[1]

    kernel = ulna.compile(swing, x=(2,), a=())
    f, x, a = to_jax(kernel), jnp.array([[0.3, 0.4], [-0.6, 0.1]]), 0.7
    np.testing.assert_allclose(jax.vmap(jax.grad(f), (0, None))(x, a), kernel.jacobian()(x, a), rtol=1e-14)
    slopes = jax.jit(jax.jacrev(f, (0, 1)))(x[0], a)
    np.testing.assert_allclose(slopes[0], kernel.jacobian()(x[0], a), rtol=1e-14)
    np.testing.assert_allclose(slopes[1], kernel.jacobian("a")(x[0], a), rtol=1e-14)
    np.testing.assert_allclose(jax.grad(f, 1)(x[0], a), kernel.jacobian("a")(x[0], a), rtol=1e-14)
    np.testing.assert_allclose(jax.hessian(f)(x[0], a), kernel.hessian()(x[0], a), rtol=1e-13)
    y, back = jax.vjp(f, x[0], a)
    np.testing.assert_allclose(back(2.0 * jnp.ones_like(y))[0], 2.0 * slopes[0], rtol=1e-14)
    with pytest.raises(TraceError, match="Take the second derivative forward"):
        jax.jacrev(jax.jacrev(f))(x[0], a)


def test_equal_functions_share_their_code() -> None:
    from ulna.interop import jax_functions

    f, g = (to_jax(ulna.compile(lambda x: 3.0 * x + 0.125, x=(3,))) for _ in range(2))
    before = len(jax_functions._targets)
    f(np.ones(3)), g(np.ones(3))
    assert len(jax_functions._targets) == before + 1


def test_it_is_pickled_and_shown() -> None:
    f = pickle.loads(pickle.dumps(to_jax(ROBOT.kernel("fk"))))
    np.testing.assert_array_equal(f(Q), ROBOT.fk(Q))
    assert repr(f) == "<JAX function fk(7)->(4,4)>"


def test_kernels_take_arrays_and_say_which_function_is_for_transformations() -> None:
    kernel = ROBOT.kernel("fk")
    np.testing.assert_array_equal(kernel(jnp.asarray(Q)), ROBOT.fk(Q))
    for call in (kernel, ROBOT.fk):
        with pytest.raises(
            InputError, match=r"`q` is a .*Tracer of jax that .* ulna.interop.to_jax\(kernel\)"
        ):
            jax.jit(call)(Q)


def test_refusals_say_what_to_do() -> None:
    f = to_jax(ROBOT.kernel("inverse_dynamics"))
    with pytest.raises(ShapeError, match=r"`v` has shape \(5, 6\); expected \(\.\.\., 7\)"):
        f(Q, V[:, :6], V)
    with pytest.raises(ShapeError, match="leading axes that broadcast"):
        jax.jit(f)(Q, V[:2], V)
    with pytest.raises(DtypeError, match=r"`q` has dtype complex128; expected real numbers"):
        f(Q + 0j, V, V)
    with pytest.raises(TypeError, match=r"takes 3 arguments; 1 were given"):
        f(Q)
    with pytest.raises(InputError, match="expected a kernel"):
        to_jax("fk")
