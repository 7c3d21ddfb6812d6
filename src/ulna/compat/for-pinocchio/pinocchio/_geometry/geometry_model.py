"""GeometryModel: the geometries of a robot, of one kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

from pinocchio._containers.arguments import check_methods
from pinocchio._containers.files import register
from pinocchio._containers.former_names import replacement_message
from pinocchio._geometry.geometry_collection import GeometryCollection
from pinocchio._geometry.geometry_data import GeometryData


@final
class GeometryModel(GeometryCollection):
    """The geometries of a robot, of one kind, and the pairs of them to check for collisions."""

    def createData(self) -> GeometryData:
        """What placements and results are written into."""
        return GeometryData(self)

    if not TYPE_CHECKING:  # for type checkers the attributes are there

        def __getattr__(self, name: str) -> Any:
            if name == "collisionPairs":
                self._make_pairs()
                if name in self.__dict__:
                    return self.__dict__[name]
            raise self._no_attribute(name)

    def _no_attribute(self, name: str) -> AttributeError:
        text = (
            f"'GeometryModel' object has no attribute {name!r}. {replacement_message('GeometryModel', name)}"
        )
        return AttributeError(text.rstrip(), name=name, obj=self)


check_methods([GeometryModel, GeometryData])
register(GeometryModel)
