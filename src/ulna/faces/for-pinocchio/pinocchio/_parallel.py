"""Many configurations at once: columns of matrices, computed by kernels that take batches."""

from __future__ import annotations

from typing import Any, final

from pinocchio._arrays import matrix
from pinocchio._model import Model
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["ModelPool", "abaInParallel", "rneaInParallel"]


@final
class ModelPool:
    """A model for calls with many configurations; the number of threads is told to each call."""

    def __init__(self, model: Model, pool_size: int = 1) -> None:
        self._model, self._size = model, int(pool_size)

    def model(self) -> Model:
        """The model."""
        return self._model

    def size(self) -> int:
        """The number that was asked for."""
        return self._size


def rneaInParallel(num_threads: int, pool: ModelPool, q: Any, v: Any, a: Any) -> Floats:
    """Torques (nv, n) of n motions, one in each column."""
    return _many("inverse_dynamics", num_threads, pool, q, v, a)


def abaInParallel(num_threads: int, pool: ModelPool, q: Any, v: Any, tau: Any) -> Floats:
    """Accelerations (nv, n) that torques give, one in each column."""
    return _many("forward_dynamics", num_threads, pool, q, v, tau)


def _many(name: str, threads: int, pool: ModelPool, *columns: Any) -> Floats:
    if not isinstance(pool, ModelPool):
        raise InputError(f"The pool is {pool!r}; expected pinocchio.ModelPool(model).")
    model = pool.model()
    count = getattr(columns[0], "shape", (0, 0))[-1]
    sizes = (model.nq, model.nv, model.nv)
    rows = [matrix(c, (n, count), "columns").T for c, n in zip(columns, sizes, strict=True)]
    return model.engine().plain(name)(*rows, threads=int(threads)).T
