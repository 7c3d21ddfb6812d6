"""Kernels on a real GPU equal those on the CPU: with PyTorch's tensors, on streams, with its derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.errors import DtypeError, InputError
from ulna.interop import to_torch

torch = pytest.importorskip("torch")
if not torch.cuda.is_available():
    pytest.skip("there is no GPU", allow_module_level=True)
pytest.importorskip("cuda.core")

ROBOT = ulna.load("panda")
Q = torch.tensor(ROBOT.random_configuration(1000, seed=1))


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize(
    ("name", "count"), [("fk", 1), ("jacobian", 1), ("inverse_dynamics", 3), ("forward_dynamics", 3), ("mass_matrix", 1)]
)  # fmt: skip
def test_results_are_those_of_the_cpu(name: str, count: int, dtype: str) -> None:
    torch.manual_seed(1)
    arrays = [Q, torch.randn(1000, 7, dtype=Q.dtype), torch.randn(7, dtype=Q.dtype)][:count]
    on_gpu = [x.to("cuda", getattr(torch, dtype)) for x in arrays]
    found = ROBOT.kernel(name, device="cuda", dtype=dtype)(*on_gpu).cpu().numpy()
    expected = ROBOT.kernel(name)(*(x.numpy() for x in arrays))
    size = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(found / size, expected / size, atol=1e-13 if dtype == "float64" else 1e-5)


def test_out_streams_and_layouts() -> None:
    fk, expected = ROBOT.kernel("fk", device="cuda"), ROBOT.fk(Q.numpy())
    q = Q.cuda()
    out = torch.empty(1000, 4, 4, dtype=q.dtype, device="cuda")
    stream = torch.cuda.Stream()
    stream.wait_stream(torch.cuda.current_stream())
    with torch.cuda.stream(stream):
        assert fk(q, out=out) is out
    stream.synchronize()
    np.testing.assert_allclose(out.cpu(), expected, atol=1e-14)
    columns = q.T.contiguous().T
    np.testing.assert_allclose(fk(columns, stream=stream.cuda_stream).cpu(), expected, atol=1e-14)
    assert fk(q[:0]).shape == (0, 4, 4)


def test_inverse_kinematics() -> None:
    T = torch.tensor(ROBOT.fk(Q.numpy()), device="cuda")
    q, is_met, *_ = ROBOT.kernel("ik", device="cuda")(T)
    assert (is_met == 1.0).all()
    np.testing.assert_allclose(ROBOT.fk(q.cpu().numpy()), T.cpu().numpy(), atol=2e-6)


def test_derivatives_on_the_gpu() -> None:
    fk = to_torch(ROBOT.kernel("fk"))
    q = Q[:3].cuda().requires_grad_()
    assert torch.autograd.gradcheck(fk, (q,), check_forward_ad=True)


def test_refusals() -> None:
    fk = ROBOT.kernel("fk", device="cuda")
    with pytest.raises(InputError, match="in the memory of the CPU"):
        fk(Q)
    with pytest.raises(DtypeError, match="expected float64"):
        fk(Q.cuda().float())
