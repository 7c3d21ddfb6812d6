"""Many configurations at once: columns of matrices, computed by kernels that take batches."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arguments import ArgumentError, check_size
from pinocchio._containers.arrays import StdVec, index, matrix
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.errors import InputError

MOST_DATA = 100_000
"""No pool has more data: what asks for more is a mistake."""


class ModelPool:
    """A model with several data; the number of threads is an argument of each call."""

    @by_name("model size", "other")
    def __init__(self, model: Model | ModelPool, size: int = 1) -> None:
        if isinstance(model, ModelPool):
            if size != 1:
                raise ArgumentError(
                    f"ModelPool was given a pool and {size!r}; expected (model, size) or (pool)."
                )
            self._model, self._datas = model._model, StdVec(d.copy() for d in model._datas)
        else:
            if not isinstance(model, Model):
                raise ArgumentError(f"The model of a pool is {model!r}; expected a pinocchio.Model.")
            count = check_size(size, "size", MOST_DATA)
            self._model, self._datas = model, StdVec(model.createData() for _ in range(count))

    def size(self) -> int:
        """How many data there are."""
        return len(self._datas)

    def resize(self, new_size: int) -> None:
        """Changes how many data there are."""
        count = check_size(new_size, "new_size", MOST_DATA)
        remaining = list(self._datas)[:count]
        more = (self._model.createData() for _ in range(count - len(remaining)))
        self._datas = StdVec([*remaining, *more])

    def update(self, data: Data) -> None:
        """Makes all data like one."""
        self._datas = StdVec(data.copy() for _ in self._datas)

    def getModel(self, index: int) -> Model:
        """The model of an index; all are one."""
        return self.getModels()[self._place(index)]

    def getModels(self) -> StdVec[Model]:
        """The model, once for each of the data."""
        return StdVec([self._model] * self.size())

    def getData(self, index: int) -> Data:
        """The data of an index."""
        return self._datas[self._place(index)]

    def getDatas(self) -> StdVec[Data]:
        """The data."""
        return self._datas

    def _place(self, place: int) -> int:
        return index(place, self.size(), "place in the pool", "pool.resize(n) makes more.")

    def copy(self) -> Any:
        """A copy."""
        return type(self)(self)

    __copy__ = copy


def rneaInParallel(num_thread: int, pool: ModelPool, q: Any, v: Any, a: Any, tau: Any = None) -> Any:
    """The torques of n motions, one in each column.

    Args:
        num_thread: Number of threads, at most the pool's size; 0 is one.
        pool: A ModelPool, which holds the model.
        q: Configurations (nq, n) [rad or m].
        v: Velocities (nv, n) [rad/s or m/s].
        a: Accelerations (nv, n) [rad/s^2 or m/s^2].
        tau: Array (nv, n) to fill [N m or N]; None for a new one.

    Returns:
        Torques (nv, n) [N m or N]; None where `tau` is filled.

    Raises:
        ArgumentError: If `pool` is none.
        InputError: If the pool has less data than threads are asked for.
        SizeError: If `num_thread` is below zero, or so large that it must be a mistake.
    """
    return _many("inverse_dynamics", num_thread, pool, (q, v, a), tau)


def abaInParallel(num_thread: int, pool: ModelPool, q: Any, v: Any, tau: Any, a: Any = None) -> Any:
    """The accelerations under n vectors of torques, one in each column.

    Args:
        num_thread: Number of threads, at most the pool's size; 0 is one.
        pool: A ModelPool, which holds the model.
        q: Configurations (nq, n) [rad or m].
        v: Velocities (nv, n) [rad/s or m/s].
        tau: Torques (nv, n) [N m or N].
        a: Array (nv, n) to fill [rad/s^2 or m/s^2]; None for a new one.

    Returns:
        Accelerations (nv, n) [rad/s^2 or m/s^2]; None where `a` is filled.

    Raises:
        ArgumentError: If `pool` is none.
        InputError: If the pool has less data than threads are asked for.
        SizeError: If `num_thread` is below zero, or so large that it must be a mistake.
    """
    return _many("forward_dynamics", num_thread, pool, (q, v, tau), a)


def _many(name: str, threads: int, pool: ModelPool, columns: tuple[Any, ...], into: Any) -> Any:
    if not isinstance(pool, ModelPool):
        raise ArgumentError(f"The pool is {pool!r}; expected pinocchio.ModelPool(model).")
    threads = check_size(threads, "num_thread", MOST_DATA)
    if threads > pool.size():
        raise InputError(
            f"`num_thread` is {threads}, and the pool has {pool.size()} data; expected at most as many threads. "
            "ModelPool(model, n) has more."
        )
    model = pool.getModel(0)
    model._check_gravity()
    count = getattr(columns[0], "shape", (0, 0))[-1]
    sizes = (model.nq, model.nv, model.nv)
    rows = [matrix(c, (n, count), "columns").T for c, n in zip(columns, sizes, strict=True)]
    results = model._compiled().core_kernel(name)(*rows, threads=max(threads, 1)).T
    if into is None:
        return results
    matrix(into, results.shape, "result")
    into[:] = results
    return None
