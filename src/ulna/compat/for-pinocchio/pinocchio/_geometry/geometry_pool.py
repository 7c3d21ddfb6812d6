"""GeometryPool: a model and a geometry model with several data of both, for many configurations."""

from __future__ import annotations

from typing import Any

from pinocchio._algorithms.parallel import ModelPool
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.keywords import by_name
from pinocchio._geometry.geometry_data import GeometryData
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model.model import Model


class GeometryPool(ModelPool):
    """A model and a geometry model with several data of both."""

    @by_name("model geometry_model size", "other")
    def __init__(
        self, model: Model | GeometryPool, geometry_model: GeometryModel | None = None, size: int = 1
    ) -> None:
        super().__init__(model, size)
        if isinstance(model, GeometryPool):
            self._geometry = model._geometry.copy()
            self._geometry_datas = StdVec(d.copy() for d in model._geometry_datas)
        elif geometry_model is None:
            raise ArgumentError(
                "GeometryPool was given a model alone; expected a model and its GeometryModel."
            )
        else:
            self._geometry = geometry_model.copy()
            self._geometry_datas = StdVec(self._geometry.createData() for _ in range(self.size()))

    def resize(self, new_size: int) -> None:
        """Changes how many data there are."""
        super().resize(new_size)
        remaining = list(self._geometry_datas)[: self.size()]
        more = (self._geometry.createData() for _ in range(self.size() - len(remaining)))
        self._geometry_datas = StdVec([*remaining, *more])

    @by_name("data", "geometry_data")
    def update(self, data: Any) -> None:
        """Makes all data of geometries (or all Data) like one."""
        if hasattr(data, "oMg"):
            self._geometry_datas = StdVec(data.copy() for _ in self._geometry_datas)
        else:
            super().update(data)

    def sync(self, geometry_model: GeometryModel, geometry_indexes: Any) -> None:
        """Copies some geometries from another model of the same geometries.

        Args:
            geometry_model: The other model.
            geometry_indexes: Their indices.
        """
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

    def collision_arguments(self) -> tuple[Any, ...]:
        """What `computeCollisions` is given before q."""
        return self._model, self.getData(0), self._geometry, self.getGeometryData(0)
