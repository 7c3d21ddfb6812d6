"""Triangles as a sequence of small codes: a walk from triangle to triangle over their common edges.

After Rossignac, Edgebreaker: connectivity compression for triangle meshes (1999). The walk holds the open directed
edges behind which triangles are left. It takes the edge u -> v that was opened last, and a code says what is there:

| code | meaning |
|---|---|
| BORDER | no triangle |
| NEW | triangle (u, v, w) with a vertex w that was not met before |
| NEXT | w is where the open edge that begins at v ends |
| PREVIOUS | w is where the open edge that ends at u begins |
| ANOTHER | w is any other vertex, named in a second sequence |

Where no edge is open, the next triangle is named by its three vertices. Vertices are numbered in the order
in which they are met. For each of them the walk knows how to predict where it is: beyond the edge, as far
as the third vertex of the triangle before it.
"""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np

from ulna.typing import Array

BORDER, NEW, NEXT, PREVIOUS, ANOTHER = range(5)


class Walk(NamedTuple):
    """A walk over all triangles of a surface."""

    codes: list[int]
    """What is behind each edge that was taken."""
    names: list[int]
    """Vertices that do not follow from the codes: 0 for a new one, else how many numbers ago it was met, from 1."""
    order: list[int]
    """The vertices in the order in which they are met."""
    predictors: list[tuple[int, int, int]]
    """Numbers (u, v, x) for each vertex: it is predicted at p_u + p_v - p_x; (x, x, x) predicts p_x, -1 the origin."""


def walk(triangles: Array) -> Walk:
    """The walk over the triangles (m, 3) of a surface. Each has three different vertices."""
    return _Walker(np.asarray(triangles, dtype=np.int64)).walk()


@final
class _Walker:
    """A walk while it is made."""

    def __init__(self, triangles: Array) -> None:
        self._triangles: list[list[int]] = triangles.tolist()
        count = int(triangles.max(initial=-1)) + 1
        self._number = [-1] * count
        self._next, self._previous, self._opposite = [-1] * count, [-1] * count, [-1] * count
        self._open: list[tuple[int, int]] = []
        self._behind: dict[tuple[int, int], list[int]] = {}
        for k, (a, b, c) in enumerate(self._triangles):
            for edge in ((a, b), (b, c), (c, a)):
                self._behind.setdefault(edge, []).append(k)
        self._done = [False] * len(self._triangles)
        self.result = Walk([], [], [], [])

    def walk(self) -> Walk:
        """All triangles, component by component."""
        for k in range(len(self._triangles)):
            if not self._done[k]:
                self._start(k)
                while self._open:
                    self._take(*self._open.pop())
        return self.result

    def _start(self, k: int) -> None:
        self._done[k] = True
        u, v, w = self._triangles[k]
        for vertex in (u, v, w):
            last = len(self.result.order) - 1
            self._name(vertex, (last, last, last))
        for a, b, opposite in ((u, v, w), (v, w, u), (w, u, v)):
            self._open_edge(b, a, opposite)

    def _take(self, u: int, v: int) -> None:
        if self._next[u] != v:  # a triangle was found on both sides meanwhile
            return
        opposite = self._opposite[u]
        self._close(u, v)
        k = next((k for k in self._behind.get((u, v), ()) if not self._done[k]), None)
        if k is None:
            self.result.codes.append(BORDER)
            return
        self._done[k] = True
        triangle = self._triangles[k]
        w = triangle[(triangle.index(v) + 1) % 3]
        self._write_code(u, v, w, opposite)
        for a, b, third in ((w, u, v), (v, w, u)):
            if self._next[a] == b:
                self._close(a, b)
            else:
                self._open_edge(b, a, third)

    def _write_code(self, u: int, v: int, w: int, opposite: int) -> None:
        codes, number = self.result.codes, self._number
        if number[w] < 0:
            codes.append(NEW)
            self._number_vertex(w, (number[u], number[v], number[opposite]))
        elif self._next[v] == w:
            codes.append(NEXT)
        elif self._previous[u] == w:
            codes.append(PREVIOUS)
        else:
            codes.append(ANOTHER)
            self._name(w, (0, 0, 0))

    def _name(self, vertex: int, predictor: tuple[int, int, int]) -> None:
        number = self._number[vertex]
        self.result.names.append(0 if number < 0 else len(self.result.order) - number)
        if number < 0:
            self._number_vertex(vertex, predictor)

    def _number_vertex(self, vertex: int, predictor: tuple[int, int, int]) -> None:
        self._number[vertex] = len(self.result.order)
        self.result.order.append(vertex)
        self.result.predictors.append(predictor)

    def _open_edge(self, u: int, v: int, opposite: int) -> None:
        self._next[u], self._previous[v], self._opposite[u] = v, u, opposite
        self._open.append((u, v))

    def _close(self, u: int, v: int) -> None:
        self._next[u] = -1
        if self._previous[v] == u:
            self._previous[v] = -1
