"""GeometryModel: the geometries of a robot, of one kind."""

from __future__ import annotations

from typing import final

from pinocchio._containers.files import register
from pinocchio._geometry.geometry_collection import GeometryCollection
from pinocchio._geometry.geometry_data import GeometryData


@final
class GeometryModel(GeometryCollection):
    """The geometries of a robot, of one kind, and the pairs of them to check for collisions."""

    def createData(self) -> GeometryData:
        """What placements and results are written into."""
        return GeometryData(self)


register(GeometryModel)
