"""Kernels as PyTorch functions: values, derivatives of every kind by finite differences, zero copies, refusals."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import ulna
from ulna.errors import DtypeError, InputError, ShapeError
from ulna.interop import to_torch

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.filterwarnings("ignore::FutureWarning", "ignore::UserWarning")

ROBOT = ulna.load("panda")
Q = torch.tensor(ROBOT.random_configuration(3, seed=1))


@pytest.fixture(autouse=True)
def _seed() -> None:
    torch.manual_seed(1)


def _random(*shape: int, grad: bool = True) -> torch.Tensor:
    return torch.randn(shape, dtype=torch.float64, requires_grad=grad)


@pytest.mark.parametrize("dtype", [torch.float64, torch.float32])
def test_values_are_those_of_the_kernel_bit_for_bit(dtype: torch.dtype) -> None:
    fk = to_torch(ROBOT.kernel("fk"))
    name = str(dtype).removeprefix("torch.")
    T = fk(Q.to(dtype))
    assert T.dtype == dtype and T.shape == (3, 4, 4)
    assert (T.numpy() == ROBOT.kernel("fk", dtype=name)(Q.to(dtype).numpy())).all()
    assert fk(Q[0].to(dtype)).shape == (4, 4)
    assert fk(Q.to(dtype)[:, None].expand(3, 2, 7)).shape == (3, 2, 4, 4)  # strides of zero


@pytest.mark.parametrize(
    ("name", "count"), [("fk", 1), ("jacobian", 1), ("inverse_dynamics", 3), ("forward_dynamics", 3), ("mass_matrix", 1)]
)  # fmt: skip
def test_derivatives_equal_finite_differences(name: str, count: int) -> None:
    f = to_torch(ROBOT.kernel(name))
    arguments = (Q[:2].clone().requires_grad_(), _random(2, 7), _random(7))[:count]  # the last is broadcast
    # A joint acceleration is large: relative to it, finite differences keep seven digits.
    size = 1e-6 * max(1.0, float(f(*arguments).detach().abs().max()) ** 2)
    assert torch.autograd.gradcheck(f, arguments, atol=10.0 * size, check_forward_ad=True, fast_mode=True)


def test_second_derivatives_and_those_by_some_inputs_only() -> None:
    f = to_torch(ulna.compile(lambda q, x: np.sin(q[0]) * x * x + q[1] ** 3, q=(2,), x=()))
    q, x = _random(4, 2), _random(4)
    assert torch.autograd.gradcheck(f, (q, x), check_forward_ad=True)
    assert torch.autograd.gradgradcheck(f, (q, x))
    assert torch.autograd.gradcheck(f, (q, x.detach()))
    assert torch.autograd.gradcheck(f, (q, _random()))  # a number for all samples


def test_a_derivative_of_float32_stays_float32() -> None:
    q = Q.float().requires_grad_()
    (g,) = torch.autograd.grad(to_torch(ROBOT.kernel("fk"))(q)[..., :3, 3].sum(), q)
    J = ROBOT.kernel("fk").jacobian()(Q.numpy())[..., :3, 3, :].sum(axis=1)
    assert g.dtype == torch.float32
    np.testing.assert_allclose(g.numpy(), J, atol=1e-5)


def test_several_outputs_of_which_one_is_used() -> None:
    f = to_torch(ulna.compile(lambda q: (q * q, np.sin(q)), q=(3,)))
    q = _random(3)
    squares, _ = f(q)
    (g,) = torch.autograd.grad(squares.sum(), q)
    assert torch.equal(g, 2.0 * q)


def test_transformations_of_torch_func() -> None:
    func = torch.func
    fk, inverse = to_torch(ROBOT.kernel("fk")), to_torch(ROBOT.kernel("inverse_dynamics"))
    v, a = _random(3, 7, grad=False), _random(7, grad=False)
    assert torch.equal(func.vmap(fk, in_dims=1)(Q.T), fk(Q))
    expected = inverse(Q, v, a)
    assert torch.equal(func.vmap(inverse, in_dims=(0, 0, None))(Q, v, a), expected)
    nested = func.vmap(func.vmap(inverse, in_dims=(None, 0, None)), in_dims=(0, None, None))(Q, v, a)
    assert torch.equal(nested[1, 1], inverse(Q[1], v[1], a))
    # One batched argument has a batch axis besides, the other has not.
    mixed = func.vmap(inverse, in_dims=(0, 0, None))(Q, v[:, None].expand(3, 2, 7), a)
    assert torch.equal(mixed[:, 1], expected)
    J = ROBOT.kernel("fk").jacobian()(Q[0].numpy())
    np.testing.assert_allclose(func.jacrev(fk)(Q[0]), J, atol=1e-14)
    np.testing.assert_allclose(func.jacfwd(fk)(Q[0]), J, atol=1e-14)

    def height(q: torch.Tensor) -> torch.Tensor:
        return fk(q)[2, 3]

    H = func.hessian(height)(Q[0])
    torch.testing.assert_close(H, H.T)
    torch.testing.assert_close(H, func.jacrev(func.jacrev(height))(Q[0]))


def test_the_result_shares_memory_and_inputs_are_not_copied(monkeypatch: pytest.MonkeyPatch) -> None:
    f = to_torch(ROBOT.kernel("fk"))
    seen, made = [], []

    def kernel(q: np.ndarray) -> np.ndarray:
        seen.append(q)
        made.append(np.zeros((3, 4, 4)))
        return made[0]

    monkeypatch.setitem(f._kernels, ("cpu", "float64"), kernel)
    T = f(Q)
    assert np.shares_memory(seen[0], Q.numpy())
    assert np.shares_memory(T.numpy(), made[0])


def test_gradients_through_a_kernel_reach_a_goal() -> None:
    fk = to_torch(ROBOT.kernel("fk"))
    goal = fk(torch.tensor(ROBOT.configurations["qr"]))[:3, 3]
    q = torch.tensor(ROBOT.configurations["qr"] + 0.3, requires_grad=True)
    optimizer = torch.optim.LBFGS([q], max_iter=50, line_search_fn="strong_wolfe")

    def loss() -> torch.Tensor:
        optimizer.zero_grad()
        distance = ((fk(q)[:3, 3] - goal) ** 2).sum()
        distance.backward()
        return distance

    optimizer.step(loss)
    assert float(loss().detach()) < 1e-9


def test_it_is_pickled_and_shown() -> None:
    f = pickle.loads(pickle.dumps(to_torch(ROBOT.kernel("fk"))))
    assert torch.equal(f(Q), to_torch(ROBOT.function("fk"))(Q))
    assert repr(f) == "<torch function fk(7)->(4,4)>"


def test_refusals_say_what_to_do() -> None:
    f = to_torch(ROBOT.kernel("inverse_dynamics"))
    with pytest.raises(InputError, match=r"`q` is of type ndarray; expected a torch.Tensor. torch.as_tensor"):
        f(Q.numpy(), Q, Q)
    with pytest.raises(DtypeError, match=r"`q` has dtype torch.int64; .* q.double\(\)"):
        f(torch.zeros(7, dtype=torch.int64), Q, Q)
    with pytest.raises(DtypeError, match=r"`v` has dtype torch.float32; expected torch.float64 as `q` has"):
        f(Q, Q.float(), Q)
    with pytest.raises(
        InputError, match=r"`q` is on meta; expected a tensor on the CPU, or on an NVIDIA GPU. tensor.cpu\(\)"
    ):
        f(*3 * (Q.to("meta"),))
    with pytest.raises(InputError, match=r"`v` is on meta; expected cpu, where `q` is"):
        f(Q, Q.to("meta"), Q)
    with pytest.raises(ShapeError, match=r"`v` has shape \(3, 6\); expected \(\.\.\., 7\)"):
        f(Q, Q[:, :6], Q)
    with pytest.raises(ShapeError, match="leading axes that broadcast"):
        f(Q, Q[:2], Q)
    with pytest.raises(TypeError, match=r"takes 3 arguments; 1 were given"):
        f(Q)
    with pytest.raises(InputError, match=r"expected a kernel, such as robot.kernel\('fk'\)"):
        to_torch(ROBOT.fk)


def test_kernels_take_tensors_and_say_which_function_knows_derivatives() -> None:
    kernel = ROBOT.kernel("fk")
    np.testing.assert_array_equal(kernel(Q), ROBOT.fk(Q.numpy()))
    np.testing.assert_array_equal(ROBOT.fk(Q[0]), ROBOT.fk(Q[0].numpy()))
    for call in (kernel, ROBOT.fk):
        with pytest.raises(
            InputError, match=r"`q` is a Tensor of torch that .* requires grad.*ulna.interop.to_torch"
        ):
            call(Q.clone().requires_grad_())
        with pytest.raises(
            InputError, match=r"`q` is a Tensor of torch that .*ulna.interop.to_torch\(kernel\)"
        ):
            torch.func.vmap(call)(Q)


def test_derivatives_pass_through_loops() -> None:
    from ulna.numeric import loop

    f = to_torch(ulna.compile(lambda x: loop(lambda y: y > 1.0, lambda y: (0.5 * y * y,), (x,), 20)[0], x=()))
    x = torch.tensor(1.8, dtype=torch.float64, requires_grad=True)
    f(x).backward()
    assert float(f(x).detach()) == pytest.approx(1.8**8 / 128.0)  # three iterations
    assert float(x.grad) == pytest.approx(1.8**7 / 16.0)
    assert torch.autograd.gradcheck(f, (x,))
