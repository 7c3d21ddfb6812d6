"""Calls of coal for the pairs of a geometry model, made once for all its data."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from operator import is_
from typing import Any, final

from pinocchio._geometry.geometry_collection import GeometryCollection
from ulna.collision.narrow import coal


def asking(kind: str, one: Any, two: Any) -> Callable[..., Any]:
    """A call of coal about two geometries: from two Transform3s, request and result to the answer.

    Args:
        kind: Name of coal's class, such as "ComputeCollision".
        one: A geometry of coal.
        two: The other geometry.

    Returns:
        The call.
    """
    functor = getattr(coal(), kind)(one, two)
    call = type(functor).__call__  # wrapped for programs (see coal_poses); here poses are coal's
    return functools.partial(getattr(call, "__wrapped__", call), functor)


@final
class PairCalls:
    """The calls of a kind for the pairs of a geometry model, each made when it is first needed."""

    __slots__ = ("_calls", "_kind", "_objects", "_shapes", "first", "second")

    def __init__(self, kind: str, geometries: GeometryCollection) -> None:
        self._kind, self._objects = kind, list(geometries.geometryObjects)
        self.first = [pair.first for pair in geometries.collisionPairs]
        self.second = [pair.second for pair in geometries.collisionPairs]
        self._shapes: list[Any] = [None] * len(self._objects)
        self._calls: list[Any] = [None] * len(self.first)

    def fits(self, geometries: GeometryCollection) -> bool:
        """Whether geometries, their shapes and the pairs are those of the calls."""
        objects, pairs = geometries.geometryObjects, geometries.collisionPairs
        same = len(objects) == len(self._objects) and all(map(is_, objects, self._objects))
        return (
            same
            and all(
                [
                    shape is None or one._coal is shape
                    for one, shape in zip(objects, self._shapes, strict=True)
                ]
            )
            and [pair.first for pair in pairs] == self.first
            and [pair.second for pair in pairs] == self.second
        )

    def of(self, chosen: Sequence[int]) -> list[Any]:
        """The calls of all pairs, of which those of some are made; None for others."""
        for k in chosen:
            if self._calls[k] is None:
                ends = self.first[k], self.second[k]
                for i in ends:
                    self._shapes[i] = self._objects[i].geometry
                self._calls[k] = asking(self._kind, *(self._shapes[i] for i in ends))
        return self._calls


def calls_of(geometries: GeometryCollection, kind: str) -> PairCalls:
    """The calls of a kind for the pairs of a geometry model, kept with it.

    Args:
        geometries: The geometry model.
        kind: "ComputeCollision" or "ComputeDistance".

    Returns:
        The calls, made anew where a geometry, a shape or a pair is another one.
    """
    calls_by_kind: dict[str, PairCalls] = geometries.__dict__.setdefault("_pair_calls", {})
    known = calls_by_kind.get(kind)
    if known is None or not known.fits(geometries):
        known = calls_by_kind[kind] = PairCalls(kind, geometries)
    return known
