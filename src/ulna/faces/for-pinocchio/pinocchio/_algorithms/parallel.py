"""Many configurations at once: columns of matrices, computed by kernels that take batches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pinocchio._containers.arrays import StdVec, index, matrix
from pinocchio._containers.keywords import by_name
from pinocchio._model.model import Model
from ulna.errors import InputError

if TYPE_CHECKING:
    from pinocchio._data.data import Data
    from pinocchio._geometry.geometry_model import GeometryData, GeometryModel


class ModelPool:
    """A model with several data; the number of threads is told to each call."""

    def __init__(self, model: Model | ModelPool, size: int = 1) -> None:
        if isinstance(model, ModelPool):
            self._model, self._datas = model._model, StdVec(d.copy() for d in model._datas)
        else:
            self._model, self._datas = model, StdVec(model.createData() for _ in range(int(size)))

    def size(self) -> int:
        """How many data there are."""
        return len(self._datas)

    def resize(self, new_size: int) -> None:
        """Changes how many data there are."""
        kept = list(self._datas)[: int(new_size)]
        self._datas = StdVec([*kept, *(self._model.createData() for _ in range(int(new_size) - len(kept)))])

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
        """One of its own."""
        return type(self)(self)

    __copy__ = copy


class GeometryPool(ModelPool):
    """A model and a geometry model with several data of both."""

    def __init__(
        self, model: Model | GeometryPool, geometry_model: GeometryModel | None = None, size: int = 1
    ) -> None:
        super().__init__(model, size)
        if isinstance(model, GeometryPool):
            self._geometry = model._geometry.copy()
            self._geometry_datas = StdVec(d.copy() for d in model._geometry_datas)
        elif geometry_model is None:
            raise InputError("GeometryPool was given a model alone; expected a model and its GeometryModel.")
        else:
            self._geometry = geometry_model.copy()
            self._geometry_datas = StdVec(self._geometry.createData() for _ in range(int(size)))

    def resize(self, new_size: int) -> None:
        """Changes how many data there are."""
        super().resize(new_size)
        kept = list(self._geometry_datas)[: int(new_size)]
        more = (self._geometry.createData() for _ in range(int(new_size) - len(kept)))
        self._geometry_datas = StdVec([*kept, *more])

    @by_name("data", "geometry_data")
    def update(self, data: Any) -> None:
        """Makes all data of geometries (or all Data) like one."""
        if hasattr(data, "oMg"):
            self._geometry_datas = StdVec(data.copy() for _ in self._geometry_datas)
        else:
            super().update(data)

    def sync(self, geometry_model: GeometryModel, geometry_indexes: Any) -> None:
        """Takes over some geometries of another model of the same ones."""
        for i in geometry_indexes:
            self._geometry.geometryObjects[i] = geometry_model.geometryObjects[i].copy()

    def getGeometryModel(self, index: int) -> GeometryModel:
        """The geometry model of an index; all are one."""
        return self.getGeometryModels()[self._place(index)]

    def getGeometryModels(self) -> StdVec[GeometryModel]:
        """The geometry model, once for each of the data."""
        return StdVec([self._geometry] * self.size())

    def getGeometryData(self, index: int) -> GeometryData:
        """The geometry data of an index."""
        return self._geometry_datas[self._place(index)]

    def getGeometryDatas(self) -> StdVec[GeometryData]:
        """The data of the geometries."""
        return self._geometry_datas

    def asked(self) -> tuple[Any, ...]:
        """What `computeCollisions` is given before q."""
        return self._model, self.getData(0), self._geometry, self.getGeometryData(0)


def rneaInParallel(num_thread: int, pool: ModelPool, q: Any, v: Any, a: Any, tau: Any = None) -> Any:
    """Torques (nv, n) of n motions, one in each column; or nothing, and `tau` is filled with them."""
    return _many("inverse_dynamics", num_thread, pool, (q, v, a), tau)


def abaInParallel(num_thread: int, pool: ModelPool, q: Any, v: Any, tau: Any, a: Any = None) -> Any:
    """Accelerations (nv, n) that torques give, one in each column; or nothing, and `a` is filled with them."""
    return _many("forward_dynamics", num_thread, pool, (q, v, tau), a)


def _many(name: str, threads: int, pool: ModelPool, columns: tuple[Any, ...], into: Any) -> Any:
    if not isinstance(pool, ModelPool):
        raise InputError(f"The pool is {pool!r}; expected pinocchio.ModelPool(model).")
    model = pool.getModel(0)
    count = getattr(columns[0], "shape", (0, 0))[-1]
    sizes = (model.nq, model.nv, model.nv)
    rows = [matrix(c, (n, count), "columns").T for c, n in zip(columns, sizes, strict=True)]
    found = model.engine().plain(name)(*rows, threads=int(threads)).T
    if into is None:
        return found
    matrix(into, found.shape, "result")
    into[:] = found
    return None
