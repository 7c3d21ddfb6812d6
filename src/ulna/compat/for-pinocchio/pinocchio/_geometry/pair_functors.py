"""Functions that ask coal about two geometries."""

from __future__ import annotations

from typing import Any

from pinocchio._geometry.geometry_object import GeometryObject
from pinocchio._geometry.pair_calls import asking


class _PairFunctor:
    """A query of coal about two geometries, created anew when one of them has another shape."""

    def __init__(self, geometry_object1: GeometryObject, geometry_object2: GeometryObject) -> None:
        self.of = geometry_object1, geometry_object2
        """The two."""
        self._shapes: tuple[Any, Any] = (None, None)
        self._ask: Any = None

    def getGeometryObject1(self) -> GeometryObject:
        """The first geometry."""
        return self.of[0]

    def getGeometryObject2(self) -> GeometryObject:
        """The second geometry."""
        return self.of[1]

    def run(self, tf1: Any, tf2: Any, request: Any, result: Any) -> Any:
        """Asks coal, the geometries being at two Transform3s; fills `result`."""
        one, two = self.of
        first, second = one.geometry, two.geometry
        if first is not self._shapes[0] or second is not self._shapes[1]:
            self._shapes = first, second
            self._ask = asking(type(self).__name__, first, second)
        result.clear()
        return self._ask(tf1, tf2, request, result)

    def __call__(self, tf1: Any, tf2: Any, request: Any, result: Any) -> Any:
        """See `run`."""
        return self.run(tf1, tf2, request, result)


class ComputeCollision(_PairFunctor):
    """A function that asks coal whether two geometries touch; answers how many contacts there are."""


class ComputeDistance(_PairFunctor):
    """A function that asks coal for the distance of two geometries [m]."""
